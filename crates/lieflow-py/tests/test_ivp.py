"""lieflow.solve_ivp: results, events, dense output, exceptions, and arguments that cannot be used."""

from __future__ import annotations

import pickle
import signal
import threading
import time
import traceback

import numpy as np
import pytest
from conftest import J, M, body, interrupted, turns_during
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import lieflow as lf
from lieflow._settings import settings_of
from lieflow._second_run import finer

ROTATION = {"group": "SO(3)", "frame": "body"}


@pytest.fixture(scope="module")
def reference():
    times = np.linspace(0.0, 20.0, 41)
    right = solve_ivp(
        lambda t, y: (y.reshape(3, 3) @ lf.so3.hat(body(t, y.reshape(3, 3)))).ravel(),
        (0, 20), np.eye(3).ravel(), method="DOP853", rtol=1e-13, atol=1e-13, t_eval=times,
    )
    return times, right.y.T.reshape(-1, 3, 3)


def test_the_readme_example():
    r = lf.solve_ivp(body, (0, 100), np.eye(3), rtol=1e-9, atol=1e-12, **ROTATION)
    assert r.status == 0 and r.success and r.check() is r
    assert lf.so3.contains(r.y, 1e-13).all()
    assert lf.so3.log(r.y).shape == (len(r.t), 3)
    # M is fixed in space, so that Rᵀ keeps the momentum in the body on a level of the energy.
    m = M @ r.y
    energy = (m**2 / J).sum(1)
    assert np.abs(energy / energy[0] - 1).max() < 1e-6
    assert r.nfev > 0 and r.nsteps == len(r.t) - 1 and r.t_end == 100 and np.array_equal(r.y_end, r.y[-1])


@pytest.mark.parametrize("method", ["rkmk dop853 exp", "rkmk verner6 cay", "rkmk dopri5 exp", "rk dop853", "cf4"])
def test_points_agree_with_scipy(reference, method):
    times, right = reference
    tight = {"rtol": 1e-11, "atol": 1e-11} if "cf" not in method else {"rtol": 1e-10, "atol": 1e-10}
    r = lf.solve_ivp(body, (0, 20), np.eye(3), method=method, t_eval=times, **tight, **ROTATION)
    assert np.array_equal(r.t, times)
    assert np.abs(r.y - right).max() < 2e-7


def test_the_frames_differ_by_ad(reference):
    times, right = reference
    r = lf.solve_ivp(lambda t, y: y @ body(t, y), (0, 20), np.eye(3), group="SO(3)", frame="space", t_eval=times)
    assert np.abs(r.y - right).max() < 1e-5


def quaternion(q):
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def test_every_group_gives_the_same_rotation(reference):
    times, right = reference
    tight = {"t_eval": times, "rtol": 1e-10, "atol": 1e-10}
    q = lf.solve_ivp(lambda t, q: body(t, quaternion(q)), (0, 20), [1, 0, 0, 0], group="S3", frame="body", **tight)
    assert np.abs(np.array([quaternion(x) for x in q.y]) - right).max() < 1e-6
    assert np.abs(q.as_rotation().as_matrix() - right).max() < 1e-6
    g = lf.solve_ivp(
        lambda t, g: np.concatenate([body(t, g[:3, :3]), [0.0, 0.0, 1.0]]),
        (0, 20), np.eye(4), group="SE(3)", frame="body", **tight,
    )
    assert np.abs(g.y[:, :3, :3] - right).max() < 1e-6 and lf.se3.contains(g.y).all()
    x = lf.solve_ivp(lambda t, x: -x / J, (0, 20), M, group="SO(3)", action="coadjoint", **tight)
    assert np.abs(x.y - M @ right).max() < 1e-6
    for group in ("GL(3)", "SL(3)", lf.Gm(np.eye(3))):
        y = lf.solve_ivp(lambda t, y: lf.so3.hat(body(t, y)), (0, 20), np.eye(3), group=group, frame="body", **tight)
        assert np.abs(y.y - right).max() < 1e-5
    big = lf.solve_ivp(
        lambda t, y: np.block([[lf.so3.hat(body(t, y[:3, :3])), np.zeros((3, 1))], [np.zeros((1, 4))]]),
        (0, 20), np.eye(4), group=lf.SO(4), frame="body", **tight,
    )
    assert np.abs(big.y[:, :3, :3] - right).max() < 1e-6


