"""What a run returns: errors, drift, rotations, counts, and the equations of the actions."""

from __future__ import annotations

import pickle
import threading

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from conftest import BODY, J, M, PARTS, ROTATION, START, turn

import lieflow as lf


def test_the_error_of_a_matrix_that_is_no_rotation_is_a_length():
    field = [[0.1, "cos(t)", 0.0], [-1.0, 0.2, "0.3*t"], [0.0, 0.4, 0.3]]
    ode = lf.MatrixOde(group="GL(3)", action="translation", field=field, start=np.eye(3).tolist())
    r = lf.solve_ivp(ode, (0, 2), method="rkmk midpoint exp", steps=40, t_eval=[2.0])
    [name] = r.y
    true = np.linalg.norm(r.y[name][0] - lf.solve_ivp(ode, (0, 2), t_eval=[2.0]).y[name][0])
    # Each step in two parts leaves 0.294 of the error.
    assert r.estimate_error().y[name] == pytest.approx(0.706 * true, rel=0.02) and true > 1e-4


def test_the_error_of_rotations_is_an_angle():
    r = lf.solve_ivp(BODY, (0, 9), method="rkmk4 cay", steps=60, t_eval=[9.0])
    angle = np.linalg.norm(lf.so3.log(r.attitude[0].T @ BODY.exact(9.0).attitude))
    assert r.estimate_error().y["attitude"] == pytest.approx(angle, rel=1e-6) and angle > 1e-6


def test_the_error_of_a_large_matrix_does_not_saturate():
    r = lf.solve_ivp(lambda t, y: np.diag([1.0, 2.0, 3.0]), (0, 1), np.eye(3), group="GL(3)", frame="space",
                     method="rk midpoint", steps=1, t_eval=[1.0])
    # The first step of a run is split at this place.
    other = np.prod([1 + h + h**2 / 2 for h in np.outer([0.33643258, 1 - 0.33643258], [1.0, 2.0, 3.0])], axis=0)
    assert r.estimate_error().y == pytest.approx(np.linalg.norm(r.y[0] - np.diag(other))) and r.estimate_error().y > 4


@pytest.mark.parametrize("times", [None, [50.0], np.linspace(45, 50, 7)])
def test_drift_is_from_the_start_of_the_run(times):
    r = lf.solve_ivp(BODY, (0, 50), t_eval=times, method="rkmk bs3 exp", rtol=1e-3, atol=1e-3, quantities=["momentum_body", "energy"])
    start = 0.5 * (np.array([0.01, 2.0, 0.0]) ** 2 / [1.0, 2.0, 3.0]).sum()
    assert r.drift["energy"] == pytest.approx(np.abs(r.energy - start).max(), rel=1e-9) and r.drift["energy"] > 1e-6
    assert pickle.loads(pickle.dumps(r)).drift == r.drift
    other = lf.solve_ivp(BODY, (0, 50), [0.0, 1.0, 1.0], t_eval=times, method="rkmk bs3 exp", rtol=1e-3, atol=1e-3,
                         quantities=["momentum_body", "energy"])
    assert other.drift["energy"] == pytest.approx(np.abs(other.energy - 5 / 12).max(), rel=1e-9)


def test_as_rotation_refuses_what_is_none():
    scale = lf.solve_ivp(lambda t, y: np.diag([1.0, 2.0, 3.0]), (0, 1), np.eye(3), group="GL(3)", frame="body", t_eval=[0, 1])
    vector = lf.solve_ivp(lambda t, y: np.zeros((4, 4)), (0, 1), [2.0, 0, 0, 0], group="SO(4)", action="linear", t_eval=[1.0])
    for call, argument in ((scale.as_rotation, "y[1]"), (vector.as_rotation, "y[0]"),
                           (lambda: lf.so3.as_rotation(2 * np.eye(3)), "r"), (lambda: lf.se3.as_transform(2 * np.eye(4)), "g")):
        with pytest.raises(lf.ArgumentError) as caught:
            call()
        assert caught.value.argument == argument
    assert lf.so3.as_rotation(np.eye(3)).magnitude() == 0
    parts = lf.solve_ivp(lambda t, y: {"R": [0, 0, 1.0], "n": [0, 0]}, (0, 1), START, group=PARTS, frame="body")
    for run, names in ((parts, "R, n"), (lf.solve_ivp(BODY, (0, 1), quantities="omega_body"), "omega_body")):
        with pytest.raises(lf.ArgumentError, match=rf"^y: the quantities {names}, expected attitude or quaternion among them"):
            run.as_rotation()
    assert lf.so3.as_rotation(parts.R).magnitude()[-1] == pytest.approx(1.0)


