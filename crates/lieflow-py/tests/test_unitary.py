"""U(n): the maps on complex arrays, and runs with complex y."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from numpy.testing import assert_allclose

import lieflow as lf

N = 3


@pytest.fixture
def pair(rng):
    a = rng.standard_normal((2, 7, N, N)) + 1j * rng.standard_normal((2, 7, N, N))
    return 0.3 * (a - np.swapaxes(a.conj(), -1, -2))


def test_maps_are_those_of_complex_matrices(rng, pair):
    group, (u, v) = lf.U(N), pair
    g = group.exp(u)
    assert g.dtype == np.complex128 and np.abs(g - scipy.linalg.expm(u)).max() < 1e-13
    assert np.abs(group.log(g) - u).max() < 1e-12
    one = np.eye(N)
    assert np.abs(group.cay(u) - np.linalg.solve(one - u / 2, one + u / 2)).max() < 1e-13
    assert np.abs(group.cay_inv(group.cay(u)) - u).max() < 1e-12
    assert np.abs(group.dexpinv(u, group.dexp(u, v)) - v).max() < 1e-13
    assert np.abs(group.dcayinv(u, group.dcay(u, v)) - v).max() < 1e-13
    h = 1e-5
    for psi, dpsi in ((group.exp, group.dexp), (group.cay, group.dcay)):
        slope = (psi(u + h * v) - psi(u - h * v)) / (2 * h) @ np.linalg.inv(psi(u))
        assert np.abs(slope - dpsi(u, v)).max() < 1e-9
    assert np.abs(group.Ad(g, v) - g @ v @ np.linalg.inv(g)).max() < 1e-13
    m = rng.standard_normal((7, N, N)) + 1j * rng.standard_normal((7, N, N))
    pairing = lambda a, b: (a.conj() * b).sum((-1, -2)).real  # noqa: E731
    assert np.abs(pairing(group.coad(u, m), v) - pairing(m, group.ad(u, v))).max() < 1e-12
    x = rng.standard_normal((N, N))
    assert np.abs(group.project(x) + group.project(x).conj().T).max() == 0.0
    out = np.empty((7, N, N), complex)
    assert group.cay(u, out=out) is out and np.array_equal(out, group.cay(u))
    assert group.contains(group.random((4, 2), rng)).all() and group.dim == 9
    assert np.abs(group.log(-np.eye(1) + 0j) if N == 1 else lf.U(1).log([[-1.0]])) == pytest.approx(np.pi)


def test_a_group_is_a_value():
    group = lf.U(4)
    assert pickle.loads(pickle.dumps(group)) == group != lf.U(3)
    assert eval(repr(group), {"lieflow": lf}) == group and group.name == "U(4)" and hash(group) == hash(lf.U(4))


def test_what_is_not_in_it_is_named(pair):
    group, (u, _) = lf.U(N), pair
    bad = u.copy()
    bad[3, 0, 0] = 1.0
    for make, argument in ((lambda: group.exp(bad), "u[3]"), (lambda: group.cay(bad), "u[3]"),
                           (lambda: group.log(bad), "g[0]"), (lambda: group.exp(np.eye(2)), "u"),
                           (lambda: group.cay_inv(-np.eye(3)), "g"), (lambda: lf.U(0), "n"),
                           (lambda: group.exp(np.full((N, N), np.nan)), "u")):
        with pytest.raises(lf.ArgumentError) as caught:
            make()
        assert caught.value.argument == argument
    for wrong in ("text", None, [[1.0], [1.0, 2.0]]):
        with pytest.raises(TypeError, match="^u"):
            group.exp(wrong)
    with pytest.raises(TypeError, match="^n"):
        lf.U(2.5)


SIGMA = np.array([[[0, 1], [1, 0]], [[0, -1j], [1j, 0]], [[1, 0], [0, -1]]])


def hamiltonian(t):
    """Three levels that do not commute at different times."""
    h = np.diag([0.0, 1.0, 2.5]).astype(complex)
    h[0, 1], h[1, 2] = 0.7 * np.exp(1j * t), 0.4 * np.cos(2 * t) * np.exp(-0.3j)
    return h + np.triu(h, 1).conj().T


def exact(y0, right):
    def f(t, y):
        h = -1j * hamiltonian(t)
        y = y.reshape(y0.shape)
        return (h @ y - (y @ h if right else 0)).ravel()

    done = scipy.integrate.solve_ivp(f, (0, 4), y0.astype(complex).ravel(), method="DOP853", rtol=1e-13, atol=1e-14)
    return done.y[:, -1].reshape(y0.shape)


RHO = np.array([[0.5, 0.2j, 0.0], [-0.2j, 0.3, 0.1], [0.0, 0.1, 0.2]])


@pytest.mark.parametrize(
    ("y0", "action", "frame"),
    [(np.eye(3), "translation", "space"), (RHO, "conjugation", None), (np.array([1.0, 0, 0]), "linear", None),
     (np.eye(3)[:, :2], "linear", None)],
)
@pytest.mark.parametrize("group", ["U(3)", "U", lf.U(3)])
def test_a_field_of_t_has_the_solution_of_scipy(y0, action, frame, group):
    right = exact(y0, action == "conjugation")
    for method, linear in ((None, False), ("magnus6", True), ("rkmk dopri5 cay", False)):
        f = (lambda t: -1j * hamiltonian(t)) if linear else (lambda t, y: -1j * hamiltonian(t))
        r = lf.solve_ivp(f, (0, 4), y0, group=group, action=action, frame=frame, linear=linear, method=method,
                         rtol=1e-11, atol=1e-11, t_eval=[0, 2, 4])
        assert r.success and r.y.dtype == np.complex128 and r.y.shape == (3, *y0.shape)
        assert np.abs(r.y[-1] - right).max() < 2e-8 and np.array_equal(r.y[-1], r.y_end)
        if action == "translation":
            assert lf.U(3).contains(r.y).all()
        elif action == "conjugation":
            levels = np.linalg.eigvalsh(r.y)
            assert np.abs(levels - levels[0]).max() < 1e-13


def test_the_body_frame_and_a_field_of_y():
    # ẏ = y f with f = y† g y is ẏ = g y.
    g = lambda t, y: 1j * (hamiltonian(t) + np.diag(np.abs(y[:, 0]) ** 2))  # noqa: E731
    tight = {"group": "U(3)", "rtol": 1e-11, "atol": 1e-11}
    a = lf.solve_ivp(g, (0, 2), np.eye(3), frame="space", **tight)
    b = lf.solve_ivp(lambda t, y: y.conj().T @ g(t, y) @ y, (0, 2), np.eye(3), frame="body", **tight)
    assert np.abs(a.y_end - b.y_end).max() < 1e-8


def test_rabi_flips_with_events_sol_and_a_change():
    omega = 1.3
    kept = {"group": "U(2)", "action": "linear", "rtol": 1e-11, "atol": 1e-11}
    field = lambda t, y: -0.5j * omega * SIGMA[0]  # noqa: E731
    half = lambda t, y: abs(y[1]) ** 2 - 0.5  # noqa: E731
    r = lf.solve_ivp(field, (0, 9), [1, 0], events=lf.Event(half), dense_output=True, **kept)
    times = np.arange(1, 8, 2) * np.pi / (2 * omega)
    assert len(r.t_events[0]) == 4 and np.abs(r.t_events[0] - times).max() < 1e-10
    assert np.abs(r.y_events[0][:, 1] ** 2 + 0.5).max() < 1e-10
    t = np.linspace(0, 9, 50)
    right = np.stack([np.cos(omega * t / 2), -1j * np.sin(omega * t / 2)], axis=1)
    again = pickle.loads(pickle.dumps(r.sol))
    assert np.abs(r.sol(t) - right).max() < 1e-9 and np.array_equal(again(t), r.sol(t))
    assert r.estimate_error().y < 1e-9
    frame = r.to_dataframe()
    assert list(frame.columns) == ["re1", "re2", "im1", "im2"]
    assert np.array_equal(frame.to_numpy(), np.hstack([r.y.real, r.y.imag]))
    # A measurement: after the first flip the level is 1 again.
    seen = []
    change = lf.Event(half, change=lambda t, y: np.array([1.0, 0.0]), direction=1)
    r = lf.solve_ivp(field, (0, 9), [1, 0], events=change, callback=lambda t, y: seen.append(y), **kept)
    assert np.abs(r.t_events[0] - times[0] * np.arange(1, len(r.t_events[0]) + 1)).max() < 1e-9
    assert seen[0].dtype == np.complex128 and seen[0].shape == (2,)
    run = lf.Integrator(field, None, (0, 9), [1, 0], **kept)
    run.advance_to(2.0)
    assert np.abs(run.y - [np.cos(omega), -1j * np.sin(omega)]).max() < 1e-9
    run.y = [0, 1j]
    assert np.array_equal(run.y, [0, 1j])


def test_su2_has_quaternions_and_complex_matrices():
    q = lf.solve_ivp(lambda t, q: [0.1, 0.2, t], (0, 3), [1, 0, 0, 0], group="SU(2)", frame="space", rtol=1e-12, atol=1e-12)
    m = lf.solve_ivp(lambda t, m: -0.5j * np.einsum("i,ijk", [0.1, 0.2, t], SIGMA), (0, 3), np.eye(2), group="SU(2)",
                     frame="space", rtol=1e-12, atol=1e-12)
    w, x, y, z = q.y_end
    assert np.abs(m.y_end - (w * np.eye(2) - 1j * (x * SIGMA[0] + y * SIGMA[1] + z * SIGMA[2]))).max() < 1e-11


@pytest.mark.parametrize(
    ("change", "argument"),
    [({"y0": np.eye(2)}, "y0"), ({"y0": 2 * np.eye(3)}, "y0"), ({"frame": None}, "frame"),
     ({"events": "abs(y11)"}, "events[0]"), ({"action": "lagrangian", "frame": None}, "action"),
     ({"fun": lf.Field("U(3)", ["1"] * 9), "group": None}, "fun")],
)
def test_bad_input_is_named(change, argument):
    given = {"fun": lambda t, y: -1j * hamiltonian(t), "t_span": (0, 1), "y0": np.eye(3), "group": "U(3)", "frame": "space"}
    with pytest.raises(lf.ArgumentError) as caught:
        lf.solve_ivp(**{**given, **change})
    assert caught.value.argument == argument, str(caught.value)


def test_wrong_values_of_f_are_named():
    for value in (np.eye(2), None, "text"):
        with pytest.raises(TypeError, match="f at t = 0"):
            lf.solve_ivp(lambda t, y: value, (0, 1), np.eye(3), group="U(3)", frame="space")
    r = lf.solve_ivp(lambda t, y: np.full((3, 3), np.nan), (0, 1), np.eye(3), group="U(3)", frame="space")
    assert r.status == -1


TURN = np.array([[0.2j, -0.65j + 0.1], [-0.65j - 0.1, -0.3j]])
STARTS = {"translation": np.array([[0, 1j], [1, 0]]), "linear": np.array([[0.6], [0.8j]]),
          "conjugation": np.array([[0.5, 0.2j], [-0.2j, 0.3]])}


@pytest.mark.parametrize("action", list(STARTS))
def test_a_problem_by_name_is_the_field(action):
    y0, tight = STARTS[action], {"rtol": 1e-11, "atol": 1e-11, "method": "rkmk dop853 exp"}
    problem = lf.MatrixOde(group="U(2)", action=action, field=TURN, start=y0)
    assert eval(repr(problem), {"lieflow": lf}) == problem == pickle.loads(pickle.dumps(problem))
    frame = "space" if action == "translation" else None
    g = lambda t, y: abs(y[0, 0]) ** 2 - 0.2  # noqa: E731
    field = lf.solve_ivp(lambda t, y: TURN, (0, 4), y0, group="U(2)", action=action, frame=frame, events=g,
                         dense_output=True, **tight)
    named = lf.solve_ivp(problem, (0, 4), events=lambda t, y: g(t, y.point), dense_output=True, quantities="point", **tight)
    assert named.point.dtype == np.complex128 and named.point.shape == (len(named.t), *y0.shape)
    assert np.abs(named.y["point"][-1] - field.y_end).max() < 1e-11
    assert len(field.t_events[0]) > 0 and np.abs(named.t_events[0] - field.t_events[0]).max() < 1e-10
    assert np.abs(named.y_events[0].point - field.y_events[0]).max() < 1e-10
    t = np.linspace(0, 4, 9)
    again = pickle.loads(pickle.dumps(named))
    assert np.abs(named.sol(t).point - field.sol(t)).max() < 1e-10
    assert np.array_equal(again.sol(t).point, named.sol(t).point) and np.array_equal(again.point, named.point)
    assert all(drift < 1e-13 for drift in named.drift.values()) and named.drift
    assert named.estimate_error().y["point"] < 1e-8
    frame = named.to_dataframe()
    assert list(frame.columns) == list(problem.columns("point"))
    flat = named.point.reshape(len(t := named.t), -1)
    assert np.array_equal(frame.to_numpy(), np.hstack([flat.real, flat.imag]))
    # Another start by its complex array: of a run, of an integrator, after an event.
    other = 1j * y0 if action != "conjugation" else y0.conj()
    right = lf.solve_ivp(problem.replace(start=other), (0, 4), t_eval=[4.0], **tight).point
    assert np.array_equal(lf.solve_ivp(problem, (0, 4), other, t_eval=[4.0], **tight).point, right)
    run = lf.Integrator(problem, tight["method"], (0, 4), other, rtol=1e-11, atol=1e-11)
    run.advance_to(4.0)
    assert np.abs(run.y.point - right[0]).max() < 1e-9
    seen = []
    set_other = lf.Event(lambda t, y: t - 1.0, change=lambda t, y: seen.append(y) or other)
    moved = lf.solve_ivp(problem, (0, 5), events=set_other, t_eval=[1.0, 5.0], **tight)
    assert np.abs(seen[0] - field.sol(1.0)).max() < 1e-10 and np.abs(moved.point[-1] - right[0]).max() < 1e-9


def test_states_of_quantum_systems_and_fluids_are_complex():
    h = np.array([[0.3, 0.4 - 0.2j, 0.1j], [0.4 + 0.2j, -0.5, 0.2], [-0.1j, 0.2, 1.0]])
    psi = np.array([0.6, 0.8j, 0.0])
    move = scipy.linalg.expm(-2j * h)
    state = lf.Schrodinger(hamiltonian=h, amplitudes=psi)
    r = lf.solve_ivp(state, (0, 2), t_eval=[0, 2])
    assert r.amplitudes.shape == (2, 3) and np.abs(r.amplitudes - [psi, move @ psi]).max() < 1e-10
    assert np.abs(lf.solve_ivp(state, (0, 2), psi.conj(), t_eval=[2]).amplitudes - move @ psi.conj()).max() < 1e-10
    rho = np.outer(psi, psi.conj()) * 0.5 + np.diag([0.1, 0.1, 0.3])
    for keys in ({"density": rho}, {"amplitudes": psi}):
        start = rho if "density" in keys else np.outer(psi, psi.conj())
        mixed = lf.DensityMatrix(hamiltonian=h, **keys)
        r = lf.solve_ivp(mixed, (0, 2), t_eval=[0, 2])
        assert r.density.shape == (2, 3, 3)
        assert np.abs(r.density - [start, move @ start @ move.conj().T]).max() < 1e-10
    other = move @ rho @ move.conj().T
    assert np.abs(lf.solve_ivp(mixed, (0, 2), other, t_eval=[0]).density - other).max() < 1e-14
    fluid = lf.Fluid(surface="sphere", n=6, random={"seed": 1, "below": 4})
    r = lf.solve_ivp(fluid, (0, 1), t_eval=[0, 1], quantities=["matrix", "levels"])
    w = r.matrix
    assert w.shape == (2, 6, 6) and np.abs(w).max() > 0.1 and np.array_equal(w, -w.conj().swapaxes(1, 2))
    assert np.abs(w[0] - w[1]).max() > 1e-3
    assert np.abs(np.diff(np.linalg.eigvalsh(-1j * w), axis=0)).max() < 1e-12
    assert np.array_equal(lf.solve_ivp(fluid, (0, 1), w[1], t_eval=[0], quantities="matrix").matrix[0], w[1])
    seen = []
    turned = lf.Event(lambda t, y: t - 0.5, change=lambda t, state: seen.append(state) or state.conj().T)
    r = lf.solve_ivp(fluid, (0, 1), events=turned, t_eval=[0.5, 1], quantities="matrix")
    assert np.array_equal(seen[0], r.y_events[0].matrix[0])
    back = lf.solve_ivp(fluid, (0.5, 1), -seen[0], t_eval=[1], quantities="matrix")
    assert np.abs(r.matrix[-1] - back.matrix[0]).max() < 1e-11


@pytest.mark.parametrize(
    ("wrong", "argument"),
    [(lambda p: lf.solve_ivp(p, (0, 1), np.eye(3) + 0j), "y0"), (lambda p: p.replace(start=2 * np.eye(2)), "start"),
     (lambda p: p.replace(start=2j * np.eye(2)), "start"), (lambda p: lf.solve_ivp(p, (0, 1), 2j * np.eye(2)), "y0"),
     (lambda p: lf.solve_ivp(p.replace(field=[[1, 0], [0, 0]]), (0, 1)), "field[0, 0]"),
     (lambda p: lf.solve_ivp(lambda t, y: TURN, (0, 1), 2 * np.eye(2), group="U(2)", frame="space"), "y0"),
     (lambda p: lf.solve_ivp(lambda t, y: np.eye(2), (0, 1), np.eye(2), group="U(2)", frame="space"), "fun"),
     (lambda p: lf.MatrixOde(group="U(2)", field=TURN, start=1j * np.eye(2), start_imaginary=np.eye(2)), "start_imaginary")],
)
def test_messages_name_u_n(wrong, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        wrong(lf.MatrixOde(group="U(2)", field=TURN))
    assert caught.value.argument == argument and "SO(4)" not in str(caught.value), str(caught.value)


def test_another_value_of_a_complex_key_is_both_parts():
    levels = lf.Schrodinger(hamiltonian=[[0, 1j], [-1j, 0]], amplitudes=[1, 1j])
    still = levels.replace(hamiltonian=[[0, 0], [0, 0]], amplitudes=[1, 0])
    assert np.array_equal(lf.solve_ivp(still, (0, 1), t_eval=[1.0]).amplitudes, [[1, 0]])
    mixed = lf.DensityMatrix(hamiltonian=[[1, 0], [0, 0]], density=[[0.7, 0.2 - 0.1j], [0.2 + 0.1j, 0.3]])
    pure = mixed.replace(density=[[1, 0], [0, 0]])
    assert np.allclose(lf.solve_ivp(pure, (0, 1), t_eval=[1.0]).density, [[[1, 0], [0, 0]]])
    assert "density" not in mixed.replace(density=None, amplitudes=[1, 1j]).keys


@pytest.mark.parametrize(
    ("group", "y0", "det"),
    [("SL(2)", 2 * np.eye(2), "4, expected 1, as in SL"),
     ("SU(3)", 1j * np.eye(3), r"0 - 1i, expected 1, as in SU"),
     ("SO(4)", np.diag([1.0, 1, 1, -1]), "−1")],
)
def test_a_start_of_another_determinant_is_refused(group, y0, det):
    with pytest.raises(lf.ArgumentError, match=f"y0: .*determinant .*{det}") as caught:
        lf.solve_ivp(lambda t, y: 0 * y, (0, 1), y0, group=group, frame="space")
    assert caught.value.argument == "y0"
    still = lf.MatrixOde(group=group, field=np.zeros(y0.shape).tolist())
    with pytest.raises(lf.ArgumentError, match=f"y0: .*determinant .*{det}"):
        lf.solve_ivp(still, (0, 1), y0 if np.iscomplexobj(y0) else y0.ravel())


def test_shapes_are_those_of_the_user():
    with pytest.raises(lf.ArgumentError, match=r"y0: shape \(3,\), expected shape \(2, 2\)"):
        lf.solve_ivp(lambda t, y: 0 * y, (0, 1), [1j, 0, 0], group="U(2)", frame="space")


@pytest.mark.parametrize("group", ["SL(2)", "SU(3)"])
@pytest.mark.parametrize("frame", ["space", "body"])
def test_a_field_with_a_trace_is_refused(group, frame):
    one = np.eye(2) if group == "SL(2)" else np.eye(3, dtype=complex)
    with pytest.raises(lf.ArgumentError, match="trace") as caught:
        lf.solve_ivp(lambda t, y: one if group == "SL(2)" else 1j * one, (0, 1), one, group=group, frame=frame)
    assert caught.value.argument == "fun"
    inside = np.diag([1.0, -1.0]) if group == "SL(2)" else 1j * np.diag([1.0, 1.0, -2.0])
    r = lf.solve_ivp(lambda t, y: inside, (0, 1), one, group=group, frame=frame, t_eval=[1.0])
    assert abs(np.linalg.det(r.y[0]) - 1) < 1e-13


def test_formulas_are_events_of_complex_numbers():
    h = np.array([[1.0, 0.5 - 0.3j], [0.5 + 0.3j, -1.0]])
    for group in ("U(2)", lf.U(2)):
        texts = ["re21", "re11^2 + im11^2 - 0.95", lf.Event("im12 - 0.2", terminal=3)]
        calls = [lambda t, y: y[1, 0].real, lambda t, y: abs(y[0, 0]) ** 2 - 0.95,
                 lf.Event(lambda t, y: y[0, 1].imag - 0.2, terminal=3)]
        settings = dict(group=group, frame="space", rtol=1e-10, atol=1e-10)
        by_text, by_call = (lf.solve_ivp(lambda t, y: -1j * h, (0, 9), np.eye(2), events=e, **settings) for e in (texts, calls))
        assert by_text.status == 1 and min(map(len, by_text.t_events)) >= 3
        for one, two in zip(by_text.t_events, by_call.t_events):
            assert np.abs(one - two).max() < 1e-12
    vector = dict(group="U(2)", action="linear", frame=None)
    psi = lf.solve_ivp(lambda t, y: -1j * h, (0, 9), [1.0, 0.0], events="re1^2 + im1^2 - 0.95", **vector)
    assert np.abs(np.abs(psi.y_events[0][:, 0]) ** 2 - 0.95).max() < 1e-12 and len(psi.t_events[0]) >= 3
    with pytest.raises(lf.ArgumentError, match=r"events\[0\].*`y11`"):
        lf.solve_ivp(lambda t, y: -1j * h, (0, 9), np.eye(2), events="y11", group="U(2)", frame="space")


def test_complex_numbers_lie_in_memory_as_pairs():
    import ctypes

    def f(t, y):
        a, b = y[0, 1].imag, y[1, 0].real
        return np.array([[1j * a, 0.3 + 1j * b], [-0.3 + 1j * b, 0.2j]])

    numbers = ctypes.POINTER(ctypes.c_double)

    @ctypes.CFUNCTYPE(None, ctypes.c_double, numbers, numbers, numbers)
    def of_c(t, y, v, p):
        a, b = y[3], y[4]
        for i, x in enumerate([0, a, 0.3, b, -0.3, b, 0, 0.2]):
            v[i] = x

    y0 = lf.U(2).random(rng=1)
    runs = [lf.solve_ivp(fun, (0, 2), y0, group="U(2)", frame="space", steps=20) for fun in (f, lf.CFunction(of_c))]
    assert np.abs(runs[0].y_end - runs[1].y_end).max() < 1e-14 < np.abs(runs[0].y_end - y0).max()


@pytest.mark.parametrize(("group", "leaves"), [("SL(2)", False), ("SL(3)", True), ("SU(2)", False), ("SU(3)", True), ("SO(3)", False)])
def test_which_maps_leave_the_determinant(group, leaves):
    n = int(group[3])
    a = np.array([[0.3, 0.2, 0.5], [0.1, -0.2, 0.4], [0.3, 0.9, -0.1]])[:n, :n]
    a = a + 0.3j * (a + a.T) if group[:2] == "SU" else a
    a = a - a.conj().T if group[:2] != "SL" else a
    a = a - np.trace(a) / n * np.eye(n)
    value = lf.so3.vee(a) if group == "SO(3)" else a
    for name in ("exp", "cay", "pade22"):
        r = lf.solve_ivp(lambda t, y: value * (1 + t), (0, 1), np.eye(n), group=group, frame="space", method=f"rkmk4 {name}", steps=4)
        off = abs(np.linalg.det(r.y_end) - 1)
        assert off > 1e-10 if leaves and name != "exp" else off < 1e-14


def test_matrices_in_single_precision_are_taken(pair):
    group, u = lf.U(N), pair[0]
    g = group.exp(u).astype(np.complex64)
    assert group.defect(g).max() > 1e-10
    for single, right in ((group.log(g), u), (group.cay(group.cay_inv(g)), g), (group.Ad(g, u), u)):
        assert np.abs(single - right).max() < 1e-5
    skew = u + 1e-8 * np.ones((N, N))
    assert np.abs(group.exp(skew) - group.exp(u)).max() < 1e-7
    # The distance is relative, as in Group: ‖g†g − 1‖ = 0.21 √3 by ‖g‖² = 3.63.
    for call, words in (
        (lambda: group.log(1.1 * group.exp(u)[0]),
         "g: a matrix at a relative distance of 1.0e-01 from U(3), expected a unitary matrix to 1e-06"),
        (lambda: group.exp(u + 1e-3 * np.eye(N)), "u[0]: a matrix at a relative distance of "),
        (lambda: lf.SO(3).Ad(1.1 * np.eye(3), np.zeros((3, 3))), "g: a matrix at a relative distance of 1.0e-01 from SO(3), "),
    ):
        with pytest.raises(lf.ArgumentError) as caught:
            call()
        assert str(caught.value).startswith(words), str(caught.value)


def test_maps_of_u_n_do_not_depend_on_a_phase(rng):
    """u + i·phase·1 has the dexp⁻¹ of u: the singular set is that of u(n), not that of so(2n)."""
    n, group = 3, lf.U(3)
    u, v = (group.project(rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n))) for _ in range(2))
    expected = group.dexpinv(u, v)
    for phase in [np.pi - np.linalg.eigvals(u).imag[0], np.pi, 2 * np.pi, 30.0]:
        assert_allclose(group.dexpinv(u + 1j * phase * np.eye(n), v), expected, rtol=0, atol=1e-12)
    start, settings = np.eye(2, dtype=complex), {"group": "U(2)", "frame": "space", "steps": 8, "method": "rkmk4 exp"}
    field = lambda t, y: 0.3j * np.array([[np.sin(t), 1.0], [1.0, -t]])  # noqa: E731
    plain = lf.solve_ivp(field, (0, 4), start, **settings)
    for energy in [np.pi, 2 * np.pi]:
        turned = lf.solve_ivp(lambda t, y: field(t, y) + 1j * energy * np.eye(2), (0, 4), start, **settings)  # noqa: B023
        assert_allclose(turned.y_end, plain.y_end * np.exp(4j * energy), rtol=0, atol=1e-12)


@pytest.mark.parametrize("d", [1e-3, 1e-6, 1e-9, 1e-13, 0.0])
def test_log_of_u_n_beside_a_half_turn(rng, d):
    q = lf.U(3).random(rng=rng)
    angles = np.array([np.pi - d, np.pi - 2 * d, 1.0])
    u = lf.U(3).log(q @ np.diag(np.exp(1j * angles)) @ q.conj().T)
    found = np.sort(np.linalg.eigvals(u).imag)
    assert_allclose(np.abs(found), np.sort(np.abs(angles)), rtol=0, atol=1e-13)
    assert_allclose(lf.U(3).exp(u), q @ np.diag(np.exp(1j * angles)) @ q.conj().T, rtol=0, atol=1e-13)


def test_every_minus_one_has_a_logarithm():
    for n in (1, 2, 3, 4):
        assert_allclose(np.abs(np.linalg.eigvals(lf.U(n).log(-np.eye(n)))), np.pi, rtol=1e-14)
        with pytest.raises(lf.ArgumentError, match="an eigenvalue −1") as refused:
            lf.U(n).cay_inv(-np.eye(n))
        assert refused.value.argument == "g"


def test_a_forgotten_minus_i_is_told():
    h = np.array([[1.0, 0.3], [0.3, -1.0]], complex)
    with pytest.raises(lf.ArgumentError, match="expected a skew-Hermitian matrix, −iH of a Hermitian H"):
        lf.solve_ivp(lambda t, y: h, (0, 1), np.eye(2, dtype=complex), group="U(2)", frame="space")
