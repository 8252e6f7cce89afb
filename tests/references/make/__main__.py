"""python3 -m make [name ...]: write these files, or all of them; names as in the README."""
import importlib
import subprocess
import sys

NAMES = ["dexp", "expm", "expm_complex", "fluids", "hard", "log", "maps", "rigid_body", "se3", "so3"]

names = sys.argv[1:] or NAMES
if len(names) == 1:
    importlib.import_module("make." + names[0]).main()
else:  # each with its own precision
    for name in names:
        subprocess.run([sys.executable, "-m", "make", name], check=True)
