"""SciPy's tests of solve_ivp and of expm, restated. The vectors of solve_ivp are numbers in Parts."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import lieflow as lf

LINE = lf.Parts(y="numbers 2")
LOOSE = {"rtol": 1e-8, "atol": 1e-8}


def rational(t, y):
    """SciPy's fun_rational, with y1 = t/(t + 10), y2 = 10 t/(t + 10)²."""
    a, b = y.y
    return {"y": [b / t, b * (a + 2 * b - 1) / (t * (a - 1))]}


def sol_rational(t):
    return np.array([t / (t + 10), 10 * t / (t + 10) ** 2]).T


def ivp(fun, span, y0, **options):
    return lf.solve_ivp(fun, span, {"y": y0}, group=LINE, **{**LOOSE, **options})


@pytest.mark.parametrize("method", ["rkmk bs3 exp", "rkmk dopri5 exp", "rkmk dop853 exp", "rkmk verner6 exp", "rk dop853"])
@pytest.mark.parametrize("span", [(5, 9), (5, 1)])
@pytest.mark.parametrize("t_eval", [None, "grid"])
def test_integration(method, span, t_eval):
    times = None if t_eval is None else np.linspace(*span, 10)
    r = ivp(rational, span, [1 / 3, 2 / 9], method=method, t_eval=times, dense_output=True)
    assert r.status == 0 and r.success and "end" in r.message and r.t_events == []
    assert r.t[0] == span[0] and r.t[-1] == span[1] and r.nfev > 0
    assert np.abs(r.y["y"] - sol_rational(r.t)).max() < 1e-6
    middle = 0.5 * sum(span)
    assert np.abs(r.sol(middle)["y"] - sol_rational(middle)).max() < 1e-6
    assert np.abs(r.sol(r.t)["y"] - r.y["y"]).max() < 1e-13


def test_events():
    """SciPy's test_events: the zeros of the components, their directions, and an end."""
    def first(t, y):
        return y.y[0] - y.y[1] ** 0.7

    def second(t, y):
        return y.y[1] ** 0.6 - y.y[0]

    def third(t, y):
        return t - 7.4

    for method in ("rkmk dopri5 exp", "rkmk dop853 exp"):
        r = ivp(rational, (5, 8), [1 / 3, 2 / 9], method=method, events=(first, second))
        assert r.status == 0 and len(r.t_events[0]) == 1 and 5.3 < r.t_events[0][0] < 5.7
        assert len(r.t_events[1]) == 1 and 7.3 < r.t_events[1][0] < 7.7
        assert np.abs(sol_rational(r.t_events[1][0]) - r.y_events[1].y[0]).max() < 1e-6
        first.direction, second.direction = 1, 1
        r = ivp(rational, (5, 8), [1 / 3, 2 / 9], method=method, events=(first, second))
        assert len(r.t_events[0]) == 1 and len(r.t_events[1]) == 0
        first.direction, second.direction = -1, -1
        r = ivp(rational, (5, 8), [1 / 3, 2 / 9], method=method, events=(first, second))
        assert len(r.t_events[0]) == 0 and len(r.t_events[1]) == 1
        first.direction = second.direction = 0
        third.terminal = True
        r = ivp(rational, (5, 8), [1 / 3, 2 / 9], method=method, events=(first, second, third), dense_output=True)
        assert r.status == 1 and r.t_events[2][0] == pytest.approx(7.4, abs=1e-13) and len(r.t_events[1]) == 0
        assert r.t[-1] == r.t_events[2][0] and r.sol.t_max == r.t[-1]
        third.terminal = False


def test_terminal_after_some_zeros():
    """SciPy's test_event_terminal_integer and bounces: 7 zeros of sin."""
    crossing = lf.Event(lambda t, y: y.y[0], terminal=7)
    r = ivp(lambda t, y: {"y": [y.y[1], -y.y[0]]}, (0, 100), [1.0, 0.0], events=crossing)
    assert r.status == 1 and np.abs(r.t_events[0] - (0.5 + np.arange(7)) * np.pi).max() < 1e-6


def test_limits_of_steps():
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], max_step=0.1)
    assert np.diff(r.t).max() <= 0.1 + 1e-12
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], first_step=0.01)
    assert r.t[1] == pytest.approx(5.01)
    for bad in ({"max_step": -1}, {"first_step": -1}, {"first_step": 0}, {"max_steps": 0}):
        with pytest.raises(lf.ArgumentError):
            ivp(rational, (5, 9), [1 / 3, 2 / 9], **bad)
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], max_steps=2)
    assert r.status == -1 and r.t_end < 9


def test_t_eval():
    for bad in ([4, 6], [5, 9.5], [6, 5.5]):
        with pytest.raises(lf.ArgumentError):
            ivp(rational, (5, 9), [1 / 3, 2 / 9], t_eval=bad)
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], t_eval=[5, 5.01, 7, 8, 8.01, 9])
    assert np.array_equal(r.t, [5, 5.01, 7, 8, 8.01, 9]) and np.abs(r.y["y"] - sol_rational(r.t)).max() < 1e-6
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], t_eval=[])
    assert len(r.t) == 0 and r.y["y"].shape == (0, 2)
    # An end before the last time of t_eval: what was reached.
    r = ivp(rational, (5, 9), [1 / 3, 2 / 9], t_eval=np.linspace(5, 9, 9), events=lf.Event(lambda t, y: t - 7.1, terminal=1))
    assert np.array_equal(r.t, np.linspace(5, 7, 5))


