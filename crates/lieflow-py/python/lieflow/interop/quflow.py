"""The isospectral midpoint rule as an integrator of quflow: ``quflow.solve(W, integrator=isomp, …)``.

quflow inspects and pickles its integrator, so that this is a plain function with the arguments of its
``isomp_fixedpoint``. The fluid is that on the sphere: Ẇ = [P, W]/ħ with ΔP = W. Each step is iterated to rounding.
Source: K. Modin, M. Viviani, Lie–Poisson methods for isospectral flows, Found. Comput. Math. 20 (2020).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import number, whole
from .._errors import ArgumentError
from .._integrator import Integrator
from .._problems import Problem, problem_of

__all__ = ["isomp"]

Complex = NDArray[np.complex128]


_FLUIDS: dict[int, Problem] = {}


def _fluid(n: int) -> Problem:
    """The fluid on the sphere with n×n matrices. Its own start is not used."""
    if n not in _FLUIDS:
        _FLUIDS[n] = problem_of("fluid", {"surface": "sphere", "n": n, "jets": [[1, 1.0]]})
    return _FLUIDS[n]


def isomp(
    W: Complex,
    dt: float,
    steps: int = 100,
    hamiltonian: Callable[..., Any] | None = None,
    time: float | None = None,
    forcing: Callable[..., Any] | None = None,
    strang_splitting: Callable[..., Any] | None = None,
    stats: dict[str, Any] | None = None,
    callback: Callable[[Complex, Complex], Any] | None = None,
    tol: float | str = "auto",
    maxit: int = 10,
    minit: int = 1,
    verbatim: bool = False,
    compsum: bool = False,
    reinitialize: bool = False,
) -> Complex:
    """Take steps of the isospectral midpoint rule. W is overwritten and returned.

    Parameters
    ----------
    W : (N, N) array of complex128
        A skew-Hermitian matrix, N ≤ 512.
    dt : float
        The step size, negative backward.
    steps : int
        The number of steps.
    hamiltonian : callable, optional
        None, or quflow's ``solve_poisson``. Another one is refused.
    time, forcing, strang_splitting : None
        ``time`` has no effect on an autonomous flow. A forcing and a splitting are refused.
    stats : dict, optional
        Gets ``iterations``, the mean number for a step, and ``number_of_maxit``, which is 0: each step is iterated to
        rounding.
    callback : callable, optional
        callback(W, dW) after each step, before W is changed.
    tol, maxit, minit, verbatim, compsum, reinitialize
        Have no effect: each step is iterated to rounding, from a guess that is extrapolated from the steps before.
    """
    if not isinstance(W, np.ndarray):
        raise TypeError(f"W: a value of type {type(W).__name__}, expected an array of complex128")
    if W.dtype != np.complex128 or W.ndim != 2 or W.shape[0] != W.shape[1]:
        raise ArgumentError("W", f"an array of {W.dtype}, shape {W.shape}", "complex128, shape (N, N)")
    if not np.isfinite(W).all():
        raise ArgumentError("W", "a number that is not finite", "finite numbers")
    off = np.abs(W + W.conj().T).max(initial=0.0)
    if off > 1e-10 * max(np.abs(W).max(initial=0.0), 1e-300):
        raise ArgumentError("W", f"a matrix with |W + W*| = {off:.1e}", "a skew-Hermitian matrix")
    package = getattr(hamiltonian, "__module__", None) or ""
    is_quflows = getattr(hamiltonian, "__name__", "") == "solve_poisson" and package.partition(".")[0] == "quflow"
    if hamiltonian is not None and not is_quflows:
        name = getattr(hamiltonian, "__name__", repr(hamiltonian))
        raise ArgumentError("hamiltonian", name, "solve_poisson of quflow, the fluid on the sphere")
    for name, given in (("forcing", forcing), ("strang_splitting", strang_splitting)):
        if given is not None:
            raise ArgumentError(name, repr(given), "None")
    if not W.flags.writeable:
        raise ArgumentError("W", "a read-only array", "an array that is overwritten")
    steps, dt = whole("steps", steps), number("dt", dt)
    if steps == 0:
        return W
    n = W.shape[0]
    state = np.concatenate([W.real.ravel("F"), W.imag.ravel("F")])
    run = Integrator(
        _fluid(n), "isospectral2", (0.0, dt * steps), state, steps=steps, quantities="enstrophy"
    )
    if callback is None:
        run.advance_to(run.t_end)
        W[...] = _matrix(run.state, n)
    else:
        for _ in range(steps):
            run.step()
            after = _matrix(run.state, n)
            callback(W, after - W)
            W[...] = after
    if stats is not None:
        stats.update(iterations=run._run.stats()[3] / steps, number_of_maxit=0.0)
    return W


def _matrix(state: NDArray[np.float64], n: int) -> Complex:
    """The matrix of the numbers of a state, which are by columns."""
    re, im = state.reshape(2, n, n).swapaxes(1, 2)
    return np.asarray(re + 1j * im)
