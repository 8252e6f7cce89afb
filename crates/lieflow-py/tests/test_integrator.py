"""Runs that are taken step by step: stops, threads, exceptions, Ctrl-C."""

import _thread
import gc
import pickle
import threading
import time
import weakref

import lieflow as lf
import numpy as np
import pytest

ROTATION = dict(group="SO(3)", frame="body")
TIGHT = dict(rtol=1e-10, atol=1e-12)
BODY = lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.1, 1.0, 0.0])

# A pulse of 1000 that lasts a thousandth of the time.
TIMES, RATE = [0, 2, 2.0005, 2.001, 10], [0.0, 0.0, 1000.0, 0.0, 0.0]
PULSE = lf.Samples(TIMES, RATE)
RATES = lf.Samples(TIMES, np.outer(RATE, [0, 0, 1]))
PULSED = {
    "samples": (RATES, dict(y0=np.eye(3), **ROTATION)),
    "field": (lf.Field("SO(3)", ["0", "0", "s"], samples=PULSE), dict(y0=np.eye(3), frame="body")),
    "body": (lf.DrivenBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.1, 1.0, 0.0], torque=["0", "0", "s"], samples=PULSE), {}),
    "matrix": (lf.MatrixOde(group="SO(3)", field=[["0", "-s", "0"], ["s", "0", "0"], ["0", "0", "0"]], samples=PULSE), {}),
}


@pytest.mark.parametrize("name", PULSED)
def test_a_step_ends_at_each_knot_of_samples(name):
    problem, more = PULSED[name]
    whole = lf.solve_ivp(problem, (0, 10), t_eval=[10.0], **TIGHT, **more)
    run = lf.Integrator(problem, None, (0, 10), **TIGHT, **more)
    run.advance_to(10.0)
    assert run.nsteps == whole.nsteps
    if name in ("samples", "field"):
        assert (run.y == whole.y[-1]).all()
        # A step ends four roundings of t before a knot.
        assert np.abs(lf.so3.log(run.y) - [0, 0, 0.5]).max() < 1e-11
    else:
        name = {"body": "attitude", "matrix": "point"}[name]
        assert (getattr(run.y, name) == getattr(whole, name)[-1]).all()


def test_stops_are_taken_and_checked():
    def f(t, _):
        return [0.0, 0.0, 1000.0 if 2.0 <= t < 2.001 else 0.1]

    run = lf.Integrator(f, None, (0, 4), np.eye(3), stops=[2.0, 2.001], **TIGHT, **ROTATION)
    run.advance_to(4.0)
    angle = lf.so3.log(run.y)[2]
    assert abs(np.sin((angle - (0.4 + 0.9999)) / 2)) < 1e-11
    line = lf.BeamLine(particle=[1e-3, 0, 0, 0], elements=[{"kind": "quadrupole", "length": 1.0, "k": 0.5}, {"kind": "drift", "length": 1.0}])
    with pytest.raises(lf.ArgumentError, match="t_span.*a finite end"):
        lf.Integrator(line, None, (0, np.inf))


