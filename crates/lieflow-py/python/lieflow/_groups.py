"""Groups of matrices, and exp of matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._arrays import real
from ._errors import ArgumentError

__all__ = ["GL", "Gm", "Group", "SO", "Sp", "expm"]

Array = NDArray[np.float64]


class Group:
    """A group of n×n matrices with its maps on arrays of shape (..., n, n). Leading axes broadcast.

    :func:`lieflow.SO`, :func:`lieflow.GL`, :func:`lieflow.Sp` and :func:`lieflow.Gm` make it. Arguments are checked to be
    in 𝔤 or in G. Errors: :class:`lieflow.ArgumentError` with the place of the matrix, TypeError.

    ========================  ====================================================
    ``exp(u)``, ``log(g)``    the exponential and its inverse
    ``cay(u), cay_inv(g)``    (𝟙 − u/2)⁻¹(𝟙 + u/2) and its inverse (not for GL)
    ``dexp(u, v)``            d/dε exp(u + εv) = dexp_u(v) exp(u)
    ``dexpinv(u, v)``         its inverse
    ``dcay(u, v)``            (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹
    ``dcayinv(u, v)``         (𝟙 − u/2) v (𝟙 + u/2)
    ``project(x)``            the element of 𝔤 nearest to x (Frobenius)
    ========================  ====================================================

    All take ``out=``, an array of float64 in C order.
    """

    __slots__ = ("_args", "_group", "cay", "cay_inv", "dcay", "dcayinv", "dexp", "dexpinv", "exp", "log", "project")

    def __init__(self, family: str, n: int, q: int = 0, form: Array | None = None) -> None:
        self._args = (family, n, q, form)
        flat = None if form is None else [float(x) for x in form.ravel()]
        group = self._group = _lieflow.MatrixGroup(family, n, q, flat)
        self.exp, self.log, self.cay, self.cay_inv = group.exp, group.log, group.cay, group.cay_inv
        self.dexp, self.dexpinv, self.dcay, self.dcayinv = group.dexp, group.dexpinv, group.dcay, group.dcayinv
        self.project = group.project

    @property
    def name(self) -> str:
        """The name, such as ``SO(4)``."""
        return self._group.name

    @property
    def n(self) -> int:
        """The size of the matrices."""
        return self._group.n

    @property
    def dim(self) -> int:
        """The dimension of the group."""
        return self._group.dim

    def __repr__(self) -> str:
        family, n, q, form = self._args
        if family == "gm" and form is not None:
            return f"lieflow.Gm({form.tolist()})"
        return f"lieflow.{ {'so': 'SO', 'sp': 'Sp', 'gl': 'GL'}[family] }({n}{f', {q}' if q else ''})"

    def __reduce__(self) -> tuple[type[Group], tuple[str, int, int, Array | None]]:
        return (Group, self._args)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Group):
            return NotImplemented
        mine, theirs = self._args, other._args
        return mine[:3] == theirs[:3] and np.array_equal(np.asarray(mine[3]), np.asarray(theirs[3]))

    def __hash__(self) -> int:
        return hash(self._args[:3])

    def _matrices(self, name: str, x: ArrayLike) -> Array:
        array = real(name, x)
        if array.shape[-2:] != (self.n, self.n):
            raise ArgumentError(name, f"shape {array.shape}", f"shape (..., {self.n}, {self.n})")
        return array

    def ccsk(self, u: ArrayLike, out: Array | None = None, *, order: str = "123") -> Array:
        """Return canonical coordinates of the second kind, in the order "123" or "321".

        On SO(n) a product of plane rotations, on GL(n) and Sp(n) of triangular matrices; a general G_M has none.
        """
        return self._group.ccsk(u, order, out)

    def Ad(self, g: ArrayLike, u: ArrayLike) -> Array:
        """Return Ad_g u = g u g⁻¹."""
        a, b = self._matrices("g", g), self._matrices("u", u)
        return np.asarray(np.linalg.solve(np.swapaxes(a, -1, -2), np.swapaxes(a @ b, -1, -2)).swapaxes(-1, -2))

    def ad(self, u: ArrayLike, v: ArrayLike) -> Array:
        """Return ad_u v = uv − vu."""
        a, b = self._matrices("u", u), self._matrices("v", v)
        return np.asarray(a @ b - b @ a)

    def coad(self, u: ArrayLike, m: ArrayLike) -> Array:
        """Return ad*_u m = uᵀm − muᵀ, with ⟨m, v⟩ = tr(mᵀv)."""
        a, b = self._matrices("u", u).swapaxes(-1, -2), self._matrices("m", m)
        return np.asarray(a @ b - b @ a)

    def contains(self, g: ArrayLike, tol: float = 1e-12) -> NDArray[np.bool_]:
        """Return True for each matrix with ‖gᵀMg − M‖ ≤ tol (Frobenius), and for SO(n) with det g > 0."""
        return np.asarray(self._group.defect(g) <= tol)

    def random(self, size: int | tuple[int, ...] | None = None, rng: Any = None) -> Array:
        """Return random elements, shape size + (n, n). On SO(n) they have Haar's measure."""
        lead = () if size is None else (size,) if isinstance(size, int) else tuple(size)
        seed = int(np.random.default_rng(rng).integers(0, 2**63))
        count = int(np.prod(lead, dtype=int))
        return self._group.random(count, seed).reshape(*lead, self.n, self.n)


def SO(n: int, q: int = 0) -> Group:
    """Return SO(n), gᵀg = 𝟙 and det g = 1; or SO(n, q), gᵀMg = M with M = diag(1, …, −1) and n ones."""
    return Group("so", n, q)


def GL(n: int) -> Group:
    """Return GL(n), all invertible matrices."""
    return Group("gl", n)


def Sp(n: int) -> Group:
    """Return Sp(n) for even n = 2m, gᵀJg = J with J = [0 𝟙; −𝟙 0]."""
    return Group("sp", n)


def Gm(M: ArrayLike) -> Group:
    """Return G_M = {g : gᵀMg = M} for an invertible real M."""
    form = real("M", M)
    if form.ndim != 2 or form.shape[0] != form.shape[1]:
        raise ArgumentError("M", f"shape {form.shape}", "a square matrix")
    return Group("gm", form.shape[0], 0, form)


def expm(
    A: ArrayLike, structure: str | None = None, threads: int = 1, out: NDArray[Any] | None = None
) -> NDArray[Any]:
    """Return exp of each matrix of A, shape (..., n, n), float64 or complex128.

    With ``structure="skew"`` the matrices must be skew-symmetric or skew-Hermitian; then the result is orthogonal or
    unitary to rounding at every norm. Up to n = 6 many matrices are computed in SIMD lanes. ``threads`` divides the real
    matrices among threads. Errors: :class:`lieflow.ArgumentError` with the place of a matrix that has no exponential.
    Relative error: a small multiple of ε times the condition number of exp.
    """
    try:
        array = A if isinstance(A, np.ndarray) else np.asarray(A)
    except ValueError:
        array = real("A", A)  # rows of different lengths: it raises
    if array.dtype.kind != "c":
        return _lieflow.expm(A, structure, threads, out)
    value = _lieflow.expm_complex(np.array(array, dtype=np.complex128, order="C"), structure)
    if out is None:
        return value
    if not isinstance(out, np.ndarray) or out.dtype != np.complex128 or out.shape != value.shape:
        raise ArgumentError("out", "another type or shape", f"an array of complex128, shape {value.shape}")
    out[...] = value
    return out
