"""lieflow.se3, the groups of matrices and expm, beside SciPy and their own inverses."""

from __future__ import annotations

import pickle
import re
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import scipy.linalg
from numpy.testing import assert_allclose

import lieflow as lf
from lieflow import se3


def test_se3_maps(rng):
    u, v = rng.standard_normal((2, 30, 6))
    g = se3.exp(u)
    assert np.abs(g - scipy.linalg.expm(se3.hat(u))).max() < 1e-13
    assert np.abs(se3.log(g) - u).max() < 1e-12 and se3.contains(g).all()
    h = 1e-6
    slope = (se3.exp(u + h * v) - se3.exp(u - h * v)) / (2 * h) @ np.linalg.inv(g)
    assert np.abs(se3.dexpinv(u, se3.vee(slope)) - v).max() < 1e-7
    assert np.abs(se3.hat(se3.Ad(g, v)) - g @ se3.hat(v) @ np.linalg.inv(g)).max() < 1e-12
    a, b = se3.hat(u), se3.hat(v)
    assert np.abs(se3.vee(a @ b - b @ a) - se3.ad(u, v)).max() < 1e-13
    m = rng.standard_normal((30, 6))
    assert np.abs((se3.coad(u, m) * v).sum(-1) - (m * se3.ad(u, v)).sum(-1)).max() < 1e-12
    with pytest.raises(lf.ArgumentError, match=r"g\[1, 3, 3\]"):
        se3.log(np.stack([np.eye(4), 2 * np.eye(4)]))
    assert se3.contains(se3.random((2, 3), rng)).all()


@pytest.mark.parametrize("group", [lf.SO(3), lf.SO(5), lf.SO(3, 1), lf.Sp(4), lf.GL(3), lf.Gm([[2.0, 1.0], [0.0, 3.0]])])
def test_maps_of_matrix_groups(rng, group):
    n = group.n
    u, v = (group.project(0.3 * rng.standard_normal((7, n, n))) for _ in range(2))
    g = group.exp(u)
    assert np.abs(g - scipy.linalg.expm(u)).max() < 1e-13
    assert np.abs(group.log(g) - u).max() < 1e-10
    assert group.contains(g, 1e-12).all()
    assert np.abs(group.dexpinv(u, group.dexp(u, v)) - v).max() < 1e-12
    h = 1e-5
    slope = (group.exp(u + h * v) - group.exp(u - h * v)) / (2 * h) @ np.linalg.inv(g)
    assert np.abs(slope - group.dexp(u, v)).max() < 1e-8
    assert np.abs(group.Ad(g, v) - g @ v @ np.linalg.inv(g)).max() < 1e-12
    if "GL" not in group.name:
        assert np.abs(group.cay_inv(group.cay(u)) - u).max() < 1e-11
        bad = u.copy()
        bad[3] += 1.0
        with pytest.raises(lf.ArgumentError, match=r"u\[3\]"):
            group.exp(bad)
    assert pickle.loads(pickle.dumps(group)) == group
    assert repr(eval(repr(group), {"lieflow": lf})) == repr(group)
    assert group.contains(group.random((2, 2), rng), 1e-10).all()


def test_groups_refuse_wrong_sizes():
    for make in (lambda: lf.SO(0), lambda: lf.Sp(3), lambda: lf.Gm([[1.0, 0.0]]), lambda: lf.Gm(np.zeros((2, 2)))):
        with pytest.raises(lf.ArgumentError):
            make()


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4, 5, 6, 7, 8, 16])
def test_expm_is_scipys(rng, n):
    for count in (1, 7, 8, 64, 100):
        scale = 10.0 ** rng.uniform(-6, 1, (count, 1, 1))
        a = scale * rng.standard_normal((count, n, n))
        right = scipy.linalg.expm(a) if n else a
        g = lf.expm(a)
        assert g.shape == a.shape
        size = np.maximum(np.linalg.norm(right, axis=(1, 2)), 1.0) if n else 1.0
        assert (np.linalg.norm(g - right, axis=(1, 2)) / size < 1e-11).all()
        assert np.array_equal(lf.expm(a, threads=3), g)
        skew = a - np.swapaxes(a, -1, -2)
        q = lf.expm(skew, structure="skew")
        assert np.abs(np.swapaxes(q, -1, -2) @ q - np.eye(n)).max(initial=0.0) < 1e-13


