"""lieflow.so3 beside SciPy and its own inverses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lieflow as lf
from lieflow import so3


@pytest.mark.parametrize("n", [0, 1, 2, 31, 32, 33, 64, 65, 1000])
def test_exp_and_log_are_scipys(rng, n):
    u = rng.standard_normal((n, 3))
    r = so3.exp(u)
    assert r.shape == (n, 3, 3)
    if n:
        assert np.abs(r - Rotation.from_rotvec(u).as_matrix()).max() < 5e-15
        assert np.abs(so3.log(r) - Rotation.from_matrix(r).as_rotvec()).max() < 1e-13


@pytest.mark.parametrize("alpha", [0.0, 1e-300, 1e-9, 1e-3, 1.0, 3.0, np.pi - 1e-9, np.pi - 1e-15])
def test_log_is_the_inverse_of_exp_at_every_angle(rng, alpha):
    axes = rng.standard_normal((50, 3))
    u = alpha * axes / np.linalg.norm(axes, axis=1)[:, None]
    back = so3.log(so3.exp(u))
    assert np.abs(np.linalg.norm(back, axis=1) - alpha).max() < 4e-16 + 1e-15 * alpha
    # Next to π the axis is known to ε/(π − α), up to its sign.
    gap = np.minimum(np.abs(back - u).max(1), np.abs(back + u).max(1)) if np.pi - alpha < 1e-8 else np.abs(back - u).max(1)
    assert gap.max() < 1e-14


def test_the_differentials_are_derivatives(rng):
    u, v = rng.standard_normal((2, 40, 3))
    h = 1e-6
    for map_, d in ((so3.exp, so3.dexp), (so3.cay, so3.dcay)):
        slope = (map_(u + h * v) - map_(u - h * v)) / (2 * h) @ np.swapaxes(map_(u), -1, -2)
        assert np.abs(so3.vee(slope) - d(u, v)).max() < 1e-8
    assert np.abs(so3.dexpinv(u, so3.dexp(u, v)) - v).max() < 1e-13
    assert np.abs(so3.dcayinv(u, so3.dcay(u, v)) - v).max() < 1e-13
    assert np.abs(so3.cay_inv(so3.cay(u)) - u).max() < 1e-12
    assert np.abs(so3.exp_on(u, v) - (so3.exp(u) @ v[..., None])[..., 0]).max() < 1e-14


def test_dexpinv_by_its_series(rng):
    u, v = 0.01 * rng.standard_normal((5, 3)), rng.standard_normal((5, 3))
    for q, bound in ((0, 1e-1), (1, 1e-3), (2, 1e-7), (4, 1e-11), (8, 1e-15)):
        assert np.abs(so3.dexpinv(u, v, q=q) - so3.dexpinv(u, v)).max() < bound


def test_leading_axes_broadcast(rng):
    u, v = rng.standard_normal((4, 1, 3)), rng.standard_normal((5, 3))
    w = so3.dexpinv(u, v)
    assert w.shape == (4, 5, 3)
    assert np.array_equal(w[2, 3], so3.dexpinv(u[2, 0], v[3]))
    many = rng.standard_normal((100, 3))
    assert np.allclose(so3.dexp(u[0, 0], many)[7], so3.dexp(u[0, 0], many[7]), rtol=0, atol=1e-15)
    assert so3.exp(np.zeros((2, 0, 3))).shape == (2, 0, 3, 3)


def test_out_and_overlaps(rng):
    u = rng.standard_normal((50, 3))
    expected = so3.exp(u)
    out = np.empty((50, 3, 3))
    assert so3.exp(u, out=out) is out
    assert np.array_equal(out, expected)
    memory = np.empty(50 * 9)
    inside = memory[: 150].reshape(50, 3)
    inside[...] = u
    assert np.array_equal(so3.exp(inside, out=memory.reshape(50, 3, 3)), expected)
    w = u.copy()
    assert np.array_equal(so3.dexp(w, w, out=w), so3.dexp(u, u))
    read_only = np.empty((50, 3, 3))
    read_only.flags.writeable = False
    for bad in (np.empty((50, 3)), np.empty((50, 3, 3), np.float32), np.empty((50, 3, 3), order="F"), read_only, [0.0]):
        with pytest.raises(lf.ArgumentError, match="out"):
            so3.exp(u, out=bad)


@pytest.mark.parametrize(
    "make",
    [
        lambda u: u.astype(np.float32),
        lambda u: np.round(u).astype(int),
        lambda u: u.tolist(),
        np.asfortranarray,
        lambda u: np.repeat(u, 2, axis=0)[::2],
        lambda u: u[::-1],
        lambda u: np.frombuffer(b"x" + u.tobytes(), np.uint8)[1:].view(float).reshape(u.shape),
        lambda u: u.astype(">f8"),
    ],
)
def test_every_kind_of_real_array_works(rng, make):
    x = make(rng.standard_normal((6, 3)))
    assert np.array_equal(so3.exp(x), so3.exp(np.array(x, dtype=float)))


def test_a_read_only_array_and_a_subclass_work(rng):
    class Sub(np.ndarray):
        pass

    u = rng.standard_normal((6, 3))
    v = u.view(Sub)
    u.flags.writeable = False
    assert np.array_equal(so3.exp(u), so3.exp(v))


@pytest.mark.parametrize("bad", [1j * np.ones(3), "text", None, [[1.0, 2.0, 3.0], [1.0]], object()])
def test_what_is_not_real_numbers_is_a_type_error(bad):
    with pytest.raises(TypeError, match="u: .*expected real numbers"):
        so3.exp(bad)


def test_a_wrong_argument_is_named_with_its_element(rng):
    with pytest.raises(lf.ArgumentError) as caught:
        so3.exp(np.zeros((3, 4)))
    assert (caught.value.argument, caught.value.expected) == ("u", "shape (..., 3)")
    u = rng.standard_normal((10, 20, 3))
    u[7, 11, 1] = np.nan
    with pytest.raises(lf.ArgumentError, match=r"u\[7, 11\]"):
        so3.exp(u)
    r = so3.exp(rng.standard_normal((100, 3)))
    for wrong in (2.0, -1.0):
        r[77] = wrong * np.eye(3)
        with pytest.raises(ValueError, match=r"r\[77\].*(SO\(3\)|determinant)"):
            so3.log(r)
    with pytest.raises(lf.ArgumentError, match="v: leading axes"):
        so3.dexp(np.zeros((2, 3)), np.zeros((4, 3)))


def test_the_small_functions(rng):
    u, v = rng.standard_normal((2, 5, 3))
    r = so3.random(5, rng)
    assert so3.contains(r).all() and not so3.contains(-r).any() and not so3.contains(2 * r).any()
    assert np.abs(so3.project(r + 1e-3) - r).max() < 1e-2
    assert so3.contains(so3.project(rng.standard_normal((20, 3, 3)))).all()
    assert np.array_equal(so3.vee(so3.hat(u)), u)
    assert np.allclose(so3.hat(u) @ v[..., None], so3.ad(u, v)[..., None])
    assert np.allclose(so3.hat(so3.Ad(r, u)), r @ so3.hat(u) @ np.swapaxes(r, -1, -2))
    assert np.allclose((so3.coad(u, v) * r[:, 0]).sum(-1), (v * so3.ad(u, r[:, 0])).sum(-1))
    assert np.array_equal(so3.from_rotation(so3.as_rotation(r)).round(12), r.round(12))


@pytest.mark.parametrize("order", ["123", "321", "213", "231", "132", "312"])
def test_canonical_coordinates_of_the_second_kind(rng, order):
    u = rng.standard_normal((5, 3))
    right = np.array([np.eye(3)] * 5)
    for axis in order:
        right = right @ Rotation.from_rotvec(u * np.eye(3)[int(axis) - 1]).as_matrix()
    assert np.abs(lf.so3.ccsk(u, order=order) - right).max() < 1e-14
    if order in ("123", "321"):
        assert np.abs(lf.SO(3).ccsk(lf.so3.hat(u), order=order) - right).max() < 1e-14
    with pytest.raises(lf.ArgumentError, match="order"):
        lf.so3.ccsk(u, order="112")


def slope(map_, u, v):
    """dΨ_u(v) by differences of order 6."""
    h, weights = 1e-2, {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    d = sum(c * (map_(u + n * h * v) - map_(u - n * h * v)) for n, c in weights.items()) / h
    m = d @ np.swapaxes(map_(u), -1, -2)
    return so3.vee((m - np.swapaxes(m, -1, -2)) / 2)


@pytest.mark.parametrize("order", ["123", "321", "213", "231", "132", "312"])
def test_the_inverse_differential_of_ccsk(rng, order):
    u, v = rng.uniform(-1.2, 1.2, (2, 50, 3))
    found = so3.dccskinv(u, slope(lambda x: so3.ccsk(x, order=order), u, v), order=order)
    assert np.abs(found - v).max() < 1e-9
    # At u = 0 it is v, and u is one of many.
    assert np.array_equal(so3.dccskinv(np.zeros(3), v, order=order), v)
    assert np.array_equal(so3.dccskinv(u[7], v, order=order)[3], so3.dccskinv(u[7], v[3], order=order))


def test_the_pade_map(rng):
    u, v = rng.standard_normal((2, 200, 3)) * np.geomspace(1e-8, 3, 200)[:, None]
    a = so3.hat(u)
    ratio = np.linalg.solve(np.eye(3) - a / 2 + a @ a / 12, np.eye(3) + a / 2 + a @ a / 12)
    assert np.abs(so3.pade22(u) - ratio).max() < 1e-14 and so3.contains(so3.pade22(1e3 * u), 1e-13).all()
    assert np.abs(so3.pade22([12**0.5, 0, 0]) - np.diag([1, -1, -1])).max() < 1e-15  # an angle of π
    angle = np.linalg.norm(so3.log(so3.pade22([0.1, 0, 0])))
    assert angle - 0.1 == pytest.approx(-(0.1**5) / 720, rel=1e-2)
    found = so3.dpade22inv(u, slope(so3.pade22, u, v / 10))
    assert np.abs(found - v / 10).max() < 1e-9
    assert so3.dpade22inv(u[:, None], v).shape == (200, 200, 3)


def test_refusals_of_ccsk_and_pade22():
    for call, argument in (
        (lambda: so3.dccskinv(np.ones(3), np.ones(3), order="112"), "order"),
        (lambda: so3.dccskinv(np.ones((2, 3)), np.ones((4, 3))), "v"),
        (lambda: so3.dpade22inv(np.ones((2, 3)), np.ones((4, 3))), "v"),
        (lambda: so3.pade22([1e200, 0, 0]), "result"),
        (lambda: so3.dpade22inv([1e200, 0, 0], [1, 0, 0]), "result"),
    ):
        with pytest.raises(lf.ArgumentError) as caught:
            call()
        assert caught.value.argument == argument


@pytest.mark.parametrize("scalar_first", [True, False])
def test_quaternions_are_scipys(rng, scalar_first):
    rotation = Rotation.random(50, random_state=3)
    r = rotation.as_matrix()
    q = lf.so3.as_quaternion(r, scalar_first=scalar_first)
    right = rotation.as_quat(canonical=True, scalar_first=scalar_first)
    assert np.abs(q - right).max() < 1e-14
    assert np.abs(lf.so3.from_quaternion(q, scalar_first=scalar_first) - r).max() < 1e-14
    with pytest.raises(TypeError):
        lf.so3.as_quaternion(r)
    with pytest.raises(lf.ArgumentError, match=r"q\[1\]"):
        lf.so3.from_quaternion([[1, 0, 0, 0], [2, 0, 0, 0]], scalar_first=scalar_first)


def test_values_of_scipys_test_rotation():
    # scipy/spatial/transform/tests/test_rotation.py: from_rotvec and as_rotvec.
    assert np.allclose(lf.so3.exp([[1, 0, 0], [1e-3, 0, 0], [0, 0, 0]]),
                       Rotation.from_rotvec([[1, 0, 0], [1e-3, 0, 0], [0, 0, 0]]).as_matrix(), rtol=0, atol=3e-16)
    for degrees in (0, 1e-9, 90, 120, 180 - 1e-6, 180):
        u = np.deg2rad(degrees) * np.array([0.6, 0.0, 0.8])
        r = lf.so3.exp(u)
        assert np.abs(r - Rotation.from_rotvec(u).as_matrix()).max() < 1e-15
        back = lf.so3.log(r)
        assert min(np.abs(back - u).max(), np.abs(back + u).max() if degrees == 180 else 1) < 1e-12
    quarter = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float)  # 120° about (1, 1, 1)
    assert np.allclose(lf.so3.log(quarter), 2 * np.pi / 3 / np.sqrt(3), rtol=0, atol=1e-15)
    near = np.array([[0.0, 1.0, 0.1], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # no rotation: test_from_matrix_calculation
    assert np.abs(lf.so3.project(near) - Rotation.from_matrix(near).as_matrix()).max() < 5e-3
    for size in (0, 1, 3):
        assert lf.so3.exp(np.zeros((size, 3))).shape == (size, 3, 3)
        assert lf.so3.log(np.zeros((size, 0, 3, 3))).shape == (size, 0, 3)
