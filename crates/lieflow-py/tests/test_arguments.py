"""Which argument is named, in which words, and what is accepted."""

from __future__ import annotations

import pickle
from fractions import Fraction

import numpy as np
import pytest
from conftest import BODY, PARTS, ROTATION, START, turn

import lieflow as lf


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"R": [0, 0], "n": [0, 0]}, r"\['R'\]: shape \(2,\), expected shape \(3,\)"),
        ({"R": [0, 0, 0]}, r"\['n'\]: missing"),
        ({"R": [0, 0, 0], "n": [0, 0], "z": 1}, r"\['z'\]: no part has this name"),
        ({"R": [0, 0, 0], "n": None}, r"\['n'\]: None"),
        ([0, 0, 0], ": a value of type list, expected a dict of R, n"),
    ],
)
def test_a_wrong_value_of_parts_is_a_type_error(value, words):
    with pytest.raises(TypeError, match=r"f at t = 0\.0" + words):
        lf.solve_ivp(lambda t, y: value, (0, 1), START, group=PARTS, frame="body")
    right = {"R": [0, 0, 1.0], "n": [0, 0]}
    kick = lf.Event(lambda t, y: t - 0.5, change=lambda t, y: value if value != [0, 0, 0] else 3)
    with pytest.raises(TypeError, match=r"change of events\[0\] at t = 0\.5"):
        lf.solve_ivp(lambda t, y: right, (0, 1), START, group=PARTS, frame="body", events=kick)


@pytest.mark.parametrize(
    ("y0", "group", "argument"),
    [({**START, "n": [0, np.nan]}, PARTS, "y0['n'][1]"), ({**START, "R": np.full((3, 3), np.nan)}, PARTS, "y0['R'][0, 0]"),
     ([[1, 0], [0, np.nan]], "U(2)", "y0[1, 1]")],
)
def test_a_part_that_is_not_finite_is_named(y0, group, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(turn, (0, 1), y0, group=group, frame="body")
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    ("value", "words"),
    [(["a", "b", "c"], "texts, such as a"), ([1j, 0, 0], "complex numbers"), ([[1], [1, 2]], "rows of different lengths"),
     ([object(), 0, 0], "an array with a value of type object"), ([10**400, 0, 0], "a number beyond the range of float64"),
     ([None, 0, 0], "an array with None")],
)
def test_what_came_is_told(value, words):
    with pytest.raises(TypeError, match=f"f returned {words}.* at t = 0.0, expected 3 numbers"):
        lf.solve_ivp(lambda t, y: value, (0, 1), np.eye(3), **ROTATION)
    with pytest.raises(TypeError, match=f"u: {words}.*expected real numbers"):
        lf.so3.exp(value)