def test_actions_on_matrices():
    a = np.diag([1.0, 2.0, 3.0]) + 0.3
    r = lf.solve_ivp(
        lambda t, l: lf.so3.vee(np.tril(l, -1) - np.tril(l, -1).T), (0, 3), a, group="SO(3)", action="conjugation"
    )
    assert np.abs(np.linalg.eigvalsh(r.y[-1]) - np.linalg.eigvalsh(a)).max() < 1e-12
    symplectic = lf.solve_ivp(
        lambda t: [[0.0, 1.0], [-(2 + np.cos(t)), 0.0]], (0, 5), np.eye(2),
        group="Sp(2)", frame="space", linear=True, method="magnus4", steps=500,
    )
    assert np.abs(np.linalg.det(symplectic.y) - 1).max() < 1e-13


@pytest.mark.parametrize("method", ["rkmk dop853 exp", "rkmk verner6 exp", "rkmk bs3 cay", "rk dopri5"])
def test_dense_output_needs_no_f(method):
    calls = 0

    def f(t, y):
        nonlocal calls
        calls += 1
        return body(t, y)

    r = lf.solve_ivp(f, (0, 20), np.eye(3), method=method, dense_output=True, rtol=1e-6, atol=1e-6, **ROTATION)
    before = calls
    assert np.abs(r.sol(r.t) - r.y).max() < 1e-13
    t = np.random.default_rng(1).uniform(0, 20, (7, 11))
    y = r.sol(t)
    assert y.shape == (7, 11, 3, 3) and calls == before
    assert np.array_equal(r.sol(t[3, 4]), y[3, 4])
    if method.startswith("rkmk"):
        assert lf.so3.contains(y, 1e-12).all()
    again = lf.solve_ivp(f, (0, 20), np.eye(3), method=method, t_eval=np.sort(t.ravel()), rtol=1e-6, atol=1e-6, **ROTATION)
    assert np.abs(again.y - r.sol(again.t)).max() < 1e-13
    for bad in (-1e-9, 20.1, np.nan):
        with pytest.raises(lf.ArgumentError, match="t: .*time of the run"):
            r.sol([0.0, bad])
    copy = pickle.loads(pickle.dumps(r.sol))
    assert np.array_equal(copy(t), y) and copy.t_max == 20 and copy.n_segments == r.nsteps
    found = []
    threads = [threading.Thread(target=lambda: found.append(r.sol(t))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(x, y) for x in found)


def test_dense_output_by_shorter_steps_is_refused_with_names():
    with pytest.raises(ValueError, match="dop853"):
        lf.solve_ivp(body, (0, 1), np.eye(3), method="cf4", dense_output=True, **ROTATION)


def test_orders_of_dense_output():
    fine = lf.solve_ivp(body, (0, 2), np.eye(3), rtol=1e-13, atol=1e-13, dense_output=True, **ROTATION)
    t = np.linspace(0, 2, 201)
    for method, order in (("rkmk bs3 exp", 3), ("rkmk dopri5 exp", 4), ("rkmk verner6 exp", 5), ("rkmk dop853 exp", 7)):
        errors = []
        for steps in (16, 32):
            r = lf.solve_ivp(body, (0, 2), np.eye(3), method=method, steps=steps, dense_output=True, **ROTATION)
            errors.append(np.abs(r.sol(t) - fine.sol(t)).max())
        assert np.log2(errors[0] / errors[1]) > order - 0.7, (method, errors)


def w2(t, y):
    return body(t, y)[1]


def test_events_have_scipys_meaning():
    def up(t, y):
        return w2(t, y) - 0.5

    up.direction = 1

    def end(t, y):
        return w2(t, y) - 0.5

    end.terminal, end.direction = 3, -1
    r = lf.solve_ivp(body, (0, 100), np.eye(3), events=[up, end, w2], **ROTATION)
    assert r.status == 1 and len(r.t_events[1]) == 3 and r.t[-1] == r.t_events[1][-1]
    for t, y in zip(r.t_events, r.y_events):
        assert y.shape == (len(t), 3, 3)
    assert all(abs(up(t, y)) < 1e-9 for t, y in zip(r.t_events[0], r.y_events[0]))
    assert "end" in r.message
    none = lf.solve_ivp(body, (0, 0.01), np.eye(3), events=up, **ROTATION)
    assert none.t_events[0].shape == (0,) and none.y_events[0].shape == (0, 3, 3)


def test_an_event_changes_the_state():
    half = lf.so3.exp([0.0, 0.0, np.pi])
    kick = lf.Event(lambda t, y: t - 1.0, change=lambda t, y: y @ half, name="kick")
    r = lf.solve_ivp(lambda t, y: [0.0, 0.0, 1.0], (0, 2), np.eye(3), events=kick, t_eval=[0.5, 2.0], **ROTATION)
    assert np.abs(r.y - lf.so3.exp([[0, 0, 0.5], [0, 0, 2 + np.pi]])).max() < 1e-12
    bad = lf.Event(lambda t, y: t - 1.0, change=lambda t, y: 2 * y, name="grow")
    r = lf.solve_ivp(body, (0, 2), np.eye(3), events=bad, **ROTATION)
    assert r.status == -1 and "grow" in r.message and r.t_end == pytest.approx(1.0)
    with pytest.raises(lf.RunError, match="grow"):
        r.check()


@pytest.mark.parametrize("place", ["f", "event", "change", "callback"])
def test_an_exception_leaves_as_the_same_object(place):
    rng = np.random.default_rng(3)
    often = place in ("f", "event")
    for call in rng.integers(1, 400 if often else 3, 50 if often else 5):
        left, raised = int(call), ValueError("mine")

        def counted(value):
            nonlocal left
            left -= 1
            if left == 0:
                raise raised
            return value

        kick = lf.Event(lambda t, y: counted(np.sin(9 * t + 1)) if place == "event" else np.sin(9 * t + 1),
                        change=lambda t, y: counted(y) if place == "change" else y)
        with pytest.raises(ValueError) as caught:
            lf.solve_ivp(
                lambda t, y: counted(body(t, y)) if place == "f" else body(t, y), (0, 20), np.eye(3),
                events=kick, callback=(lambda t, y: counted(None)) if place == "callback" else None, **ROTATION,
            )
        assert caught.value is raised
        assert "counted" in "".join(traceback.format_tb(caught.value.__traceback__))


def test_interrupts_arrive_at_once():
    for python in (True, False):
        def slow(t, y):
            if python:
                sum(range(100))
            return [0.0, 0.0, 1.0]

        late = interrupted(
            lambda: lf.solve_ivp(slow if python else CFUNC, (0, 1e9), np.eye(3), dt=1e-3, t_eval=[1e9], **ROTATION)
        )
        assert late < 0.15, late


def test_interrupts_at_random_moments():
    rng = np.random.default_rng(8)
    fields = {"python": lambda t, y: [0.0, 0.0, 1.0], "c": CFUNC, "formula": lf.Field("SO(3)", [0, 0, "1 + 0.1*sin(t)"])}
    for delay in rng.uniform(0.001, 0.05, 20):
        f = list(fields.values())[int(rng.integers(3))]
        timer = threading.Timer(delay, signal.pthread_kill, (threading.main_thread().ident, signal.SIGINT))
        started = time.perf_counter()
        with pytest.raises(KeyboardInterrupt):
            timer.start()
            space = {"frame": "body"} if isinstance(f, lf.Field) else ROTATION
            lf.solve_ivp(f, (0, 1e9), np.eye(3), dt=1e-3, t_eval=[1e9], **space)
        timer.join()
        assert time.perf_counter() - started < delay + 0.3


def c_function():
    import ctypes
    import pathlib
    import subprocess
    import sysconfig
    import tempfile

    compiler = (sysconfig.get_config_var("CC") or "cc").split()[0]
    folder = pathlib.Path(tempfile.mkdtemp())
    (folder / "f.c").write_text(
        "void f(double t, const double *y, double *v, const double *p) {"
        "  for (int j = 0; j < 3; j++) v[j] = (p[3]*y[j] + p[4]*y[3+j] + p[5]*y[6+j]) / p[j]; }"
    )
    subprocess.run([compiler, "-O2", "-shared", "-fPIC", "-o", folder / "f.so", folder / "f.c"], check=True)
    return ctypes.CDLL(str(folder / "f.so")).f


CFUNC = lf.CFunction(c_function(), [*J, *M])


def test_the_address_of_a_c_function(reference):
    times, right = reference
    r = lf.solve_ivp(CFUNC, (0, 20), np.eye(3), t_eval=times, rtol=1e-11, atol=1e-11, **ROTATION)
    assert np.abs(r.y - right).max() < 1e-7
    events = lf.solve_ivp(CFUNC, (0, 20), np.eye(3), events=w2, **ROTATION)
    assert len(events.t_events[0]) > 0
    for bad in (0, -8):
        with pytest.raises(lf.ArgumentError, match="fun"):
            lf.CFunction(bad)
    for bad in (None, "x", 1.5, True):
        with pytest.raises(TypeError, match="fun"):
            lf.CFunction(bad)


@pytest.mark.parametrize("of", ["address", "formula", "samples", "problem"])
def test_runs_without_python_release_the_interpreter(of):
    samples = lf.Samples([0.0, 1e5], [[0.1, 0.2, 0.3]] * 2)
    fun = {"address": CFUNC, "formula": lf.Field("SO(3)", [0, "0.1*y11", 1]), "samples": samples,
           "problem": lf.RigidBody(inertia=J, momentum_body=M)}[of]
    space = {"address": ROTATION, "formula": {"frame": "body"}, "samples": ROTATION, "problem": {}}[of]
    start = None if of == "problem" else np.eye(3)
    assert turns_during(lf.solve_ivp, fun, (0, 1e5), start, steps=400_000, t_eval=[1e5], method="rkmk4 exp", **space) > 20


@pytest.mark.parametrize(
    ("value", "words"),
    [([1.0, 2.0], "3 numbers"), (None, "None"), ("text", "text"), (1.0, "3 numbers"), (1j * M, "array of complex128")],
)
def test_a_wrong_value_of_f_names_f_t_and_what_came(value, words):
    with pytest.raises(TypeError, match=r"f returned .* at t = 0\.0, expected 3 numbers") as caught:
        lf.solve_ivp(lambda t, y: value, (0, 1), np.eye(3), **ROTATION)
    assert words in str(caught.value)


def test_f_that_writes_into_y_has_no_effect(reference):
    times, right = reference
    kept = []

    def f(t, y):
        v = body(t, y)
        y[...] = 7.0
        kept.append(y)
        return v

    r = lf.solve_ivp(f, (0, 20), np.eye(3), t_eval=times, rtol=1e-10, atol=1e-10, **ROTATION)
    assert np.abs(r.y - right).max() < 1e-6
    assert len({id(y) for y in kept[:10]}) == 10


def test_nan_of_f_ends_the_run():
    def f(t, y):
        return body(t, y) if t < 1 else [np.nan] * 3

    r = lf.solve_ivp(f, (0, 2), np.eye(3), **ROTATION)
    assert r.status == -1 and not r.success and 0.9 < r.t[-1] <= 1 and "t = " in r.message
    r = lf.solve_ivp(f, (0, 2), np.eye(3), dt=0.1, **ROTATION)
    assert r.status == -1 and r.t[-1] == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"y0": np.eye(4)}, "y0"),
        ({"y0": 2 * np.eye(3)}, "y0"),
        ({"y0": np.diag([1, 1, -1])}, "y0"),
        ({"y0": np.full((3, 3), np.nan)}, "y0[0, 0]"),
        ({"group": "SO3x"}, "group"),
        ({"group": None}, "group"),
        ({"frame": None}, "frame"),
        ({"frame": "world"}, "frame"),
        ({"action": "translate"}, "action"),
        ({"method": "rkmk dop54"}, "method"),
        ({"method": "magnus4"}, "method"),
        ({"t_eval": [0.5, 1.5]}, "t_eval[1]"),
        ({"t_eval": [0.5, 0.2]}, "t_eval[1]"),
        ({"t_span": (0, np.nan)}, "t_span"),
        ({"t_span": (0, 1, 2)}, "t_span"),
        ({"rtol": -1.0}, "rtol"),
        ({"dt": -0.1}, "dt"),
        ({"steps": 0}, "steps"),
        ({"dt": 0.1, "steps": 3}, "steps"),
        ({"max_steps": 1.5}, "max_steps"),
    ],
)
def test_wrong_arguments_are_named(change, argument):
    given = {"t_span": (0, 1), "y0": np.eye(3), **ROTATION, **change}
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(body, **given)
    assert caught.value.argument == argument and isinstance(caught.value, ValueError)
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


