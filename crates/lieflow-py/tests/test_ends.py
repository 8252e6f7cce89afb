"""Where runs end: by callbacks and events; and second runs from there."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from conftest import J, body

import lieflow as lf
from lieflow import _lieflow

BODY = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0])
ROTATION = {"group": "SO(3)", "frame": "body"}
ROWS = np.linspace(0, 10, 101)


@pytest.mark.parametrize("keys", [{}, {"dense_output": True}, {"method": "rkmk4 exp", "dt": 0.07}])
@pytest.mark.parametrize("of", ["problem", "function", "formulas", "parts"])
@pytest.mark.parametrize("end", [10.0, -10.0])
def test_a_callback_ends_the_run_at_its_row(of, keys, end):
    parts = lf.Parts(R="rotation", n="number")
    fun, y0, space = {
        "problem": (BODY, None, {}),
        "function": (body, np.eye(3), ROTATION),
        "formulas": (lf.Field("SO(3)", ["sin(t)", "y12", "1"]), np.eye(3), {"frame": "body"}),
        "parts": (lambda t, y: {"R": body(t, y.R), "n": np.cos(t)}, {"R": np.eye(3), "n": 1.0}, {"group": parts, "frame": "body"}),
    }[of]
    times, sign = np.sign(end) * ROWS, np.sign(end)
    r = lf.solve_ivp(fun, (0, end), y0, t_eval=times, callback=lambda t, y: abs(t) >= 3, **keys, **space)
    assert r.status == 1 and r.t[-1] == r.t_end == times[30] and "callback" in r.message
    last = {name: x[-1] for name, x in r.y.items()} if isinstance(r.y, dict) else {"y": r.y[-1]}
    ends = r.y_end if isinstance(r.y_end, dict) else {"y": r.y_end}
    assert all(np.array_equal(last[name], ends[name]) for name in last)
    # A run that goes on has no jump.
    rest = lf.solve_ivp(fun, (r.t_end, end), r.y_end, t_eval=[end], **{**keys, "dense_output": False}, **space)
    whole = lf.solve_ivp(fun, (0, end), y0, t_eval=[end], **{**keys, "dense_output": False}, **space)
    for name in ends:
        one, two = (x.y[name] if isinstance(x.y, dict) else x.y for x in (rest, whole))
        assert np.abs(one - two).max() < (1e-3 if "dt" in keys else 1e-9)
    if "dense_output" in keys:
        for sol in (r.sol, pickle.loads(pickle.dumps(r.sol))):
            assert {sol.t_min, sol.t_max} == {0.0, times[30]}
            near = sol([times[30], times[30] - sign * 1e-9])
            for x in near.values() if isinstance(near, dict) else [near]:
                assert np.abs(x[0] - x[1]).max() < 1e-8
            with pytest.raises(lf.ArgumentError, match="a time of the run"):
                sol(times[31])


def test_a_callback_ends_a_run_at_its_first_or_last_row():
    for at, rows in ((0.0, 1), (10.0, 101)):
        r = lf.solve_ivp(BODY, (0, 10), t_eval=ROWS, callback=lambda t, y, at=at: t >= at, dense_output=True)
        assert r.status == 1 and r.t_end == at and len(r.t) == rows and r.sol.t_max == at
    seen = []
    r = lf.solve_ivp(body, (0, np.inf), np.eye(3), callback=lambda t, y: seen.append(t) or len(seen) == 4, dt=0.5,
                     method="rkmk4 exp", **ROTATION)
    assert seen == [0, 0.5, 1, 1.5] and r.t_end == 1.5 and r.status == 1


def test_a_second_run_ends_where_the_callback_did():
    latest = [0.0]

    def f(t, y):
        latest[0] = max(latest[0], t)
        return body(t, y)

    r = lf.solve_ivp(f, (0, 10), np.eye(3), t_eval=ROWS, callback=lambda t, y: t >= 3, method="rkmk4 exp", dt=0.25, **ROTATION)
    latest[0] = 0.0
    assert 0 < r.estimate_error().y < 1e-3 and latest[0] <= 3 + 1e-12


def test_a_solution_without_an_end_ends_at_the_event():
    event = lf.Event("w2", direction=-1, terminal=2)
    r = lf.solve_ivp(BODY, (0, np.inf), events=event, quantities=["omega_body"], dense_output=True)
    assert r.status == 1 and r.sol.t_max == r.t_end
    assert np.abs(r.sol(r.t_end).omega_body[1]) < 1e-9
    steps = r.sol.n_segments
    with pytest.raises(lf.ArgumentError, match="a time of the run"):
        r.sol(r.t_end + 1)
    assert r.sol.n_segments == steps
    # With an end the solution goes on to it.
    r = lf.solve_ivp(BODY, (0, 40), events=event, quantities=["omega_body"], dense_output=True)
    assert r.t_end < 40 == r.sol.t_max and r.sol(40.0).omega_body.shape == (3,)


@pytest.mark.parametrize("g", ["ln(11 - t)", lambda t, y: [10.0 - t][int(t > 12)]], ids=["formula", "function"])
def test_the_rest_of_a_solution_needs_no_event(g):
    r = lf.solve_ivp(BODY, (0, 40), events=lf.Event(g, terminal=1), dense_output=True)
    times = np.linspace(0, r.t_end, 50)
    before = r.sol(times)
    far = r.sol([20.0, 40.0])
    assert r.t_end == pytest.approx(10.0) and r.sol.t_max == 40.0
    assert np.abs(far.attitude - BODY.exact([20.0, 40.0]).attitude).max() < 1e-9
    assert all(np.array_equal(before[name], x) for name, x in r.sol(times).items())


def test_the_rest_of_a_solution_has_the_changes_of_the_state():
    push = lf.Event(lambda t, y: t - 15.0, change=lambda t, m: 2 * m)
    options = {"quantities": "momentum_body", "dense_output": True}
    r = lf.solve_ivp(BODY, (0, 40), events=[lf.Event("t - 10", terminal=1), push], **options)
    whole = lf.solve_ivp(BODY, (0, 40), events=[lf.Event("t - 10"), push], **options)
    assert r.t_end == 10.0 and np.array_equal(r.sol(20.0).momentum_body, whole.sol(20.0).momentum_body)


@pytest.mark.parametrize(
    ("change", "options", "reached", "words"),
    [(None, {"max_steps": 30}, 10.0, "30 attempts"), ("at 12", {}, 10.0, "KeyError: 'at 12'")],
)
def test_a_rest_that_fails_is_told_and_not_tried_again(change, options, reached, words):
    calls = []

    def push(t, state):
        calls.append(t)
        raise KeyError(change)

    events = [lf.Event("t - 10", terminal=1), *([] if change is None else [lf.Event("t - 12", change=push)])]
    r = lf.solve_ivp(BODY, (0, 40), events=events, dense_output=True, **options)
    for _ in range(2):
        with pytest.raises(lf.RunError, match=f"t: the solution ends at 1.*its rest failed: {words}") as caught:
            r.sol([1.0, 20.0])
        assert r.sol.t_max == 40.0 and len(calls) == (change is not None)
    assert change is None or isinstance(caught.value.__cause__, KeyError)
    assert np.abs(r.sol(reached).attitude - BODY.exact(reached).attitude).max() < 1e-9
    copy = pickle.loads(pickle.dumps(r.sol))
    assert reached <= copy.t_max < 13 and np.array_equal(copy(reached).attitude, r.sol(reached).attitude)


def test_the_rule_of_the_second_tolerance_is_that_of_the_command_line():
    assert _lieflow.LAST_DIGITS == 64 * np.finfo(float).eps
    for rtol, atol, factor in ((1e-9, 0, 0.1), (1e-13, 0, 0.1), (0.9e-13, 0.9e-13, 10), (0, 1e-14, 10), (1e-14, 1e-6, 0.1)):
        assert _lieflow.other_tolerance(rtol, atol) == factor
        r = lf.solve_ivp(body, (0, 1), np.eye(3), rtol=rtol, atol=atol, **ROTATION)
        found_by = r.estimate_error().found_by
        assert ("a tenth" in found_by) == (factor == 0.1) or "a quarter" in found_by


@pytest.mark.parametrize("events", [None, "w2", ["w1", lf.Event("w3", terminal=3)]])
@pytest.mark.parametrize("keys", [{}, {"method": "rkmk4 exp", "steps": 200}, {"y0": [0.3, 1.0, 0.2], "quantities": "momentum_body"}])
def test_the_copy_of_a_result_of_a_problem_has_an_estimate(keys, events):
    if "y0" in keys and events is not None:
        keys = {**keys, "quantities": ["momentum_body", "omega_body"]}
    r = lf.solve_ivp(BODY, (0, 9), events=events, **keys)
    copy = pickle.loads(pickle.dumps(r))
    own, other = r.estimate_error(), copy.estimate_error()
    # The clock decides whether a second run looks for pulses.
    if own.found_by == other.found_by:
        assert own == other
    assert pickle.loads(pickle.dumps(copy)).estimate_error().y.keys() == own.y.keys()


def test_the_copy_of_a_result_with_functions_has_none():
    of_function = lf.solve_ivp(lambda t, y: -y / J, (0, 1), [1.0, 2, 3], group="SO(3)", action="coadjoint")
    for r in (lf.solve_ivp(BODY, (0, 9), events=lambda t, y: y.attitude[0, 0]), of_function,
              lf.solve_ivp(BODY, (0, 9), events=lf.Event("w1", change=lambda t, y: y))):
        assert r.estimate_error().found_by
        with pytest.raises(lf.RunError, match="a copy of the result"):
            pickle.loads(pickle.dumps(r)).estimate_error()