def test_integers_of_any_size_and_fractions_are_numbers():
    assert np.array_equal(lf.so3.hat([10**30, 0, Fraction(1, 2)]), lf.so3.hat([1e30, 0, 0.5]))
    r = lf.solve_ivp(lambda t, y: [Fraction(1, 2), 0, 10**30 - 10**30], (0, 1), np.eye(3), t_eval=[1.0], **ROTATION)
    assert np.abs(r.y[0] - lf.so3.exp([0.5, 0, 0])).max() < 1e-12


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: lf.solve_ivp(turn, (0, 1), np.eye(3), max_step="a", **ROTATION), TypeError, "max_step: 'a'"),
        (lambda: lf.solve_ivp(turn, (0, 1), np.eye(3), steps=10**30, **ROTATION), lf.ArgumentError, "steps: 1000"),
        (lambda: lf.solve_ivp(turn, (0, 1), np.eye(3), max_steps=np.nan, **ROTATION), lf.ArgumentError, "max_steps: nan"),
        (lambda: lf.FreeBodies([1, 2, 2.5], [[1, 0, 0]]).advance("rkmk4 cay", 0.1, np.nan), lf.ArgumentError, "steps: nan"),
        (lambda: lf.FreeBodies([1, 2, 2.5], [[1, 0, 0]]).advance("rkmk4 cay", "a", 1), TypeError, "h: 'a'"),
        (lambda: lf.FreeBodies([1, 2, 2.5], [[1, 0, 0]]).advance("rkmk4 cay", 0.1, 1, -1), lf.ArgumentError, "threads: -1"),
        (lambda: lf.so3.dexpinv([1, 0, 0], [1, 0, 0], q="a"), TypeError, "q: 'a'"),
        (lambda: lf.SO(4).dexpinv(np.zeros((4, 4)), np.zeros((4, 4)), q=-1), lf.ArgumentError, "q: -1"),
        (lambda: lf.SO(-1), lf.ArgumentError, "n: -1, expected an integer ≥ 1"),
        (lambda: lf.SO(3, -1), lf.ArgumentError, "q: -1, expected an integer ≥ 0"),
        (lambda: lf.SO(2.5), TypeError, "n: a value of type float, expected an integer"),
        (lambda: lf.expm(np.eye(2), threads=0), lf.ArgumentError, "threads: 0"),
        (lambda: lf.expm(np.eye(2), threads=-1), lf.ArgumentError, "threads: -1"),
        (lambda: lf.expm(1j * np.eye(2), threads=0), lf.ArgumentError, "threads: 0"),
        (lambda: lf.Event("w1", points=10**12), lf.ArgumentError, "points: 1000000000000, expected an integer from 1 to"),
        (lambda: lf.so3.random("a"), TypeError, "size: 'a'"),
        (lambda: lf.so3.random(-1), lf.ArgumentError, "size: -1"),
        (lambda: lf.CFunction(2**70), lf.ArgumentError, "fun: the address 118"),
        (lambda: lf.solve_ivp(lambda t, y: [[1j]], (0, 1), 1 + 0j, group="U(1)", action="linear"), lf.ArgumentError, "y0: "),
        (lambda: lf.solve_ivp(lambda t, y: 1j, (0, 1), [[1], [1, 2]], group="SU(2)", frame="body"), TypeError, "y0: rows of diff"),
        (lambda: lf.Schrodinger(hamiltonian=[[None, 1j], [-1j, 0]], amplitudes=[1, 0]), TypeError, r"hamiltonian\[0\]\[0\]: a value"),
        (lambda: lf.solve_ivp(lf.Field("SO(3)", [0, None, 0]), (0, 1), np.eye(3), frame="body"), TypeError, r"^field\[1\]: a value"),
        (lambda: lf.Parts(a="numbers ²"), lf.ArgumentError, "a: 'numbers ²', expected"),
    ],
)
def test_an_argument_of_another_kind_is_named(call, error, words):
    with pytest.raises(error, match=words):
        call()


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: lf.solve_ivp(BODY, (0, 1), [1.0, 2.0]), "y0"),
        (lambda: lf.solve_ivp(BODY, (0, 1), [0.0, np.nan, 0.0], quantities="momentum_body"), "y0[1]"),
        (lambda: lf.solve_ivp(turn, (0, 1), np.eye(3), method="cf4", dense_output=True, **ROTATION), "dense_output"),
        (lambda: lf.solve_ivp(lambda t, y: np.eye(2), (0, 1), np.diag([1, 0.0]), group="GL(2)", frame="body"), "y0"),
        (lambda: lf.solve_ivp(lambda t, y: np.zeros((4, 4)), (0, 1), [[1, 0.2], [0.1, 1]], group="Sp(4)", action="lagrangian"), "y0"),
        (lambda: lf.Samples([0.0], np.zeros((1, 3))), "t"),
        (lambda: lf.Samples([0.0, 1.0], [[0, 0, np.nan], [0, 0, 0]]), "values[0, 2]"),
        (lambda: lf.Samples([0.0, 1.0], np.zeros((2, 0))), "values"),
        (lambda: lf.Gm(np.zeros((2, 2))), "M"),
        (lambda: lf.Gm([[1.0, np.nan], [0, 1]]), "M[0, 1]"),
        (lambda: lf.Gm(np.zeros((0, 0))), "M"),
        (lambda: lf.FreeBodies([1, 2, 2.5], np.ones((2, 3)), [np.eye(3), 2 * np.eye(3)]), "attitude[1]"),
        (lambda: lf.FreeBodies([1, 2, -2.5], np.ones((2, 3))), "inertia[2]"),
        (lambda: lf.FreeBodies([1, 2, 2.5], [[0, 0, 0], [0, np.nan, 0]]), "momentum[1, 1]"),
        (lambda: lf.solve_ivp(lf.Field("SO(3)", ["x", 0, 0]), (0, 1), np.eye(3), frame="body"), "field[0]"),
        (lambda: lf.solve_ivp(lf.Field("SO(3)", "x"), (0, 1), np.eye(3), frame="body"), "field"),
        (lambda: lf.solve_ivp(lf.Field("GL(2)", [[0, 0], ["x", 0]]), (0, 1), np.eye(2), frame="body"), "field[1][0]"),
        (lambda: lf.solve_ivp(lf.Field("GL(2)", [0, 0, "x", 0]), (0, 1), np.eye(2), frame="body"), "field[2]"),
        (lambda: lf.solve_ivp(lf.Field(PARTS, {"n": [0, "x"], "R": [0, 0, 0]}), (0, 1), START, frame="body"), "field['n'][1]"),
        (lambda: lf.so3.exp_on([1, 0, 0], [[1, 0, 0], [np.nan, 0, 0]]), "x[1]"),
    ],
)
def test_the_argument_has_its_own_name(call, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        call()
    assert caught.value.argument == argument and str(caught.value).startswith(argument), str(caught.value)


def test_the_advice_on_formulas_is_for_python():
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.Field("SO(3)", ["log(t)", "x", 0]), (0, 1), np.eye(3), frame="body")
    first, [second] = caught.value, caught.value.others
    assert (first.argument, second.argument) == ("field[0]", "field[1]")
    assert "did you mean `ln`" in first.expected and "an entry `x = 0.5` in `parameters`" in second.expected
    for call in (lambda: lf.RigidBody(inertia=[1, 2, "a"], omega_body=[0, 1, 0]), lambda: lf.solve_ivp(BODY, (0, 1), events="w4")):
        with pytest.raises(lf.ArgumentError, match="`parameters`") as caught:
            call()
        assert "problem." not in str(caught.value) and "line" not in str(caught.value)


