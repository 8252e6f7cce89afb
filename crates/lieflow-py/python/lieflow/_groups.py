"""Groups of matrices, and exp of matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._arrays import Array, complex_numbers, elements, into, leading, near, number, own, pair, real, size_of_elements, what, whole
from ._errors import ArgumentError
from ._types import Matrices, Real, Whole

__all__ = ["GL", "Gm", "Group", "SL", "SO", "Sp", "expm"]


class Group:
    """A group of n×n matrices with its maps on arrays of shape (..., n, n). Leading axes broadcast.

    :func:`lieflow.SO`, :func:`lieflow.GL`, :func:`lieflow.SL`, :func:`lieflow.Sp` and :func:`lieflow.Gm` make it. Arguments
    must be in 𝔤 or in G to 1e-6 of their size; the maps take the element of 𝔤 that is nearest. Errors: :class:`lieflow.ArgumentError` with the place of the matrix, TypeError.

    ========================  ====================================================
    ``exp(u)``, ``log(g)``    the exponential and its inverse
    ``cay(u), cay_inv(g)``    (𝟙 − u/2)⁻¹(𝟙 + u/2) and its inverse; see SL
    ``dexp(u, v)``            d/dε exp(u + εv) = dexp_u(v) exp(u)
    ``dexpinv(u, v, q=)``     its inverse, or the series of it up to k = q
    ``dcay(u, v)``            (𝟙 − u/2)⁻¹ v (𝟙 + u/2)⁻¹
    ``dcayinv(u, v)``         (𝟙 − u/2) v (𝟙 + u/2)
    ``project(x)``            the element of 𝔤 nearest to x (Frobenius)
    ========================  ====================================================

    All take ``out=``, an array of float64 in C order.
    Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    """

    __slots__ = ("_args", "_group", "cay", "cay_inv", "dcay", "dcayinv", "dexp", "exp", "log", "project")

    def __init__(self, family: str, n: int, q: int = 0, form: Array | None = None) -> None:
        form = None if form is None else own("M", form)
        self._args = (family, n, q, form)
        flat = None if form is None else [float(x) for x in form.ravel()]
        group = self._group = _lieflow.MatrixGroup(family, n, q, flat)
        self.exp, self.log, self.cay, self.cay_inv = group.exp, group.log, group.cay, group.cay_inv
        self.dexp, self.dcay, self.dcayinv = group.dexp, group.dcay, group.dcayinv
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
        return f"lieflow.{ {'so': 'SO', 'sp': 'Sp', 'gl': 'GL', 'sl': 'SL'}[family] }({n}{f', {q}' if q else ''})"

    def __reduce__(self) -> tuple[type[Group], tuple[str, int, int, Array | None]]:
        return (Group, self._args)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Group):
            return NotImplemented
        mine, theirs = self._args, other._args
        return mine[:3] == theirs[:3] and np.array_equal(np.asarray(mine[3]), np.asarray(theirs[3]))

    def __hash__(self) -> int:
        return hash(self._args[:3])

    def _algebra(self, name: str, x: ArrayLike) -> Array:
        """Elements of 𝔤."""
        u = elements(name, x, (self.n, self.n))
        off = np.abs(u - self.project(u)).max((-1, -2), initial=0.0)
        size = np.abs(u).max((-1, -2), initial=0.0)
        near(name, off, size, (f"the algebra of {self.name}", "an element of it"))
        return u

    def _element(self, name: str, x: Matrices) -> Array:
        """Elements of the group."""
        g = elements(name, x, (self.n, self.n))
        near(name, self._group.defect(g) / self._scale, size_of_elements(g), (self.name, "an element of it"))
        return g

    @property
    def _scale(self) -> float:
        """The largest entry of M, which distances from the group are relative to."""
        form = self._args[3]
        return 1.0 if form is None else float(np.abs(form).max())

    def dexpinv(self, u: ArrayLike, v: ArrayLike, out: Array | None = None, *, q: Whole | None = None) -> Array:
        """Return dexp_u⁻¹(v), the inverse of dexp_u; right-trivialised.

        With q, the series Σ_k B_k/k! ad_u^k v is cut after k = q. Shapes: (..., n, n); leading axes broadcast.
        Errors: ArgumentError for what is not in 𝔤, and next to eigenvalues 2πik of ad_u, k ≠ 0, where dexp_u is singular.
        """
        return self._group.dexpinv(u, v, None if q is None else whole("q", q), out)

    def ccsk(self, u: ArrayLike, out: Array | None = None, *, order: str = "123") -> Array:
        """Return canonical coordinates of the second kind, in the order "123" or "321".

        On SO(n) a product of plane rotations, on GL(n) and Sp(n) of triangular matrices; a general G_M has none.
        """
        return self._group.ccsk(u, order, out)

    def Ad(self, g: Matrices, u: ArrayLike, out: Array | None = None) -> Array:
        """Return Ad_g u = g u g⁻¹, shape (..., n, n)."""
        a, b = pair("g", self._element("g", g), 2, "u", self._algebra("u", u), 2)
        found = np.linalg.solve(np.swapaxes(a, -1, -2), np.swapaxes(a @ b, -1, -2))
        return into(np.ascontiguousarray(found.swapaxes(-1, -2)), out)

    def ad(self, u: ArrayLike, v: ArrayLike, out: Array | None = None) -> Array:
        """Return ad_u v = uv − vu, shape (..., n, n)."""
        a, b = pair("u", self._algebra("u", u), 2, "v", self._algebra("v", v), 2)
        with np.errstate(over="ignore", invalid="ignore"):
            found = a @ b - b @ a
        return into(self.project(into(found, None)), out)  # without the rounding off 𝔤

    def coad(self, u: ArrayLike, m: ArrayLike, out: Array | None = None) -> Array:
        """Return ad*_u m = uᵀm − muᵀ, with ⟨m, v⟩ = tr(mᵀv), shape (..., n, n).

        A run with ``action="coadjoint"`` solves ẏ = −ad*_f y; a body has f = −ω.
        """
        a, b = pair("u", self._algebra("u", u), 2, "m", elements("m", m, (self.n, self.n)), 2)
        a = a.swapaxes(-1, -2)
        return into(a @ b - b @ a, out)

    def contains(self, g: Matrices, tol: Real = 1e-12) -> NDArray[np.bool_]:
        """Return True for each matrix with ‖gᵀMg − M‖ ≤ tol·max|Mᵢⱼ| (Frobenius).

        On SO(n) det g > 0, too, on SO(n, q) det g may be −1; on SL(n) |det g − 1| ≤ tol or 1e-10; on GL(n) g has an inverse.
        """
        return np.asarray(self._group.defect(g) <= tolerance(tol) * self._scale)

    def random(self, size: Whole | Sequence[Whole] | None = None, rng: Any = None) -> Array:
        """Return random elements, shape size + (n, n). On SO(n) they have Haar's measure."""
        lead = leading(size)
        seed = int(np.random.default_rng(rng).integers(0, 2**63))
        count = int(np.prod(lead, dtype=int))
        return self._group.random(count, seed).reshape(*lead, self.n, self.n)


