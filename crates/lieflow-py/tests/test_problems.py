"""Problems by the name of their kind, their runs, and scenes."""

from __future__ import annotations

import pickle
import pydoc
import re
import warnings

import numpy as np
import pytest
from conftest import interrupted
from stub_of_problems import stub

import lieflow as lf
from lieflow import _problems

BODY = {"inertia": [0.0026, 0.0103, 0.0108], "omega_body": [0.01, 1.0, 0.0]}


@pytest.fixture(scope="module")
def run():
    body = lf.RigidBody(**BODY)
    times = np.linspace(0, 600, 1001)
    return lf.solve_ivp(body, (0, 600), t_eval=times, events=lf.Event("w2", terminal=5), dense_output=True)


def test_the_first_example(run):
    body = lf.RigidBody(**BODY)
    assert run.status == 1 and run.success and len(run.t_events[0]) == 5
    k = len(run.t)
    assert run.attitude.shape == (k, 3, 3) and lf.so3.contains(run.attitude, 1e-13).all()
    assert run.momentum_body.shape == (k, 3) and set(run.y) == {"momentum_body", "attitude"}
    exact = body.exact(run.t)
    assert np.abs(run.attitude - exact.attitude).max() < 1e-9
    assert run.drift["energy"] < 1e-15 and "momentum_norm" in run.drift
    assert np.abs(body.exact(run.t_events[0], "omega_body").omega_body[:, 1]).max() < 1e-9
    error = run.estimate_error()
    assert "exact" in error.found_by and error.y["attitude"] < 1e-9 and error.t_events[0] < 1e-8
    # The fifth zero ended the run before 300: the solution goes on when it is asked for.
    point = run.sol(300.0)
    assert np.abs(point.attitude - body.exact(300.0).attitude).max() < 1e-7
    assert point.attitude.shape == (3, 3) and lf.so3.contains(point["attitude"], 1e-13)
    assert np.abs(run.sol(run.t).attitude - run.attitude).max() < 1e-13
    assert run.as_rotation().as_matrix().shape == (k, 3, 3)
    pandas = pytest.importorskip("pandas")
    frame = run.to_dataframe()
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns[:3]) == ["m1", "m2", "m3"]
    assert np.array_equal(frame["g23"], run.attitude[:, 1, 2])


def test_results_pickle(run):
    copy = pickle.loads(pickle.dumps(run))
    assert np.array_equal(copy.attitude, run.attitude) and copy.drift == run.drift
    times = np.linspace(0, run.t_end, 57)
    assert np.array_equal(copy.sol(times).attitude, run.sol(times).attitude)
    # It has the problem, and can run again.
    own, other = run.estimate_error(), copy.estimate_error()
    assert own.y.keys() == other.y.keys() and len(own.t_events) == len(other.t_events) == len(run.t_events)


def test_an_event_by_a_function_is_that_by_its_formula(run):
    body = lf.RigidBody(**BODY)

    def g(t, y):
        return y.omega_body[1]

    other = lf.solve_ivp(body, (0, 600), t_eval=run.t, quantities=["attitude", "omega_body"],
                         events=lf.Event(g, terminal=5), method="rkmk dop853 exp")
    assert np.allclose(other.t_events[0], run.t_events[0], rtol=0, atol=1e-9)
    assert other.y_events[0].omega_body.shape == (5, 3)
    both = lf.solve_ivp(body, (0, 60), events=["2*w2 - 0.1", "m1*m1 - 1e-5"], quantities="attitude")
    assert len(both.t_events) == 2


def test_an_event_changes_the_state():
    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], momentum_body=[0.0, 0.0, 3.0])
    kick = lf.Event(lambda t, y: t - 1.0, change=lambda t, m: 2 * m, name="kick")
    r = lf.solve_ivp(body, (0, 2), quantities="momentum_body", events=kick, t_eval=[0.5, 2.0])
    assert np.allclose(r.momentum_body, [[0, 0, 3], [0, 0, 6]])
    assert "second run" in r.estimate_error().found_by


def test_numbers_of_another_start():
    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], momentum_body=[0.0, 0.0, 3.0])
    r = lf.solve_ivp(body, (0, 1), [1.0, 0.0, 0.0], quantities="momentum_body")
    assert np.allclose(r.momentum_body[-1], [1, 0, 0])
    with pytest.raises(lf.ArgumentError, match="y0: length 2, expected 3"):
        lf.solve_ivp(body, (0, 1), [1.0, 0.0], quantities="momentum_body")
    with pytest.raises(lf.ArgumentError, match="y0: quantities by name, expected the y_end of a run, the numbers of a state"):
        lf.solve_ivp(body, (1, 2), dict(r.y_end), quantities="momentum_body")


