"""The group U(n) of unitary matrices, with complex arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import complex_numbers, finite, into, leading, near, pair, quaternions, series, size_of_elements, whole
from ._errors import ArgumentError
from ._groups import Group, expm, size_of, tolerance
from ._types import Real, Whole

__all__ = ["U", "ComplexPoints", "Unitary", "is_unitary_name"]

Complex = NDArray[np.complex128]


def _plain(name: str) -> str:
    """Return the name in lower case without parentheses and spaces."""
    return name.lower().replace("(", "").replace(")", "").replace(" ", "")


def is_unitary_name(name: str) -> bool:
    """Return True for ``U(n)``, ``SU(n)``, with or without n and parentheses."""
    return _plain(name).rstrip("0123456789") in ("u", "su")


def is_su2(name: str) -> bool:
    """Return True for ``SU(2)``, with or without parentheses."""
    return _plain(name) == "su2"


def four_numbers(y: Any) -> bool:
    """Return True for what has the shape of a quaternion."""
    try:
        return bool(np.shape(y) == (4,))
    except ValueError:  # rows of different lengths
        return False


def of_rotation(group: Any, y: Any) -> Any:
    """Return the quaternion of SciPy's Rotation, where the group is that of unit quaternions. Return another y as it is."""
    if hasattr(y, "as_quat") and isinstance(group, str) and _plain(group) in ("s3", "su2"):
        return quaternions(y)
    return y


class ComplexPoints:
    """Complex arrays as the pairs of real numbers that a run has."""

    __slots__ = ("point", "value")

    def __init__(self, point: tuple[int, ...] | None = None, value: tuple[int, ...] | None = None) -> None:
        self.point, self.value = point, value

    def split(self, y: NDArray[np.float64]) -> Complex:
        """Return complex numbers of real ones, whose last axis has Re and Im."""
        return np.ascontiguousarray(y).view(np.complex128)[..., 0]

    def join(self, name: str, x: Any, point: bool) -> NDArray[np.float64]:
        """Return the real numbers of a point, or of a value of f."""
        array, shape = complex_numbers(name, x), self.point if point else self.value
        if shape is not None and array.shape != shape:
            if point:
                raise ArgumentError(name, f"shape {array.shape}", f"shape {shape}")
            raise TypeError(f"{name}: an array of shape {array.shape}, expected complex numbers of shape {shape}")
        if point:
            finite(name, array)
        return array.reshape(*array.shape, 1).view(np.float64)


class ComplexState:
    """The complex array of a state of a problem, from the real numbers that a run integrates, and back.

    These are, column by column, a skew-Hermitian matrix as its real and then its imaginary part; [X; Y] of X + iY; or
    [X −Y; Y X].
    """

    __slots__ = ("by_parts", "shape", "size")

    def __init__(self, shape: tuple[int, ...], size: int, by_parts: bool) -> None:
        self.shape, self.size, self.by_parts = shape, size, by_parts

    def split(self, numbers: NDArray[np.float64]) -> Complex:
        """Return the complex array of the real numbers."""
        rows = self.shape[0]
        if self.by_parts:
            x, y = numbers.reshape(2, *self.shape[::-1]).swapaxes(1, 2)
        else:
            both = numbers.reshape(-1, 2 * rows).T[:, : int(np.prod(self.shape[1:]))]
            x, y = both[:rows].reshape(self.shape), both[rows:].reshape(self.shape)
        return np.asarray(x + 1j * y)

    def join(self, name: str, x: Any) -> NDArray[np.float64]:
        """Return the real numbers of a complex array."""
        z = complex_numbers(name, x)
        if z.shape != self.shape:
            raise ArgumentError(name, f"shape {z.shape}", f"shape {self.shape}")
        if self.by_parts:
            return np.concatenate([z.real.ravel("F"), z.imag.ravel("F")])
        if self.size == 4 * z.size:
            return _on_both_sides(z).ravel("F")
        return np.concatenate([z.real, z.imag]).ravel("F")


def _on_both_sides(x: Complex) -> NDArray[np.float64]:
    """[X −Y; Y X] of X + iY."""
    return np.concatenate(
        [np.concatenate([x.real, -x.imag], axis=-1), np.concatenate([x.imag, x.real], axis=-1)], axis=-2
    )