def test_near_names_are_told():
    with pytest.raises(lf.ArgumentError, match="translation"):
        lf.solve_ivp(body, (0, 1), np.eye(3), group="SO(3)", frame="body", action="translatoin")
    with pytest.raises(lf.ArgumentError, match="dop853"):
        lf.solve_ivp(body, (0, 1), np.eye(3), method="rkmk dop835", **ROTATION)


@pytest.mark.parametrize("bad", [{"y0": None}, {"y0": "x"}, {"y0": 1j * np.eye(3)}, {"t_span": None}, {"method": 3},
                                 {"events": [3]}, {"fun": 3.5}, {"group": 3}, {"dt": "x"}])
def test_wrong_types_are_type_errors(bad):
    given = {"fun": body, "t_span": (0, 1), "y0": np.eye(3), **ROTATION, **bad}
    with pytest.raises(TypeError):
        lf.solve_ivp(given.pop("fun"), given.pop("t_span"), given.pop("y0"), **given)


def test_runs_backward_and_over_no_time():
    forward = lf.solve_ivp(body, (0, 5), np.eye(3), rtol=1e-11, atol=1e-11, **ROTATION)
    back = lf.solve_ivp(body, (5, 0), forward.y_end, rtol=1e-11, atol=1e-11, **ROTATION)
    assert np.abs(back.y_end - np.eye(3)).max() < 1e-8
    nothing = lf.solve_ivp(body, (3, 3), np.eye(3), **ROTATION)
    assert np.array_equal(nothing.t, [3.0]) and nothing.success