@pytest.mark.parametrize("name", lf.scenes())
def test_a_run_goes_on_from_the_end_of_another(name):
    scene = lf.load(name)
    problem, (start, end) = scene.problem, scene.t_span
    end = start + (min(end, start + 10.0) - start) / 10
    middle = start + 0.4 * (end - start)
    control = {"rtol": 1e-11, "atol": 1e-11, "method": "rkmk dop853 exp"}
    whole = lf.solve_ivp(problem, (start, end), t_eval=[start], **control).check()
    first = lf.solve_ivp(problem, (start, middle), t_eval=[start], **control).check()
    second = lf.solve_ivp(problem, (middle, end), pickle.loads(pickle.dumps(first.y_end)), **control).check()
    for quantity in whole.y_end:
        one, two = whole.y_end[quantity], second.y_end[quantity]
        assert one.shape == whole.y[quantity].shape[1:]
        assert np.abs(one - two).max() <= 1e-8 * max(1.0, np.abs(one).max()), quantity
    assert np.array_equal(second.y_end[quantity], second.y[quantity][-1])


def test_the_end_of_another_run_is_refused():
    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], momentum_body=[0.0, 1.0, 3.0])
    end = lf.solve_ivp(body, (0, 1), quantities="momentum_body").y_end
    with pytest.raises(lf.ArgumentError, match="expected the end of a run of 'rigid-body' with the same quantities"):
        lf.solve_ivp(body, (1, 2), end, quantities="attitude")
    with pytest.raises(lf.ArgumentError, match="y0: the end of another run, of 'rigid-body', expected"):
        lf.solve_ivp(lf.Spin(field=[0, 0, 1], rate=0, moment=[1, 0, 0]), (1, 2), end)
    # The body may be another one, and a run that is taken step by step goes on, too.
    other = body.replace(inertia=[1.0, 2.0, 2.5])
    run = lf.Integrator(other, None, (1, 2), end, quantities="momentum_body")
    assert np.array_equal(run.y.momentum_body, end.momentum_body)
    assert np.array_equal(end.momentum_body, lf.solve_ivp(other, (1, 2), end, quantities="momentum_body").momentum_body[0])


def test_a_quantum_state_has_length_one():
    levels = lf.Schrodinger(hamiltonian=[["0", "0.3"], ["0.3", "1"]], amplitudes=[1.0, 0.0])
    with pytest.raises(lf.ArgumentError, match=r"\|y0\|: 2, expected 1, the length of a state"):
        lf.solve_ivp(levels, (0, 1), [2.0, 0.0])
    with pytest.raises(lf.ArgumentError, match=r"\|y0\|: 2"):
        lf.Integrator(levels, None, (0, 1), [0.0, 2.0j])
    half = np.sqrt([0.5, 0.5])
    assert np.allclose(lf.solve_ivp(levels, (0, 1), half, quantities="populations").populations[0], 0.5)
    mixed = lf.DensityMatrix(hamiltonian=[["0", "0.3"], ["0.3", "1"]], density=[[1.0, 0.0], [0.0, 0.0]])
    with pytest.raises(lf.ArgumentError, match="the trace of y0: 2, expected 1, that of a density matrix"):
        lf.solve_ivp(mixed, (0, 1), np.eye(2))
    assert np.allclose(lf.solve_ivp(mixed, (0, 1), np.eye(2) / 2, quantities="populations").populations, 0.5)


def test_a_callback_and_an_exception():
    body, seen = lf.RigidBody(**BODY), []
    r = lf.solve_ivp(body, (0, 600), t_eval=np.arange(600.0), callback=lambda t, y: seen.append(y.attitude) or t > 3)
    assert r.status == 1 and len(seen) == 5
    raised = ValueError("mine")

    def g(t, y):
        raise raised

    with pytest.raises(ValueError) as caught:
        lf.solve_ivp(body, (0, 600), events=g)
    assert caught.value is raised


def test_every_kind_is_a_class():
    assert len(_problems.KINDS) >= 25
    for name, made in _problems.KINDS.items():
        assert getattr(lf, made.__name__) is made and made.__name__ in lf.__all__
        text = pydoc.render_doc(made)
        assert made.equation in text and made.kind == name
        for key, *_ in made.key_table:
            assert key in text


def test_the_stub_of_the_classes():
    import pathlib

    there = pathlib.Path(_problems.__file__).with_name("_problems.pyi")
    assert there.read_text() == stub()