def expression(f, t, y0, right):
    """SciPy's solution of ẏ = right(y)."""
    y0 = np.asarray(y0)
    done = scipy.integrate.solve_ivp(
        lambda t, y: right(f, y.reshape(y0.shape)).ravel(), (0, t), y0.astype(np.result_type(y0, f, float)).ravel(),
        method="DOP853", rtol=1e-12, atol=1e-13,
    )
    return done.y[:, -1].reshape(y0.shape)


W = np.array([0.3, -0.2, 0.5])
TWIST = np.array([0.3, -0.2, 0.5, 0.1, 0.7, -0.4])
A4 = np.triu(np.arange(16.0).reshape(4, 4) / 20, 1)
A4 = A4 - A4.T
C2 = np.array([[0.3j, 0.2 + 0.1j], [-0.2 + 0.1j, -0.4j]])
H4 = np.array([[0.1, 0.2, 0.3, 0.1], [0.0, 0.2, 0.1, 0.4], [0.5, 0.1, -0.1, 0.0], [0.1, 0.3, -0.2, -0.2]])


@pytest.mark.parametrize(
    ("group", "action", "f", "y0", "right"),
    [
        ("SO(3)", "linear", W, M, np.cross),
        ("SO(3)", "coadjoint", W, M, np.cross),
        ("SE(3)", "coadjoint", TWIST, np.arange(1.0, 7.0),
         lambda f, y: np.r_[np.cross(f[:3], y[:3]) + np.cross(f[3:], y[3:]), np.cross(f[:3], y[3:])]),
        ("SO(4)", "linear", A4, np.arange(4.0), lambda f, y: f @ y),
        ("SO(4)", "conjugation", A4, H4, lambda f, y: f @ y - y @ f),
        ("SO(4)", "coadjoint", A4, H4, lambda f, y: y @ f.T - f.T @ y),
        ("GL(4)", "coadjoint", H4, A4, lambda f, y: y @ f.T - f.T @ y),
        ("U(2)", "linear", C2, np.array([1.0, 1j]), lambda f, y: f @ y),
        ("U(2)", "conjugation", C2, np.array([[1.0, 2j], [-2j, 3.0]]), lambda f, y: f @ y - y @ f),
        ("U(2)", "coadjoint", C2, np.array([[1.0, 2j], [-2j, 3.0]]), lambda f, y: y @ f.conj().T - f.conj().T @ y),
        ("Sp(4)", "lagrangian", H4, np.array([[0.1, 0.2], [0.2, 0.3]]),
         lambda f, y: f[2:, :2] - f[:2, :2].T @ y - y @ f[:2, :2] - y @ f[:2, 2:] @ y),
    ],
)
def test_every_action_has_the_equation_of_the_documentation(group, action, f, y0, right):
    if action == "lagrangian":
        b, c = f[:2, 2:] + f[:2, 2:].T, f[2:, :2] + f[2:, :2].T
        f = np.block([[f[:2, :2], b], [c, -f[:2, :2].T]])
    r = lf.solve_ivp(lambda t, y: f, (0, 1), y0, group=group, action=action, rtol=1e-12, atol=1e-12)
    assert np.abs(r.y_end - expression(f, 1.0, y0, right)).max() < 1e-9