def tolerance(tol: Any) -> float:
    """Return a tolerance of membership."""
    value = number("tol", tol)
    if not value >= 0:
        raise ArgumentError("tol", f"{value}", "a number of at least 0")
    return value


def size_of(name: str, n: Any, least: int = 1) -> int:
    """Return the size of a group."""
    if isinstance(n, bool) or not hasattr(n, "__index__"):
        raise TypeError(f"{name}: {what(n)}, expected an integer")
    return whole(name, n, least)


def SO(n: Whole, q: Whole = 0) -> Group:
    """Return SO(n), gᵀg = 𝟙 and det g = 1; or SO(n, q), gᵀMg = M with M = diag(1, …, −1) and n ones; det g may be −1."""
    q = size_of("q", q, 0)
    return Group("so", size_of("n", n, 0 if q else 1), q)


def GL(n: Whole) -> Group:
    """Return GL(n), all invertible matrices."""
    return Group("gl", size_of("n", n))


def SL(n: Whole) -> Group:
    """Return SL(n), the matrices with det g = 1. For n > 2 cay leaves it: det cay(u) is not 1, and most g are no cay(u)."""
    return Group("sl", size_of("n", n))


def Sp(n: Whole) -> Group:
    """Return Sp(n) for even n = 2m, gᵀJg = J with J = [0 𝟙; −𝟙 0]."""
    return Group("sp", size_of("n", n))


def Gm(M: ArrayLike) -> Group:
    """Return G_M = {g : gᵀMg = M} for an invertible real M.

    A symmetric or skew part of M that is 1e-10 of M or less is taken as rounding and left out.
    """
    form = real("M", M)
    if form.ndim != 2 or form.shape[0] != form.shape[1] or form.size == 0:
        raise ArgumentError("M", f"shape {form.shape}", "a square matrix")
    return Group("gm", form.shape[0], 0, form)


def expm(
    A: ArrayLike, structure: str | None = None, threads: Whole = 1, out: NDArray[Any] | None = None
) -> NDArray[Any]:
    """Return exp of each matrix of A, shape (..., n, n), float64 or complex128.

    With ``structure="skew"`` the matrices must be skew-symmetric or skew-Hermitian; then the result is orthogonal or
    unitary to rounding at every norm. Up to n = 6 many real matrices are computed in SIMD lanes. ``threads`` divides the
    matrices among threads; the result does not depend on it. Errors: :class:`lieflow.ArgumentError` with the place of a
    matrix that is not skew, where that is said, or has no exponential. Relative error: a small multiple of ε times the
    condition number of exp, except for matrices far from normal: where the powers of abs(A) are much larger than those of A,
    as for [[s, -s], [s, -s]], it is larger.
    """
    if type(threads) is not int or threads < 1:
        threads = whole("threads", threads, 1)
    try:
        array = A if isinstance(A, np.ndarray) else np.asarray(A)
    except ValueError:
        array = real("A", A)  # rows of different lengths: it raises
    if array.dtype.kind != "c":
        return _lieflow.expm(A, structure, threads, out)
    return into(_lieflow.expm_complex(complex_numbers("A", A), structure, threads), out)