@pytest.mark.parametrize("name", lf.scenes())
def test_every_scene_is_a_problem_that_its_repr_makes_again(name):
    scene = lf.load(name)
    problem = scene.problem
    again = eval(repr(problem), {"lieflow": lf})
    assert again == problem and type(again) is type(problem)
    copy = pickle.loads(pickle.dumps(problem))
    assert copy == problem and copy.method == problem.method
    assert problem.quantities and problem.methods()


@pytest.mark.parametrize(
    "problem",
    [lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.1, 1.0, 0.2]),
     lf.HeavyTop(inertia=[1.0, 2.0, 0.7], weight=[0.1, 0.0, 1.0], omega_body=[0.3, 0.0, 4.0], vertical=[0.6, 0.0, 0.8])],
    ids=["body", "top"],
)
def test_a_lie_series_is_dense_output(problem):
    given = {"dense_output": True, "rtol": 1e-11, "atol": 1e-11, "quantities": "momentum_body"}
    series = lf.solve_ivp(problem, (0, 10), method="taylor16", **given)
    other = lf.solve_ivp(problem, (0, 10), method="rkmk dop853 exp", **{**given, "rtol": 1e-14, "atol": 1e-14})
    t = np.linspace(0, 10, 333)
    assert np.abs(series.sol(t).momentum_body - other.sol(t).momentum_body).max() < 1e-9
    again = pickle.loads(pickle.dumps(series.sol))
    assert np.array_equal(again(t).momentum_body, series.sol(t).momentum_body)
    assert series.nsteps < other.nsteps / 2


@pytest.mark.parametrize("name", ["flipping-book", "lagrange-top", "toda-lattice", "gyro-record", "spin-and-oscillator"])
def test_a_scene_runs(name, tmp_path):
    scene = lf.load(name, set=["time.t_span=[0, 2]"])
    r = scene.run()
    assert r.success and len(r.t) > 1
    for quantity in scene.quantities:
        assert len(r.y[quantity]) == len(r.t)
    file = tmp_path / "scene.toml"
    file.write_text(scene.text)
    if name != "gyro-record":
        again = lf.load(file).run()
        assert all(np.array_equal(a, b) for a, b in zip(r.y.values(), again.y.values()))
    assert np.array_equal(pickle.loads(pickle.dumps(scene)).run().t, r.t)


def test_a_scene_that_is_none():
    with pytest.raises(lf.ArgumentError, match="flipping-book"):
        lf.load("flipping-bok")


@pytest.mark.parametrize(
    ("keys", "argument", "words"),
    [
        ({"inertia": [1.0, -2.0, 3.0]}, "inertia[1]", "> 0"),
        ({"inertia": [1.0, 2.0]}, "inertia", "3"),
        ({"inertia": "x"}, "inertia", "text"),
        ({"omega_bdy": [0.0, 1.0, 0.0]}, "omega_bdy", "omega_body"),
        ({"omega_body": [0.0, float("nan"), 0.0]}, "omega_body[1]", ""),
        ({"attitude": 2 * np.eye(3)}, "attitude", ""),
    ],
)
def test_a_wrong_key_is_named(keys, argument, words):
    with pytest.raises(lf.ArgumentError) as caught:
        lf.RigidBody(**{**BODY, **keys})
    assert caught.value.argument == argument and words in str(caught.value), str(caught.value)


def test_all_mistakes_are_told_at_once():
    with pytest.raises(lf.ArgumentError) as caught:
        lf.RigidBody(inertia=[1.0, -2.0, 3.0], omega_bdy=[0.0, 1.0, 0.0])
    assert len(caught.value.others) >= 1 and "omega_body" in str(caught.value)


def test_numbers_are_formulas_of_parameters():
    texts = {"inertia": ["k/3", 2, "k"], "omega_body": ["90*deg", "rpm", 0], "parameters": {"k": "2*j", "j": 1.5}}
    numbers = {"inertia": [1, 2, 3], "omega_body": [np.pi / 2, np.pi / 30, 0]}
    body = lf.RigidBody(**texts)
    assert body.keys["inertia"] == ["k/3", 2, "k"]
    ends = [lf.solve_ivp(lf.RigidBody(**keys), (0, 1)).momentum_body[-1] for keys in (texts, numbers)]
    assert np.abs(ends[0] - ends[1]).max() < 1e-14
    for text, words in (("5 deg", "write 5*deg"), ("t", "may change with time"), ("1/0", "expected a finite number")):
        with pytest.raises(lf.ArgumentError) as caught:
            lf.RigidBody(**{**BODY, "inertia": [1, 2, text]})
        assert caught.value.argument == "inertia[2]" and words in str(caught.value), str(caught.value)