def test_no_integration_and_args():
    r = ivp(lambda t, y: {"y": [1.0, 1.0]}, (4, 4), [2.0, 3.0], dense_output=True)
    assert np.array_equal(r.sol(4)["y"], [2, 3]) and r.nsteps == 0
    r = ivp(lambda t, y, p, q: {"y": [p, q]}, (0, 2), [0.0, 0.0], args=(1.0, -2.0), events=lambda t, y, p, q: y.y[1] + q)
    assert np.allclose(r.y_end["y"], [2, -4]) and r.t_events[0][0] == pytest.approx(-1.0) if len(r.t_events[0]) else True


BURKARDT = [
    [[1.0, 2.0], [3.0, 0.0]],
    [[1.0, 3.0], [3.0, 2.0]],
    [[0.0, 1.0], [-39.0, -40.0]],
    [[-49.0, 24.0], [-64.0, 31.0]],
    [[0.0, 6.0, 0.0, 0.0], [0.0, 0.0, 6.0, 0.0], [0.0, 0.0, 0.0, 6.0], [0.0, 0.0, 0.0, 0.0]],
    [[1.0, 1.0], [0.0, 1.0]],
    [[1.0 + np.finfo(float).eps, 1.0], [0.0, 1.0 - np.finfo(float).eps]],
    [[21.0, 17.0, 6.0], [-5.0, -1.0, -6.0], [4.0, 4.0, 16.0]],
    [[1.0, 2.0, 2.0, 2.0], [3.0, 1.0, 1.0, 2.0], [3.0, 2.0, 1.0, 2.0], [3.0, 3.0, 3.0, 1.0]],
    [[4.0, 2.0, 0.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]],
    [[29.87942128909879, 0.7815750847907159, -2.289519314033932],
     [0.7815750847907159, 25.72656945571064, 8.680737820540137],
     [-2.289519314033932, 8.680737820540137, 34.39400925519054]],
    [[-131.0, 19.0, 18.0], [-390.0, 56.0, 54.0], [-387.0, 57.0, 52.0]],
]


def expm_in_80_bits(a):
    """The exponential by Taylor's series in extended precision. (SciPy 1.17 is off by 1e-12 for the ninth matrix.)"""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(a).sum(0).max(), 1e-30)))) + 3)
    x = np.asarray(a, dtype=np.longdouble) / np.longdouble(2) ** halvings
    total = term = np.eye(len(a), dtype=np.longdouble)
    for k in range(1, 30):
        term = term @ x / k
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total.astype(float)


@pytest.mark.parametrize("matrix", BURKARDT)
def test_burkardts_matrices(matrix):
    a = np.array(matrix)
    right = expm_in_80_bits(a)
    condition = max(np.linalg.norm(a), 1.0)
    assert np.abs(lf.expm(a) - right).max() < 1e-13 * condition * np.abs(right).max()


def test_expm_of_scipys_other_matrices():
    assert np.array_equal(lf.expm(np.zeros((2, 2))), np.eye(2)) and np.array_equal(lf.expm([[0, 0], [0, 0]]), np.eye(2))
    assert lf.expm([[1]]) == np.exp(1) and lf.expm(np.zeros((0, 0))).shape == (0, 0)
    assert lf.expm(np.zeros((0, 3, 3))).shape == (0, 3, 3)
    assert np.allclose(lf.expm(np.array([[2, 5], [0, -3]])), [[np.exp(2), np.exp(2) - np.exp(-3)], [0, np.exp(-3)]], rtol=1e-14)
    # Two by two, Sylvester's formula; SciPy's issues 9548 and 10036.
    tiny = np.array([[0.0, 1e-8], [-1e-8, 0.0]])
    assert np.allclose(lf.expm(tiny), np.eye(2) + tiny, rtol=0, atol=1e-16)
    big = np.array([[-7.9, 1e4], [0.0, -7.9]])
    assert np.allclose(lf.expm(big), np.exp(-7.9) * np.array([[1, 1e4], [0, 1]]), rtol=1e-12)
    complex_one = np.array([[1j, 2.0], [0.5, -1j]])
    assert np.abs(lf.expm(complex_one) - scipy.linalg.expm(complex_one)).max() < 1e-14


@pytest.mark.parametrize("n", [2, 3, 4, 6, 8, 16])
def test_batches_of_mixed_norms(rng, n):
    """SciPy 1.18.0 was wrong by 300 % here: each matrix of a batch is that alone."""
    a = rng.standard_normal((40, n, n)) * 10.0 ** rng.uniform(-6, 1.3, (40, 1, 1))
    both = lf.expm(a)
    for one, matrix in zip(both, a):
        right = lf.expm(matrix)
        assert np.abs(one - right).max() <= 1e-12 * max(1.0, np.linalg.norm(matrix)) * np.abs(right).max()
        alone = scipy.linalg.expm(matrix)
        assert np.abs(one - alone).max() <= 1e-11 * max(1.0, np.linalg.norm(matrix)) * np.abs(alone).max()