def _adjoint(x: Complex) -> Complex:
    return x.conj().swapaxes(-1, -2)


class Unitary:
    """The group U(n) with its maps on complex arrays of shape (..., n, n). Leading axes broadcast.

    :func:`lieflow.U` makes it. The maps are those of :class:`lieflow.Group`: ``exp``, ``log``, ``cay``, ``cay_inv``,
    ``dexp``, ``dexpinv``, ``dcay``, ``dcayinv``, ``Ad``, ``ad``, ``coad``, ``project``, ``contains``, ``random``. Elements
    of u(n) are skew-Hermitian. Arguments must be in u(n) or in U(n) to 1e-6 of their size. Physics writes exp(−iH) with a
    Hermitian H: here u = −iH. ``out=`` is an array of complex128 in C order. Differentials are right-trivialised.
    Errors: :class:`lieflow.ArgumentError` with the place of the matrix, TypeError.
    Source: A. Iserles, H. Munthe-Kaas, S. P. Nørsett, A. Zanna, Lie-group methods, Acta Numerica 9 (2000).
    """

    __slots__ = ("_n", "_real")

    def __init__(self, n: int) -> None:
        self._n, self._real = n, Group("u", n)

    @property
    def name(self) -> str:
        """The name, such as ``U(4)``."""
        return f"U({self._n})"

    @property
    def n(self) -> int:
        """The size of the matrices."""
        return self._n

    @property
    def dim(self) -> int:
        """The dimension of the group."""
        return self._n**2

    def __repr__(self) -> str:
        return f"lieflow.U({self._n})"

    def __reduce__(self) -> tuple[type[Unitary], tuple[int]]:
        return (Unitary, (self._n,))

    def __eq__(self, other: object) -> bool:
        return self._n == other._n if isinstance(other, Unitary) else NotImplemented

    def __hash__(self) -> int:
        return hash(("U", self._n))

    def _matrices(self, name: str, x: ArrayLike, check: bool = True) -> Complex:
        array = complex_numbers(name, x)
        if array.shape[-2:] != (self._n, self._n):
            raise ArgumentError(name, f"shape {array.shape}", f"shape (..., {self._n}, {self._n})")
        if check:
            finite(name, array, 2)
        return array

    def _algebra(self, name: str, x: ArrayLike) -> Complex:
        u = self._matrices(name, x)
        size = np.abs(u).max(axis=(-1, -2), initial=0.0)
        off = np.abs(u + _adjoint(u)).max(axis=(-1, -2), initial=0.0) / 2
        near(name, off, size, (f"the algebra of {self.name}", "a skew-Hermitian matrix, −iH of a Hermitian H"))
        return u

    def _element(self, name: str, x: ArrayLike) -> Complex:
        g = self._matrices(name, x)
        near(name, self.defect(g), size_of_elements(g), (self.name, "a unitary matrix"))
        return g

    def defect(self, g: ArrayLike) -> NDArray[np.float64]:
        """Return the distance ‖g†g − 1‖ of each matrix from U(n) (Frobenius)."""
        a = self._matrices("g", g, check=False)
        with np.errstate(invalid="ignore", over="ignore"):
            return np.asarray(np.linalg.norm(_adjoint(a) @ a - np.eye(self._n), axis=(-1, -2)))

    def _complex(self, x: NDArray[np.float64], out: Complex | None) -> Complex:
        n = self._n
        return into(x[..., :n, :n] + 1j * x[..., n:, :n], out)

    def exp(self, u: ArrayLike, out: Complex | None = None) -> Complex:
        """Return exp(u), unitary to rounding at every norm."""
        a = self._algebra("u", u)
        return np.asarray(expm((a - _adjoint(a)) / 2, structure="skew", out=out))

    def log(self, g: ArrayLike, out: Complex | None = None) -> Complex:
        """Return the principal logarithm, with eigenvalues in i[−π, π]: that of an eigenvalue −1 is iπ or −iπ."""
        return self._complex(self._real.log(_on_both_sides(self._element("g", g))), out)

    def cay(self, u: ArrayLike, out: Complex | None = None) -> Complex:
        """Return (1 − u/2)⁻¹(1 + u/2)."""
        return self._complex(self._real.cay(_on_both_sides(self._algebra("u", u))), out)

    def cay_inv(self, g: ArrayLike, out: Complex | None = None) -> Complex:
        """Return the u with cay(u) = g. An eigenvalue −1 of g is refused."""
        return self._complex(self._real.cay_inv(_on_both_sides(self._element("g", g))), out)

    def _two(self, f: Any, u: ArrayLike, v: ArrayLike, out: Complex | None) -> Complex:
        a, b = pair("u", self._algebra("u", u), 2, "v", self._algebra("v", v), 2)
        return self._complex(f(_on_both_sides(a), _on_both_sides(b)), out)

    def dexp(self, u: ArrayLike, v: ArrayLike, out: Complex | None = None) -> Complex:
        """Return dexp_u(v) with d/dε exp(u + εv) = dexp_u(v) exp(u)."""
        return self._two(self._real.dexp, u, v, out)

    def dexpinv(self, u: ArrayLike, v: ArrayLike, out: Complex | None = None, *, q: Whole | None = None) -> Complex:
        """Return the inverse of dexp_u, applied to v. With q, its series Σ_k B_k/k! ad_u^k v is cut after k = q."""
        if q is not None:
            a, b = pair("u", self._algebra("u", u), 2, "v", self._algebra("v", v), 2)
            return into(series(lambda x, y: x @ y - y @ x, a, b, whole("q", q)), out)
        return self._two(self._real.dexpinv, u, v, out)

    def dcay(self, u: ArrayLike, v: ArrayLike, out: Complex | None = None) -> Complex:
        """Return (1 − u/2)⁻¹ v (1 + u/2)⁻¹."""
        return self._two(self._real.dcay, u, v, out)

    def dcayinv(self, u: ArrayLike, v: ArrayLike, out: Complex | None = None) -> Complex:
        """Return (1 − u/2) v (1 + u/2)."""
        return self._two(self._real.dcayinv, u, v, out)

    def project(self, x: ArrayLike, out: Complex | None = None) -> Complex:
        """Return ½(x − x†), the element of u(n) nearest to x (Frobenius)."""
        a = self._matrices("x", x)
        return into((a - _adjoint(a)) / 2, out)

    def Ad(self, g: ArrayLike, u: ArrayLike, out: Complex | None = None) -> Complex:
        """Return Ad_g u = g u g†."""
        a, b = pair("g", self._element("g", g), 2, "u", self._algebra("u", u), 2)
        return into(a @ b @ _adjoint(a), out)

    def ad(self, u: ArrayLike, v: ArrayLike, out: Complex | None = None) -> Complex:
        """Return ad_u v = uv − vu."""
        a, b = pair("u", self._algebra("u", u), 2, "v", self._algebra("v", v), 2)
        with np.errstate(over="ignore", invalid="ignore"):
            found = a @ b - b @ a
        return self.project(into(found, None), out)  # without the rounding off u(n)

    def coad(self, u: ArrayLike, m: ArrayLike, out: Complex | None = None) -> Complex:
        """Return ad*_u m = u†m − mu†, with ⟨m, v⟩ = Re tr(m†v).

        A run with ``action="coadjoint"`` solves ẏ = −ad*_f y.
        """
        a, b = pair("u", self._algebra("u", u), 2, "m", self._matrices("m", m), 2)
        a = _adjoint(a)
        return into(a @ b - b @ a, out)

    def contains(self, g: ArrayLike, tol: Real = 1e-12) -> NDArray[np.bool_]:
        """Return True for each matrix with ‖g†g − 1‖ ≤ tol (Frobenius)."""
        return np.asarray(self.defect(g) <= tolerance(tol))

    def random(self, size: Whole | Sequence[Whole] | None = None, rng: Any = None) -> Complex:
        """Return random elements with Haar's measure, shape size + (n, n)."""
        generator, shape = np.random.default_rng(rng), (*leading(size), self._n, self._n)
        q, r = np.linalg.qr(generator.standard_normal(shape) + 1j * generator.standard_normal(shape))
        d = np.diagonal(r, axis1=-2, axis2=-1)
        return np.asarray(q * (d / np.abs(d))[..., None, :])


def U(n: Whole) -> Unitary:
    """Return U(n), g†g = 1, with complex arrays."""
    return Unitary(size_of("n", n))