@pytest.mark.parametrize("value", [1j, object(), {1, 2}, np.array([1j])])
def test_a_key_of_another_type(value):
    with pytest.raises(TypeError, match="inertia"):
        lf.RigidBody(**{**BODY, "inertia": value})


@pytest.mark.parametrize(
    ("change", "argument", "words"),
    [
        ({"quantities": "attitud"}, "quantities", "attitude"),
        ({"method": "magnus4"}, "method", ""),
        ({"method": "rkmk dop835"}, "method", "dop853"),
        ({"group": "SO(3)"}, "group", "its own"),
        ({"frame": "body"}, "frame", "its own"),
        ({"events": "w4"}, "events[0]", "w"),
        ({"events": "w1 +"}, "events[0]", ""),
        ({"t_eval": [700.0]}, "t_eval[0]", "600"),
    ],
)
def test_wrong_arguments_of_a_run(change, argument, words):
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.RigidBody(**BODY), (0, 600), **change)
    assert caught.value.argument == argument and words in str(caught.value), str(caught.value)


def test_values_of_all_types():
    whole = lf.RigidBody(inertia=(1, 2, 3), omega_body=np.float32([0, 1, 0]))
    assert whole.keys["inertia"] == [1, 2, 3]
    from scipy.spatial.transform import Rotation

    turned = whole.replace(attitude=Rotation.from_euler("z", 90, degrees=True))
    assert np.allclose(lf.solve_ivp(turned, (0, 0)).attitude[0], [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert "attitude" not in turned.replace(attitude=None).keys
    with pytest.raises(lf.ArgumentError, match="rigid-body"):
        lf.problem_of("rigid-bdy", {})
    assert lf.problem_of("rigid-body", whole.keys) == whole


def test_facts_and_names():
    top = lf.load("lagrange-top").problem
    assert isinstance(top.facts, dict) and "energy" in top.invariants
    book = lf.load("flipping-book").problem
    assert "exact" in book.methods() and book.columns("omega_body") == ("w1", "w2", "w3")
    driven = lf.load("damped-satellite").problem
    assert driven.exact(1.0) is None


def test_a_formula_without_a_value_is_named():
    ode = lf.Composed(parts=[{"name": "x", "space": "numbers", "start": [1.0], "field": ["-1/sqrt(x)"]}])
    r = lf.solve_ivp(ode, (0, 5))
    assert r.status == -1 and "sqrt" in r.message and r.t[-1] > 0.5


def test_samples_from_arrays():
    t = np.linspace(0, 2, 21)
    w = np.column_stack([np.sin(t), np.cos(t), t])
    samples = lf.Samples(t, w, "cubic", names=("a", "b", "c"))
    system = lf.Composed(
        samples=samples,
        parts=[{"name": "R", "space": "rotation", "field": ["a", "b", "c"]}],
    )
    r = lf.solve_ivp(system, (0, 2), t_eval=[2.0])
    direct = lf.solve_ivp(samples, (0, 2), np.eye(3), group="SO(3)", frame="space", t_eval=[2.0])
    assert np.abs(r.state.reshape(-1, 3, 3) - direct.y).max() < 1e-10
    assert pickle.loads(pickle.dumps(system)) == system
    with pytest.raises(lf.ArgumentError, match="t_span"):
        lf.solve_ivp(system, (0, 3))


def test_an_interrupt_of_a_large_fluid():
    fluid = lf.load("vortices-on-sphere").problem
    assert interrupted(lambda: lf.solve_ivp(fluid, (0, 1e6), dt=1e-3, t_eval=[1e6])) < 0.5


def test_an_interrupt_of_the_exact_motion():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0.1])
    times = np.linspace(0, 1e4, 4_000_000)
    assert interrupted(lambda: body.exact(times)) < 0.5


