"""The maps of se(3) and SE(3) on arrays.

Vectors are (ω, v) of shape (..., 6), **rotation first** as in SciPy and GTSAM; manif and spatialmath have translation
first. Elements are 4×4 matrices [R x; 0 1], shape (..., 4, 4). Leading axes broadcast; ``out=`` as in :mod:`lieflow.so3`.

exp(ω, v) = (exp ω, dexp_ω v), log(R, x) = (log R, dexp_ω⁻¹ x). Differentials are right-trivialised.
Errors: :class:`lieflow.ArgumentError`, TypeError.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import so3
from ._lieflow import (
    se3_cay as cay,
    se3_dcayinv as dcayinv,
    se3_dexp as dexp,
    se3_dexpinv as dexpinv,
    se3_exp as exp,
    se3_log as log,
)
from .so3 import _tail

__all__ = [
    "Ad", "ad", "as_transform", "cay", "coad", "contains", "dcayinv", "dexp", "dexpinv", "exp", "from_transform", "hat", "log",
    "project", "random", "vee",
]

Array = NDArray[np.float64]


def hat(u: ArrayLike) -> Array:
    """Return the matrices [ω̂ v; 0 0] of u = (ω, v), shape (..., 4, 4)."""
    a = _tail("u", u, (6,))
    out = np.zeros(a.shape[:-1] + (4, 4))
    out[..., :3, :3] = so3.hat(a[..., :3])
    out[..., :3, 3] = a[..., 3:]
    return out


def vee(m: ArrayLike) -> Array:
    """Return u = (ω, v) of the matrices [ω̂ v; 0 0], shape (..., 6)."""
    a = _tail("m", m, (4, 4))
    return np.concatenate([so3.vee(a[..., :3, :3]), a[..., :3, 3]], axis=-1)


def Ad(g: ArrayLike, u: ArrayLike) -> Array:
    """Return Ad_g (ω, v) = (Rω, Rv + x × Rω), shape (..., 6)."""
    a, b = _tail("g", g, (4, 4)), _tail("u", u, (6,))
    omega = (a[..., :3, :3] @ b[..., :3, None])[..., 0]
    v = (a[..., :3, :3] @ b[..., 3:, None])[..., 0] + np.cross(a[..., :3, 3], omega)
    return np.concatenate(np.broadcast_arrays(omega, v), axis=-1)


def ad(u: ArrayLike, v: ArrayLike) -> Array:
    """Return ad_(ω, v) (ω′, v′) = (ω × ω′, ω × v′ + v × ω′), shape (..., 6)."""
    a, b = _tail("u", u, (6,)), _tail("v", v, (6,))
    first = np.cross(a[..., :3], b[..., :3])
    second = np.cross(a[..., :3], b[..., 3:]) + np.cross(a[..., 3:], b[..., :3])
    return np.concatenate([first, second], axis=-1)


def coad(u: ArrayLike, m: ArrayLike) -> Array:
    """Return ad*_(ω, v) (μ, π) = (μ × ω + π × v, π × ω), shape (..., 6)."""
    a, b = _tail("u", u, (6,)), _tail("m", m, (6,))
    first = np.cross(b[..., :3], a[..., :3]) + np.cross(b[..., 3:], a[..., 3:])
    return np.concatenate([first, np.cross(b[..., 3:], a[..., :3])], axis=-1)


def contains(g: ArrayLike, tol: float = 1e-12) -> NDArray[np.bool_]:
    """Return True for each matrix [R x; 0 1] with R in SO(3) to tol, shape (...)."""
    a = _tail("g", g, (4, 4))
    last = np.abs(a[..., 3, :] - np.array([0.0, 0.0, 0.0, 1.0])).max(-1) <= tol
    return np.asarray(so3.contains(a[..., :3, :3], tol) & last & np.isfinite(a[..., :3, 3]).all(-1))


def random(size: int | tuple[int, ...] | None = None, rng: Any = None) -> Array:
    """Return random elements: R by Haar's measure, x normal; shape size + (4, 4)."""
    generator = np.random.default_rng(rng)
    r = so3.random(size, generator)
    out = np.zeros(r.shape[:-2] + (4, 4))
    out[..., :3, :3] = r
    out[..., :3, 3] = generator.standard_normal(r.shape[:-2] + (3,))
    out[..., 3, 3] = 1.0
    return out


def project(x: ArrayLike) -> Array:
    """Return the motions with the rotations nearest to those of x (Frobenius) and its translations, shape (..., 4, 4)."""
    a = _tail("x", x, (4, 4))
    out = np.zeros(a.shape)
    out[..., :3, :3] = so3.project(a[..., :3, :3])
    out[..., :3, 3] = a[..., :3, 3]
    out[..., 3, 3] = 1.0
    return out


def as_transform(g: ArrayLike) -> Any:
    """Return SciPy's RigidTransform of matrices (..., 4, 4). It needs SciPy 1.16 or later."""
    from scipy.spatial.transform import RigidTransform  # type: ignore[import-untyped, import-not-found, unused-ignore]

    return RigidTransform.from_matrix(_tail("g", g, (4, 4)))


def from_transform(transform: Any) -> Array:
    """Return the matrices (..., 4, 4) of SciPy's RigidTransform."""
    return np.asarray(transform.as_matrix())