def test_advice_has_its_own_line():
    with pytest.raises(lf.ArgumentError) as caught:
        lf.RigidBody(inertia=[1, 2, -3], momentum=[1, 2, 3])
    assert caught.value.expected.startswith("did you mean `momentum_body`? (expected one of inertia, ")
    lines = str(caught.value).split("\n")
    assert lines[:2] == ["momentum: unknown key `momentum`", f"  = {caught.value.expected}"]
    [other] = caught.value.others
    assert lines[2:] == [str(other)] and other.argument == "inertia[2]"
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lf.Field("SO(3)", ["log(t)", "x", "t"]), (0, 1), np.eye(3), frame="body")
    first, [second] = caught.value, caught.value.others
    assert "\n  = " in str(first) and str(first).endswith(str(second)) and str(second).endswith(f"\n  = {second.expected}")


@pytest.mark.parametrize("fun", [BODY, turn])
def test_too_many_steps_are_a_mistake_of_steps(fun):
    y0, space = (None, {}) if fun is BODY else (np.eye(3), ROTATION)
    with pytest.raises(lf.ArgumentError, match="expected so few that t \\+ h differs from t") as caught:
        lf.solve_ivp(fun, (0, 1), y0, steps=10**17, **space)
    assert caught.value.argument == "steps" and "1" in caught.value.value
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(fun, (0, 1), y0, dt=1e-17, **space)
    assert caught.value.argument == "dt"


def test_a_change_that_leaves_se3_is_told():
    def rest(t, y):
        return np.zeros(6)

    for wrong, words in ((2 * np.eye(4), "y[3, 3]: 2.0, expected 1"), (np.eye(4) + 0.5 * np.eye(4)[::-1], "y[3, 0]: 0.5, expected 0")):
        event = lf.Event(lambda t, y: t - 1, change=lambda t, y, wrong=wrong: wrong, name="turn")
        with pytest.raises(lf.ArgumentError) as caught:
            lf.solve_ivp(rest, (0, 2), np.eye(4), group="SE(3)", frame="space", events=event)
        text = str(caught.value)
        assert text == f"change of events[0] (turn) at t = 1.0, {words}: the last row of [R x; 0 1] is [0, 0, 0, 1]"
        run = lf.Integrator(rest, None, (0, 2), np.eye(4), group="SE(3)", frame="space")
        with pytest.raises(lf.ArgumentError, match=r"^y\[3, \d\]: .*last row"):
            run.y = wrong
    moved = np.eye(4)
    moved[:3, 3] = 1, 2, 3
    event = lf.Event(lambda t, y: t - 1, change=lambda t, y: moved.tolist())
    r = lf.solve_ivp(rest, (0, 2), np.eye(4), group="SE(3)", frame="space", events=event).check()
    assert np.abs(r.y_end - moved).max() < 1e-15
    with pytest.raises(TypeError, match=r"change of events\[0\].*shape \(4, 4\)"):
        lf.solve_ivp(rest, (0, 2), np.eye(4), group="SE(3)", frame="space", events=lf.Event("t - 1", change=lambda t, y: [0]))