def test_moments_that_no_body_has_are_a_warning(tmp_path):
    bad, good = [1.0, 2.0, 4.0], [1.0, 2.0, 3.0]
    file = tmp_path / "scene.toml"

    def scene(inertia):
        body = f'kind = "rigid-body"\ninertia = {inertia}\nomega_body = [0, 1, 0]'
        file.write_text(f"[problem]\n{body}\n[time]\nt_span = [0, 1]\n")
        return lf.load(file)

    for make in (
        lambda inertia: lf.RigidBody(inertia=inertia, omega_body=[0, 1, 0]),
        lambda inertia: lf.DrivenBody(inertia=inertia, omega_body=[0, 1, 0], torque=["0", "0", "t"]),
        lambda inertia: lf.RigidBodies(bodies=[{"inertia": j, "momentum_body": good} for j in (good, inertia)]),
        lambda inertia: lf.FreeBodies(inertia, [good]),
        scene,
    ):
        with pytest.warns(UserWarning, match=re.escape("J3 > J1 + J2 (4 > 1 + 2): impossible for a real body")) as told:
            make(bad)
        assert len(told) == 1 and told[0].filename == __file__
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            make(good)


@pytest.mark.parametrize("name", ["inertia", "omega", "keys", "method"])
def test_a_problem_does_not_change(name):
    body = lf.RigidBody(inertia=[1, 2, 2.5], momentum_body=[1, 0, 1])
    with pytest.raises(AttributeError, match=f"{name}: a problem does not change; replace"):
        setattr(body, name, [1, 1, 1])
    assert body.replace(inertia=[1, 1, 1]).keys["inertia"] == [1, 1, 1] and body.keys["inertia"] == [1, 2, 2.5]


@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e-12, 1e-34])
def test_the_default_tolerances_know_the_unit_of_a_small_body(unit):
    body = lf.RigidBody(inertia=[unit, 2 * unit, 2.5 * unit], omega_body=[0.1, 1.0, 0.0])
    exact = body.exact([50.0], "omega_body")["omega_body"]
    for method in (None, "rkmk dop853 exp", "rkmk4"):
        r = lf.solve_ivp(body, (0, 50), t_eval=[50.0], quantities="omega_body", method=method)
        assert np.abs(r.omega_body - exact).max() < (1e-6 if method == "rkmk4" else 1e-9), (unit, method)

    def f(t, m):
        return -m / (unit * np.array([1.0, 2.0, 2.5]))

    m0 = unit * np.array([0.1, 2.0, 0.0])
    r = lf.solve_ivp(f, (0, 50), m0, group="SO(3)", action="coadjoint", t_eval=[50.0])
    assert np.abs(r.y / (unit * np.array([1.0, 2.0, 2.5])) - exact).max() < 1e-9, unit


@pytest.mark.parametrize("end", [40.0, -40.0])
@pytest.mark.parametrize("steps", [{"method": "rkmk4 exp", "dt": 0.1}, {"method": "rkmk dopri5 exp"}, {}])
def test_dense_output_follows_the_turns_of_rows(end, steps):
    """A body that turns 64 times about z: rows at a few times and the curve have the same angles and signs."""
    body = lf.RigidBody(inertia=[1, 1, 2], omega_body=[0.1, 0.0, 10.0])
    stop = lf.Event(lambda t, y: abs(t) - 20.125, change=lambda t, numbers: numbers)
    asked = {"quantities": ["momentum_body", "attitude", "euler_zyx", "quaternion"], "dense_output": True, **steps}
    times = np.linspace(0, end, 4001)
    for events in ([], [stop]):
        run = lf.solve_ivp(body, (0, end), t_eval=times, events=events, **asked)
        few = lf.solve_ivp(body, (0, end), t_eval=times[::500], events=events, **asked)
        turned = np.abs(run.euler_zyx[:, 0] - run.euler_zyx[0, 0]).max()
        assert turned > 390
        assert np.abs(np.diff(run.quaternion, axis=0)).max() < 0.1
        for sol in (run.sol, few.sol, pickle.loads(pickle.dumps(few.sol))):
            at = sol(times)
            assert np.abs(at.euler_zyx - run.euler_zyx).max() < 1e-9, (steps, end)
            assert np.abs(at.quaternion - run.quaternion).max() < 1e-9, (steps, end)
        assert np.abs(few.euler_zyx - run.euler_zyx[::500]).max() < 1e-9


def test_a_body_goes_on_with_its_own_momentum():
    """The state of a free body is its attitude alone: its momentum is in the keys."""
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.3, 1, 0.2])
    other, end = body.replace(inertia=[1.5, 2, 3]), lf.solve_ivp(body, (0, 1)).y_end
    with pytest.raises(lf.ArgumentError, match="an attitude alone, whose momentum the keys of the other problem say"):
        lf.solve_ivp(other, (1, 2), end)
    again = pickle.loads(pickle.dumps(end))
    assert np.array_equal(lf.solve_ivp(body, (1, 2), again).momentum_body[0], end["momentum_body"])
    alone = lf.solve_ivp(body, (0, 1), quantities="momentum_body").y_end
    assert np.array_equal(lf.solve_ivp(other, (1, 2), alone, quantities="momentum_body").momentum_body[0], alone["momentum_body"])