def test_args_callback_and_data_frame():
    seen = []
    r = lf.solve_ivp(
        lambda t, y, a, b: a * body(t, y) + b, (0, 5), np.eye(3), args=(1.0, np.zeros(3)), steps=50,
        callback=lambda t, y: seen.append(t) or t >= 2, **ROTATION,
    )
    assert r.status == 1 and r.t_end == pytest.approx(2.0) and seen == r.t.tolist() and "callback" in r.message
    pandas = pytest.importorskip("pandas")
    assert isinstance(r.to_dataframe(), pandas.DataFrame)


def test_memory_is_flat():
    import resource

    def fails(t, y):
        raise ValueError

    named = lf.RigidBody(inertia=J, momentum_body=M)
    loose = {"rtol": 1e-6, "atol": 1e-6}

    def run(n):
        for _ in range(n):
            lf.solve_ivp(body, (0, 0.05), np.eye(3), dense_output=True, events=w2, **loose, **ROTATION).sol(0.01)
            lf.solve_ivp(named, (0, 0.05), dense_output=True, events="w2", **loose).sol(0.01)
            with pytest.raises(ValueError):
                lf.solve_ivp(fails, (0, 0.05), np.eye(3), **ROTATION)
            with pytest.raises(ValueError):
                lf.solve_ivp(named, (0, 0.05), events=fails)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = run(500)
    assert run(5000) - before < 4000  # kB


