"""Every map with every kind of argument: what works, and what is refused in which words."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import lieflow as lf

RNG = np.random.default_rng(11)
U3, V3 = RNG.standard_normal((2, 4, 3))
U6, V6 = RNG.standard_normal((2, 4, 6))
SO4, SP4 = lf.SO(4), lf.Sp(4)
A4, B4 = (SO4.project(0.3 * RNG.standard_normal((4, 4, 4))) for _ in range(2))
C4, D4 = (SP4.project(0.3 * RNG.standard_normal((4, 4, 4))) for _ in range(2))
GOOD = {
    "so3.exp": (lf.so3.exp, (U3,)),
    "so3.cay": (lf.so3.cay, (U3,)),
    "so3.log": (lf.so3.log, (lf.so3.exp(U3),)),
    "so3.cay_inv": (lf.so3.cay_inv, (lf.so3.cay(U3),)),
    "so3.exp_on": (lf.so3.exp_on, (U3, V3)),
    "so3.dexp": (lf.so3.dexp, (U3, V3)),
    "so3.dexpinv": (lf.so3.dexpinv, (U3, V3)),
    "so3.dcay": (lf.so3.dcay, (U3, V3)),
    "so3.dcayinv": (lf.so3.dcayinv, (U3, V3)),
    "so3.ccsk": (lf.so3.ccsk, (U3,)),
    "so3.dccskinv": (lf.so3.dccskinv, (U3 / 2, V3)),
    "so3.pade22": (lf.so3.pade22, (U3,)),
    "so3.dpade22inv": (lf.so3.dpade22inv, (U3, V3)),
    "se3.exp": (lf.se3.exp, (U6,)),
    "se3.cay": (lf.se3.cay, (U6,)),
    "se3.log": (lf.se3.log, (lf.se3.exp(U6),)),
    "se3.dexp": (lf.se3.dexp, (U6, V6)),
    "se3.dexpinv": (lf.se3.dexpinv, (U6, V6)),
    "se3.dcayinv": (lf.se3.dcayinv, (U6, V6)),
    "SO(4).exp": (SO4.exp, (A4,)),
    "SO(4).log": (SO4.log, (SO4.exp(A4),)),
    "SO(4).cay": (SO4.cay, (A4,)),
    "SO(4).cay_inv": (SO4.cay_inv, (SO4.cay(A4),)),
    "SO(4).dexp": (SO4.dexp, (A4, B4)),
    "SO(4).dexpinv": (SO4.dexpinv, (A4, B4)),
    "SO(4).dcay": (SO4.dcay, (A4, B4)),
    "SO(4).dcayinv": (SO4.dcayinv, (A4, B4)),
    "Sp(4).exp": (SP4.exp, (C4,)),
    "Sp(4).dexpinv": (SP4.dexpinv, (C4, D4)),
    "expm": (lf.expm, (A4,)),
}
#: Arguments are elements of a group, or of an algebra of matrices.
ON_GROUP = {"so3.log", "so3.cay_inv", "se3.log", "SO(4).log", "SO(4).cay_inv"}
ALL = pytest.mark.parametrize("name", GOOD)


@ALL
def test_arrays_of_every_layout_work(name):
    f, args = GOOD[name]
    right = f(*args)
    wide = [np.repeat(a, 2, axis=0)[::2] for a in args]
    read_only = [a.copy() for a in args]
    for a in read_only:
        a.flags.writeable = False

    class Sub(np.ndarray):
        pass

    for other in (wide, [np.asfortranarray(a) for a in args], [a[::-1][::-1] for a in args], [a.tolist() for a in args],
                  read_only, [a.view(Sub) for a in args], [a.astype(">f8") for a in args]):
        value = f(*other)
        assert np.array_equal(value, right) and type(value) is np.ndarray
    single = f(*(a[0] for a in args))
    assert np.abs(single - right[0]).max() < 1e-14 and single.shape == right.shape[1:]
    if name not in ON_GROUP:
        assert np.abs(f(*(a.astype(np.float32) for a in args)) - right).max() < 1e-4


def packed(values):
    """The same numbers, not aligned, as in a record after one byte."""
    values = np.asarray(values)
    records = np.zeros(1, dtype=[("flag", "u1"), ("values", values.dtype, values.shape)])
    records["values"] = values
    assert not records[0]["values"].flags.aligned
    return records[0]["values"]


def test_arrays_that_are_not_aligned_work():
    rotation, h = {"group": "SO(3)", "frame": "body"}, np.array([[0.5j, 1.0], [-1.0, 0.25j]])
    rate = packed([0.0, 0.5, 1.0])
    run = lf.solve_ivp(lambda t, y: rate, (0, 1), packed(np.eye(3)), events=lambda t, y: packed([t - 0.5]), **rotation)
    right = lf.solve_ivp(lambda t, y: rate.tolist(), (0, 1), np.eye(3), events=lambda t, y: t - 0.5, **rotation)
    assert np.array_equal(run.y_end, right.y_end) and np.array_equal(run.t_events[0], right.t_events[0])
    unitary = lf.solve_ivp(lambda t, y: packed(h), (0, 1), packed(np.eye(2) + 0j), group="U(2)", frame="body")
    assert np.abs(unitary.y_end - lf.expm(h)).max() < 1e-13
    assert np.array_equal(lf.expm(packed(h)), lf.expm(h)) and np.array_equal(lf.expm(packed(A4)), lf.expm(A4))


@ALL
def test_empty_axes_give_an_empty_result(name):
    f, args = GOOD[name]
    tail = f(*args).shape[1:]
    for lead in ((0,), (3, 0), (0, 2)):
        assert f(*(np.zeros(lead + a.shape[1:]) for a in args)).shape == lead + tail


@ALL
@pytest.mark.parametrize("bad", [1j, None, "text", "ragged", "objects"])
def test_what_is_not_real_is_a_type_error(name, bad):
    f, args = GOOD[name]
    first = {"ragged": [[1.0], [1.0, 2.0]], "objects": np.array([object()] * 3), "text": "text", None: None}.get(bad)
    if bad == 1j:
        first = 1j * args[0]
        if name == "expm":
            assert np.abs(f(first) - lf.expm(first)).max() == 0
            return
    with pytest.raises(TypeError):
        f(first, *args[1:])


@ALL
def test_a_wrong_shape_is_named(name):
    f, args = GOOD[name]
    with pytest.raises(lf.ArgumentError, match="shape") as caught:
        f(args[0][..., :-1], *args[1:])
    assert caught.value.argument and caught.value.value and caught.value.expected
    if len(args) == 2:
        with pytest.raises(lf.ArgumentError):
            f(args[0], args[1][:3])


@ALL
@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_named_by_element(name, wrong):
    f, args = GOOD[name]
    first = args[0].copy()
    first[(2,) + (0,) * (first.ndim - 1)] = wrong
    with pytest.raises(lf.ArgumentError) as caught:
        f(first, *args[1:])
    assert "[2" in caught.value.argument, caught.value.argument


@pytest.mark.parametrize("name", sorted(ON_GROUP))
def test_what_is_not_on_the_group_is_named_by_element(name):
    f, args = GOOD[name]
    first = args[0].copy()
    first[1] *= 2
    with pytest.raises(lf.ArgumentError) as caught:
        f(first)
    assert "[1" in caught.value.argument, caught.value.argument


@pytest.mark.parametrize("name", [n for n in GOOD if n.startswith("SO(4).d") or n in ("SO(4).exp", "SO(4).cay")])
def test_what_is_not_in_the_algebra_is_named(name):
    f, args = GOOD[name]
    first = args[0].copy()
    first[3] += np.eye(4)
    with pytest.raises(lf.ArgumentError) as caught:
        f(first, *args[1:])
    assert "[3" in caught.value.argument or "algebra" in str(caught.value)


@ALL
def test_out_is_filled_or_refused(name):
    f, args = GOOD[name]
    right = f(*args)
    out = np.full(right.shape, 7.0)
    assert f(*args, out=out) is out and np.array_equal(out, right)
    for a in args:  # it may overlap an argument
        if a.size >= right.size and a.shape == right.shape:
            mine = [b.copy() for b in args]
            assert np.array_equal(f(*mine, out=mine[0]), right)
    read_only = np.empty(right.shape)
    read_only.flags.writeable = False
    for bad in (np.empty(right.shape, np.float32), np.empty(right.shape[1:]), np.empty(right.shape, order="F"), read_only, [1.0]):
        with pytest.raises((lf.ArgumentError, TypeError)):
            f(*args, out=bad)
    memory = np.zeros(args[0].size + right.size)
    start = memory[: args[0].size].reshape(args[0].shape)
    start[...] = args[0]
    shifted = memory[1 : 1 + right.size].reshape(right.shape)  # it begins within the argument
    assert np.array_equal(f(start, *args[1:], out=shifted), right)


def test_unknown_names_are_told_once():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0])
    for keys in ({"method": "RK45"}, {"method": "magnus4"}, {"quantities": ["atitude"]}):
        with pytest.raises(lf.ArgumentError) as refused:
            lf.solve_ivp(body, (0, 1), **keys)
        assert "expected unknown" not in str(refused.value)
        assert refused.value.argument == next(iter(keys))


@pytest.mark.parametrize(
    ("options", "argument"),
    [({"rtol": [1e-3] * 3}, "rtol"), ({"atol": np.ones(3) * 1e-6}, "atol"), ({"max_step": [1.0]}, "max_step"),
     ({"t_eval": [1.0, 0.0]}, "t_eval[1]"), ({"t_span": (0, np.inf)}, "t_span")],
)
def test_options_are_named(options, argument):
    options = {"t_span": (0, 1), **options}
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(lambda t, y: 0 * y, y0=[1.0, 0, 0], group="SO(3)", action="linear", **options)
    assert caught.value.argument == argument
    with pytest.raises(TypeError, match="direction: 'up', expected a number"):
        lf.Event("m1", direction="up")


def test_what_would_have_no_effect_is_refused():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0])
    for keys in ({"args": (1.0,)}, {"linear": True}, {"method": ""}):
        with pytest.raises(lf.ArgumentError) as caught:
            lf.solve_ivp(body, (0, 1), **keys)
        assert caught.value.argument == next(iter(keys))
    # Events take them.
    lf.solve_ivp(body, (0, 1), args=(1.0,), events=lambda t, y, a: a + t)
    for keys in ({"args": 1.0}, {"quantities": 3}, {"callback": 3}):
        with pytest.raises(TypeError, match=next(iter(keys))):
            lf.solve_ivp(body, (0, 1), **keys)
    with pytest.raises(TypeError, match="terminal: 'yes'"):
        lf.Event("m1", terminal="yes")
    with pytest.raises(lf.ArgumentError, match="direction: nan"):
        lf.Event("m1", direction=np.nan)
    with pytest.raises(lf.ArgumentError, match="points: 1000000000, expected an integer from 1 to 100000"):
        lf.solve_ivp(body, (0, 1), events=lf.Event("m1", points=10**9))
    assert lf.load("asymmetric-top", set="time.dt=0.01").run().success


def test_settings_of_another_kind_are_refused():
    def run(**keys):
        span = keys.pop("t_span", (0, 1))
        return lf.solve_ivp(lambda t, y: [0, 0, 1.0], span, np.eye(3), group="SO(3)", frame="body", **keys)

    for keys, says in (
        ({"dense_output": "no"}, "dense_output: 'no', expected True or False"),
        ({"linear": "yes"}, "linear: 'yes', expected True or False"),
        ({"method": "rkmk4", "steps": True}, "steps: True, expected a number"),
        ({"t_span": ("0", "1")}, r"t_span: \('0', '1'\), expected two numbers"),
    ):
        with pytest.raises(TypeError, match=says):
            run(**keys)
    for stop in (7, -1e-9, np.nan):
        with pytest.raises(lf.ArgumentError, match=r"stops\[1\]: .*expected a time within \[0.0, 1.0\]"):
            run(stops=[0.5, stop])
    assert run(stops=[0.5], dense_output=np.True_).success
    late = run(t_span=(1e15, 1e15 + 4))
    assert late.status == -1 and "t + h is t after rounding" in late.message
    with pytest.raises(lf.ArgumentError, match="names: 'a' twice"):
        lf.Samples([0.0, 1.0], np.zeros((2, 2)), names=["a", "a"])
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0])
    with pytest.raises(lf.ArgumentError, match=r"y0: shape \(3, 3\), expected a list of the numbers of a state"):
        lf.solve_ivp(body, (0, 1), np.eye(3))
    with pytest.raises(lf.ArgumentError, match="y0: length 2, expected 9"):
        lf.solve_ivp(body, (0, 1), [1, 2.0])
    with pytest.raises(lf.ArgumentError, match="y0: columns that depend on each other"):
        lf.solve_ivp(lambda t, g: np.eye(2), (0, 1), np.diag([1, 0.0]), group="GL(2)", frame="body")


@pytest.mark.parametrize(
    ("group", "says"),
    [("SO(-3)", "unknown|one of"), ("U(n)", "numbers in place"), ("SO(0)", "a size from 1"), ("Sp(3)", "even size")],
)
def test_groups_are_named(group, says):
    with pytest.raises(lf.ArgumentError, match=says) as caught:
        lf.solve_ivp(lambda t, y: 0 * y, (0, 1), np.eye(3), group=group, frame="space")
    assert caught.value.argument == "group" and "expected expected" not in str(caught.value)


def test_times_have_the_name_of_their_argument():
    for t, says in (([0.0, 0.0], r"t\[1\]: 0"), ([0.0], "t: length 1, expected at least 2")):
        with pytest.raises(lf.ArgumentError, match=says):
            lf.Samples(t, np.zeros(len(t)))
    with pytest.raises(lf.ArgumentError, match="interpolation: .*quadratic"):
        lf.Samples([0.0, 1.0], [0.0, 1.0], "quadratic")
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0])
    with pytest.raises(lf.ArgumentError, match=r"t_eval\[1\]: 0\.5"):
        lf.solve_ivp(body, (0, 1), t_eval=[0.5, 0.5])


@pytest.mark.parametrize("number", [5, 0, -1, True, 1.5])
def test_a_number_is_no_field(number):
    space = {"group": "SO(3)", "frame": "body"}
    with pytest.raises(TypeError, match="fun"):
        lf.solve_ivp(number, (0, 1), np.eye(3), **space)
    with pytest.raises(TypeError, match="fun"):
        lf.Integrator(number, None, (0, 1), np.eye(3), **space)


@pytest.mark.parametrize(("group", "y0"), [("SO(4)", np.eye(4)), ("U(2)", np.eye(2)), ("SU(2)", np.eye(2))])
def test_a_value_outside_the_algebra_is_refused_in_both_frames(group, y0):
    for frame in ("space", "body"):
        with pytest.raises(lf.ArgumentError, match="fun"):
            lf.solve_ivp(lambda t, y: np.diag(np.arange(1.0, 1 + len(y0))) + 0 * y, (0, 1), y0, group=group, frame=frame)


def test_the_density_matrix_of_a_state_is_taken():
    rng = np.random.default_rng(3)
    for n in (2, 3, 4):
        for _ in range(20):
            psi = rng.standard_normal(n) + 1j * rng.standard_normal(n)
            psi /= np.linalg.norm(psi)
            lf.DensityMatrix(hamiltonian=np.eye(n), density=np.outer(psi, psi.conj()))
            q = np.linalg.qr(rng.standard_normal((n, n)))[0]
            a = q @ np.diag(np.arange(1.0, n + 1)) @ q.T
            lf.Hill(a=a, q=a, period=1.0)
            lf.Riccati(c=a, b=a, p=a)
    with pytest.raises(lf.ArgumentError, match="antisymmetric"):
        lf.DensityMatrix(hamiltonian=np.eye(2), density=np.array([[0.5, 0.1j], [0.1j, 0.5]]))


@pytest.mark.parametrize("far", [1.0, 3e3, 7e6])
def test_a_rotation_that_is_none_is_refused_beside_a_large_position(far):
    pose = np.eye(4)
    pose[0, 3] = far
    turn = {"group": "SE(3)", "frame": "body"}
    lf.solve_ivp(lambda t, y: [0, 0, 1, 0, 0, 0], (0, 1), pose, **turn)
    for wrong in (2 * np.eye(3), np.zeros((3, 3)), np.diag([1.0, 1, -1])):
        pose[:3, :3] = wrong
        with pytest.raises(ValueError, match="y0"):
            lf.solve_ivp(lambda t, y: [0, 0, 1, 0, 0, 0], (0, 1), pose, **turn)
    parts = lf.Parts(R="rotation", x="numbers 3")
    start = {"R": 2 * np.eye(3), "x": [far, 0, 0]}
    with pytest.raises(ValueError, match="y0"):
        lf.solve_ivp(lambda t, y: {"R": [0, 0, 1.0], "x": [0, 0, 0]}, (0, 1), start, group=parts, frame="body")


def test_a_transposed_pose_is_refused():
    pose = np.eye(4)
    pose[:3, 3] = 1, 2, 3
    def f(t, y):
        return np.zeros(6)

    with pytest.raises(ValueError, match=r"y0\[3, 0\]"):
        lf.solve_ivp(f, (0, 1), pose.T, group="SE(3)", frame="space")
    run = lf.Integrator(f, None, (0, 1), pose, group="SE(3)", frame="space")
    with pytest.raises((ValueError, RuntimeError), match="last row"):
        run.y = pose.T
    assert (run.y == pose).all()


def test_the_error_of_a_first_step_from_rest_is_seen():
    power, rtol = 0.2, 1e-6
    run = lf.solve_ivp(lambda t, y: [0, 0, t**power], (0, 1), np.eye(3), group="SO(3)", frame="space", rtol=rtol, atol=rtol)
    angle = np.arctan2(run.y_end[1, 0], run.y_end[0, 0])
    assert abs(angle - 1 / (power + 1)) < 20 * run.estimate_error().y


def test_constants_of_one_name_are_refused():
    for parameters in ({"J": np.zeros((2, 2)), "J1": [5.0, 6.0]}, {"k": np.arange(12.0), "k1": [1.0, 2.0]}):
        with pytest.raises(lf.ArgumentError, match="twice"):
            lf.solve_ivp(lf.Field("SO(3)", ["0", "0", "1"], **parameters), (0, 1), np.eye(3), frame="space")


def test_entries_of_large_matrices_have_names():
    y = np.eye(11)
    rows = [[f"{0.1 * (j - i)}*J1_11" for j in range(11)] for i in range(11)]
    run = lf.solve_ivp(lf.Field("SO(11)", rows, J=np.ones((11, 11))), (0, 1), y, frame="space", events="y1_11 - 0.5*y11_1")
    assert run.success and np.abs(run.y[-1].T @ run.y[-1] - y).max() < 1e-12
    columns = run.to_dataframe().columns
    assert columns.is_unique and "y1_11" in columns and "y11_1" in columns


def test_the_end_of_a_run_is_not_edited():
    body = lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0.2])
    end = lf.solve_ivp(body, (0, 1)).y_end
    name = next(iter(end))
    with pytest.raises(TypeError, match="y_end"):
        end[name] = np.zeros(3)
    with pytest.raises(ValueError, match="read-only"):
        end[name][...] = 0.0
    again = pickle.loads(pickle.dumps(end))
    assert all((again[name] == end[name]).all() for name in end)
    assert lf.solve_ivp(body, (1, 2), y0=again).success


def test_states_of_two_qubits():
    h = np.diag([1.0, 2.0, 3.0, 4.0]).astype(complex)
    start = np.array([1, 1j, 0, 0]) / np.sqrt(2)
    exact = np.exp(-1j * np.diag(h)) * start
    for group in ("U(4)", lf.U(4)):
        for y0 in (start, list(start)):
            run = lf.solve_ivp(lambda t, y: -1j * h, (0, 1), y0, group=group, action="linear", rtol=1e-10, atol=1e-12)
            assert np.abs(run.y[-1] - exact).max() < 1e-9
    quaternion = lf.solve_ivp(lambda t, y: [0, 0, 1.0], (0, 1), [1, 0, 0, 0], group="SU(2)", frame="space")
    assert quaternion.y.shape[1:] == (4,)


def test_an_event_at_the_start_in_a_short_step():
    turn = lambda t, y: [0, 0, 1.0]
    for t0, step in ((1.7e9, 1e-3), (1.7e9, 1e-5), (1.0, 1e-13)):
        run = lf.solve_ivp(
            turn, (t0, t0 + 1), np.eye(3), group="SO(3)", frame="space", rtol=1e-9, first_step=step,
            events=[lambda t, y: t - t0, lambda t, y: y[1, 0]],
        )
        assert [list(times) for times in run.t_events] == [[t0], [t0]], (t0, step)


def test_names_and_lists_of_numbers_are_read_before_they_are_used():
    body = lf.RigidBody(inertia=[1, 2, 3], momentum_body=[1, 0, 0])
    with pytest.raises(TypeError, match="t0: 'a', expected a number"):
        body.exact([0, 1], t0="a")
    with pytest.raises(TypeError, match="method: a value of type int, expected a name"):
        body.orders(3)
    with pytest.raises(TypeError, match=r"names\[0\]: a value of type int, expected a name"):
        lf.Samples([0, 1], [1, 2], names=[3])
    with pytest.raises(lf.ArgumentError, match=r"stops: shape \(1, 2\), expected a list of numbers"):
        lf.solve_ivp(body, (0, 1), stops=[[0.2, 0.5]])


def test_places_count_from_zero():
    told = {
        "a[1, 0]: expected a symmetric matrix, but a[0, 1] is 2 and a[1, 0] is 3": lambda: lf.Hill(
            a=[[1, 2], [3, 4]], q=[[1, 0], [0, 1]], period=1
        ),
        "field[1, 2]: ": lambda: lf.MatrixOde(group="so", field=[[0, 1, 2], [-1, 0, 3], [-2, 3, 0]]),
        "field[1, 2] is 3 and field[2, 1] is 3, expected field[2, 1] = -field[1, 2]": lambda: lf.MatrixOde(
            group="so", field=[[0, 1, 2], [-1, 0, 3], [-2, 3, 0]]
        ),
        "|s[1]| = 0": lambda: lf.SpinChain(spins=[[1, 0, 0], [0, 0, 0]]),
    }
    for words, make in told.items():
        with pytest.raises(lf.ArgumentError) as caught:
            lf.solve_ivp(make(), (0, 1))
        assert words in str(caught.value), str(caught.value)


def test_a_value_that_is_lost_within_a_run_is_told():
    def turn(t, y):
        return [np.nan if t > 0.5 else 1.0, 0.0, 0.0]

    run = lf.solve_ivp(turn, (0, 1), np.eye(3), group="SO(3)", frame="body")
    assert not run.success and "the right-hand side f is not finite" in run.message, run.message
    field = lf.Field("SO(3)", ["ln(0.5-t)", "0", "0"])
    message = lf.solve_ivp(field, (0, 1), np.eye(3), frame="body").message
    assert "field[0] = ln(0.5-t) is" in message, message
    # Another run of the same field, which ends for another reason, has nothing of the first one.
    message = lf.solve_ivp(field, (0, 0.4), np.eye(3), frame="body", max_steps=1).message
    assert "ln(" not in message, message
    parts = lf.Field(lf.Parts(attitude="rotation", w="numbers 2"), {"attitude": ["0", "sqrt(a)", "0"], "w": ["1", "0"]}, let={"a": "0.5 - t"})
    start = {"attitude": np.eye(3), "w": [0, 0]}
    message = lf.solve_ivp(parts, (0, 1), start, dt=0.1, frame="body").message
    assert "field['attitude'][1] = sqrt(a) is NaN" in message, message


def test_what_stands_for_a_name_or_a_quaternion():
    with pytest.raises(TypeError, match="y: a value of type float, expected a name"):
        lf.Field("SO(3)", ["1", "0", "0"], y=1.0)
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec([0.1, -0.2, 0.3])
    keys = {"inertia": [1, 2, 3], "omega_body": [0.1, 0.2, 0.3]}
    x, y, z, w = turn.as_quat()
    body = lf.RigidBody(**keys, quaternion=turn)
    assert body == lf.RigidBody(**keys, quaternion=[w, x, y, z])
    by_matrix = lf.RigidBody(**keys, attitude=turn)
    ends = [lf.solve_ivp(p, (0, 1), quantities="attitude").y.attitude[-1] for p in (body, by_matrix)]
    assert np.allclose(*ends, atol=1e-6)


def test_a_span_with_too_many_jumps_is_refused():
    magnet = {"kind": "quadrupole", "length": 0.5, "k": 1.0}
    line = lf.BeamLine(elements=[magnet, {"kind": "drift", "length": 1.0}], particle=[1e-3, 0, 0, 0])
    event = lf.Event("x", terminal=1)
    for end, expected in ((1e7, "at most 1000000 times"), (np.inf, "a finite end: f jumps again and again")):
        with pytest.raises(lf.ArgumentError, match=f"t_span: .*{expected}"):
            lf.solve_ivp(line, (0, end), events=event)
    # A pulse is at few times.
    flip = lf.Schrodinger(energies=[0, 0], coupling=[[0, 0.5], [0.5, 0]], pulse=[20, 1], amplitudes=[1, 0])
    run = lf.solve_ivp(flip, (0, np.inf), events=lf.Event("t - 40", terminal=1), quantities=["populations"])
    assert run.success and np.abs(run.populations[-1] - np.sin(0.5 * np.sqrt(np.pi) + [np.pi / 2, 0]) ** 2).max() < 1e-9


@pytest.mark.parametrize(("group", "y0", "arguments", "argument"), [
    ("SO(4)", np.eye(2), {"action": "lagrangian"}, "action"),
    ("SO(3,1)", np.eye(4), {"method": "rkmk4 ccsk", "frame": "space"}, "method"),
])
def test_what_does_not_fit_the_group_has_its_name(group, y0, arguments, argument):
    with pytest.raises(lf.ArgumentError) as refused:
        lf.solve_ivp(lambda t, y: np.zeros((4, 4)), (0, 1), y0, group=group, **arguments)
    assert refused.value.argument == argument and refused.value.expected
    assert "MatrixGroup" not in str(refused.value)