def test_estimates_know_turns_and_signs():
    for keys, asked in (
        ({"omega_body": [0.1, 1, 0.2], "quaternion": [-0.5, 0.5, 0.5, 0.5]}, ["quaternion", "attitude"]),
        ({"omega_body": [0.1, 1, 2.2]}, ["euler_zyx", "attitude"]),
    ):
        body = lf.RigidBody(inertia=[1, 2, 3], **keys)
        run = lf.solve_ivp(body, (0, 30), t_eval=[0, 10, 20, 30], quantities=asked)
        error = run.estimate_error()
        assert error.found_by == "the exact motion" and max(error.y.values()) < 1e-11, error
        first = body.exact([0.0], asked[0])[asked[0]]
        assert np.abs(first[0] - run.y[asked[0]][0]).max() < 1e-14


def test_estimates_leave_out_rows_where_an_event_changes_the_state():
    """The row at the end of the step has the y after the event, and that of a second run at this time the y before."""
    def f(t, y):
        return [0.3 * np.sin(3 * t), 0.2, 1 + y[0]]

    flip = lf.Event(lambda t, y: t - 5.03, change=lambda t, y: -y)
    settings = {"group": "SO(3)", "action": "linear", "events": flip}
    for steps in ({}, {"dt": 0.5, "method": "rkmk4"}):
        run = lf.solve_ivp(f, (0, 20), [0.6, 0, 0.8], **settings, **steps)
        place = int(np.abs(run.t - 5.03).argmin())
        assert np.abs(run.y[place] + run.y_events[0][0]).max() < 1e-12
        assert run.estimate_error().y < (1e-9 if not steps else 0.02)


def test_a_pulse_is_searched_for_after_few_steps():
    def f(t, s):
        return [2 * np.exp(-(((t - 17.3) / 0.05) ** 2)), 0, 0.1]

    run = lf.solve_ivp(f, (0, 30), [0, 0.6, 0.8], group="SO(3)", action="linear", rtol=1e-6)
    assert run.nsteps > 20 or run.estimate_error().y > 0.1, run.estimate_error()


TENSOR = np.array([[2, 0.1, 0.2], [0.1, 1.5, -0.1], [0.2, -0.1, 1.2]])
OTHER = np.array([[1.8, 0.05, 0.1], [0.05, 1.5, -0.2], [0.1, -0.2, 1.1]])


@pytest.mark.parametrize("quantities", [["attitude", "momentum_space", "momentum_body"], ["momentum_body"]])
@pytest.mark.parametrize("kind, keys", [(lf.HeavyTop, {"weight": [0, 0, 1.0]}), (lf.RigidBody, {}), (lf.DrivenBody, {"damping": 0.1})])
def test_states_of_bodies_are_in_the_frame_of_the_tensor(kind, keys, quantities):
    start = {"omega_body": [0.1, 0.2, -0.1], "attitude": lf.so3.exp([1.0, -0.8, 0.5])}
    first = kind(inertia=TENSOR, **start, **keys)
    before = lf.solve_ivp(first, (0, 2), quantities=quantities)
    if kind is lf.RigidBody and "attitude" in quantities:
        with pytest.raises(lf.ArgumentError, match="an attitude alone"):
            lf.solve_ivp(first.replace(inertia=OTHER), (2, 3), before.y_end, quantities=quantities)
        return
    for inertia in (OTHER, np.diag([1.2, 1.5, 2.0]), [1.2, 1.5, 2.0]):
        after = lf.solve_ivp(first.replace(inertia=inertia), (2, 3), before.y_end, quantities=quantities)
        for name in quantities:
            # The momentum in space is that of the state where the attitude is, the one in the body where it is alone.
            assert np.abs(after[name][0] - before[name][-1]).max() < 1e-13, (name, inertia)
    # A run goes on from the numbers of a state, as from itself.
    run = lf.Integrator(first, t_span=(0, 5), quantities=quantities)
    run.advance_to(2.0)
    again = lf.solve_ivp(first, (2, 5), run.state, quantities=quantities)
    whole = lf.solve_ivp(first, (0, 5), quantities=quantities)
    for name in quantities:
        assert np.abs(again[name][-1] - whole[name][-1]).max() < 1e-11