def test_threads_read_and_step_one_run():
    """Readers and two threads that take steps wait for each other without the interpreter."""

    def f(t, y):
        return [np.sin(t), 1.0, y[0, 1]]

    run = lf.Integrator(f, None, (0, np.inf), np.eye(3), **ROTATION)
    wrong = []

    def steps():
        try:
            for _ in range(200):
                run.step()
        except Exception as error:  # noqa: BLE001
            wrong.append(error)

    def reads():
        for _ in range(400):
            assert run.t >= 0 and run.y.shape == (3, 3)

    threads = [threading.Thread(target=act, daemon=True) for act in (steps, steps, reads, reads)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not any(thread.is_alive() for thread in threads), "threads wait for each other"
    assert not wrong and run.nsteps == 400


def test_f_cannot_use_its_own_run():
    def f(t, _):
        return [0.0, 0.0, run.t if inside else 1.0]

    inside = False
    run = lf.Integrator(f, None, (0, 5), np.eye(3), **ROTATION)
    run.step()
    before, inside = run.t, True
    with pytest.raises(RuntimeError, match="f cannot use the integrator that calls it"):
        run.step()
    inside = False
    assert run.t == before
    run.advance_to(5.0)
    assert np.abs(lf.so3.log(run.y) - [0, 0, 5.0 - 2 * np.pi]).max() < 1e-9


@pytest.mark.parametrize("steps", [dict(rtol=1e-8, atol=1e-10), dict(dt=0.01)])
def test_a_run_goes_on_after_an_exception(steps):
    class Broken(Exception):
        pass

    calls, broken_at = 0, None

    def f(t, y):
        nonlocal calls
        calls += 1
        if broken_at is not None and calls >= broken_at:
            raise Broken
        return [np.sin(t), y[0, 1], 1.0]

    def new():
        return lf.Integrator(f, None, (0, 3), np.eye(3), **steps, **ROTATION)

    whole, run = new(), new()
    rng = np.random.default_rng(1)
    for t in (1.0, 2.0, 3.0):
        broken_at = None
        whole.advance_to(t)
        for _ in range(10):
            broken_at, before = calls + int(rng.integers(1, 40)), run.t
            with pytest.raises(Broken):
                while True:
                    run.advance_to(min(t, run.t + 0.05)) if run.t < t else f(0.0, np.eye(3))
            assert run.t >= before
        broken_at = None
        run.advance_to(t)
        if "dt" in steps:
            assert np.abs(run.y - whole.y).max() < 1e-13
        assert np.abs(run.y - whole.y).max() < 1e-6


@pytest.mark.parametrize("what", ["named", "formula", "bodies"])
def test_ctrl_c_is_heard(what):
    field = lf.Field("SO(3)", ["sin(t)", "1", "cos(t)"])
    bodies = lf.FreeBodies(np.tile([1.0, 2.0, 3.0], (2000, 1)), np.ones((2000, 3)))
    act = {
        "named": lambda: lf.Integrator(BODY, "rkmk4", (0, 1e4), dt=1e-6).advance_to(1e4),
        "formula": lambda: lf.Integrator(field, "rkmk4", (0, 1e4), np.eye(3), frame="body", dt=1e-6).advance_to(1e4),
        "bodies": lambda: bodies.advance("rkmk4 cay", 1e-3, 10**7),
    }[what]
    sent = []

    def send():
        time.sleep(0.3)
        sent.append(time.perf_counter())
        _thread.interrupt_main()

    thread = threading.Thread(target=send)
    with pytest.raises(KeyboardInterrupt):
        thread.start()
        act()
    late = time.perf_counter() - sent[0]
    thread.join()
    assert late < 0.3, late


def test_parts_of_a_call_do_not_change_the_bodies():
    j, m = np.tile([1.0, 2.0, 3.0], (50, 1)), np.random.default_rng(2).normal(size=(50, 3))
    one, many = lf.FreeBodies(j, m), lf.FreeBodies(j, m)
    one.advance("rkmk4 cay", 0.01, 3000)
    for _ in range(3000):
        many.advance("rkmk4 cay", 0.01, 1)
    assert (one.momentum == many.momentum).all()


def test_arguments_are_named_and_copied():
    calls = 0

    def f(t, y):
        nonlocal calls
        calls += 1
        return [0.0, 0.0, 1.0]

    start = np.eye(3)
    run = lf.Integrator(f, None, (0, 5), start, **ROTATION)
    run.advance_to(1.0)
    assert run.nfev == calls
    for wrong in ("a", None, [1.0, 2.0]):
        with pytest.raises((TypeError, lf.ArgumentError), match="t: "):
            run.advance_to(wrong)
    field = lf.Field("SO(3)", ["0", "0", "1"])
    run = lf.Integrator(field, None, (0, 5), start, frame="body")
    start[:] = 7.0
    run.advance_to(1.0)
    assert (pickle.loads(pickle.dumps(run)).y == run.y).all()


def test_the_limit_of_attempts_is_that_of_a_call():
    run = lf.Integrator(BODY, "rkmk4 exp", dt=0.01, max_steps=100)
    for k in range(1, 30):
        run.advance_to(0.9 * k)
    assert run.nsteps > 2000
    with pytest.raises(RuntimeError, match="100 attempts did not reach the end.*raise max_steps"):
        run.advance_to(100.0)
    run.advance_to(run.t + 0.5)
    field = lf.Integrator(lf.Field("SO(3)", ["0", "0", "1"]), "rkmk4 exp", frame="body", y0=np.eye(3), dt=0.01, max_steps=100)
    with pytest.raises(RuntimeError, match="100 attempts"):
        field.advance_to(100.0)


def test_a_refused_time_within_a_step_is_explained():
    run = lf.Integrator(lambda t, y: [0.0, 0.0, 1.0], None, (0, 10), np.eye(3), **ROTATION)
    run.step()
    middle = run.t / 2
    run.interpolate(middle)
    run.y = run.y
    with pytest.raises(lf.ArgumentError, match="the last step is not known"):
        run.interpolate(middle)


def test_a_state_off_m_is_told_by_its_name():
    run = lf.Integrator(lambda t, y: [0, 0, 1.0], y0=np.eye(3), group="SO(3)", frame="body")
    for name, value in (("y", 2 * np.eye(3)), ("state", 2 * np.eye(3))):
        with pytest.raises(lf.ArgumentError, match=rf"^{name}: a point at a relative distance of 8.0e0 from SO\(3\), expected at most 1e-6$"):
            setattr(run, name, value)
    assert np.array_equal(run.y, np.eye(3))
    run = lf.Integrator(lambda t, y: np.zeros(6), y0=np.eye(4), group="SE(3)", frame="body")
    pose = np.eye(4)
    pose[3, 1] = 0.5
    for name in ("y", "state"):
        with pytest.raises(lf.ArgumentError, match=rf"^{name}\[3, 1\]: 0.5, expected 0: the last row"):
            setattr(run, name, pose)


def test_args_are_those_of_a_run():
    for args, words in ((2, "a value of type int"), ("ab", "the text 'ab'"), (None, "None")):
        for run in (lf.Integrator, lambda f, method, *rest, **keys: lf.solve_ivp(f, *rest, **keys)):
            with pytest.raises(TypeError, match=f"^args: {words}, expected a tuple"):
                run(lambda t, y, *more: [0, 0, 1.0], None, (0, 1), np.eye(3), args=args, **ROTATION)
    run = lf.Integrator(lambda t, y, w: [0, 0, w], None, (0, 1), np.eye(3), args=[2.0], **ROTATION)
    run.advance_to(1.0)
    assert np.abs(lf.so3.log(run.y) - [0, 0, 2]).max() < 1e-13


@pytest.mark.parametrize("method", ["rkmk dop853", "rkmk dopri5", "rkmk bs3 cay", "cf4"])
@pytest.mark.parametrize("by", ["step", "advance_to"])
def test_an_attempt_in_which_f_raised_does_not_count(method, by):
    def taken(broken_at):
        calls = 0

        def f(t, y):
            nonlocal calls
            calls += 1
            if calls in broken_at:
                raise ZeroDivisionError
            return [np.sin(3 * t), y[0, 1], 1.0]

        run = lf.Integrator(f, method, (0, 10), np.eye(3), rtol=1e-6, **ROTATION)
        raised = 0
        while run.t < 4:
            try:
                run.step() if by == "step" else run.advance_to(4.0)
            except ZeroDivisionError:
                raised += 1
        assert raised == len(broken_at)
        return run, calls

    (run, calls), (broken, more) = taken(()), taken((2, 3, 50, 77, 78))
    assert run.nfev == calls and broken.nfev <= more
    assert (broken.t, broken.nsteps, broken.nrejected) == (run.t, run.nsteps, run.nrejected)
    if by == "step":
        assert broken.nfev == run.nfev and np.array_equal(broken.y, run.y)


def test_f_is_checked_where_a_span_is_empty():
    for f, error in ((lambda t, y: "nonsense", TypeError), (lambda t, y: [1.0, 2.0], TypeError), (lambda t, y: 1 / 0, ZeroDivisionError)):
        for make in (lf.solve_ivp, lambda f, span, y, **keys: lf.Integrator(f, None, span, y, **keys)):
            with pytest.raises(error):
                make(f, (3, 3), np.eye(3), **ROTATION)
    r = lf.solve_ivp(lambda t, y: [0, 0, 1.0], (3, 3), np.eye(3), **ROTATION)
    assert r.success and r.nfev == 1 and np.array_equal(r.y_end, np.eye(3))


class Owner:
    """An object whose methods are the functions of a run that it keeps."""

    def f(self, t, y, *args):
        return [0.0, 0.0, 1.0]

    def of_parts(self, t, y):
        return {"n": [1.0]}

    def event(self, t, y, *args):
        return t - 0.5

    def change(self, t, y, *args):
        return y

    def callback(self, t, y):
        return False


def dense(f, **options):
    return lf.solve_ivp(f, (0, 1), np.eye(3), dense_output=True, **ROTATION, **options)


OWNED = {
    "integrator": lambda o: lf.Integrator(o.f, None, (0, 1), np.eye(3), **ROTATION),
    "integrator of args": lambda o: lf.Integrator(lambda t, y, o: o.f(t, y), None, (0, 1), np.eye(3), args=(o,), **ROTATION),
    "integrator of parts": lambda o: lf.Integrator(o.of_parts, None, (0, 1), {"n": [1.0]}, group=lf.Parts(n="numbers 1")),
    "result": lambda o: dense(o.f),
    "result of args": lambda o: dense(lambda t, y, o: o.f(t, y), args=(o,)),
    "event": lambda o: dense(lambda t, y: [0.0, 0.0, 1.0], events=lf.Event(o.event, terminal=1, change=o.change), callback=o.callback),
    "problem": lambda o: lf.solve_ivp(BODY, (0, 1), events=lf.Event(o.event, terminal=1), callback=o.callback, dense_output=True),
}


@pytest.mark.parametrize("name", OWNED)
def test_what_refers_to_its_own_run_is_freed(name):
    owners = []
    for _ in range(5):
        owner = Owner()
        owner.run = OWNED[name](owner)
        if hasattr(owner.run, "step"):
            owner.run.step()
        else:
            assert owner.run.success
        owners.append(weakref.ref(owner))
        del owner
    gc.collect()
    assert [owner() for owner in owners] == [None] * 5


def test_a_function_that_names_its_run_is_freed():
    def function():
        def f(t, y):
            return [0.0, 0.0, 1.0 if run else 0.0]

        run = None
        run = lf.Integrator(f, None, (0, 1), np.eye(3), **ROTATION)
        gc.collect()  # what is in use stays
        run.advance_to(1.0)
        assert run.t == 1.0
        return weakref.ref(f)

    freed = [function() for _ in range(5)]
    gc.collect()
    assert [f() for f in freed] == [None] * 5