def test_expm_of_one_matrix_does_not_depend_on_calls_before(rng):
    sizes = [1, 2, 3, 5, 8, 16, 17, 40]
    matrices = [rng.standard_normal((n, n)) * 10.0**power for n in sizes for power in (-3, 0, 1)]
    alone = [lf.expm(a) for a in matrices]
    for k in rng.integers(len(matrices), size=200):
        a = matrices[k]
        if k % 5 == 0:
            with pytest.raises(lf.ArgumentError):
                lf.expm(np.full_like(a, np.inf))
        assert np.array_equal(lf.expm(a), alone[k])
        with ThreadPoolExecutor(1) as other:
            assert np.array_equal(other.submit(lf.expm, a).result(), alone[k])


def test_expm_of_mixed_norms_and_complex(rng):
    a = rng.standard_normal((50, 4, 4)) * np.logspace(-10, 1.5, 50)[:, None, None]
    one_by_one = np.array([scipy.linalg.expm(x) for x in a])
    assert (np.abs(lf.expm(a) - one_by_one).max((1, 2)) / np.abs(one_by_one).max((1, 2)) < 1e-11).all()
    z = rng.standard_normal((5, 4, 4)) + 1j * rng.standard_normal((5, 4, 4))
    assert np.abs(lf.expm(z) - np.array([scipy.linalg.expm(x) for x in z])).max() < 1e-11
    h = z - np.conj(np.swapaxes(z, -1, -2))
    q = lf.expm(h, structure="skew")
    assert np.abs(np.conj(np.swapaxes(q, -1, -2)) @ q - np.eye(4)).max() < 1e-13
    for bad, words in ((np.full((3, 2, 2), np.nan), r"A\[0\]"), (np.zeros((2, 3)), "A: shape")):
        with pytest.raises(lf.ArgumentError, match=words):
            lf.expm(bad)
    with pytest.raises(lf.ArgumentError, match="structure"):
        lf.expm(np.eye(2), structure="symmetric")
    assert lf.expm([[0, 1], [-1, 0]]).shape == (2, 2)


def test_differentials_of_se3(rng):
    u, v = rng.standard_normal((2, 7, 6))
    h = 1e-6
    moved = lf.se3.exp(u + h * v) @ np.linalg.inv(lf.se3.exp(u - h * v))
    assert np.abs(lf.se3.log(moved) / (2 * h) - lf.se3.dexp(u, v)).max() < 1e-8
    assert np.abs(lf.se3.dexpinv(u, lf.se3.dexp(u, v)) - v).max() < 1e-13
    g = lf.se3.exp(u)
    assert lf.se3.contains(lf.se3.project(g + 1e-3)).all()


def test_motions_of_scipy(rng):
    transform = pytest.importorskip("scipy.spatial.transform")
    if not hasattr(transform, "RigidTransform"):
        pytest.skip("no RigidTransform")
    u = rng.standard_normal((9, 6))
    rigid = lf.se3.as_transform(lf.se3.exp(u))
    assert np.abs(rigid.as_exp_coords() - lf.se3.log(lf.se3.exp(u))).max() < 1e-12
    assert np.abs(lf.se3.from_transform(transform.RigidTransform.from_exp_coords(u)) - lf.se3.exp(u)).max() < 1e-13


@pytest.mark.parametrize("group", [lf.SO(4), lf.Sp(4), lf.SO(3, 1)])
def test_the_differential_of_cay(rng, group):
    u, v = (group.project(0.3 * rng.standard_normal((5, 4, 4))) for _ in range(2))
    h = 1e-6
    moved = (group.cay(u + h * v) - group.cay(u - h * v)) / (2 * h)
    assert np.abs(group.dcay(u, v) @ group.cay(u) - moved).max() < 1e-8
    assert np.abs(group.dcayinv(u, group.dcay(u, v)) - v).max() < 1e-13