def test_events_that_are_too_fast_are_a_warning():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.2, 0.0, 1.0])
    with pytest.warns(RuntimeWarning, match="zeros of events may be missed in"):
        r = lf.solve_ivp(body, (0, 10), method="taylor16", events="sin(1e6*t)")
    assert r.unsure_steps > 0
    r = lf.solve_ivp(body, (0, 10), method="taylor16", events="sin(20*t)")
    assert r.unsure_steps == 0 and len(r.t_events[0]) == 64
    with pytest.warns(RuntimeWarning, match="may have ended the run at a wrong zero"):
        r = lf.solve_ivp(body, (0, 10), method="taylor16", events=lf.Event("sin(1e6*t)", terminal=3))
    assert r.status == 1 and r.unsure_steps > 0


@pytest.mark.parametrize(
    ("steps", "argument", "words"),
    [({"dt": 0.1, "rtol": 1e-6}, "dt",
      "`dt` fixes the steps and `rtol`, `atol` leave them to the error: expected one of the two"),
     ({"steps": 10, "atol": 1e-6}, "steps", "`steps` fixes the steps"),
     ({"dt": 0.1, "max_step": 0.2}, "max_step",
      "`max_step` is for steps chosen by error: give `rtol` or `atol` instead of `dt`"),
     ({"steps": 10, "first_step": 0.2}, "first_step", "instead of `steps`"),
     ({"rtol": 1e-30, "atol": 0.0}, "rtol", "expected at least"), ({"rtol": 1e-16, "atol": 0.0}, "rtol", "where atol is 0")],
)
def test_settings_that_exclude_each_other(steps, argument, words):
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.2, 0.0, 1.0])
    field = lambda t, y: [0.0, 0.0, 1.0]  # noqa: E731
    for run in (lambda: lf.solve_ivp(body, (0, 1), **steps), lambda: lf.Integrator(body, None, (0, 1), **steps),
                lambda: lf.solve_ivp(field, (0, 1), np.eye(3), group="SO(3)", frame="space", **steps)):
        with pytest.raises(lf.ArgumentError) as caught:
            run()
        assert caught.value.argument == argument and words in str(caught.value), str(caught.value)