def test_several_mistakes_pickle():
    with pytest.raises(lf.ArgumentError) as caught:
        lf.RigidBody(inertia=[1.0, -2.0, 3.0], omega_bdy=[0.0, 1.0, 0.0])
    copy = pickle.loads(pickle.dumps(caught.value))
    assert str(copy) == str(caught.value) and len(copy.others) == len(caught.value.others) >= 1
    assert [e.argument for e in copy.others] == [e.argument for e in caught.value.others] and copy.expected == caught.value.expected


def test_arguments_as_in_scipy():
    r = lf.solve_ivp(lambda t, y, a: [0, 0, a], (0, 1), np.eye(3), args=[2.0], stops=None, t_eval=[1.0], **ROTATION)
    assert np.abs(r.y[0] - lf.so3.exp([0, 0, 2.0])).max() < 1e-12
    for args in (2.0, "ab", None):
        with pytest.raises(TypeError, match="args"):
            lf.solve_ivp(turn, (0, 1), np.eye(3), args=args, **ROTATION)


def test_rotations_of_scipy_are_accepted(rng):
    transform = pytest.importorskip("scipy.spatial.transform")
    u = rng.standard_normal((2, 3))
    rotation = transform.Rotation.from_rotvec(u)
    assert np.abs(lf.so3.log(rotation) - u).max() < 1e-13
    r = lf.solve_ivp(turn, (0, 1), rotation[0], t_eval=[0.0], **ROTATION)
    assert np.abs(r.y[0] - lf.so3.exp(u[0])).max() < 1e-14
    parts = lf.solve_ivp(lambda t, y: {"R": [0, 0, 1.0], "n": [0, 0]}, (0, 1), {**START, "R": rotation[1]}, group=PARTS, frame="body")
    assert np.abs(parts.R[0] - lf.so3.exp(u[1])).max() < 1e-14
    bodies = lf.FreeBodies([1, 2, 2.5], np.ones((2, 3)), rotation)
    assert np.abs(bodies.attitude - lf.so3.exp(u)).max() < 1e-14
    if hasattr(transform, "RigidTransform"):
        rigid = transform.RigidTransform.from_exp_coords([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
        assert np.abs(lf.se3.log(rigid) - [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]).max() < 1e-13
        motion = lf.solve_ivp(lambda t, y: np.zeros(6), (0, 1), rigid, group="SE(3)", frame="body")
        assert np.abs(motion.y[0] - rigid.as_matrix()).max() < 1e-14


def test_a_field_with_its_group_again():
    name = "".join(["SO", "(3)"])
    field = lf.Field("SO(3)", [0, 0, 1])
    assert lf.solve_ivp(field, (0, 1), np.eye(3), group=name, frame="body").success
    field = lf.Field(lf.SO(4), np.zeros((4, 4)).tolist())
    assert lf.solve_ivp(field, (0, 1), np.eye(4), group=lf.SO(4), frame="body").success
    again = lf.Parts(R="rotation", n="numbers 2")
    field = lf.Field(PARTS, {"R": [0, 0, 1], "n": [0, 0]})
    assert again == PARTS and hash(again) == hash(PARTS) and lf.Parts(n="numbers 2", R="rotation") != PARTS
    assert lf.solve_ivp(field, (0, 1), START, group=again, frame="body").success
    with pytest.raises(lf.ArgumentError, match="its group"):
        lf.solve_ivp(field, (0, 1), START, group=lf.SO(4), frame="body")


def test_a_c_function_is_not_called_as_one_of_python():
    import ctypes

    of_ctypes = ctypes.CDLL(None).abs
    with pytest.raises(TypeError, match=r"fun: .*expected lf\.CFunction\(fun, parameters\)"):
        lf.solve_ivp(of_ctypes, (0, 1), np.eye(3), **ROTATION)
    scipy = pytest.importorskip("scipy")
    double = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(lambda x: x)
    with pytest.raises(TypeError, match=r"fun: .*LowLevelCallable.*lf\.CFunction"):
        lf.solve_ivp(scipy.LowLevelCallable(double), (0, 1), np.eye(3), **ROTATION)


def test_a_quantity_that_was_not_asked_for_is_told():
    for event, error in ((lambda t, y: y.momentum_body[0], AttributeError), (lambda t, y: y["momentum_body"][0], KeyError)):
        with pytest.raises(error, match="no quantity 'momentum_body', expected one of attitude; .*quantities="):
            lf.solve_ivp(BODY, (0, 1), events=event, quantities="attitude")


def test_keys_without_names_are_told_with_the_class():
    for made, first in ((lf.RigidBody, "inertia"), (lf.HeavyTop, "inertia"), (lf.Toda, "positions")):
        with pytest.raises(TypeError, match=rf"^{made.__name__}: an array of int64 without a name, expected keys by name, as {first}=\.\.\.$"):
            made([1, 2, 3])


@pytest.mark.parametrize("call", [lf.so3.exp, lf.so3.hat], ids=["compiled", "numpy"])
def test_what_is_wrong_with_out_is_told(call):
    read_only = np.empty((3, 3))
    read_only.flags.writeable = False
    for out, value in (
        (read_only, "a read-only array"),
        (np.empty((3, 3), order="F"), "an array that is not in C order"),
        (np.empty((6, 3))[::2], "an array that is not in C order"),
        (np.empty((3, 3), np.float32), "an array of float32"),
        (np.empty((2, 3)), r"shape \(2, 3\)"),
        ([1.0], "a value of type list"),
    ):
        with pytest.raises(lf.ArgumentError, match=rf"^out: {value}, expected a writeable array of float64 in C order, shape \(3, 3\)$"):
            call(np.ones(3), out=out)


def test_a_tolerance_that_is_0_is_the_one_that_was_given():
    for options, words in (({"atol": 0}, "^atol: 0, expected a number > 0, or an rtol beside it$"), ({"rtol": 0}, "^rtol: 0, expected > 0")):
        for run in (lf.solve_ivp, lambda f, span, y, **keys: lf.Integrator(f, None, span, y, **keys)):
            with pytest.raises(lf.ArgumentError, match=words):
                run(turn, (0, 1), np.eye(3), **options, **ROTATION)


@pytest.mark.parametrize("fun", [turn, lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.01, 1, 0])], ids=["function", "problem"])
def test_the_estimate_of_an_error_warns_once_and_here(fun):
    system = {"y0": np.eye(3), "method": "rkmk dop853", **ROTATION} if fun is turn else {}
    with pytest.warns(RuntimeWarning, match="zeros of events may be missed"):
        r = lf.solve_ivp(fun, (0, 10), events=lf.Event(lambda t, y: np.sin(500 * t)), **system)
    with pytest.warns(RuntimeWarning, match="zeros of events may be missed") as told:
        r.estimate_error()
    assert [entry.filename for entry in told] == [__file__]