def test_lielabs_checks_of_exp_and_log(rng):
    # As in Lielab's tests: exp(0) = 1, log(exp(u)) = u, d exp by commutators at small u, the Cayley map to second order.
    for group in (lf.SO(3), lf.SO(5), lf.Sp(4), lf.GL(3)):
        n = group.n
        u, v = (group.project(0.05 * rng.standard_normal((n, n))) for _ in range(2))
        assert np.array_equal(group.exp(np.zeros((n, n))), np.eye(n))
        assert np.abs(group.log(group.exp(u)) - u).max() < 1e-14
        ad = group.ad
        series = v + ad(u, v) / 2 + ad(u, ad(u, v)) / 6 + ad(u, ad(u, ad(u, v))) / 24
        assert np.abs(group.dexp(u, v) - series).max() < 1e-5
        inverse = v - ad(u, v) / 2 + ad(u, ad(u, v)) / 12
        assert np.abs(group.dexpinv(u, v) - inverse).max() < 1e-5
        if group.name != "GL(3)":
            assert np.abs(group.cay(u) - (np.eye(n) + u + u @ u / 2)).max() < 1e-3
            assert group.contains(group.cay(u), 1e-14)


def test_elements_to_six_digits_have_maps(rng):
    # As a start of a run, and as so3 and se3.
    for group in (lf.SO(3), lf.SO(4), lf.SO(3, 1), lf.Sp(4), lf.SL(3), lf.Gm(np.diag([1.0, 2, 3]))):
        n = group.n
        u = group.project(0.3 * rng.standard_normal((n, n)))
        off = 1e-8 * rng.standard_normal((n, n))
        exact = group.exp(u)
        assert np.abs(group.exp(u + off) - exact).max() < 1e-7 and group.contains(group.exp(u + off)), group
        found = group.log(exact + off)
        assert np.abs(found - u).max() < 1e-6 and np.abs(found - group.project(found)).max() < 1e-15, group
        assert np.abs(group.dexp(u + off, u) - u).max() < 1e-7
        if group.name != "SL(3)":
            assert np.abs(group.cay_inv(group.cay(u) + off) - u).max() < 1e-6, group
        with pytest.raises(lf.ArgumentError, match="Lie algebra"):
            group.exp(np.eye(n))
        with pytest.raises(lf.ArgumentError):
            group.log(exact + 1e-3)
        assert not group.contains(exact + 1e-3)


@pytest.mark.parametrize("group", [lf.SO(3), lf.Sp(4), lf.U(2)])
def test_matrices_whose_squares_overflow_are_in_no_group(group):
    for size in (1e80, 1e155, 1e200):
        with pytest.raises(lf.ArgumentError, match="^g: a matrix at a relative distance of .* from " + re.escape(group.name)):
            group.Ad(size * np.eye(group.n), np.zeros((group.n, group.n)))


@pytest.mark.parametrize("scale", [1e-13, 1e-7, 1.0, 1e6, 1e13])
def test_membership_does_not_depend_on_the_scale_of_m(scale):
    group, c, s = lf.Gm(scale * np.eye(2)), np.cos(0.3), np.sin(0.3)
    rotation, other = np.array([[c, -s], [s, c]]), np.array([[2.0, 1.0], [0.0, 3.0]])
    u = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert group.contains(rotation) and not group.contains(other)
    assert_allclose(group.Ad(rotation, u), u, rtol=0, atol=1e-14)
    with pytest.raises(lf.ArgumentError, match="^g: a matrix at a relative distance"):
        group.Ad(other, u)


def test_refusals_of_maps_name_their_argument_once():
    with pytest.raises(lf.ArgumentError) as refused:
        lf.GL(2).log(np.diag([-1.0, -2.0]))
    assert refused.value.argument == "g" and str(refused.value).count("g:") == 1 and refused.value.expected
    for tol in (-1.0, np.nan):
        with pytest.raises(lf.ArgumentError, match="^tol: "):
            lf.GL(2).contains(np.eye(2), tol=tol)
    for tol in (None, "a"):
        with pytest.raises(TypeError, match="^tol: "):
            lf.GL(2).contains(np.eye(2), tol=tol)