def test_a_body_by_its_coadjoint_action():
    r = lf.solve_ivp(lambda t, m: -m / J, (0, 3), M, group="SO(3)", action="coadjoint", rtol=1e-11, atol=1e-11)
    exact = lf.RigidBody(inertia=J, momentum_body=M).exact(3.0, "momentum_body").momentum_body
    assert np.abs(r.y_end - exact).max() < 1e-8
    for text in (lf.so3.coad.__doc__, lf.solve_ivp.__doc__):
        assert "f = −ω" in text


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("rkmk4 exp", {"steps": 10}), (None, {}), ("rkmk bs3 exp", {"rtol": 1e-5}), (None, {"dense_output": True}),
        ("rkmk-gauss4", {"steps": 10}), ("rkmk-gauss2-symmetric", {"rtol": 1e-4}),
    ],
)
@pytest.mark.parametrize("group", ["SO(3)", "SO(4)", "U(2)", PARTS])
def test_every_call_of_f_is_counted(method, options, group):
    calls = 0
    n = {"SO(3)": 3, "SO(4)": 4, "U(2)": 2}.get(group) if isinstance(group, str) else 0

    def f(t, y):
        nonlocal calls
        calls += 1
        if n == 0:
            return {"R": [t, 0, 1], "n": [0, t]}
        return [np.cos(t), 0.1, 1.0] if n == 3 else np.zeros((n, n))

    r = lf.solve_ivp(f, (0, 1), np.eye(n) if n else START, group=group, frame="body", method=method, **options)
    assert r.nfev == calls


def test_a_result_is_read_by_names_too():
    r = lf.solve_ivp(turn, (0, 1), np.eye(3), dense_output=True, **ROTATION)
    assert r["y"] is r.y and r["success"] and {"t", "y", "sol", "t_events", "status", "nfev", "success"} <= set(r.keys())
    assert dict(r)["t"] is r.t and list(r) == r.keys()
    named = lf.solve_ivp(BODY, (0, 1))
    assert named["attitude"] is named.attitude and "energy" in named["drift"]
    for result, quantities in ((r, []), (named, list(named.y))):
        names = result.keys()
        assert names[-len(quantities) :] == quantities if quantities else "attitude" not in result
        assert all(name in result and result[name] is not KeyError for name in names) and list(dict(result)) == names
    assert "attitude" in named and "attitude" in named.keys() and dict(named)["attitude"] is named.attitude
    for name in ("check", "_rows", "nothing"):
        assert name not in named
        with pytest.raises(KeyError, match=name):
            named[name]


def test_a_table_without_rows():
    pytest.importorskip("pandas")
    for fun, y0, space, columns in ((turn, np.eye(3), ROTATION, 9), (turn, START, {"group": PARTS, "frame": "body"}, 11)):
        f = turn if space is ROTATION else (lambda t, y: {"R": [0, 0, 1.0], "n": [0, 0]})
        assert lf.solve_ivp(f, (0, 1), y0, t_eval=[], **space).to_dataframe().shape == (0, columns)
    assert lf.solve_ivp(BODY, (0, 1), t_eval=[]).to_dataframe().shape == (0, 12)


def test_the_callback_has_no_args():
    seen = []
    lf.solve_ivp(lambda t, y, a: [0, 0, a], (0, 1), np.eye(3), args=(1.0,), callback=lambda t, y: seen.append(t), steps=2,
                 method="rkmk4 exp", **ROTATION)
    assert seen == [0.0, 0.5, 1.0]


def test_a_stop_is_one_step_more():
    for options in ({"steps": 4}, {"dt": 0.25}):
        r = lf.solve_ivp(turn, (0, 1), np.eye(3), method="rkmk4 exp", stops=[0.33], **options, **ROTATION)
        assert np.allclose(r.t, [0, 0.25, 0.33, 0.58, 0.83, 1.0], atol=1e-14) and r.nsteps == 5


def _swings(**keys):
    """A run about one axis, with its error at each row."""
    angle = lambda t: t + 0.7 / 3 * (1 - np.cos(3 * t))  # noqa: E731
    r = lf.solve_ivp(lambda t, y: [0, 0, 1 + 0.7 * np.sin(3 * t)], (0, 20), [1, 0, 0], group="SO(3)", action="linear", **keys)
    exact = np.stack([np.cos(angle(r.t)), np.sin(angle(r.t)), 0 * r.t], 1)
    return r, np.linalg.norm(r.y - exact, axis=1)


@pytest.mark.parametrize("steps", [{"steps": 40}, {"rtol": 1e-8, "method": "rkmk dopri5"}])
def test_rows_at_events_have_an_error(steps):
    keys = {"method": "rkmk4 cay", **steps}
    r, true = _swings(t_eval=[0, 10.0], events=lambda t, y: t - 10, **keys)
    assert true[1] / 3 < r.estimate_error().y < 3 * true[1]
    r, true = _swings(events=lf.Event(lambda t, y: t - 1.5, terminal=1), **keys)
    assert r.status == 1 and true[-1] / 3 < r.estimate_error().y < 3 * true.max()