def test_a_span_without_an_end_says_what_ends_it():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.2, 0.0, 1.0])
    r = lf.solve_ivp(body, (0, np.inf), events=lf.Event("w1 - 100", terminal=1), max_steps=100)
    assert r.status == -1 and "the span has no end, and no event ended the run: give t_span an end" in r.message


def test_the_estimate_finds_a_pulse_that_the_run_passed_over():
    def f(t, y):
        return [0.0, 0.0, 1.0 if 50.0003 < t < 50.0203 else 0.0]

    r = lf.solve_ivp(f, (0, 100), np.eye(3), group="SO(3)", frame="body")
    passed = np.abs(r.y[-1] - lf.so3.exp([0, 0, 0.02])).max()
    error = r.estimate_error()
    assert passed > 0.01 and abs(error.y - 0.02) < 1e-6 and error.found_by.endswith("in at least 2000 steps")
    found = lf.solve_ivp(f, (0, 100), np.eye(3), group="SO(3)", frame="body", stops=[50.0003, 50.0203])
    assert found.estimate_error().y < 1e-9
    # A step of the second run ends where the first one has found a pulse.
    def pulse(t, y):
        return [0.1 + 5.0 * np.exp(-(((t - 50.742) / 0.2) ** 2)), 0.0, 0.2]

    settings = settings_of(rtol=1e-7, atol=1e-7)
    seen = lf.solve_ivp(pulse, (0, 100), np.eye(3), group="SO(3)", frame="body", rtol=1e-7, atol=1e-7, max_step=1.0)
    other = finer(settings, seen, 0.0, 100.0)[1]
    [kink] = other["kinks"]  # f does not jump there
    assert abs(kink - 50.742) < 0.5 and other["stops"] == settings["kinks"] == []
    # A limit of the user stays, and a run that takes long is not made in short steps.
    slow = lf.solve_ivp(f, (0, 100), np.eye(3), group="SO(3)", frame="body", min_step=1.0, first_step=2.0)
    assert "steps" not in slow.estimate_error().found_by
    # A search beside steps of one size finds it, too, and is not needed for a smooth f.
    fixed = lf.solve_ivp(f, (0, 100), np.eye(3), group="SO(3)", frame="body", dt=1.0).estimate_error()
    assert 0.01 < fixed.y < 0.03 and "f seems to jump" in fixed.found_by
    fixed = lf.solve_ivp(lambda t, y: [np.sin(t), 0.0, 0.2], (0, 100), np.eye(3), group="SO(3)", frame="body", dt=0.1)
    assert fixed.estimate_error().found_by == "a second run with each step in two parts"


@pytest.mark.parametrize("method", ["rkmk-gauss4", "cf3", "rkmk-gauss6", "cf-ees25"])
def test_the_estimate_finds_a_jump_after_the_last_node_of_a_step(method):
    def run(jump, stops=()):
        f = lambda t, y: [0.0, 0.0, 0.2 * np.sign(t - jump)]  # noqa: E731
        return lf.solve_ivp(f, (0, 5), np.eye(3), method=method, dt=0.1, group="SO(3)", frame="body", stops=stops)

    passed = run(1.0999)
    off = np.abs(passed.y[-1] - lf.so3.exp([0, 0, 0.2 * (5 - 2 * 1.0999)])).max()
    assert off > 1e-6 and passed.estimate_error().y > 0.5 * off
    # Where a step ends at the jump, the run is right.
    assert run(1.0999, [1.0999]).estimate_error().y < 1e-11
    if method.startswith("rkmk"):  # others have a stage at an end of a step, where f is 0
        assert run(1.0).estimate_error().y < 1e-11


