"""Compares the fluid on the sphere with quflow: the same flow, the same N, the same start, in turns.

    cargo bench --bench zeitlin --no-run       # prints the path of the executable
    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 NUMBA_NUM_THREADS=1 \\
        python benches/zeitlin.py EXECUTABLE [N ...]

It needs quflow (github.com/klasmodin/quflow) and its dependencies. h = ħ/4, a random field of l < 10.
lieflow runs with its default tolerance, which is rounding, and with 1e-10. quflow runs with its default
tolerance, and to rounding (tol = 1e-16·‖W‖, compensated, any number of iterations). Compare rows of about
the same `spectrum` and `error`: `error` is the relative distance to the state of lieflow, `spectrum` the
largest change of an eigenvalue. Times are CPU times of the thread, the minimum over rounds.
"""
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import quflow
from quflow.integrators import isomp_fixedpoint

EXE, SIZES = sys.argv[1], [int(n) for n in sys.argv[2:]] or [32, 64, 128, 256, 512]
ROUNDS = 3


def load(path, n):
    return np.fromfile(path, dtype=np.complex128).reshape(n, n)


def gap(a, b):
    return np.abs(np.linalg.eigvalsh(-1j * a) - np.linalg.eigvalsh(-1j * b)).max()


def peer(w0, dt, steps, **kwargs):
    w, stats = w0.copy(), {"_": 0}
    begin = time.thread_time()
    w = isomp_fixedpoint(w, dt, steps=steps, stats=stats, **kwargs)
    return 1e3 * (time.thread_time() - begin) / steps, w, stats["iterations"]


print("    N  who                  ms/step  iterations  spectrum     error      dH/H   times ours")
for n in SIZES:
    steps = 200 if n < 200 else 60
    dt = 0.25 * quflow.geometry.hbar(n)
    with tempfile.TemporaryDirectory() as d:
        subprocess.run([EXE, "--exchange", d, str(n), "1", "0"], check=True, capture_output=True)
        w0 = load(Path(d) / "start", n)
        tight = {"tol": 1e-16 * np.linalg.norm(w0, np.inf), "maxit": 100, "compsum": True}
        best = {}
        for _ in range(ROUNDS):
            for tolerance in ["0", "1e-10"]:
                out = subprocess.run([EXE, "--exchange", d, str(n), str(steps), tolerance],
                                     check=True, capture_output=True, text=True).stdout
                for line in out.splitlines():
                    rule, ms, iterations, *_ = line.split()
                    name = rule if tolerance == "0" else f"{rule} 1e-10"
                    best[name] = (min(best.get(name, (9e9,))[0], float(ms)),
                                  load(Path(d) / rule, n), float(iterations))
            for name, kwargs in [("quflow", {}), ("quflow to rounding", tight)]:
                now = peer(w0, dt, steps, **kwargs)
                best[name] = (min(best.get(name, (9e9,))[0], now[0]), *now[1:])
        ours = best["isospectral"]
        energy = quflow.energy_euler(w0)
        for name, (ms, w, iterations) in best.items():
            error = np.linalg.norm(w - ours[1]) / np.linalg.norm(w)
            drift = abs(quflow.energy_euler(w) / energy - 1)
            print(f"{n:5}  {name:18} {ms:9.3f}  {iterations:9.1f}  {gap(w, w0):9.1e} {error:9.1e} "
                  f"{drift:9.1e}  {ms / ours[0]:9.2f}", flush=True)
