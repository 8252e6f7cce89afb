"""The integrator for quflow, without quflow."""

from __future__ import annotations

import inspect
import pickle

import numpy as np
import pytest

import lieflow as lf
from lieflow.interop.quflow import _fluid, _matrix, isomp

N = 17


def solve_poisson(w):
    """Has the name of quflow's default Hamiltonian."""
    raise AssertionError("it is not called")


solve_poisson.__module__ = "quflow.laplacian.direct"


def another(w):
    raise AssertionError("it is not called")


another.__name__ = "solve_poisson"


@pytest.fixture
def w(rng):
    a = rng.standard_normal((N, N)) + 1j * rng.standard_normal((N, N))
    w = a - a.conj().T
    return w - np.trace(w) / N * np.eye(N)


def test_the_signature_is_that_of_quflow():
    # inspect.getfullargspec is what quflow.solve calls.
    names = inspect.getfullargspec(isomp).args
    assert names == ["W", "dt", "steps", "hamiltonian", "time", "forcing", "strang_splitting", "stats", "callback", "tol",
                     "maxit", "minit", "verbatim", "compsum", "reinitialize"]
    assert pickle.loads(pickle.dumps(isomp)) is isomp


def test_it_keeps_the_spectrum_and_is_the_run_by_name(w):
    before, levels = w.copy(), np.linalg.eigvalsh(-1j * w)
    stats: dict[str, float] = {"_": 0}
    out = isomp(w, 0.01, steps=20, hamiltonian=solve_poisson, time=0.0, stats=stats)
    assert out is w and not np.array_equal(w, before)
    assert np.abs(np.linalg.eigvalsh(-1j * w) - levels).max() < 1e-12
    assert np.abs(w + w.conj().T).max() < 1e-13 and stats["number_of_maxit"] == 0
    shorter = {"_": 0}
    isomp(before.copy(), 0.001, steps=20, stats=shorter)
    assert 2 < shorter["iterations"] < stats["iterations"] < 50
    state = np.concatenate([before.real.ravel("F"), before.imag.ravel("F")])
    r = lf.solve_ivp(_fluid(N), (0, 0.2), state, method="isospectral2", steps=20, t_eval=[0.2], quantities="matrix")
    assert np.abs(r.matrix[0] - w).max() < 1e-12


def test_steps_go_there_and_back(w):
    h = 0.05
    half = isomp(isomp(w.copy(), h / 2, 1), h / 2, 1)
    assert np.abs(isomp(w.copy(), h, 1) - half).max() < 0.2 * np.abs(half - w).max()
    back = isomp(isomp(w.copy(), h, 3), -h, 3)
    assert np.abs(back - w).max() < 1e-11


def test_the_callback_sees_each_step(w):
    seen = []
    alone = isomp(w.copy(), 0.01, 3)
    out = isomp(w, 0.01, 3, callback=lambda x, dx: seen.append((x.copy(), dx)))
    assert len(seen) == 3 and np.abs(seen[-1][0] + seen[-1][1] - out).max() < 1e-15 and np.array_equal(out, alone)


@pytest.mark.parametrize(
    ("change", "argument"),
    [({"hamiltonian": np.sin}, "hamiltonian"), ({"hamiltonian": another}, "hamiltonian"), ({"forcing": np.sin}, "forcing"), ({"strang_splitting": np.sin}, "strang_splitting"),
     ({"steps": -1}, "steps"), ({"W": np.eye(4)}, "W"), ({"W": np.eye(4, dtype=complex)}, "W"),
     ({"W": np.full((3, 3), np.nan + 0j)}, "W"), ({"W": np.broadcast_to(0j, (3, 3))}, "W"), ({"steps": np.nan}, "steps")],
)
def test_what_is_not_done_is_refused_by_name(w, change, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        isomp(**{"W": w, "dt": 0.01, **change})
    assert caught.value.argument == argument
    assert _matrix(np.arange(8.0), 2)[0, 1] == 2 + 6j
