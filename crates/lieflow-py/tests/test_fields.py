"""Fields as formulas, samples and parts; integrators; many bodies."""

from __future__ import annotations

import multiprocessing
import pickle

import numpy as np
import pytest
from conftest import J, M, body

import lieflow as lf

ROTATION = {"group": "SO(3)", "frame": "body"}
FORMULAS = ["dot(m, [y11, y21, y31])/J1", "dot(m, [y12, y22, y32])/J2", "dot(m, [y13, y23, y33])/J3"]
TIMES = np.linspace(0, 20, 41)


@pytest.fixture(scope="module")
def right():
    return lf.solve_ivp(body, (0, 20), np.eye(3), t_eval=TIMES, rtol=1e-12, atol=1e-12, **ROTATION)


def test_formulas_are_the_function(right):
    field = lf.Field("SO(3)", FORMULAS, m=M, J=J)
    r = lf.solve_ivp(field, (0, 20), np.eye(3), frame="body", t_eval=TIMES, rtol=1e-12, atol=1e-12, events="y11 - 0.5")
    assert np.abs(r.y - right.y).max() < 1e-9
    assert len(r.t_events[0]) > 0 and np.abs(r.y_events[0][:, 0, 0] - 0.5).max() < 1e-9
    copy = pickle.loads(pickle.dumps(field))
    again = eval(repr(field), {"lieflow": lf, "array": np.array})
    for other in (copy, again):
        assert np.array_equal(lf.solve_ivp(other, (0, 20), np.eye(3), frame="body", t_eval=TIMES, rtol=1e-12, atol=1e-12).y, r.y)
    named = lf.Field("SO(3)", "transpose(R)*m", y="R", m=M)
    function = lf.solve_ivp(lambda t, R: M @ R, (0, 5), np.eye(3), t_eval=[5.0], **ROTATION)
    assert np.abs(lf.solve_ivp(named, (0, 5), np.eye(3), frame="body", t_eval=[5.0]).y - function.y).max() < 1e-9


def test_formulas_of_other_groups():
    hill = lf.Field("Sp(2)", [["0", "1"], ["-(2 + cos(t))", 0]])
    r = lf.solve_ivp(hill, (0, 5), np.eye(2), frame="space", method="magnus4", steps=500)
    assert np.abs(np.linalg.det(r.y) - 1).max() < 1e-13
    spin = lf.Field("SO(3)", "b", let={"b": ["cos(t)", "sin(t)", "w"]}, w=2.0)
    s = lf.solve_ivp(spin, (0, 9), [0, 0, 1.0], action="linear")
    f = lf.solve_ivp(lambda t, y: [np.cos(t), np.sin(t), 2.0], (0, 9), [0, 0, 1.0], group="SO(3)", action="linear")
    assert np.abs(s.y_end - f.y_end).max() < 1e-10
    with pytest.raises(lf.ArgumentError, match="its group"):
        lf.solve_ivp(spin, (0, 9), [0, 0, 1.0], group="SE(3)", action="linear")


@pytest.mark.parametrize(
    ("field", "argument"),
    [(["x", "0", "0"], "field"), (["0", "0"], "field"), (["1 +", "0", "0"], "field"), ("1", "field")],
)
def test_wrong_formulas_are_named(field, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.Field("SO(3)", field), (0, 1), np.eye(3), frame="body")
    assert caught.value.argument.startswith(argument), str(caught.value)


def test_a_formula_without_a_value_ends_the_run():
    r = lf.solve_ivp(lf.Field("SO(3)", ["sqrt(1 - t)", 0, 0]), (0, 3), np.eye(3), frame="body")
    assert r.status == -1 and "sqrt(1 - t)" in r.message and 0.9 < r.t_end <= 1


