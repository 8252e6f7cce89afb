"""Long calls beside other threads and Ctrl-C: who waits, for how long, and what is left."""

from __future__ import annotations

import pickle
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import BODY, ROTATION, body, interrupted, turns_during

import lieflow as lf

FORMULAS = lf.Field("SO(3)", ["sin(t)", "1", "cos(t)"])


def many(n=20000):
    return lf.FreeBodies([1.0, 2.0, 3.0], np.random.default_rng(0).standard_normal((n, 3)))


def integrator(fun, **options):
    return lf.Integrator(fun, "rkmk4", (0, np.inf), np.eye(3), dt=1e-3, **options)


@pytest.mark.parametrize("of", ["function", "formulas", "bodies"])
def test_a_reader_waits_for_a_part_of_a_call(of):
    run = {"function": lambda: integrator(body, **ROTATION), "formulas": lambda: integrator(FORMULAS, frame="body"), "bodies": many}[of]()
    act, read = {
        "function": (lambda: run.advance_to(run.t + 100), lambda: run.t),
        "formulas": (lambda: run.advance_to(run.t + 500), lambda: run.y),
        "bodies": (lambda: run.advance("rkmk4 cay", 1e-3, 5000), lambda: run.momentum),
    }[of]
    done = threading.Event()

    def acts():
        while not done.is_set():
            act()

    thread = threading.Thread(target=acts)
    thread.start()
    time.sleep(0.05)
    waits, steps = [], []
    for _ in range(10):
        start = time.perf_counter()
        read()
        waits.append(time.perf_counter() - start)
        steps.append(run.nsteps)
        time.sleep(0.01)
    done.set()
    thread.join()
    assert np.median(waits) < 0.15, waits
    assert steps == sorted(set(steps)) and run.nsteps > steps[-1]


def test_ctrl_c_is_heard_by_a_thread_that_waits():
    def slow(t, y):
        time.sleep(0.05)
        return [0.0, 0.0, 1.0]

    run = lf.Integrator(slow, None, (0, 10), np.eye(3), **ROTATION)
    thread = threading.Thread(target=run.step)  # twelve stages and more: 0.6 s
    thread.start()
    time.sleep(0.02)
    assert interrupted(lambda: [run.t for _ in range(2)]) < 0.15
    assert thread.is_alive()
    thread.join()
    assert run.t > 0 and run.nsteps == 1


def test_after_an_error_all_bodies_are_as_before():
    m = np.random.default_rng(0).standard_normal((2000, 3))
    m[1500] = [1e200, 1e200, 0]
    turns = lf.so3.random(2000, 3)
    for attitude in (None, turns):
        bodies = lf.FreeBodies([1.0, 2.0, 3.0], m, attitude)
        for threads in (1, 3):
            with pytest.raises(lf.ArgumentError, match="bodies.*1500"):
                bodies.advance("rkmk4 exp", 0.1, 500, threads)
            assert np.array_equal(bodies.momentum, m) and bodies.nsteps == 0
            assert attitude is None or np.array_equal(bodies.attitude, attitude)
    good = lf.FreeBodies([1.0, 2.0, 3.0], m[:1500])
    good.advance("rkmk4 exp", 0.1, 7)
    good.advance("rkmk4 exp", 0.1, 5)
    assert good.nsteps == 12 and pickle.loads(pickle.dumps(good)).nsteps == 0


def test_after_ctrl_c_all_bodies_are_at_one_step():
    bodies, again = many(2000), many(2000)
    assert interrupted(lambda: bodies.advance("rkmk4 cay", 1e-3, 10**8)) < 0.3
    assert bodies.nsteps > 0
    again.advance("rkmk4 cay", 1e-3, bodies.nsteps)
    assert np.array_equal(again.momentum, bodies.momentum)


def test_ctrl_c_is_heard_between_times():
    sol = lf.solve_ivp(BODY, (0, 100), dense_output=True).sol
    field = lf.solve_ivp(body, (0, 100), np.eye(3), dense_output=True, **ROTATION).sol
    samples = lf.Samples(np.arange(1000.0), np.ones((1000, 3)), "cubic")
    times = np.linspace(0, 100, 2_000_000)
    for f, t in ((sol, times), (field, times), (samples, np.resize(times, 8_000_000))):
        assert interrupted(lambda: f(t)) < 0.3  # noqa: B023, called here


def test_points_do_not_depend_on_the_parts_of_a_call():
    sol = lf.solve_ivp(BODY, (0, 100), dense_output=True, quantities=["attitude", "euler_zxz"]).sol
    samples = lf.Samples(np.arange(101.0), np.random.default_rng(1).standard_normal((101, 3)), "cubic")
    times = np.random.default_rng(2).uniform(0, 100, (3, 1000))
    for at in (lambda t: sol(t).attitude, lambda t: sol(t).euler_zxz, samples):
        rows = at(times)
        assert np.array_equal(rows[2, 7], at(times[2, 7])) and np.array_equal(rows[:, ::50], at(times[:, ::50]))
    times[2, 30] = 101.0
    for f, name in ((sol, "t"), (samples, r"t\[2, 30\]")):
        with pytest.raises(lf.ArgumentError, match=f"^{name}: 101, expected a time"):
            f(times)


def test_samples_of_many_times_release_the_interpreter():
    samples = lf.Samples(np.arange(1000.0), np.ones((1000, 3)), "cubic")
    assert turns_during(samples, np.linspace(0, 100, 5_000_000)) > 20


@pytest.mark.parametrize("of", ["field", "problem"])
def test_runs_of_one_object_in_threads_have_their_own_reasons(of):
    pole = ["ln(0.5 - t)", "0", "0"]
    field, body = lf.Field("SO(3)", pole), lf.DrivenBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.0, 0.0, 0.1], torque=pole)
    runs = {"field": lambda: lf.solve_ivp(field, (0, 1), np.eye(3), frame="body"), "problem": lambda: lf.solve_ivp(body, (0, 1))}
    alone = runs[of]().message
    assert "ln(0.5 - t) is" in alone
    with ThreadPoolExecutor(4) as threads:
        messages = list(threads.map(lambda _: runs[of]().message, range(200)))
    assert set(messages) == {alone}