@pytest.mark.parametrize("inertia", [TENSOR, np.diag([2, 1.5, 1.2]), np.diag([3.0, 1, 2]), [2, 1.5, 1.2]])
def test_changes_of_bodies_are_in_the_frame_of_the_tensor(inertia):
    body = lf.RigidBody(inertia=inertia, omega_body=[0.3, 0.2, -0.1])
    pulse = lf.Event(lambda t, y: t - 1, change=lambda t, m: m + [0, 0, 0.5], name="pulse")
    run = lf.solve_ivp(body, (0, 2), t_eval=[1 - 1e-9, 1 + 1e-9], events=pulse, quantities=["momentum_body"])
    assert np.abs(run.momentum_body[1] - run.momentum_body[0] - [0, 0, 0.5]).max() < 1e-8
    turned = lf.RigidBody(inertia=inertia, omega_body=[0.3, 0.2, -0.1], quaternion=[1, 0, 0, 0])
    state = lf.Integrator(turned, t_span=(0, 1), quantities=["quaternion"]).state
    assert np.abs(np.abs(state).max() - 1) < 1e-15 and np.count_nonzero(np.abs(state) > 1e-15) == 1


def test_the_end_of_a_scene_is_a_start():
    scene = lf.load("asymmetric-top")
    end = scene.run().y_end
    t = scene.t_span[1]
    after = lf.solve_ivp(scene.problem, (t, t + 1), end, quantities=scene.quantities)
    for name in end:
        assert np.abs(after[name][0] - end[name]).max() < 1e-14


def test_parts_in_another_order_are_others():
    a = {"name": "a", "space": "numbers", "start": [1.0], "field": ["b"]}
    b = {"name": "b", "space": "numbers", "start": [2.0], "field": ["-a"]}
    end = lf.solve_ivp(lf.Composed(parts=[a, b]), (0, 1)).y_end
    assert lf.solve_ivp(lf.Composed(parts=[a, b]), (1, 2), end).success
    with pytest.raises(lf.ArgumentError, match="other parts"):
        lf.solve_ivp(lf.Composed(parts=[b, a]), (1, 2), end)


def test_a_quaternion_alone_is_a_state_of_its_keys():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.3, 1, 0.2], quaternion=[1, 0, 0, 0])
    end = lf.solve_ivp(body, (0, 1)).y_end
    same = lf.RigidBody(inertia=np.array([1.0, 2, 3]), omega_body=[0.3, 1.0, 0.2], quaternion=[1, 0, 0, 0])
    assert lf.solve_ivp(same, (1, 2), end).success
    for other in (body.replace(omega_body=[3, 0, 0]), body.replace(inertia=[2, 2.5, 3])):
        with pytest.raises(lf.ArgumentError, match="an attitude alone"):
            lf.solve_ivp(other, (1, 2), end)


def test_other_samples_have_their_interpolation():
    t = np.linspace(0, 4, 9)
    keys = {"inertia": [1, 2, 3], "omega_body": [0.3, 1, 0.2], "torque": ["u", 0, 0]}
    cubic = lf.Samples(t, np.sin(t), "cubic", names=["u"])
    linear = lf.Samples(t, np.cos(3 * t), "linear", names=["u"])
    replaced, fresh = lf.DrivenBody(samples=cubic, **keys).replace(samples=linear), lf.DrivenBody(samples=linear, **keys)
    assert replaced == fresh and replaced.keys["interpolation"] == "linear"
    assert lf.DrivenBody(samples=cubic, **keys).replace(samples=None, torque=None).keys.keys() == {"inertia", "omega_body"}


def test_equal_problems_are_one():
    one, other = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.3, 1, 0]), lf.RigidBody(inertia=np.array([1.0, 2, 3]), omega_body=[np.float64(0.3), 1, 0])
    assert one == other and len({one, other}) == 1
    assert eval(repr(other), {"lieflow": lf}) == other and "np" not in repr(other)
    below = one.replace(omega_body=[0.3, 1, -0.0])
    assert below == one and len({one, below}) == 1
    keys = {"quantities": "attitude", "method": "rkmk dop853 exp"}
    end = lf.solve_ivp(one, (0, 1), **keys).y_end
    assert lf.solve_ivp(below, (1, 2), end, **keys).success


def test_an_integrator_refuses_what_a_run_refuses():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.3, 1, 0])
    for name, value in (("group", "SE(3)"), ("frame", "body"), ("action", "linear"), ("linear", True), ("args", (1,))):
        with pytest.raises(lf.ArgumentError, match=name):
            lf.Integrator(body, None, (0, 10), **{name: value})
    with pytest.raises(lf.ArgumentError, match=r"stops\[0\]"):
        lf.Integrator(body, None, (0, 10), stops=[500.0])