def test_samples_as_a_field():
    t = np.linspace(0, 4, 41)
    rate = np.column_stack([np.sin(t), np.cos(t), 0.3 * t])
    increments = np.zeros_like(rate)
    exact = lambda t: np.column_stack([-np.cos(t), np.sin(t), 0.15 * t**2])  # noqa: E731
    increments[1:] = np.diff(exact(t), axis=0)
    truth = lf.solve_ivp(lambda t, y: [np.sin(t), np.cos(t), 0.3 * t], (0, 4), np.eye(3), t_eval=[4.0], **ROTATION)
    for values, kind, bound in ((rate, "linear", 1e-2), (rate, "cubic", 1e-4), (increments, "mean-rate", 1e-4)):
        samples = lf.Samples(t, values, kind)
        for method in (None, "rkmk4"):
            steps = {"steps": 400} if method else {}
            r = lf.solve_ivp(samples, (0, 4), np.eye(3), t_eval=[4.0], method=method, **steps, **ROTATION)
            assert np.abs(r.y - truth.y).max() < bound
        assert samples([0.05, 1.0]).shape == (2, 3)
        copy = pickle.loads(pickle.dumps(samples))
        assert np.array_equal(copy([0.05, 1.0]), samples([0.05, 1.0]))
    with pytest.raises(lf.ArgumentError, match="t_span"):
        lf.solve_ivp(lf.Samples(t, rate), (0, 5), np.eye(3), **ROTATION)
    with pytest.raises(lf.ArgumentError, match=r"t\[1\]"):
        lf.Samples(t, rate)([1.0, 5.0])
    for bad in ((t[::-1], rate, "linear"), (t, rate[:-1], "linear"), (t, rate, "quadratic"), (t[:1], rate[:1], "linear")):
        with pytest.raises(lf.ArgumentError):
            lf.Samples(*bad)


def test_held_values_jump_at_their_times():
    t, u = np.array([0, 0.5, 1.25, 2, 3.0]), np.array([1.0, -2, 0.5, 3, 9])
    held = lf.Samples(t, u, "previous")
    assert np.array_equal(held([0, 0.49, 0.5, 2.9, 3])[:, 0], [1, 1, -2, 3, 9])
    exact = (u[:-1] * np.diff(t)).sum()
    columns = [np.zeros(5), np.zeros(5), u]
    rate = lf.Samples(t, np.column_stack(columns), "previous", names=["a", "b", "u"])
    angle = lambda R: np.arctan2(R[1, 0], R[0, 0])  # noqa: E731
    for fun in (rate, lf.Field("SO(3)", [0, 0, "u"], samples=rate)):
        group = {"frame": "body"} if isinstance(fun, lf.Field) else ROTATION
        for span in ((0, 3), (3, 0)):
            for steps in ({}, {"dt": 0.4}, {"method": "rkmk4", "steps": 4}):
                r = lf.solve_ivp(fun, span, np.eye(3), **steps, **group)
                assert abs(angle(r.y_end) - np.sign(span[1] - span[0]) * exact) < 1e-12
        run = lf.Integrator(fun, None, (0, 3), np.eye(3), dt=0.4, **group)
        run.advance_to(3)
        assert abs(angle(run.y) - exact) < 1e-12
    body = lf.DrivenBody(inertia=[1, 2, 3], omega_body=[0, 0, 0.1], torque=[0, 0, "s"], samples=held)
    for steps in ({}, {"dt": 0.4}):
        r = lf.solve_ivp(body, (0, 3), quantities="momentum_space", **steps)
        assert abs(r.y_end["momentum_space"][2] - 0.3 - exact) < 1e-12


PARTS = lf.Parts(q="number", R="rotation", x="vector", m="numbers 3")


def coupled(t, y):
    return {"R": y["m"] / J, "x": [0.0, np.cos(t), y["q"]], "m": np.cross(y["m"], y["m"] / J), "q": y["x"][0]}


START = {"R": np.eye(3), "x": [0.0, 0.0, 1.0], "m": M, "q": 0.5}


