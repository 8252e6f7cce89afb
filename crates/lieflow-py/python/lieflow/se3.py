"""The maps of se(3) and SE(3) on arrays.

Vectors are (ω, v) of shape (..., 6), **rotation first** as in SciPy and GTSAM; manif and spatialmath have translation
first. Elements are 4×4 matrices [R x; 0 1], shape (..., 4, 4). Leading axes broadcast; ``out=`` as in :mod:`lieflow.so3`,
by every function that returns an array of numbers.

exp(ω, v) = (exp ω, dexp_ω v), log(R, x) = (log R, dexp_ω⁻¹ x). Differentials are right-trivialised.
Errors: :class:`lieflow.ArgumentError` for a shape, a number that is not finite, or a matrix that is no motion, with the
place of the element; TypeError for what is not real numbers.
Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import so3
from ._arrays import MEMBERSHIP, Array, elements, first, into, leading, pair, series, whole
from ._errors import ArgumentError
from ._lieflow import (
    se3_cay as cay,
    se3_ccsk123 as _ccsk123,
    se3_ccsk321 as _ccsk321,
    se3_dcayinv as dcayinv,
    se3_dexp as dexp,
    se3_dexpinv as _dexpinv,
    se3_exp as exp,
    se3_log as log,
)
from ._types import Matrices, Real, Whole

__all__ = [
    "Ad", "ad", "as_transform", "cay", "ccsk", "coad", "contains", "dcayinv", "dexp", "dexpinv", "exp", "from_transform", "hat", "log",
    "project", "random", "vee",
]


def _motions(name: str, g: Matrices) -> Array:
    """Elements of SE(3), as matrices."""
    a = elements(name, g, (4, 4))
    first(name, ~contains(a, MEMBERSHIP), "a matrix that is no motion", "[R x; 0 1] with a rotation R")
    return a


def _both(name_a: str, a: ArrayLike, name_b: str, b: ArrayLike) -> tuple[Array, Array]:
    """Two arrays of vectors, whose leading axes broadcast."""
    return pair(name_a, elements(name_a, a, (6,)), 1, name_b, elements(name_b, b, (6,)), 1)


def dexpinv(u: ArrayLike, v: ArrayLike, out: Array | None = None, *, q: Whole | None = None) -> Array:
    """Return dexp_u⁻¹(v), the inverse of dexp_u, shape (..., 6); right-trivialised.

    With q, the series Σ_k B_k/k! ad_u^k v is cut after k = q. Errors: ArgumentError, and next to |ω| = 2πk, k ≥ 1, where
    dexp is singular.
    """
    if q is None:
        return _dexpinv(u, v, out)
    return into(series(ad, *_both("u", u, "v", v), whole("q", q)), out)


def ccsk(u: ArrayLike, out: Array | None = None, *, order: str = "123") -> Array:
    """Return the translation by v times the rotations about the axes in the order "123" or "321", shape (..., 4, 4)."""
    if order not in ("123", "321"):
        raise ArgumentError("order", repr(order), '"123" or "321"')
    return (_ccsk123 if order == "123" else _ccsk321)(u, out)


def hat(u: ArrayLike, out: Array | None = None) -> Array:
    """Return the matrices [ω̂ v; 0 0] of u = (ω, v), shape (..., 4, 4)."""
    a = elements("u", u, (6,))
    found = np.zeros(a.shape[:-1] + (4, 4))
    found[..., :3, :3] = so3.hat(a[..., :3])
    found[..., :3, 3] = a[..., 3:]
    return into(found, out)


def vee(m: ArrayLike, out: Array | None = None) -> Array:
    """Return u = (ω, v) of the matrices m = [ω̂ v; 0 0], shape (..., 6)."""
    a = elements("m", m, (4, 4))
    off = np.abs(a[..., 3, :]).max(-1) > MEMBERSHIP * np.abs(a).max((-1, -2), initial=0.0)
    first("m", off, "a matrix with another last row than 0", "a matrix [ω̂ v; 0 0]")
    return into(np.concatenate([so3.vee(a[..., :3, :3]), a[..., :3, 3]], axis=-1), out)


def Ad(g: Matrices, u: ArrayLike, out: Array | None = None) -> Array:
    """Return Ad_g (ω, v) = (Rω, Rv + x × Rω) of g = [R x; 0 1], shape (..., 6)."""
    a, b = pair("g", _motions("g", g), 2, "u", elements("u", u, (6,)), 1)
    omega = (a[..., :3, :3] @ b[..., :3, None])[..., 0]
    v = (a[..., :3, :3] @ b[..., 3:, None])[..., 0] + np.cross(a[..., :3, 3], omega)
    return into(np.concatenate(np.broadcast_arrays(omega, v), axis=-1), out)


def ad(u: ArrayLike, v: ArrayLike, out: Array | None = None) -> Array:
    """Return ad_(ω, v) (ω′, v′) = (ω × ω′, ω × v′ + v × ω′), shape (..., 6)."""
    a, b = _both("u", u, "v", v)
    rotation = np.cross(a[..., :3], b[..., :3])
    translation = np.cross(a[..., :3], b[..., 3:]) + np.cross(a[..., 3:], b[..., :3])
    return into(np.concatenate([rotation, translation], axis=-1), out)


def coad(u: ArrayLike, m: ArrayLike, out: Array | None = None) -> Array:
    """Return ad*_(ω, v) (μ, π) = (μ × ω + π × v, π × ω), with ⟨m, u⟩ = μ·ω + π·v, shape (..., 6).

    A run with ``action="coadjoint"`` solves ẏ = −ad*_f y; a body in a fluid has f = −(ω, v).
    """
    a, b = _both("u", u, "m", m)
    mu = np.cross(b[..., :3], a[..., :3]) + np.cross(b[..., 3:], a[..., 3:])
    return into(np.concatenate([mu, np.cross(b[..., 3:], a[..., :3])], axis=-1), out)


def contains(g: Matrices, tol: Real = 1e-12) -> NDArray[np.bool_]:
    """Return True for each matrix [R x; 0 1] with R in SO(3) to tol, shape (...)."""
    a = elements("g", g, (4, 4), check=False)
    last = np.abs(a[..., 3, :] - np.array([0.0, 0.0, 0.0, 1.0])).max(-1) <= tol
    return np.asarray(so3.contains(a[..., :3, :3], tol) & last & np.isfinite(a[..., :3, 3]).all(-1))


def random(size: Whole | Sequence[Whole] | None = None, rng: Any = None) -> Array:
    """Return random elements: R by Haar's measure, x normal; shape size + (4, 4)."""
    generator = np.random.default_rng(rng)
    r = so3.random(leading(size), generator)
    out = np.zeros(r.shape[:-2] + (4, 4))
    out[..., :3, :3] = r
    out[..., :3, 3] = generator.standard_normal(r.shape[:-2] + (3,))
    out[..., 3, 3] = 1.0
    return out


def project(x: ArrayLike, out: Array | None = None) -> Array:
    """Return the motions with the rotations nearest to those of x (Frobenius) and its translations, shape (..., 4, 4)."""
    a = elements("x", x, (4, 4))
    found = np.zeros(a.shape)
    found[..., :3, :3] = so3.project(a[..., :3, :3])
    found[..., :3, 3] = a[..., :3, 3]
    found[..., 3, 3] = 1.0
    return into(found, out)


def as_transform(g: Matrices) -> Any:
    """Return SciPy's RigidTransform of matrices (..., 4, 4). It needs SciPy 1.16 or later."""
    from scipy.spatial.transform import RigidTransform  # type: ignore[import-untyped, import-not-found, unused-ignore]

    return RigidTransform.from_matrix(_motions("g", g))


def from_transform(transform: Any) -> Array:
    """Return the matrices (..., 4, 4) of SciPy's RigidTransform."""
    return np.asarray(transform.as_matrix())
