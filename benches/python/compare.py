"""The Python package beside SciPy, CyRK and Numba: ratios of times at equal error.

    python benches/python/compare.py [maps | expm | body]

Each round takes all candidates in turn. A time is the minimum over the rounds, so that the load of the machine matters
little. Errors of runs are the largest over the outputs, beside a run with rtol = 1e-13.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
import scipy.linalg
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import lieflow as lf

#: Moments and momentum of a body that tumbles, and of one that flips, where SciPy needs fewer calls.
BODIES = {"tumbling": ((1.0, 4.0, 18.0), (0.0, 2.75, 2.75)), "flipping": ((1.0, 2.0, 3.0), (0.01, 2.0, 0.0))}
J, M = BODIES["tumbling"]
SPAN, OUTPUTS = (0.0, 100.0), 1000


def seconds(candidates: dict[str, Callable[[], object]], rounds: int = 15) -> dict[str, float]:
    """The minimum time of one call of each candidate, in turn."""
    best = dict.fromkeys(candidates, np.inf)
    repeat = {}
    for name, run in candidates.items():
        start = time.perf_counter()
        run()
        repeat[name] = max(1, int(2e-3 / max(time.perf_counter() - start, 1e-9)))
    for _ in range(rounds):
        for name, run in candidates.items():
            start = time.thread_time()
            for _ in range(repeat[name]):
                run()
            best[name] = min(best[name], (time.thread_time() - start) / repeat[name])
    return best


def show(title: str, times: dict[str, float], unit: float, of: str = "ns") -> None:
    """Print the times and the ratios to the first one."""
    first = next(iter(times.values()))
    print(f"{title}: " + ", ".join(f"{n} {t / unit:.3g} {of} ({first / t:.3g}×)" for n, t in times.items()))


def maps() -> None:
    """exp, log and dexpinv of N vectors."""
    rng = np.random.default_rng(1)
    for n in (1, 100, 1000, 10_000, 100_000, 1_000_000):
        u, v = rng.standard_normal((2, n, 3))
        r = lf.so3.exp(u)
        rounds = 15 if n <= 100_000 else 5
        times = seconds({"SciPy": lambda: Rotation.from_rotvec(u).as_matrix(), "lieflow": lambda: lf.so3.exp(u),
                         "with out": lambda: lf.so3.exp(u, out=r)}, rounds)
        show(f"exp, N = {n}", times, 1e-9 * n)
        times = seconds({"SciPy": lambda: Rotation.from_matrix(r).as_rotvec(), "lieflow": lambda: lf.so3.log(r)}, rounds)
        show(f"log, N = {n}", times, 1e-9 * n)
        show(f"dexpinv, N = {n}", seconds({"lieflow": lambda: lf.so3.dexpinv(u, v)}, rounds), 1e-9 * n)


def expm() -> None:
    """exp of matrices."""
    rng = np.random.default_rng(2)
    for n in (3, 4, 6, 8, 16):
        a = rng.standard_normal((1000, n, n))
        times = seconds({"SciPy": lambda: scipy.linalg.expm(a), "lieflow": lambda: lf.expm(a)}, 5)
        show(f"expm of 1000, n = {n}", times, 1e-6 * 1000, "µs")
    a = rng.standard_normal((4, 4))
    show("expm of one 4×4", seconds({"SciPy": lambda: scipy.linalg.expm(a), "lieflow": lambda: lf.expm(a)}), 1e-6, "µs")


def quaternion_field(t: float, y: list[float]) -> list[float]:
    """(q, m) of a free body in floats."""
    w, x, y_, z, a, b, c = y
    p, q, r = a / J[0], b / J[1], c / J[2]
    return [0.5 * (-x * p - y_ * q - z * r), 0.5 * (w * p + y_ * r - z * q), 0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y_ * p), b * r - c * q, c * p - a * r, a * q - b * p]


def omega(t: float, g: np.ndarray) -> list[float]:
    """ω in the body, in floats."""
    (a, b, c), (d, e, f), (h, i, k) = g.tolist()
    x, y, z = M
    return [(x * a + y * d + z * h) / J[0], (x * b + y * e + z * i) / J[1], (x * c + y * f + z * k) / J[2]]


def omega_tumbling(t: float, g: np.ndarray) -> list[float]:
    """The same of the tumbling body, whose M[0] is 0."""
    (_, _, _), (d, e, f), (h, i, k) = g.tolist()
    return [(M[1] * d + M[2] * h) / J[0], (M[1] * e + M[2] * i) / J[1], (M[1] * f + M[2] * k) / J[2]]


def rotations(q: np.ndarray) -> np.ndarray:
    """Rotations of rows (w, x, y, z), of any length."""
    return Rotation.from_quat(q, scalar_first=True).as_matrix()


def body() -> None:
    """The attitudes of two free bodies at 1000 times."""
    global J, M
    for name, (J, M) in BODIES.items():
        one_body(name)
    calls()


def one_body(name: str) -> None:
    """The attitude of a free body at 1000 times."""
    times = np.linspace(*SPAN, OUTPUTS)
    named = lf.RigidBody(inertia=J, momentum_body=M)
    right = named.exact(times, "attitude").attitude
    start = [1.0, 0.0, 0.0, 0.0, *M]

    def scipy(tol: float) -> np.ndarray:
        run = solve_ivp(quaternion_field, SPAN, start, method="DOP853", rtol=tol, atol=tol, t_eval=times)
        return rotations(run.y[:4].T)

    candidates: dict[str, Callable[[float], np.ndarray]] = {"SciPy DOP853": scipy}

    def ours(fun: object) -> Callable[[float], np.ndarray]:
        def run(tol: float) -> np.ndarray:
            return lf.solve_ivp(fun, SPAN, np.eye(3), group="SO(3)", frame="body", rtol=tol, atol=tol, t_eval=times).y

        return run

    try:
        import CyRK

        def cyrk(tol: float) -> np.ndarray:
            def f(dy: np.ndarray, t: float, y: np.ndarray) -> None:
                dy[:] = quaternion_field(t, y.tolist())

            run = CyRK.pysolve_ivp(f, SPAN, np.array(start), method="DOP853", rtol=tol, atol=tol, t_eval=times,
                                   pass_dy_as_arg=True)
            return rotations(run.y[:4].T)

        candidates["CyRK"] = cyrk
    except ImportError:
        print("CyRK is not installed")
    candidates["lieflow, Python f"] = ours(omega_tumbling if M[0] == 0 else omega)
    try:
        import numba

        @numba.cfunc("void(float64, CPointer(float64), CPointer(float64), CPointer(float64))")
        def omega_c(t, y, v, p):  # type: ignore[no-untyped-def]
            for j in range(3):
                v[j] = (p[3] * y[j] + p[4] * y[3 + j] + p[5] * y[6 + j]) / p[j]

        candidates["lieflow, Numba address"] = ours(lf.CFunction(omega_c, [*J, *M]))
    except ImportError:
        print("Numba is not installed")

    columns = [f"(m1*y1{j} + m2*y2{j} + m3*y3{j})/J{j}" for j in (1, 2, 3)]
    candidates["formula"] = ours(lf.Field("SO(3)", columns, m=M, J=J))

    def by_name(method: str) -> Callable[[float], np.ndarray]:
        return lambda tol: lf.solve_ivp(
            named, SPAN, method=method, rtol=tol, atol=tol, t_eval=times, quantities="attitude"
        ).attitude

    candidates["by name, rkmk dop853"] = by_name("rkmk dop853 exp")
    candidates["by name, taylor16"] = by_name("taylor16")
    candidates["exact"] = lambda tol: named.exact(times, "attitude").attitude
    candidates["method exact"] = lambda tol: lf.solve_ivp(
        named, SPAN, method="exact", steps=1, t_eval=times, quantities="attitude"
    ).attitude

    for goal in (1e-6, 1e-9):
        runs = {}
        for way, run in candidates.items():
            # The largest tolerance, in steps of 10^(1/4), whose error is at most the goal.
            tol = 1e-3
            while np.abs(run(tol) - right).max() > goal and tol > 1e-15:
                tol /= 10**0.25
            runs[way] = lambda run=run, tol=tol: run(tol)
        show(f"{name} body, error {goal:g}", seconds(runs, 7), 1e-3, "ms")


def calls() -> None:
    """Dense output, and what a call costs beside its steps."""
    dense = lf.solve_ivp(omega, SPAN, np.eye(3), group="SO(3)", frame="body", dense_output=True)
    at = np.linspace(*SPAN, 100_000)
    show("sol at 1e5 times", seconds({"lieflow": lambda: dense.sol(at)}, 5), 1e-9 * 1e5)
    settings = {"group": "SO(3)", "frame": "body", "steps": 1}
    named = lf.RigidBody(inertia=J, momentum_body=M)
    show("a call by name, one step", seconds({"lieflow": lambda: lf.solve_ivp(named, (0, 1e-3), steps=1)}), 1e-6, "µs")
    show("a call with one step", seconds({"lieflow": lambda: lf.solve_ivp(omega, (0, 1e-3), np.eye(3), **settings)}), 1e-6, "µs")


if __name__ == "__main__":
    print(f"NumPy {np.__version__}, SciPy {scipy.__version__}, lieflow {lf.__version__}")
    for part in sys.argv[1:] or ["maps", "expm", "body"]:
        {"maps": maps, "expm": expm, "body": body}[part]()