def test_the_attributes_of_an_event_are_checked_when_they_are_set():
    event = lf.Event("y11", terminal=True, direction=-1)
    event.terminal, event.direction, event.points = np.True_, np.float32(1.0), 7
    assert (event.terminal, event.direction, event.points) == (1, 1.0, 7)
    for name, wrong, words in (("direction", None, "direction: None, expected a number"), ("terminal", "yes", "terminal: 'yes'"),
                               ("g", 3, "g: a value of type int"), ("change", 3, "change: a value of type int"),
                               ("name", 3, "name: a value of type int, expected a name")):
        with pytest.raises(TypeError, match=f"^{words}"):
            setattr(event, name, wrong)
        with pytest.raises(TypeError, match=f"^{words}"):
            lf.Event(**{"g": "y11", name: wrong})
    with pytest.raises(lf.ArgumentError, match="^points: 0, expected an integer ≥ 1"):
        event.points = 0
    with pytest.raises(AttributeError):
        event.stops = 1
    assert (event.terminal, event.direction, event.points, event.name) == (1, 1.0, 7, "y11")
    again = pickle.loads(pickle.dumps(event))
    assert repr(again) == repr(event) and again.points == 7


BEYOND = "a number beyond the range of float64"


@pytest.mark.parametrize("number", [10**400, -(10**400), Fraction(10**400)], ids=["large", "negative", "fraction"])
def test_a_number_beyond_the_range_of_an_argument_is_named(number):
    for name, call in {
        "t_span": lambda: lf.solve_ivp(turn, (0, number), np.eye(3), **ROTATION),
        "rtol": lambda: lf.solve_ivp(turn, (0, 1), np.eye(3), rtol=number, **ROTATION),
        "t": lambda: lf.Integrator(turn, None, (0, 1), np.eye(3), **ROTATION).advance_to(number),
        "a": lambda: lf.Field("SO(3)", ["a", "0", "0"], a=number),
    }.items():
        with pytest.raises(TypeError, match=f"^{name}: {BEYOND}, expected "):
            call()
    assert lf.solve_ivp(turn, (0, 10**3 // 10**3), np.eye(3), **ROTATION).success


def test_a_number_beyond_the_range_of_a_key_is_named():
    keys, start = {"inertia": [1, 2, 2.5], "omega_body": [1, 0, 0]}, ((0, 1), np.eye(3))
    for name, call in {
        "inertia[2]": lambda: lf.RigidBody(**{**keys, "inertia": [1, 2, 10**400]}),
        "parameters.a": lambda: lf.RigidBody(**keys, parameters={"a": -(10**400)}),
        "field[1]": lambda: lf.solve_ivp(lf.Field("SO(3)", ["0", 10**400, "0"]), *start, frame="body"),
        "let.c": lambda: lf.solve_ivp(lf.Field("SO(3)", ["c", "0", "0"], let={"c": 10**400}), *start, frame="body"),
    }.items():
        with pytest.raises(lf.ArgumentError) as caught:
            call()
        assert caught.value.argument == name and BEYOND in str(caught.value)


def test_a_wrong_last_row_of_a_motion_is_named():
    pose = np.eye(4)
    pose[3, 1] = 0.5
    last = pose.copy()
    last[3] = [0, 0, 0, 2]
    for g, words in ((pose, "g[3, 1]: 0.5, expected 0"), (np.stack([np.eye(4), pose]), "g[1, 3, 1]: 0.5, expected 0"),
                     (last, "g[3, 3]: 2, expected 1"), (last[None, None], "g[0, 0, 3, 3]: 2, expected 1")):
        with pytest.raises(lf.ArgumentError) as caught:
            lf.se3.log(g)
        assert str(caught.value) == f"{words}: the last row of [R x; 0 1] is [0, 0, 0, 1]"


def test_times_of_samples_are_named():
    with pytest.raises(lf.ArgumentError, match=r"^t\[2\]: 1, expected more than 2, the time before it$"):
        lf.Samples([0, 2, 1], [1, 2, 3])
    samples = lf.Samples([0, 1], [1, 2])
    for t, name in ((1.5, "t"), ([0.5, 1.5], "t[1]"), ([[0.5, 0.5], [1.5, 0.5]], "t[1, 0]"), (-1, "t")):
        with pytest.raises(lf.ArgumentError, match="expected a time within the samples, from 0 to 1") as caught:
            samples(t)
        assert caught.value.argument == name


@pytest.mark.parametrize("group", ["S3", "SU(2)"])
def test_a_rotation_is_a_quaternion_where_points_are(group):
    transform = pytest.importorskip("scipy.spatial.transform")
    start = transform.Rotation.from_rotvec([0.3, -0.2, 0.5])
    q = np.roll(start.as_quat(), 1)
    half = transform.Rotation.from_rotvec([0, 0, np.pi / 2])

    def rate(t, y):
        return [0.1, t, 0.2]

    def run(y0, change):
        event = lf.Event(lambda t, y: t - 0.5, change=change)
        return lf.solve_ivp(rate, (0, 1), y0, group=group, frame="body", events=event)

    of_rotation = run(start, lambda t, y: half)
    assert np.array_equal(of_rotation.y_end, run(q, lambda t, y: np.roll(half.as_quat(), 1)).y_end)
    stepper = lf.Integrator(rate, None, (0, 1), start, group=group, frame="body")
    assert np.array_equal(stepper.y, q)
    stepper.y = half
    assert np.array_equal(stepper.y, np.roll(half.as_quat(), 1))


def test_numbers_of_every_type_are_numbers():
    """Those of NumPy's types, as formulas and as keys of problems."""

    def end(*rates, group="SO(3)"):
        return [lf.solve_ivp(lf.Field(group, rate), (0, 1), np.eye(int(group[3])), frame="body").y_end for rate in rates]

    first, *others = end(["0.5", 0, "1"], [np.float32(0.5), np.int64(0), "1"], np.array([0.5, 0, 1]), np.longdouble([0.5, 0, 1]))
    assert all(np.array_equal(first, other) for other in others)
    m = 0.25 * np.array([[0, 1, 2, 3], [-1, 0, 4, 5], [-2, -4, 0, 6], [-3, -5, -6, 0]])
    first, *others = end(m.tolist(), m, list(m), np.float32(m), group="SO(4)")
    assert all(np.array_equal(first, other) for other in others)

    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.5, 1, 0])
    wide = lf.RigidBody(inertia=np.longdouble([1, 2, 3]), omega_body=[np.longdouble(0.5), np.float16(1), np.uint8(0)])
    assert body == wide and all(type(x) is float for x in wide.keys["inertia"])
    pandas = pytest.importorskip("pandas")
    h = np.array([[0.5, 1j], [-1j, 0.25]])
    state = lf.Schrodinger(hamiltonian=h, amplitudes=[1, 0])
    for same in (h.tolist(), h.astype(np.clongdouble), pandas.DataFrame(h), [list(row) for row in h.astype(np.complex64)]):
        assert lf.Schrodinger(hamiltonian=same, amplitudes=[1, 0]) == state