def test_states_off_m_are_refused():
    hamiltonian, lopsided = [[1, 0.3], [0.3, -1]], [2, 0.6, 0.1, 1.0]
    mixed, symmetric = lf.DensityMatrix(hamiltonian=hamiltonian, amplitudes=[1, 0]), [[2, 0.1], [0.1, 1]]
    oja, subspaces = lf.load("oja").problem, lf.load("subspaces").problem
    columns, projector = (lf.Integrator(problem, None, (0, 1)).state for problem in (oja, subspaces))
    projector[1] += 0.5
    cell = r"{}\[1, 0\]: 0.6, expected a symmetric matrix, but {}\[0, 1\] is 0.1"
    for problem, wrong, words in (
        (mixed, np.array([[0.5, 0.4], [0, 0.5]]), r"the real part of {}\[1, 0\]: 0, expected a Hermitian matrix"),
        (mixed, np.diag([2.0, -1.0]), "the least eigenvalue of {}: -1, expected at least 0"),
        (mixed, 2 * np.diag([1.0, 0.0]), "the trace of {}: 2, expected 1, that of a density matrix"),
        (lf.Schrodinger(hamiltonian=hamiltonian, amplitudes=[1, 0]), np.array([2.0, 0.0]), r"\|{}\|: 2, expected 1, the length of a state"),
        (lf.DoubleBracket(matrix=symmetric, order=[1, 2]), lopsided, cell),
        (lf.Toda(matrix=symmetric), lopsided, cell),
        (lf.QrFlow(matrix=symmetric), lopsided, cell),
        (lf.Riccati(c=symmetric, b=symmetric, p=symmetric), lopsided, cell),
        (lf.RigidBodyN(mass_moments=[1, 2], momentum=[1.0]), [0, 1, 1, 0], r"{}\[1, 0\]: 1, expected an antisymmetric matrix"),
        (oja, 2 * columns, "the distance of {}ᵀ{} from the identity: [0-9.]+, expected 0, that of orthonormal columns"),
        (subspaces, projector, r"{}\[1, 0\]: [0-9.-]+, expected a symmetric matrix"),
    ):
        with pytest.raises(lf.ArgumentError, match=words.replace("{}", "y0")):
            lf.solve_ivp(problem, (0, 1), wrong)
        change = lf.Event(lambda t, y: t - 0.5, change=lambda t, y, wrong=wrong: wrong)
        run = lf.solve_ivp(problem, (0, 1), events=change)
        assert run.status == -1 and "set at t = 0.5 cannot be used" in run.message
        if problem is oja or isinstance(wrong, list):
            with pytest.raises(lf.ArgumentError, match=words.replace("{}", "state")):
                lf.Integrator(problem, None, (0, 1)).state = wrong
        end = lf.solve_ivp(problem, (0, 1)).y_end
        assert lf.solve_ivp(problem, (1, 2), end).success


def test_quantities_may_be_spelled_as_in_scenes():
    p = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 0.2, 0.3])
    for given in ("Attitude", "attitude ", "ATTITUDE"):
        assert lf.solve_ivp(p, (0, 1), quantities=given).y_end["attitude"].shape == (3, 3)
    r = lf.solve_ivp(p, (0, 1), quantities=["Omega-Body", "omega_body", "momentum body"])
    assert list(r.y) == ["omega_body", "momentum_body"]
    assert p.exact(1.0, "euler_ZYX").euler_zyx.shape == (3,)
    with pytest.raises(lf.ArgumentError, match="^quantities: "):
        p.asked("foo")


def test_each_component_of_a_torque_has_its_own_digits():
    keys = {"inertia": [1, 2, 3], "omega_body": [0.3, 1, 0.2], "euler": {"zyx": [0.4, 0.3, 0.2]}}
    by_formulas = lf.DrivenBody(**keys, torque=["1e6*sin(t)", "1e-9", "0"])
    run = lf.solve_ivp(by_formulas, (0, 0.01), quantities="torque")
    assert (run.torque[:, 1] == 1e-9).all() and (run.torque[:, 2] == 0).all()
    # Those in space and in the body are added in the body.
    both = lf.DrivenBody(**keys, thruster=[0, 1, 0], damping=0.5, torque_space=["0", "0", "2"])
    run = lf.solve_ivp(both, (0, 1), quantities=["torque", "attitude", "omega_body"])
    right = run.attitude.transpose(0, 2, 1) @ [0, 0, 2] + [0, 1, 0] - 0.5 * run.omega_body
    assert np.abs(run.torque - right).max() < 1e-15
