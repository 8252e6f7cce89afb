"""Compares the job of flips.rs with Boost odeint, diffsol and heyoka, in turns, at equal error.

    cargo bench --bench flips --no-run       # prints the path of the executable
    python benches/flips.py EXECUTABLE

It needs g++ with Boost's headers, cargo for diffsol, and heyoka (pip install heyoka); what is missing is left out.
Prints the time at some errors, between the tolerances on a straight line through the logarithms, and the ratio to that
of odeint.
"""
import math
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

ROUNDS = 3
ERRORS = [1e-4, 1e-6, 1e-8, 1e-9, 1e-10]
EXE = Path(sys.argv[1]).resolve()
HERE = Path(__file__).parent


def heyoka_lines(rows):
    try:
        import heyoka as hy
        import numpy as np
    except ImportError:
        return
    exact, grid = np.loadtxt(rows), np.arange(0.0, 1001.0)
    a, b, c = hy.make_vars("a", "b", "c")
    system = [(a, b * c * (1 / 3 - 1 / 2)), (b, c * a * (1 - 1 / 3)), (c, a * b * (1 / 2 - 1))]
    for digits in range(6, 16):
        zeros = []
        event = hy.nt_event(b, callback=lambda _, t, sign: zeros.append(t))
        body = hy.taylor_adaptive(system, [0.1, 2.0, 0.3], tol=10.0**-digits, nt_events=[event])
        least = math.inf
        for _ in range(15):
            body.time, body.state[:] = 0.0, [0.1, 2.0, 0.3]
            zeros.clear()
            start = time.perf_counter()
            run = body.propagate_grid(grid)
            least = min(least, time.perf_counter() - start)
        error = np.linalg.norm(run[-1] - exact, axis=1).max()
        yield f"{'heyoka':20} 1e-{digits} {run[3]} {len(zeros)} {error:.2e} {1e3 * least:.3f}"


def at(points, error):
    """The time at an error."""
    points = sorted(points, reverse=True)
    for (e1, t1), (e2, t2) in zip(points, points[1:]):
        if e1 >= error >= e2:
            part = math.log(e1 / error) / math.log(e1 / e2) if e1 > e2 else 0
            return math.exp((1 - part) * math.log(t1) + part * math.log(t2))
    return None


with tempfile.TemporaryDirectory() as folder:
    rows, odeint = Path(folder) / "rows", Path(folder) / "odeint"
    build = ["g++", "-std=c++17", "-O3", "-march=native", HERE / "flips.cpp", "-o", odeint]
    peers = [odeint] if subprocess.run(build).returncode == 0 else []
    target = Path(folder) / "target"
    build = ["cargo", "build", "--release", "--quiet", "--manifest-path", HERE / "diffsol/Cargo.toml", "--target-dir", target]
    if subprocess.run(build).returncode == 0:
        peers.append(target / "release/flips-diffsol")
    least = {}
    for _ in range(ROUNDS):
        lines = []
        for program in [EXE, *peers]:
            lines += subprocess.run([program, rows], capture_output=True, text=True, check=True).stdout.splitlines()
        for line in [*lines, *heyoka_lines(rows)]:
            name, (rtol, _, _, error, ms) = line[:20].strip(), line[20:].split()
            before = least.get((name, rtol), (0.0, math.inf))
            least[name, rtol] = (float(error), min(before[1], float(ms)))

by_name = defaultdict(list)
for (name, _), point in least.items():
    by_name[name].append(point)
print(f"{'ms, and the ratio to odeint':24}", *(f"{error:>14.0e}" for error in ERRORS))
for name, points in by_name.items():
    cells = []
    for error in ERRORS:
        own, other = at(points, error), at(by_name.get("odeint dopri5", []), error)
        ratio = f" {own / other:6.2f}" if own and other else "       "
        cells.append(f"{own:7.3f}{ratio}" if own else " " * 14)
    print(f"{name:24}", *cells)