def test_parts_have_arrays_by_name():
    r = lf.solve_ivp(coupled, (0, 10), START, group=PARTS, frame="body", t_eval=TIMES / 2, dense_output=True,
                     events=lambda t, y: y.m[0], rtol=1e-11, atol=1e-11)
    assert r.R.shape == (41, 3, 3) and r.x.shape == (41, 3) and r.m.shape == (41, 3) and r.q.shape == (41,)
    assert lf.so3.contains(r.R, 1e-13).all() and np.abs(np.linalg.norm(r.x, axis=1) - 1).max() < 1e-13
    # The momentum in space stays.
    assert np.abs(np.einsum("kij,kj->ki", r.R, r.m) - M).max() < 1e-8
    assert np.abs(r.sol(5.0).R - r.R[20]).max() < 1e-12 and r.y_events[0].m.shape[1] == 3
    copy = pickle.loads(pickle.dumps(r))
    assert np.array_equal(copy.sol(3.3).m, r.sol(3.3).m)
    text = {"R": ["m1/J1", "m2/J2", "m3/J3"], "x": [0, "cos(t)", "q"],
            "m": "cross(m, [m1/J1, m2/J2, m3/J3])", "q": "x1"}
    field = lf.solve_ivp(lf.Field(PARTS, text, J=J), (0, 10), START, frame="body", t_eval=TIMES / 2, rtol=1e-11, atol=1e-11)
    assert np.abs(field.R - r.R).max() < 1e-9 and np.abs(field.q - r.q).max() < 1e-9
    assert eval(repr(PARTS), {"lieflow": lf}).spaces == PARTS.spaces
    assert r.to_dataframe().shape == (41, 16) and r.estimate_error().y["q"] < 1e-8


@pytest.mark.parametrize(
    ("y0", "words"),
    [({"R": np.eye(3)}, "missing"), ({**START, "z": 1.0}, "no part"), ({**START, "R": np.eye(2)}, "shape"),
     ({**START, "R": 2 * np.eye(3)}, "SO"), ({**START, "x": [np.nan, 0, 0]}, "finite")],
)
def test_wrong_parts_are_named(y0, words):
    with pytest.raises(lf.ArgumentError, match=words):
        lf.solve_ivp(coupled, (0, 1), y0, group=PARTS, frame="body")


def test_wrong_values_of_parts():
    with pytest.raises(lf.ArgumentError, match="frame"):
        lf.solve_ivp(coupled, (0, 1), START, group=PARTS)
    with pytest.raises(TypeError, match="f at t = 0.0"):
        lf.solve_ivp(lambda t, y: [1.0], (0, 1), START, group=PARTS, frame="body")
    for spaces in ({}, {"x": "vectr"}, {"x": "numbers 0"}):
        with pytest.raises(lf.ArgumentError):
            lf.Parts(**spaces)


@pytest.mark.parametrize("of", ["function", "formulas", "problem", "parts"])
def test_an_integrator(of):
    make = {
        "function": lambda: lf.Integrator(body, None, (0, 20), np.eye(3), rtol=1e-11, atol=1e-11, **ROTATION),
        "formulas": lambda: lf.Integrator(lf.Field("SO(3)", FORMULAS, m=M, J=J), "rkmk dop853 exp", (0, 20), np.eye(3),
                                          frame="body", rtol=1e-11, atol=1e-11),
        "problem": lambda: lf.Integrator(lf.RigidBody(inertia=J, momentum_body=M), None, (0, 20), rtol=1e-11, atol=1e-11),
        "parts": lambda: lf.Integrator(coupled, None, (0, 20), START, group=PARTS, frame="body", rtol=1e-11, atol=1e-11),
    }[of]
    attitude = lambda run: run.y if of in ("function", "formulas") else run.y["R" if of == "parts" else "attitude"]  # noqa: E731
    run = make()
    assert run.t == 0 and run.t_end == 20
    run.advance_to(10.0)
    reference = lf.solve_ivp(body, (0, 10), np.eye(3), rtol=1e-12, atol=1e-12, **ROTATION)
    assert run.t == 10 and np.abs(attitude(run) - reference.y_end).max() < 1e-8
    state = run.save()
    copy = pickle.loads(pickle.dumps(run))
    run.step()
    within = 0.5 * (10 + run.t)
    between = run.interpolate(within)
    assert lf.so3.contains(between if of in ("function", "formulas") else between["R" if of == "parts" else "attitude"], 1e-12)
    end = attitude(run)
    other = make()
    other.restore(state)
    other.step()
    copy.step()
    assert np.array_equal(attitude(other), end) and np.array_equal(attitude(copy), end)
    run.advance_to(20.0)
    assert run.nsteps > 3 and run.step() == 20
    with pytest.raises(lf.ArgumentError):
        run.advance_to(5.0)
    with pytest.raises(lf.ArgumentError):
        run.restore(state[:-3])
    run.state = run.state
    with pytest.raises(lf.ArgumentError):
        run.state = run.state[:-1]