@pytest.mark.parametrize("method", ["magnus4", "magnus6", "magnus8", "cfm4-2", "cfm6-5", "cayley-magnus4"])
def test_methods_for_linear_equations_have_their_order_in_both_frames(method):
    """In the body ẏ = y f(t) is linear by the action of y from the right."""

    def rate(t, y=None):
        return np.array([np.cos(t), 0.1 * t, 1.0])

    for frame in ("space", "body"):
        settings = {"group": "SO(3)", "frame": frame}
        general = lf.solve_ivp(rate, (0, 10), np.eye(3), **settings)
        alone = lf.solve_ivp(lambda t: rate(t), (0, 10), np.eye(3), linear=True, **settings)
        assert np.abs(alone.y_end - general.y_end).max() < 1e-9
        errors = [
            np.abs(lf.solve_ivp(lambda t: rate(t), (0, 10), np.eye(3), linear=True, method=method, steps=n, **settings).y_end
                   - general.y_end).max()
            for n in (40, 80)
        ]
        order = int(next(x for x in method if x.isdigit()))
        assert errors[1] < 2.0 ** (0.7 - order) * errors[0] or errors[1] < 1e-11
    # Quaternions have no such methods, and others take the same f(t).
    turned = lf.solve_ivp(lambda t: rate(t), (0, 10), [1, 0, 0, 0], group="S3", frame="body", linear=True)
    assert np.abs(Rotation.from_quat(np.roll(turned.y_end, -1)).as_matrix() - general.y_end).max() < 1e-9
    with pytest.raises(lf.ArgumentError, match=method):
        lf.solve_ivp(lambda t: rate(t), (0, 10), [1, 0, 0, 0], group="S3", frame="body", linear=True, method=method)
    times = np.linspace(0, 10, 1001)
    gyro = lf.Samples(times, [rate(t) for t in times])
    measured = lf.solve_ivp(gyro, (0, 10), np.eye(3), group="SO(3)", frame="body", method=method, steps=1000)
    assert np.abs(measured.y_end - general.y_end).max() < 1e-4


def _turning(t, R):
    return [np.sin(t), np.cos(2 * t), 0.5]


ON_SO3 = {"group": "SO(3)", "frame": "body"}


def _true_error(r, f=_turning, **keys):
    exact = lf.solve_ivp(f, (r.t[0], r.t[-1]), np.eye(3), t_eval=r.t, **ON_SO3, **keys)
    return np.abs(lf.so3.log(np.swapaxes(exact.y, -1, -2) @ r.y)).max()


@pytest.mark.parametrize("steps", [{"steps": 4}, {"steps": 8}, {"dt": 0.5}])
def test_the_second_run_has_shorter_steps_where_stops_shorten_them(steps):
    stops = np.arange(1, 20) * 0.1
    r = lf.solve_ivp(_turning, (0, 2), np.eye(3), method="rkmk midpoint exp", stops=stops, **steps, **ON_SO3)
    assert r.nsteps == 20 and abs(r.largest_step - 0.1) < 1e-12
    stated, true = r.estimate_error().y, _true_error(r)
    assert 1e-4 < true < 3 * stated < 9 * true
    samples = lf.Samples(np.linspace(0, 2, 21), np.array([_turning(t, None) for t in np.linspace(0, 2, 21)]))
    r = lf.solve_ivp(samples, (0, 2), np.eye(3), method="rkmk midpoint exp", **steps, **ON_SO3)
    assert 1e-4 < _true_error(r, samples) < 3 * r.estimate_error().y


def test_the_second_run_has_shorter_steps_where_few_are_not_shortened():
    """The first and the last step between knots of the record are twice as long as the others."""
    record = lf.load("gyro-record").problem
    right = lf.solve_ivp(record, (0, 8), method="rkmk dop853 exp", dt=0.001, t_eval=[8.0]).state[-1]
    for dt in (0.2, 0.1):
        r = lf.solve_ivp(record, (0, 8), method="rkmk midpoint exp", dt=dt)
        steps = np.diff(r.t)
        assert steps.max() > 1.9 * np.median(steps)
        stated, true = r.estimate_error().y["state"], np.linalg.norm(r.state[-1] - right) / np.sqrt(2)
        assert 1e-3 < true < 1.5 * stated < 3 * true