def masked(x, kind=float):
    array = np.ma.array(x, dtype=kind)
    array[(0,) * array.ndim] = np.ma.masked
    return array


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: lf.so3.exp(masked([1, 2, 3])), "u: "),
        (lambda: lf.expm(masked(np.zeros((2, 2)))), "A: "),
        (lambda: lf.expm(masked(np.zeros((2, 2)), complex)), "A: "),
        (lambda: lf.U(2).exp(masked(np.zeros((2, 2)), complex)), "u: "),
        (lambda: lf.Samples([0, 1], masked([1, 2])), "values: "),
        (lambda: lf.Samples(masked([0, 1]), [1, 2]), "t: "),
        (lambda: lf.solve_ivp(turn, (0, 1), masked(np.eye(3)), **ROTATION), "y0: "),
        (lambda: lf.solve_ivp(lambda t, y: masked([1, 2, 3]), (0, 1), np.eye(3), **ROTATION), "f returned "),
        (lambda: lf.solve_ivp(lambda t, y: masked([[1j]], complex), (0, 1), [[1]], group="U(1)", frame="body"), "f at t = 0.0: "),
        (lambda: lf.RigidBody(inertia=masked([1, 2, 3]), omega_body=[0, 1, 0]), "inertia: "),
        (lambda: lf.Schrodinger(hamiltonian=masked([[0, 1j], [-1j, 0]], complex), amplitudes=[1, 0]), "hamiltonian: "),
        (lambda: lf.solve_ivp(lf.Field("SO(3)", masked([1, 2, 3])), (0, 1), np.eye(3), frame="body"), "field: "),
    ],
)
def test_a_masked_entry_is_refused(call, words):
    with pytest.raises(TypeError, match=f"^{words}an array with a masked entry") as caught:
        call()
    assert "expected" in str(caught.value)


def test_arrays_of_other_classes_are_read():
    x = np.array([0.1, -0.2, 0.3])
    for same in (np.ma.array(x), np.ma.array(x, mask=False), x.view(type("Own", (np.ndarray,), {}))):
        assert np.array_equal(lf.so3.exp(same), lf.so3.exp(x)) and type(lf.so3.exp(same)) is np.ndarray
        run = lf.solve_ivp(lambda t, y: same, (0, 1), np.eye(3), **ROTATION)  # noqa: B023, called here
        assert np.abs(run.y_end - lf.so3.exp(x)).max() < 1e-14


def test_a_callable_that_is_also_an_integer_is_called():
    class Both:
        def __init__(self, f):
            self.f = f

        def __call__(self, *args):
            return self.f(*args)

        def __index__(self):
            return 0

    event = Both(lambda t, y: t - 0.5)
    for fun, y0, options in ((turn, np.eye(3), ROTATION), (Both(turn), np.eye(3), ROTATION), (BODY, None, {})):
        assert np.allclose(lf.solve_ivp(fun, (0, 1), y0, events=event, **options).t_events[0], [0.5])
