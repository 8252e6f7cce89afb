"""Maps on arrays: what they refuse, their ``out``, and maps beyond exp."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import scipy.linalg
from conftest import interrupted, turns_during

import lieflow as lf

A4 = np.triu(np.arange(16.0).reshape(4, 4) / 20, 1)
A4 = A4 - A4.T
C2 = np.array([[0.3j, 0.2 + 0.1j], [-0.2 + 0.1j, -0.4j]])
NAN3, NAN6, NAN44 = np.full(3, np.nan), np.full(6, np.nan), np.full((4, 4), np.nan)


@pytest.mark.parametrize("number", [1.0, 1.0 + 0.0j, 1j])
@pytest.mark.parametrize("lead", [(), (9,), (2, 3)])
def test_a_matrix_that_is_not_skew_is_refused(rng, number, lead):
    a = number * rng.standard_normal((*lead, 5, 5))
    a = a - np.swapaxes(a.conj(), -1, -2)
    assert np.abs(lf.expm(a, structure="skew") - scipy.linalg.expm(a)).max() < 1e-12
    last = tuple(n - 1 for n in lead)
    a[(*last, 0, 0)] += 1.0
    with pytest.raises(lf.ArgumentError, match="expected a skew matrix") as caught:
        lf.expm(a, structure="skew")
    assert caught.value.argument == (f"A[{', '.join(map(str, last))}]" if lead else "A")
    assert np.array_equal(lf.expm(1e-200 * (a - np.swapaxes(a.conj(), -1, -2)), structure="skew")[..., 0, 0].real, np.ones(lead))


@pytest.mark.parametrize("kind", [float, complex])
def test_expm_names_the_matrix_and_divides_among_threads(rng, kind):
    a = rng.standard_normal((3, 100, 4, 4)).astype(kind)
    assert np.array_equal(lf.expm(a, threads=3), lf.expm(a))
    a[2, 7, 1, 1] = np.nan
    with pytest.raises(lf.ArgumentError) as caught:
        lf.expm(a, threads=2)
    assert caught.value.argument == "A[2, 7]"


def test_complex_expm_releases_the_interpreter(rng):
    a = rng.standard_normal((4000, 24, 24)) * 1j
    assert turns_during(lf.expm, a) > 20


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: lf.so3.dexpinv(NAN3, [1, 0, 0], q=2), "u"),
        (lambda: lf.so3.dexpinv([[1, 0, 0]] * 2, [[0, 0, 0], NAN3], q=2), "v[1]"),
        (lambda: lf.so3.hat(NAN3), "u"),
        (lambda: lf.so3.Ad(np.eye(3), NAN3), "u"),
        (lambda: lf.so3.Ad(np.stack([np.eye(3), 2 * np.eye(3)]), [1.0, 0, 0]), "r[1]"),
        (lambda: lf.so3.ad(NAN3, [1, 0, 0]), "u"),
        (lambda: lf.so3.coad([1, 0, 0], NAN3), "m"),
        (lambda: lf.so3.vee(np.ones((3, 3))), "m"),
        (lambda: lf.so3.project(np.full((3, 3), np.inf)), "x"),
        (lambda: lf.so3.from_quaternion([np.nan, 0, 0, 1], scalar_first=True), "q"),
        (lambda: lf.se3.hat(NAN6), "u"),
        (lambda: lf.se3.vee(np.eye(4)), "m"),
        (lambda: lf.se3.Ad(2 * np.eye(4), np.ones(6)), "g"),
        (lambda: lf.se3.ad(np.ones(6), NAN6), "v"),
        (lambda: lf.se3.project(NAN44), "x"),
        (lambda: lf.SO(4).project(NAN44), "x"),
        (lambda: lf.SO(4).Ad(np.ones((4, 4)), np.zeros((4, 4))), "g"),
        (lambda: lf.GL(4).Ad(np.ones((4, 4)), np.zeros((4, 4))), "g"),
        (lambda: lf.SO(4).Ad(np.eye(4), np.ones((4, 4))), "u"),
        (lambda: lf.SO(4).ad(np.zeros((4, 4)), np.ones((4, 4))), "v"),
        (lambda: lf.SO(4).coad(A4, NAN44), "m"),
        (lambda: lf.U(2).project(np.full((2, 2), np.nan)), "x"),
        (lambda: lf.U(2).Ad(np.ones((2, 2)), C2), "g"),
        (lambda: lf.U(2).ad(C2, np.ones((2, 2))), "v"),
        (lambda: lf.so3.dexp(np.ones((2, 3)), [[1, 0, 0], NAN3]), "v[1]"),
        (lambda: lf.so3.dexp(np.ones((2, 3)), NAN3), "v"),
        (lambda: lf.so3.exp_on([NAN3, NAN3], np.ones((2, 3))), "u[0]"),
        (lambda: lf.se3.dexpinv(np.ones((2, 6)), [np.ones(6), NAN6]), "v[1]"),
        (lambda: lf.SO(4).dexp(A4, NAN44), "v"),
        (lambda: lf.SO(4).dexp(np.stack([A4, A4]), np.stack([A4, A4 + 1])), "v[1]"),
    ],
)
def test_what_no_map_can_use_is_named(call, argument):
    with pytest.raises(lf.ArgumentError) as caught:
        call()
    assert caught.value.argument == argument, str(caught.value)


def test_contains_answers_for_every_matrix():
    for group, n in ((lf.so3, 3), (lf.se3, 4), (lf.SO(4), 4), (lf.GL(2), 2), (lf.SL(2), 2), (lf.U(2), 2)):
        answer = group.contains(np.stack([np.eye(n), np.full((n, n), np.nan), np.zeros((n, n))]))
        assert answer.tolist() == [True, False, False]
    assert lf.SL(2).contains(np.diag([2.0, 0.5])) and not lf.SL(2).contains(np.diag([2.0, 1.0]))


def test_brackets_of_elements_that_commute_are_in_the_algebra(rng):
    for group in (lf.SO(5), lf.Gm(np.diag([1.0, 2.0, -3.0])), lf.Sp(4), lf.U(4)):
        n = group.n
        u = group.project(rng.standard_normal((n, n)))
        bracket = group.ad(u, 0.3 * u + 0.7 * u @ u @ u if group.name != "Sp(4)" else 0.3 * u)
        assert np.abs(bracket).max() < 1e-12
        group.ad(u, bracket)


MAPS = {
    "so3.Ad": (lf.so3.Ad, (lf.so3.exp([[1.0, 2, 3]] * 2), np.ones((2, 3)))),
    "so3.ad": (lf.so3.ad, (np.eye(3)[:2], np.ones((2, 3)))),
    "so3.coad": (lf.so3.coad, (np.eye(3)[:2], np.ones((2, 3)))),
    "so3.hat": (lf.so3.hat, (np.ones((2, 3)),)),
    "so3.vee": (lf.so3.vee, (lf.so3.hat(np.ones((2, 3))),)),
    "so3.project": (lf.so3.project, (np.eye(3) + 0.1 * np.ones((2, 3, 3)),)),
    "so3.as_quaternion": (lambda *a, **k: lf.so3.as_quaternion(*a, scalar_first=True, **k), (lf.so3.exp(np.ones((2, 3))),)),
    "so3.from_quaternion": (lambda *a, **k: lf.so3.from_quaternion(*a, scalar_first=True, **k), (np.eye(4)[:2],)),
    "so3.dexpinv": (lambda *a, **k: lf.so3.dexpinv(*a, q=3, **k), (0.1 * np.ones((2, 3)), np.eye(3)[:2])),
    "se3.Ad": (lf.se3.Ad, (lf.se3.exp(np.ones((2, 6))), np.eye(6)[:2])),
    "se3.ad": (lf.se3.ad, (np.ones((2, 6)), np.eye(6)[:2])),
    "se3.coad": (lf.se3.coad, (np.ones((2, 6)), np.eye(6)[:2])),
    "se3.hat": (lf.se3.hat, (np.ones((2, 6)),)),
    "se3.vee": (lf.se3.vee, (lf.se3.hat(np.ones((2, 6))),)),
    "se3.project": (lf.se3.project, (lf.se3.exp(np.ones((2, 6))),)),
    "se3.ccsk": (lf.se3.ccsk, (np.ones((2, 6)),)),
}
A = np.triu(np.arange(32.0).reshape(2, 4, 4), 1)
A = 0.01 * (A - np.swapaxes(A, -1, -2))
for name in ("SO(4)", "U(4)"):
    group = lf.SO(4) if name == "SO(4)" else lf.U(4)
    MAPS |= {
        f"{name}.Ad": (group.Ad, (group.exp(A), A[::-1])), f"{name}.ad": (group.ad, (A, A[::-1])),
        f"{name}.coad": (group.coad, (A, A[::-1])), f"{name}.project": (group.project, (A + 1,)),
        f"{name}.dexpinv": (lambda *a, g=group, **k: g.dexpinv(*a, q=4, **k), (A, A[::-1])),
    }


@pytest.mark.parametrize("name", MAPS)
def test_every_map_takes_out(name):
    f, args = MAPS[name]
    right = f(*args)
    out = np.full_like(right, 7.0)
    assert f(*args, out=out) is out and np.array_equal(out, right)
    read_only = np.empty_like(right)
    read_only.flags.writeable = False
    strided = np.empty((2, *right.shape), right.dtype).swapaxes(0, -1)[..., 0]
    for bad in (np.empty(right.shape, np.float32), right[0].copy(), read_only, strided, [1.0]):
        with pytest.raises(lf.ArgumentError, match="^out: "):
            f(*args, out=bad)
    if args[0].shape == right.shape and args[0].dtype == right.dtype:
        mine = [a.copy() for a in args]
        assert np.array_equal(f(*mine, out=mine[0]), right)


@pytest.mark.parametrize("group", [lf.so3, lf.se3, lf.SO(4), lf.SL(3), lf.Sp(4), lf.U(3)])
def test_the_series_of_dexpinv(rng, group):
    if group in (lf.so3, lf.se3):
        u, v = rng.standard_normal((2, 5, 3 if group is lf.so3 else 6))
        u *= 0.01
    else:
        n = group.n
        u, v = group.project(0.01 * rng.standard_normal((5, n, n))), group.project(rng.standard_normal((5, n, n)))
    exact = group.dexpinv(u, v)
    assert np.array_equal(group.dexpinv(u, v, q=0), v)
    ad = group.ad(u, v)
    assert np.abs(group.dexpinv(u, v, q=2) - (v - ad / 2 + group.ad(u, ad) / 12)).max() < 1e-15
    for q, bound in ((1, 1e-2), (2, 1e-5), (6, 1e-11)):
        assert np.abs(group.dexpinv(u, v, q=q) - exact).max() < bound


def test_maps_of_special_matrices(rng):
    group = lf.SL(3)
    u, v = (group.project(0.3 * rng.standard_normal((4, 3, 3))) for _ in range(2))
    g = group.exp(u)
    assert np.abs(np.trace(u, axis1=-2, axis2=-1)).max() < 1e-15 and group.contains(g).all() and group.dim == 8
    assert np.abs(group.log(g) - u).max() < 1e-12 and np.abs(group.dexpinv(u, group.dexp(u, v)) - v).max() < 1e-12
    assert group.contains(group.random(5, rng), 1e-10).all()
    assert np.abs(group.Ad(g, v) - g @ v @ np.linalg.inv(g)).max() < 1e-12
    assert pickle.loads(pickle.dumps(group)) == group == eval(repr(group), {"lieflow": lf})
    for call in (lambda: group.exp(u + np.eye(3)), lambda: group.log(2 * g)):
        with pytest.raises(lf.ArgumentError, match=r"^[ug]\[0\]"):
            call()
    r = lf.solve_ivp(lambda t, y: u[0], (0, 1), np.eye(3), group=group, frame="space")
    assert np.abs(r.y_end - g[0]).max() < 1e-10


@pytest.mark.parametrize("order", ["123", "321"])
def test_ccsk_of_se3(rng, order):
    u = rng.standard_normal((4, 6))
    g = lf.se3.ccsk(u, order=order)
    assert np.abs(g[:, :3, :3] - lf.so3.ccsk(u[:, :3], order=order)).max() < 1e-15 and np.array_equal(g[:, :3, 3], u[:, 3:])
    with pytest.raises(lf.ArgumentError, match="order"):
        lf.se3.ccsk(u, order="213")


@pytest.mark.parametrize("group", [lf.so3, lf.se3, lf.SO(4), lf.U(2)])
def test_the_size_of_random_elements(group):
    one = group.random()
    for size, lead in ((np.int64(3), (3,)), (3, (3,)), ((2, np.int32(1)), (2, 1)), ([2], (2,)), (0, (0,)), ((), ())):
        assert group.random(size, 1).shape == lead + one.shape


def test_many_elements_are_taken_in_parts(rng):
    u, v, count = rng.standard_normal((200_000, 3)), np.array([0.3, -0.2, 0.5]), 200_000
    one = np.array([lf.so3.dexpinv(u[i], v) for i in range(0, count, 997)])
    assert np.abs(lf.so3.dexpinv(u, v)[::997] - one).max() < 1e-14
    assert np.abs(lf.so3.dexpinv(v, u)[::997] - np.array([lf.so3.dexpinv(v, u[i]) for i in range(0, count, 997)])).max() < 1e-14
    g = lf.so3.exp(u)
    assert np.abs(lf.so3.exp(lf.so3.log(g)) - g).max() < 1e-12
    u[150_001, 1] = np.nan
    with pytest.raises(lf.ArgumentError) as caught:
        lf.so3.exp(u)
    assert caught.value.argument == "u[150001]"
    a = np.broadcast_to(C2, (70_000, 2, 2)).copy()
    assert np.array_equal(lf.expm(a)[::7000], np.broadcast_to(lf.expm(C2), (10, 2, 2)))
    a[69_998, 0, 1] = np.inf
    with pytest.raises(lf.ArgumentError) as caught:
        lf.expm(a)
    assert caught.value.argument == "A[69998]"
    assert len(lf.SO(4).random(30_000, 1)) == 30_000


@pytest.mark.parametrize("threads", [1, 2])
def test_an_interrupt_of_a_map_of_many_matrices(rng, threads):
    a = rng.standard_normal((6000, 96, 96))
    assert interrupted(lambda: lf.expm(a, threads=threads)) < 0.2
    z = a[:3000] + 0.5j
    assert interrupted(lambda: lf.expm(z, threads=threads)) < 0.3
    if threads == 1:
        skew, group = a[:3000] - np.swapaxes(a[:3000], 1, 2), lf.SO(96)
        assert interrupted(lambda: group.cay(skew)) < 0.2


def test_series_with_very_many_terms():
    # Beyond k = 410 the coefficients are 0 in float64.
    u, v = np.array([0.3, -2.0, 0.7]), np.array([1.0, 0.5, -0.2])
    exact = lf.so3.dexpinv(u, v)
    for q in (60, 100, 10**9):
        assert np.abs(lf.so3.dexpinv(u, v, q=q) - exact).max() < 1e-15, q
    with pytest.raises(lf.ArgumentError, match="a sum up to q = 40 that is not finite"):
        lf.so3.dexpinv([1e10, 0, 0], [0, 1, 0], q=40)


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_results_are_finite():
    large = 1e200 * np.ones(3)
    skew = 1e200 * (np.tri(4).T - np.tri(4))
    for call in (
        lambda: lf.so3.ad(large, [1e200, 0, 0]), lambda: lf.so3.coad(large, [1e200, 0, 0]),
        lambda: lf.se3.ad([*large, *large], [1e200, 0, 0, 0, 1e200, 0]), lambda: lf.GL(4).coad(skew, skew[::-1]),
        lambda: lf.SO(4).ad(skew, skew[::-1, ::-1] + np.diag([1e200], 3) - np.diag([1e200], -3)),
        lambda: lf.U(2).ad(1e200j * np.array([[1, 2], [2, 3]]), 1e200j * np.array([[0, 1], [1, 2]])),
        lambda: lf.U(3).coad(1e200j * np.eye(3), 1e200 * np.ones((3, 3))),
    ):
        with pytest.raises(lf.ArgumentError, match="result: a number that is not finite"):
            call()


@pytest.mark.parametrize("name", ["so3", "se3", "SO(4)", "Sp(4)", "U(2)"])
def test_leading_axes_that_do_not_broadcast_are_named(rng, name):
    group = getattr(lf, name) if name in ("so3", "se3") else eval(f"lf.{name}")
    g, n = group.random((2, 3), rng), 3 if name == "so3" else 6
    u, v = (0.1 * rng.standard_normal((*lead, n)) for lead in ((2, 3), (2, 4)))
    if hasattr(group, "name"):
        u, v = (group.project(rng.standard_normal((*lead, group.n, group.n))) for lead in ((2, 3), (2, 4)))
    calls = {
        "Ad": ("u", lambda: group.Ad(g, v)), "ad": ("v", lambda: group.ad(u, v)), "coad": ("m", lambda: group.coad(u, v)),
        "dexpinv": ("v", lambda: group.dexpinv(u, v, q=2)), "dexp": ("v", lambda: group.dexp(u, v)),
    }
    for argument, call in calls.values():
        with pytest.raises(lf.ArgumentError, match=r"leading axes \(2, 4\), expected axes that broadcast with \(2, 3\)") as caught:
            call()
        assert caught.value.argument == argument
    # Those that do are as before.
    assert np.array_equal(group.ad(u, v[0, 0])[1, 2], group.ad(u[1, 2], v[0, 0]))
    assert np.array_equal(group.coad(u[0, 0], v)[1, 3], group.coad(u[0, 0], v[1, 3]))
