"""The orders of dense output and of t_eval, through the wheel."""

from __future__ import annotations

import numpy as np
import pytest

import lieflow as lf

#: A body under torques that depend on t and on the state, with a spin beside it.
SYSTEM = lf.Composed(
    parts=[
        {"name": "R", "space": "rotation", "field": ["m1", "m2/2", "m3/3 + 0.3*s1"]},
        {"name": "s", "space": "vector", "start": [0.0, 0.6, 0.8], "field": ["cos(t)", "R13", "1 + 0.5*s2"]},
        {"name": "m", "space": "numbers", "start": [0.4, 1.0, 0.5],
         "field": ["m2*m3*(1/3 - 1/2) + 0.2*sin(t)", "m3*m1*(1 - 1/3)*0.5 - 0.1*m2*s3", "m1*m2*(1/2 - 1) + 0.1*R11"]},
    ]
)
T = np.linspace(0.0, 2.0, 41)
TABLEAUS = ["bs3", "dopri5", "dop853", "verner6", "rkf45", "rk4"]
METHODS = [*SYSTEM.methods(), *(f"rkmk {t} {m}" for t in TABLEAUS for m in ("exp", "cay")), *(f"rk {t}" for t in TABLEAUS)]


@pytest.fixture(scope="module")
def right():
    return lf.solve_ivp(SYSTEM, (0, 2), method="rkmk dop853 exp", t_eval=T).state


def error(method, steps, dense, right):
    r = lf.solve_ivp(SYSTEM, (0, 2), method=method, steps=steps, dense_output=dense, t_eval=None if dense else T).check()
    return np.abs((r.sol(T).state if dense else r.state) - right).max()


def order(method, dense, right):
    """The measured order: the largest over pairs of steps whose errors are above rounding."""
    steps, seen = 6, []
    last = error(method, steps, dense, right)
    while steps < 200:
        steps *= 2
        now = error(method, steps, dense, right)
        if now < 1e-12:
            break
        seen.append(np.log2(last / now))
        last = now
    return max(seen, default=np.inf)


@pytest.mark.parametrize("method", METHODS)
def test_output_has_the_stated_order(method, right):
    step, within = SYSTEM.orders(method)
    if step is None:
        pytest.skip("exact")
    expected = min(step, within)
    assert order(method, False, right) > expected - 0.5
    try:
        lf.solve_ivp(SYSTEM, (0, 0.1), method=method, steps=1, dense_output=True)
    except lf.ArgumentError:
        return
    assert order(method, True, right) > expected - 0.5


BODY = lf.RigidBody(inertia=[1, 2, 3], momentum_body=[0.1, 2, 0.3])
LEVELS = lf.Schrodinger(hamiltonian=[["t", 0.3], [0.3, "-t"]], amplitudes=[1, 0])


@pytest.mark.parametrize("problem", [BODY, SYSTEM, LEVELS])
@pytest.mark.parametrize("settings", [{}, {"steps": 3}])
def test_what_dense_output_keeps_is_known_before_a_run(problem, settings):
    model = problem._model(problem.quantities)
    seen = set()
    for method in problem.methods():
        try:
            lf.solve_ivp(problem, (0, 0.01), method=method, dense_output=True, **settings)
            kept = True
        except lf.ArgumentError as error:
            if error.argument != "dense_output":
                continue
            kept = False
        assert kept == model.keeps_points(method)[not settings], method
        seen.add(kept)
    assert seen == {True, False}


def test_a_problem_has_the_same_method_with_dense_output():
    plain, kept = (lf.solve_ivp(BODY, (0, 30), dense_output=dense) for dense in (False, True))
    assert np.array_equal(plain.t, kept.t) and np.array_equal(plain.momentum_body, kept.momentum_body)
    assert lf.solve_ivp(LEVELS, (0, 1), dense_output=True).check().sol(0.5) is not None


def test_the_quantities_decide_which_state_has_an_order():
    top = lf.HeavyTop(inertia=[1.0, 1.0, 0.6], weight=[0, 0, 1.0], omega_body=[0.4, 1.1, 2.0], vertical=[0.6, 0, 0.8])
    quantities = ["momentum_body", "energy"]
    assert "energy-casimir" in top.methods(quantities) and top.orders("energy-casimir", quantities) == (2, 2)
    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], momentum_body=[0.3, 0.4, 0.5])
    assert body.orders("lewis-simo") == (2, 2) and body.orders("lewis-simo", "momentum_body") == (4, 4)
    for call in (lambda: top.orders("energy-casimir"), lambda: lf.solve_ivp(top, (0, 1), method="energy-casimir", steps=8)):
        with pytest.raises(lf.ArgumentError, match="^method: energy-casimir.*; it runs where quantities are among .*momentum_body") as caught:
            call()
        assert "attitude" not in str(caught.value).split("among")[1]
    with pytest.raises(lf.ArgumentError, match="needs an attitude alone as its state; it runs where quantities are among .*attitude"):
        body.orders("rk4-qr", "momentum_body")