def test_the_state_of_an_integrator_is_set():
    run = lf.Integrator(body, None, (0, 20), np.eye(3), **ROTATION)
    run.advance_to(1.0)
    turned = lf.so3.exp([0.3, 0.0, 0.0])
    run.y = turned
    assert np.abs(run.y - turned).max() < 1e-15 and run.t == 1
    with pytest.raises(lf.ArgumentError):
        run.y = 2 * np.eye(3)
    assert np.abs(run.y - turned).max() < 1e-15
    with pytest.raises(lf.ArgumentError):
        run.y = np.eye(4)
    raised = ValueError("mine")

    def f(t, y):
        raise raised

    with pytest.raises(ValueError) as caught:
        lf.Integrator(f, None, (0, 20), np.eye(3), **ROTATION).step()
    assert caught.value is raised
    with pytest.raises(TypeError, match="t_eval"):
        lf.Integrator(body, None, (0, 20), np.eye(3), t_eval=[1.0], **ROTATION)


def test_many_bodies_are_single_ones():
    rng = np.random.default_rng(5)
    m = rng.standard_normal((130, 3))
    bodies = lf.FreeBodies(J, m, np.broadcast_to(np.eye(3), (130, 3, 3)))
    energy = bodies.energy
    bodies.advance("rkmk4 cay", 0.01, 200, threads=2)
    assert len(bodies) == 130 and lf.so3.contains(bodies.attitude, 1e-12).all()
    assert np.abs(np.linalg.norm(bodies.momentum, axis=1) - np.linalg.norm(m, axis=1)).max() < 1e-13
    assert np.abs(bodies.energy - energy).max() < 1e-6
    one = lf.solve_ivp(lf.RigidBody(inertia=J, momentum_body=m[100]), (0, 2), method="rkmk4 cay", dt=0.01)
    assert np.abs(one.attitude[-1] - bodies.attitude[100]).max() < 1e-12
    copy = pickle.loads(pickle.dumps(bodies))
    assert np.array_equal(copy.momentum, bodies.momentum)
    alone = lf.FreeBodies(np.tile(J, (3, 1)), m[:3])
    alone.advance("rk4-mg", 0.01, 10)
    assert alone.attitude is None
    for bad in (("euler", 0.01, 1, 1), ("rkmk4 cay", np.nan, 1, 1), ("rkmk4 cay", 0.01, -1, 1), ("rkmk4 cay", 0.01, 1, 0)):
        with pytest.raises(lf.ArgumentError):
            bodies.advance(*bad)
    with pytest.raises(lf.ArgumentError):
        lf.FreeBodies(J, m[0])


def work(given):
    problem, t = given
    run = lf.solve_ivp(problem, (0, t), dense_output=True)
    return run, run.sol


def test_objects_go_through_processes():
    problem = lf.RigidBody(inertia=J, momentum_body=M)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        [(run, sol)] = pool.map(work, [(problem, 3.0)])
    here = lf.solve_ivp(problem, (0, 3.0), dense_output=True)
    assert np.array_equal(run.attitude, here.attitude)
    assert np.abs(sol(3.0).attitude - here.attitude[-1]).max() < 1e-13