@pytest.mark.parametrize("steps", [{"steps": n} for n in (30, 40, 50, 60, 80)] + [{"rtol": 1e-8, "atol": 1e-8}])
def test_a_ball_that_bounces_until_it_has_bounced_enough_has_an_error(steps):
    ball = lf.Parts(x="number", v="number")
    bounce = lf.Event(lambda t, y: y.x, direction=-1, change=lambda t, y: {"x": 0.0, "v": -0.8 * y.v}, terminal=3)

    def fall(t, y):
        return {"x": y.v, "v": -9.81 - 0.1 * y.v * abs(y.v)}

    keys = {"group": ball, "events": bounce}
    method = {"method": "rkmk4 exp"} if "steps" in steps else {}
    r = lf.solve_ivp(fall, (0, 9), {"x": 2.0, "v": 0.0}, **keys, **method, **steps)
    fine = lf.solve_ivp(fall, (0, 9), {"x": 2.0, "v": 0.0}, **keys)
    true = np.abs(r.t_events[0] - fine.t_events[0]).max()
    stated = r.estimate_error().t_events[0]
    assert len(r.t_events[0]) == 3 and true < 4 * stated + 1e-12 and stated < 4 * true + 1e-6


@pytest.mark.parametrize("t", [-20.0, -10.0, -5.0, -1.0, 1.0, 5.0, 20.0, 300.0])
def test_a_subspace_is_exact_forward_and_backward(t):
    a = 2.0 * np.array([[2, 1, 0, 0], [1, 0, 1, 0], [0, 1, -1, 1], [0, 0, 1, -2]])
    for x in ([[1, 0], [0, 1], [1, 1], [0, 1]], [[1, 0], [1, 1], [1, 2], [1, -1]], [[0, 0], [0, 0], [1, 0], [0, 1]]):
        # The columns stay orthonormal in short steps.
        short, y = scipy.linalg.expm(t / 2000 * a), np.linalg.qr(np.array(x, float))[0]
        for _ in range(2000):
            y = np.linalg.qr(short @ y)[0]
        right = (y @ y.T)[np.triu_indices(4)]
        problem = lf.Subspace(a=a, x=x)
        assert np.abs(problem.exact([t]).projector[0] - right).max() < 1e-13
        run = lf.solve_ivp(problem, (0, t), t_eval=[t])
        assert np.abs(run.projector[0] - right).max() < 1e-12


def test_rounding_that_two_runs_share_has_an_error():
    # The number is not quite the upright position. In small steps the changes of the angle are lost in sums.
    plane = lf.Parts(y="numbers 2")

    def pendulum(t, y):
        return {"y": [y.y[1], -9.81 * np.sin(y.y[0]) - 0.05 * y.y[1]]}

    right = np.array([2.93808977, -0.63121882])
    for settings in ({"rtol": 1e-14, "atol": 1e-14}, {"dt": 0.005}, {"rtol": 1e-14, "atol": 1e-14, "max_step": 0.005}):
        start = {"y": [3.141592653589793, 0.0]}
        result = lf.solve_ivp(pendulum, (0, 11.5), start, group=plane, t_eval=[11.5], **settings)
        error = np.linalg.norm(result.y.y[-1] - right)
        assert result.estimate_error().y["y"] > 0.2 * error > 0.02, settings

    def quiet(t, y):
        return {"y": [y.y[1], -y.y[0]]}

    result = lf.solve_ivp(quiet, (0, 10), {"y": [1.0, 0.0]}, group=plane, rtol=1e-12, atol=1e-12)
    assert result.estimate_error().y["y"] < 1e-11


