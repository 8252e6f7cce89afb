"""The maps of so(3) and SO(3) on arrays.

Vectors have shape (..., 3) and rotations (..., 3, 3). Leading axes broadcast. Every function that returns an array of
numbers takes ``out=``, an array of float64 in C order, which may share memory with the arguments. With û the matrix of
v ↦ u × v, α = |u|, and right-trivialised differentials, d/dε Ψ(u + εv) = dΨ_u(v) Ψ(u):

==========  ==========================================================
exp         𝟙 + (sin α/α) û + ((1 − cos α)/α²) û²
dexp        𝟙 + ((1 − cos α)/α²) û + ((α − sin α)/α³) û²; the left Jacobian of robotics
dexpinv     𝟙 − û/2 + ((1 − (α/2) cot(α/2))/α²) û²
cay         𝟙 + (û + û²/2)/(1 + α²/4)
ccsk        exp(u_i e_i) exp(u_j e_j) exp(u_k e_k); dccskinv is singular at cos u_j = 0
pade22      (𝟙 − û/2 + û²/12)⁻¹ (𝟙 + û/2 + û²/12), of order 4 to exp; dpade22inv is nowhere singular
==========  ==========================================================

Errors: :class:`lieflow.ArgumentError` for a shape, a number that is not finite, or a matrix that is no rotation, with
the place of the element; TypeError for what is not real numbers.
Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import MEMBERSHIP, Array, elements, first, into, leading, pair, series, together, whole
from ._errors import ArgumentError
from ._lieflow import (
    so3_cay as cay,
    so3_cay_inv as cay_inv,
    so3_dcay as dcay,
    so3_dcayinv as dcayinv,
    so3_dexp as dexp,
    so3_dexpinv as _dexpinv,
    so3_exp as exp,
    so3_exp_on as exp_on,
    so3_log as log,
)
from ._types import Flag, Matrices, Real, Whole

__all__ = [
    "Ad",
    "ad",
    "as_quaternion",
    "as_rotation",
    "cay",
    "cay_inv",
    "ccsk",
    "coad",
    "contains",
    "dcay",
    "dcayinv",
    "dccskinv",
    "dexp",
    "dexpinv",
    "dpade22inv",
    "exp",
    "exp_on",
    "from_quaternion",
    "from_rotation",
    "hat",
    "log",
    "pade22",
    "project",
    "random",
    "vee",
]


def _rotations(name: str, r: Matrices) -> Array:
    """Rotations, as matrices."""
    a = elements(name, r, (3, 3))
    first(name, ~contains(a, MEMBERSHIP), "a matrix that is no rotation", "RᵀR = 𝟙 and det R = 1")
    return a


def dexpinv(u: ArrayLike, v: ArrayLike, out: Array | None = None, *, q: Whole | None = None) -> Array:
    """Return dexp_u⁻¹(v) = v − u × v/2 + ((1 − (α/2) cot(α/2))/α²) u × (u × v), α = |u|, shape (..., 3).

    With q, the series Σ_k B_k/k! ad_u^k v is cut after k = q. Right-trivialised. Errors: ArgumentError, and next to
    |u| = 2πk, k ≥ 1, where dexp is singular.
    """
    if q is None:
        return _dexpinv(u, v, out)
    return into(series(np.cross, *_both(u, v), whole("q", q)), out)


def ccsk(u: ArrayLike, out: Array | None = None, *, order: str = "123") -> Array:
    """Return exp(u_i e_i) exp(u_j e_j) exp(u_k e_k) for the order ijk of the axes, shape (..., 3, 3)."""
    a = elements("u", u, (3,))
    i, j, k = (exp(a * np.eye(3)[axis]) for axis in _axes(order))
    return into(i @ j @ k, out)


def _axes(order: str) -> list[int]:
    """The axes of an order, from 0."""
    if not (isinstance(order, str) and sorted(order) == ["1", "2", "3"]):
        raise ArgumentError("order", repr(order), 'an order of the axes, such as "123" or "321"')
    return [int(axis) - 1 for axis in order]


def _both(u: ArrayLike, v: ArrayLike, name: str = "v") -> tuple[Array, Array]:
    """Two arrays of vectors with the same leading axes."""
    return together("u", elements("u", u, (3,)), 1, name, elements(name, v, (3,)), 1)


def dccskinv(u: ArrayLike, v: ArrayLike, out: Array | None = None, *, order: str = "123") -> Array:
    """Return dccsk_u⁻¹(v) for the order ijk of the axes, shape (..., 3). Right-trivialised.

    In the frame e_i, e_j, ±e_k it is (v₁ − w sin u_j, v₂ cos u_i + v₃ sin u_i, w), w = (v₃ cos u_i − v₂ sin u_i)/cos u_j.
    Next to cos u_j = 0, where ccsk is singular, it grows beyond all bounds.
    """
    i, j, k = _axes(order)
    a, b = _both(u, v)
    sign = 1.0 if (i + 1) % 3 == j else -1.0
    (s1, c1), (s2, c2) = ((np.sin(x), np.cos(x)) for x in (a[..., i], a[..., j]))
    v1, v2, v3 = b[..., i], b[..., j], sign * b[..., k]
    found = np.empty_like(b)
    with np.errstate(over="ignore", invalid="ignore"):  # told by into
        w = (c1 * v3 - s1 * v2) / c2
        found[..., i], found[..., j], found[..., k] = v1 - s2 * w, c1 * v2 + s1 * v3, sign * w
    return into(found, out)


def pade22(u: ArrayLike, out: Array | None = None) -> Array:
    """Return 𝟙 + (q û + û²/2)/(q² + α²/4), q = 1 − α²/12, α = |u|, shape (..., 3, 3).

    It is the diagonal Padé approximant (2, 2) of exp: its angle is α + O(α⁵).
    """
    a = hat(u)
    with np.errstate(over="ignore", invalid="ignore"):  # told by into
        square = (a**2).sum((-1, -2), keepdims=True) / 2
        q = 1.0 - square / 12
        return into(np.eye(3) + (q * a + a @ a / 2) / (q * q + square / 4), out)


def dpade22inv(u: ArrayLike, v: ArrayLike, out: Array | None = None) -> Array:
    """Return dpade22_u⁻¹(v) = (1 − α²/12) v − u × v/2 + (1 + α²/6)/(12 + α²) (u·v) u, α = |u|, shape (..., 3).

    Right-trivialised.
    """
    a, b = _both(u, v)
    with np.errstate(over="ignore", invalid="ignore"):  # told by into
        square, dot = (a * a).sum(-1, keepdims=True), (a * b).sum(-1, keepdims=True)
        found = (1 - square / 12) * b - np.cross(a, b) / 2 + (1 + square / 6) / (12 + square) * dot * a
    return into(found, out)


def as_quaternion(r: Matrices, out: Array | None = None, *, scalar_first: Flag) -> Array:
    """Return unit quaternions (..., 4) of rotations; of q and −q the one with a real part ≥ 0.

    ``scalar_first`` has no default, because programs differ: True for (w, x, y, z), False for (x, y, z, w).
    """
    u = log(r)
    half = 0.5 * np.linalg.norm(u, axis=-1, keepdims=True)
    vector = 0.5 * np.sinc(half / np.pi) * u
    return into(np.concatenate([np.cos(half), vector] if scalar_first else [vector, np.cos(half)], axis=-1), out)


def from_quaternion(q: ArrayLike, out: Array | None = None, *, scalar_first: Flag) -> Array:
    """Return the rotations (..., 3, 3) of unit quaternions (..., 4). They are normalised if they are off by at most 1e-6."""
    a = elements("q", q, (4,))
    norm = np.linalg.norm(a, axis=-1, keepdims=True)
    first("q", np.abs(norm[..., 0] - 1.0) > MEMBERSHIP, "a quaternion of another length", "length 1")
    w, x, y, z = np.moveaxis(a / norm, -1, 0) if scalar_first else np.moveaxis(np.roll(a / norm, 1, -1), -1, 0)
    return into(_of_quaternion(w, x, y, z), out)


def _of_quaternion(w: Array, x: Array, y: Array, z: Array) -> Array:
    """The rotations of the parts of unit quaternions."""
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def hat(u: ArrayLike, out: Array | None = None) -> Array:
    """Return û, the skew matrices with û x = u × x, shape (..., 3, 3)."""
    a = elements("u", u, (3,))
    found = np.zeros(a.shape + (3,))
    found[..., 2, 1], found[..., 0, 2], found[..., 1, 0] = a[..., 0], a[..., 1], a[..., 2]
    found[..., 1, 2], found[..., 2, 0], found[..., 0, 1] = -a[..., 0], -a[..., 1], -a[..., 2]
    return into(found, out)


def vee(m: ArrayLike, out: Array | None = None) -> Array:
    """Return the vectors u of skew matrices m = û, shape (..., 3): u = (m₃₂, m₁₃, m₂₁).

    m is skew to 1e-6 of its largest entry; of a product that is skew only to rounding the skew part is ½(m − mᵀ).
    """
    a = elements("m", m, (3, 3))
    off = np.abs(a + np.swapaxes(a, -1, -2)).max((-1, -2), initial=0.0)
    first("m", off > MEMBERSHIP * np.abs(a).max((-1, -2), initial=0.0), "a matrix with m + mᵀ ≠ 0", "a skew matrix")
    return into(np.stack([a[..., 2, 1], a[..., 0, 2], a[..., 1, 0]], axis=-1), out)


def Ad(r: Matrices, u: ArrayLike, out: Array | None = None) -> Array:
    """Return Ad_R u = R u, shape (..., 3)."""
    a, b = pair("r", _rotations("r", r), 2, "u", elements("u", u, (3,)), 1)
    return into((a @ b[..., None])[..., 0], out)


def ad(u: ArrayLike, v: ArrayLike, out: Array | None = None) -> Array:
    """Return ad_u v = u × v, shape (..., 3)."""
    return into(np.cross(*_both(u, v)), out)


def coad(u: ArrayLike, m: ArrayLike, out: Array | None = None) -> Array:
    """Return ad*_u m = m × u, with ⟨m, v⟩ = m·v, shape (..., 3). Euler's equations are ṁ = ad*_ω m = m × ω.

    A run with ``action="coadjoint"`` solves ẏ = −ad*_f y = f × y, so that a body has f = −ω.
    """
    a, b = _both(u, m, "m")
    return into(np.cross(b, a), out)


def contains(r: Matrices, tol: Real = 1e-12) -> NDArray[np.bool_]:
    """Return True for each matrix with ‖RᵀR − 𝟙‖ ≤ tol (Frobenius) and det R > 0, shape (...)."""
    a = elements("r", r, (3, 3), check=False)
    with np.errstate(invalid="ignore", over="ignore"):
        gram = np.swapaxes(a, -1, -2) @ a - np.eye(3)
        return np.asarray((np.sqrt((gram**2).sum((-1, -2))) <= tol) & (np.linalg.det(a) > 0))


def project(x: ArrayLike, out: Array | None = None) -> Array:
    """Return the rotation nearest to each matrix (Frobenius), shape (..., 3, 3).

    It is U diag(1, 1, det UVᵀ) Vᵀ with the singular value decomposition x = U S Vᵀ.
    """
    a = elements("x", x, (3, 3))
    u, _, vt = np.linalg.svd(a)
    u[..., :, 2] *= np.where(np.linalg.det(u @ vt) < 0, -1.0, 1.0)[..., None]
    return into(u @ vt, out)


def random(size: Whole | Sequence[Whole] | None = None, rng: Any = None) -> Array:
    """Return random rotations by Haar's measure, shape size + (3, 3). ``rng`` is as in numpy.random.default_rng."""
    q = np.random.default_rng(rng).standard_normal(leading(size) + (4,))
    w, x, y, z = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    return _of_quaternion(w, x, y, z)


def as_rotation(r: Matrices) -> Any:
    """Return SciPy's Rotation of matrices (..., 3, 3)."""
    from scipy.spatial.transform import Rotation  # type: ignore[import-untyped, import-not-found, unused-ignore]

    return Rotation.from_matrix(_rotations("r", r))


def from_rotation(rotation: Any) -> Array:
    """Return the matrices (..., 3, 3) of SciPy's Rotation."""
    return np.asarray(rotation.as_matrix())