@pytest.mark.parametrize("method", ["rkmk4 exp", "rkmk-gauss4"])
def test_the_second_run_sees_a_period_that_divides_the_steps(method):
    keys = {"method": method, "dt": 0.1, **ON_SO3}
    for periods in range(1, 21):
        r = lf.solve_ivp(lambda t, R: [0.05 * np.cos(20 * np.pi * periods * t), 0.0, 0.0], (0, 10), np.eye(3), **keys)
        true = np.abs(lf.so3.log(r.y_end)).max()
        stated = r.estimate_error().y
        # Gauss nodes within a step have phases of their own.
        assert stated > 0.2 * true or true < 1e-3
        assert method != "rkmk4 exp" or true > 0.1


@pytest.mark.parametrize("steps", [{"dt": 0.1}, {"steps": 50}])
def test_the_second_run_has_jumps_between_its_steps_where_the_first_has(steps):
    """A controller holds its torque over each step."""

    def held(t, R):
        return [1.0 if np.floor(10 * t + 1e-9) % 2 else -0.5, 0.3 * np.sin(t), 0.2]

    keys = {"method": "rkmk-gauss4", **ON_SO3}
    r = lf.solve_ivp(held, (0, 5), np.eye(3), t_eval=[2.0, 5.0], **steps, **keys)
    exact = lf.solve_ivp(held, (0, 5), np.eye(3), t_eval=[2.0, 5.0], stops=np.arange(1, 50) / 10, **keys, dt=0.01)
    true, stated = np.abs(lf.so3.log(np.swapaxes(exact.y, -1, -2) @ r.y)).max(), r.estimate_error().y
    assert true < 1.5 * stated < 5 * true + 1e-9


def test_the_second_run_has_other_steps_where_rounding_chooses_them():
    r = lf.solve_ivp(_turning, (0, 2), np.eye(3), method="rkmk heun exp", rtol=1e-12, atol=0.0, **ON_SO3)
    stated, true = r.estimate_error(), _true_error(r)
    assert true < 5 * stated.y < 50 * true


def test_a_second_run_may_take_more_attempts_or_says_why_not():
    keys = {"method": "rkmk heun exp", "rtol": 1e-8, "atol": 1e-7, **ON_SO3}
    r = lf.solve_ivp(_turning, (0, 2), np.eye(3), t_eval=[0, 1, 2], **keys)
    just = r.nsteps + r.nrejected + 10
    r = lf.solve_ivp(_turning, (0, 2), np.eye(3), t_eval=[0, 1, 2], max_steps=just, **keys)
    estimate = r.estimate_error()
    assert r.success and _true_error(r) < 3 * estimate.y < 1e-4
    assert estimate.found_by.startswith("a second run at a tenth of the tolerance")
    calls = []

    def fails(t, R):
        calls.append(t)
        return _turning(t, R) if len(calls) < 3000 else [np.nan] * 3

    r = lf.solve_ivp(fails, (0, 2), np.eye(3), method="rkmk4 exp", steps=400, **ON_SO3)
    assert r.success
    with pytest.raises(lf.RunError, match="no estimate: a second run with each step in two parts ended at t ="):
        r.estimate_error()


@pytest.mark.parametrize("t0", [0.0, 10.0, 1e3, 1e6])
def test_errors_are_estimated_after_a_terminal_event(t0):
    for level in np.arange(0.2, 0.8, 0.04):
        event = lf.Event(lambda t, R, level=level: R[0, 0] - level, terminal=True)
        r = lf.solve_ivp(_turning, (t0, t0 + 6), np.eye(3), method="rkmk4 cay", steps=60, events=event, **ON_SO3)
        assert r.status == 1 and len(r.t_events[0]) == 1
        estimate = r.estimate_error()
        assert estimate.y < 1e-3 and estimate.t_events[0] < 1e-3


def test_a_tolerance_alone_is_that_of_scenes():
    counts = []
    for keys in ({"rtol": 1e-10}, {"rtol": 1e-10, "atol": 0.0}, {"atol": 1e-10}, {"atol": 1e-10, "rtol": 0.0}):
        r = lf.solve_ivp(_turning, (0, 2), np.eye(3), method="rkmk bs3 exp", **keys, **ON_SO3)
        counts.append(r.nsteps)
    assert counts[0] == counts[1] and counts[2] == counts[3]