def test_the_rest_of_a_solution_is_computed_once_by_many_threads():
    body, failures = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.01, 1, 0]), []
    for _ in range(30):
        event = lf.Event("w2", terminal=1)
        sol = lf.solve_ivp(body, (0, 20), events=event, dense_output=True, quantities=["omega_body"]).sol
        assert sol.t_max == 20.0
        barrier = threading.Barrier(8)

        def look(k, sol=sol, barrier=barrier):
            barrier.wait()
            try:
                sol(np.linspace(0, 20, 500 + k))
            except Exception as error:  # noqa: BLE001
                failures.append(error)

        threads = [threading.Thread(target=look, args=(k,)) for k in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert not failures


def test_a_solution_goes_on_after_an_event_at_the_start():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0.0])
    result = lf.solve_ivp(body, (0, 10), events=lf.Event("w3", terminal=1), dense_output=True)
    assert result.t_end == 0.0 and result.sol.t_max == 10.0
    assert np.abs(result.sol(5.0).attitude - body.exact(5.0).attitude).max() < 1e-12


def test_a_run_without_outputs_has_the_error_of_its_end():
    def f(t, y):
        return [np.sin(t), np.cos(3 * t), 1.0]

    run = {"group": "SO(3)", "frame": "body", "method": "rkmk4 exp", "dt": 0.5}
    none = lf.solve_ivp(f, (0, 1), np.eye(3), t_eval=[], **run).estimate_error().y
    one = lf.solve_ivp(f, (0, 1), np.eye(3), t_eval=[1.0], **run).estimate_error().y
    assert none == one > 1e-6
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0.2])
    assert lf.solve_ivp(body, (0, 1), t_eval=[], method="rkmk4 exp", dt=0.1).estimate_error().y["attitude"] > 1e-9
    with pytest.raises(lf.RunError, match="no outputs"):
        lf.solve_ivp(body, (0, 9), t_eval=[], events=lf.Event("w2", terminal=1)).estimate_error()


def test_names_of_parts_are_not_those_of_a_result():
    result = lf.solve_ivp(lambda t, y: {"x": [1.0]}, (0, 1), {"x": [0.0]}, group=lf.Parts(x="numbers 1"))
    taken = {name for name in [*dir(result), *result.keys()] if not name.startswith("_")} - {"x", "y"}
    for name in taken:
        with pytest.raises(lf.ArgumentError, match="another name"):
            lf.Parts(**{name: "number"})


def test_angles_of_subspaces_have_their_digits_at_both_ends():
    a, x = np.diag([4.0, 3, 1, 0]), np.array([[1.0, 0], [0, 1e-3], [1, 0], [0, 1]])
    for end in (-3.0, -6.0, 6.0):
        angles = lf.solve_ivp(lf.Subspace(a=a, x=x), (0, end), quantities=["angles"], t_eval=[end]).angles[-1]
        # The planes of the first and the third axis, and of the others, turn apart from each other.
        right = np.sort(np.arctan(np.exp(-3 * end) * np.array([1.0, 1000.0])))[::-1]
        assert np.abs(angles - right).max() < 1e-13
        assert np.abs((np.pi / 2 - angles) / np.tan(np.pi / 2 - right) - 1).max() < 1e-5 or end > 0


def test_memory_that_is_not_there_is_an_error():
    with pytest.raises(MemoryError):
        lf.SO(3).random(10**15)


def test_the_end_of_a_failed_run_is_where_another_one_goes_on():
    body = lf.RigidBody(inertia=[1, 2, 3], momentum_body=[1, 2, 3])
    short = lf.solve_ivp(body, (0, 10), max_steps=5)
    assert short.status == -1 and 0 < short.t_end < 10
    assert np.array_equal(short.y_end["momentum_body"], short.y["momentum_body"][-1])
    rest = lf.solve_ivp(body, (short.t_end, 10), short.y_end).check()
    whole = lf.solve_ivp(body, (0, 10)).check()
    for name in whole.y_end:
        assert np.abs(rest.y_end[name] - whole.y_end[name]).max() < 1e-8, name


def test_a_run_that_ended_at_its_start_has_no_estimate():
    body = lf.RigidBody(inertia=[1, 2, 2.5], omega_body=[0.1, 1, 0.3])
    event = lf.Event("sin(3*t)", terminal=1)
    for r in (lf.solve_ivp(body, (0, 5), events=event), lf.solve_ivp(turn, (0, 5), [1, 0, 0], group="SO(3)", action="linear", events=event, dt=0.1)):
        assert r.status == 1 and r.t_end == 0
        with pytest.raises(lf.RunError, match="the run has no step"):
            r.estimate_error()