@pytest.mark.parametrize("options", [{"dt": 0.01}, {"rtol": 1e-8, "atol": 1e-8}])
def test_a_value_outside_the_algebra_ends_the_run(options):
    K = lf.SO(4).random(rng=1) - lf.SO(4).random(rng=1).T
    K = K - K.T
    space = {"group": "SO(4)", "frame": "space", **options}
    # The derivative in place of f: at the start both are equal.
    wrong = lf.solve_ivp(lambda t, y: K @ y, (0, 3), np.eye(4), **space)
    assert wrong.status == -1 and "f: not in the Lie algebra of SO(4)" in wrong.message and wrong.t_end < 3
    late = lf.solve_ivp(lambda t, y: K + max(t - 1, 0) * np.eye(4), (0, 3), np.eye(4), **space)
    assert late.status == -1 and 1 < late.t_end < 3
    right = lf.solve_ivp(lambda t, y: K, (0, 3), np.eye(4), **space)
    assert right.success
    late = lf.solve_ivp(
        lambda t: np.array([[1j - max(t - 1, 0), 0], [0, 2j]]), (0, 3), np.eye(2), group="U(2)", frame="space", linear=True,
        **options
    )
    assert late.status == -1 and "U(2)" in late.message


def test_rtol_alone_from_rest():
    f = lambda t, y: [0.1, 0.2, np.cos(t), 1.0, 0.0, t]  # noqa: E731
    run = lf.solve_ivp(f, (0, 2), np.eye(4), group="SE(3)", frame="body", method="rkmk dopri5", rtol=1e-8, atol=0)
    fine = lf.solve_ivp(f, (0, 2), np.eye(4), group="SE(3)", frame="body", rtol=1e-12, atol=1e-12)
    assert run.success and np.abs(run.y_end - fine.y_end).max() < 1e-7


def test_a_lagrangian_start_is_symmetric():
    f = lambda t, y: [[0, 0, 1, 0], [0, 0, 0, 1], [-1, 0, 0, 0], [0, -1, 0, 0]]  # noqa: E731
    space = {"group": "Sp(4)", "action": "lagrangian"}
    assert lf.solve_ivp(f, (0, 1), np.eye(2), **space).success
    with pytest.raises(lf.ArgumentError, match="symmetric"):
        lf.solve_ivp(f, (0, 1), [[1.0, 0.2], [0.1, 1.0]], **space)


def test_a_wrong_formula_of_let_is_named():
    wrong = {"a": "sin(t)", "b": "cos(q)"}
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.Field("SO(3)", ["a", "b", "0"], let=wrong), (0, 1), np.eye(3), frame="body")
    assert caught.value.argument == "let.b" and "`q`" in str(caught.value)
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.Field("SO(3)", ["a", "b", "c"], let={"a": "sin(t", "b": "1"}), (0, 1), np.eye(3), frame="body")
    assert caught.value.argument == "let.a" and len(caught.value.others) == 1


def test_spaces_without_methods_for_linear_equations_are_told():
    expected = "methods for linear equations are for SO"
    quaternion = dict(group="S3", frame="body", linear=True, method="magnus4")
    with pytest.raises(lf.ArgumentError, match=expected):
        lf.solve_ivp(lambda t: [0, 0, 1], (0, 1), [1, 0, 0, 0], **quaternion)
    parts = lf.Parts(R="rotation", x="vector")
    with pytest.raises(lf.ArgumentError, match=expected):
        lf.solve_ivp(lambda t: {"R": [0, 0, 1], "x": [0, 0, 1]}, (0, 1), {"R": np.eye(3), "x": [1, 0, 0]}, group=parts,
                     frame="body", linear=True, method="cfm4-2")
    # Other methods run.
    run = lf.solve_ivp(lambda t: [0, 0, 1], (0, 1), [1, 0, 0, 0], **{**quaternion, "method": "rkmk dop853"})
    assert np.allclose(run.y_end, [np.cos(0.5), 0, 0, np.sin(0.5)])


def test_samples_of_parts_are_in_their_order():
    parts = lf.Parts(h="numbers 3", s="vector")
    values = [[1.0, 2, 3, 0, 0, 0.5]] * 2
    start = {"h": [0.0, 0, 0], "s": [1.0, 0, 0]}
    run = lf.solve_ivp(lf.Samples([0.0, 2.0], values), (0, 2), start, group=parts, t_eval=[2.0])
    assert np.abs(run.y["h"][-1] - [2, 4, 6]).max() < 1e-12
    assert np.abs(run.y["s"][-1] - [np.cos(1), np.sin(1), 0]).max() < 1e-6


def test_low_level_callables():
    import ctypes

    scipy = pytest.importorskip("scipy")
    pointer = ctypes.POINTER(ctypes.c_double)

    @ctypes.CFUNCTYPE(None, ctypes.c_double, pointer, pointer, pointer)
    def turn(t, y, v, p):
        v[2] = p[0]

    address = ctypes.cast(turn, ctypes.c_void_p).value
    new = ctypes.pythonapi.PyCapsule_New
    new.restype, new.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    name = b"void (double, double const *, double *, double const *)"
    capsule = new(address, name, None)
    for function in (turn, capsule, scipy.LowLevelCallable(turn), scipy.LowLevelCallable(capsule)):
        assert lf.CFunction(function, [3.0]).address == address
    numbers = (ctypes.c_double * 1)(2.0)
    with pytest.raises(lf.ArgumentError, match="user_data.*parameters"):
        lf.CFunction(scipy.LowLevelCallable(turn, ctypes.cast(numbers, ctypes.c_void_p)))


def test_formulas_of_y_are_not_linear():
    space = {"frame": "body", "linear": True}
    magnus = {**space, "method": "magnus4", "steps": 10}
    samples = lf.Samples([0, 1], [[1.0, 0], [2.0, 1]], names=["s", "q"])
    of_t = lf.Field("SO(3)", ["s", "c", "0"], let={"c": "q^2", "not_used": "y11"}, samples=samples)
    assert np.array_equal(
        lf.solve_ivp(of_t, (0, 1), np.eye(3), **magnus).y_end,
        lf.solve_ivp(of_t, (0, 1), np.eye(3), **{**magnus, "linear": False}).y_end,
    )
    for of_y in (
        lf.Field("SO(3)", ["y11", "0", "1"]),
        lf.Field("SO(3)", ["c", "0", "1"], let={"c": "s*y11"}, samples=samples),
    ):
        runs = (
            lambda: lf.solve_ivp(of_y, (0, 1), np.eye(3), **magnus),
            lambda: lf.solve_ivp(of_y, (0, 1), np.eye(3), **space),
            lambda: lf.Integrator(of_y, "magnus4", (0, 1), np.eye(3), dt=0.1, **space),
        )
        for run in runs:
            with pytest.raises(lf.ArgumentError) as caught:
                run()
            assert str(caught.value) == "linear: True, expected False: the formulas of f depend on y"


def test_parts_have_a_field_of_t_alone():
    parts = lf.Parts(R="rotation", x="vector", n="number")
    start = {"R": np.eye(3), "x": [1.0, 0, 0], "n": 0.5}

    def f(t, rate):
        return {"R": [0, 0, rate * t], "x": [0, 0, rate], "n": np.cos(t)}

    space = {"group": parts, "frame": "body", "args": (2.0,)}
    right = lf.solve_ivp(lambda t, y, rate: f(t, rate), (0, 1), start, **space)
    found = lf.solve_ivp(f, (0, 1), start, linear=True, **space)
    run = lf.Integrator(f, None, (0, 1), start, linear=True, **space)
    run.advance_to(1.0)
    for y in (found.y_end, run.y):
        assert all(np.abs(y[name] - right.y_end[name]).max() < 1e-13 for name in y)
    assert found.estimate_error().y["n"] < 1e-10


def test_long_samples_are_printed_in_short():
    t = np.arange(1001.0)
    long = lf.Samples(t, np.sin(t))
    assert len(repr(long)) < 100 and "1001 times from 0.0 to 1000.0" in repr(long)
    short = lf.Samples(t[:5], np.sin(t[:5]))
    assert repr(eval(repr(short), {"lieflow": lf})) == repr(short)


def test_samples_have_the_names_of_a_table():
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"u1": [0.0, 1.0, 2.0], "u2": [1.0, 1.0, 0.0]}, index=[0.0, 1.0, 2.0])
    assert lf.Samples(table.index, table).names == ("u1", "u2")
    assert lf.Samples(table.index, table, names=["a", "b"]).names == ("a", "b")
