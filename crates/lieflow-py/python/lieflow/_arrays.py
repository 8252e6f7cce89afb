"""Arguments: arrays of real numbers, single numbers, or an error that names the argument."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Callable, Sequence
from fractions import Fraction
from numbers import Real
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._errors import ArgumentError
from ._types import Matrices, Whole

__all__ = [
    "common", "complex_numbers", "elements", "finite", "first", "into", "is_masked", "kept", "leading", "MEMBERSHIP",
    "name_of", "near", "number", "own", "pair", "read_only", "real", "series", "size_of_elements", "together", "value", "what", "whole", "wrong_out",
]

Array = NDArray[np.float64]
T = TypeVar("T")

#: Beyond this k the coefficients B_k/k! are 0 in float64.
COEFFICIENTS = 410

#: How far matrices may be from an algebra or from a group, relative to their size.
MEMBERSHIP = 1e-6
#: How many things a cache keeps.
KEPT = 64


def what(x: Any) -> str:
    """Describe a value that is no array of real numbers."""
    if x is None:
        return "None"
    if isinstance(x, (str, bytes)):
        return f"the text {x!r}"
    if isinstance(x, (list, tuple)):
        try:
            x = np.asarray(x)
        except ValueError:
            return "rows of different lengths"
    if _is_real(x) and sys.float_info.max < abs(x) < math.inf:
        return "a number beyond the range of float64"
    if not isinstance(x, np.ndarray):
        return f"a value of type {type(x).__name__}"
    if is_masked(x):
        return "an array with a masked entry"
    if x.dtype.kind == "c":
        return f"complex numbers (an array of {x.dtype})"
    if x.dtype.kind in "US":
        return f"texts, such as {x.flat[0]!s:.20}" if x.size else "texts"
    if x.dtype.kind == "O":
        others = [entry for entry in x.flat if not _is_real(entry)]
        return f"an array with {what(others[0])}" if others else "a number beyond the range of float64"
    return f"an array of {x.dtype}"


def _is_real(x: Any) -> bool:
    return isinstance(x, Real) and not isinstance(x, str)


def is_masked(x: Any) -> bool:
    """Is x an array with an entry that does not count?"""
    return isinstance(x, np.ndarray) and type(x) is not np.ndarray and bool(np.ma.is_masked(x))


def _numbers(x: Any) -> Array | None:
    """Return x as an array of float64 in C order, or None if it has other things than real numbers."""
    if is_masked(x):
        return None
    if hasattr(x, "as_matrix"):  # SciPy's Rotation and RigidTransform
        x = x.as_matrix()
    try:
        array = np.asarray(x)
        # Integers of any size and fractions are objects.
        if array.dtype.kind == "O" and x is not None and all(map(_is_real, array.flat)):
            array = array.astype(np.float64)
    except (ValueError, OverflowError):
        return None
    if array.dtype.kind not in "fiub":
        return None
    array = np.asarray(array, dtype=np.float64)
    if not (array.flags.c_contiguous and array.flags.aligned and type(array) is np.ndarray):
        array = np.array(array, dtype=np.float64, order="C", copy=True, subok=False)
    return array


def quaternions(rotation: Any) -> Any:
    """Return the quaternions of SciPy's Rotation, the real part first."""
    return np.roll(rotation.as_quat(), 1, axis=-1)


def real(name: str, x: Any) -> Array:
    """Return x as an array of float64 in C order. Raise TypeError if it has other things than real numbers."""
    array = _numbers(x)
    if array is None:
        raise TypeError(f"{name}: {what(x)}, expected real numbers in an array")
    return array


def complex_numbers(name: str, x: Any) -> NDArray[np.complex128]:
    """Return x as an array of complex128 in C order. Raise TypeError if it has other things than numbers."""
    try:
        array = np.asarray(x)
    except ValueError:
        array = real(name, x)  # rows of different lengths: it raises
    if array.dtype.kind not in "cfiub" or is_masked(x):
        raise TypeError(f"{name}: {what(x)}, expected complex numbers")
    array = np.asarray(array, dtype=np.complex128, order="C")
    return array if array.flags.aligned else array.copy()


def own(name: str, x: Any) -> Array:
    """Return x as an array of real numbers that nobody else can change."""
    return read_only(np.array(real(name, x)))


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a new array so that nobody can change it. It is a view: NumPy lets the flag of an owner be set again."""
    array.flags.writeable = False
    return array.view()


def number(name: str, x: Any) -> float:
    """Return x as one real number."""
    if x is None or isinstance(x, (str, bytes, complex)):
        raise TypeError(f"{name}: {x!r}, expected a number")
    array = real(name, x)
    if array.ndim > 0:
        raise ArgumentError(name, f"shape {array.shape}", "one number")
    return float(array)


def name_of(argument: str, x: Any) -> str:
    """Return x as a name."""
    if not isinstance(x, str):
        raise TypeError(f"{argument}: a value of type {type(x).__name__}, expected a name")
    return x


def whole(name: str, x: Any, least: int = 0, most: int = 2**63 - 1) -> int:
    """Return x as an integer from ``least`` to ``most``."""
    if isinstance(x, (bool, np.bool_)):
        raise TypeError(f"{name}: {x!r}, expected a number")
    found = x if isinstance(x, int) else number(name, x)
    if not least <= found <= most or found != int(found):
        raise ArgumentError(name, repr(x), f"an integer from {least} to {most}" if found > most else f"an integer ≥ {least}")
    return int(found)


def value(name: str, x: Any, shape: tuple[int, ...], t: float) -> Array:
    """Return the value of a function of the user at t. Raise TypeError if it has another shape."""
    expected = "one number" if shape == () else f"{'real numbers of ' if len(shape) > 1 else ''}shape {shape}"
    if len(shape) == 1:
        expected = f"{shape[0]} numbers"
    array = _numbers(x)
    if array is None:
        raise TypeError(f"{name} returned {what(x)} at t = {t}, expected {expected}")
    if shape == () and array.size == 1:
        array = array.reshape(())
    if array.shape != shape:
        raise TypeError(f"{name} returned an array of shape {array.shape} at t = {t}, expected {expected}")
    return array


def first(name: str, wrong: NDArray[np.bool_], value: str, expected: str) -> None:
    """Raise ArgumentError for the first element that is wrong."""
    if wrong.any():
        place = [str(int(i)) for i in np.argwhere(wrong)[0]]
        raise ArgumentError(f"{name}[{', '.join(place)}]" if place else name, value, expected)


def size_of_elements(g: NDArray[Any]) -> Array:
    """Return max(1, ‖g‖²) of each matrix (Frobenius): distances from a group are relative to it."""
    with np.errstate(over="ignore"):
        return np.asarray(np.maximum(1.0, np.linalg.norm(g, axis=(-1, -2)) ** 2))


def near(name: str, off: Array, size: Array, words: tuple[str, str]) -> None:
    """Raise ArgumentError for the first element that is off by more than MEMBERSHIP times its size.

    ``words`` are what it is far from, and what was expected.
    """
    wrong = np.asarray(~((off <= MEMBERSHIP * size) & (off < np.inf)))
    if wrong.any():
        far, of = (float(np.asarray(x)[wrong][0]) for x in (off, size))
        distance = far / of if far < math.inf else math.inf
        value = f"a matrix at a relative distance of {distance:.1e} from {words[0]}"
        first(name, wrong, value, f"{words[1]} to {MEMBERSHIP:g}")


def finite(name: str, x: NDArray[Any], tail: int = 0) -> None:
    """Raise ArgumentError for the first element, with so many last axes, that has a number that is not finite."""
    bad = ~np.isfinite(x)
    if bad.any():
        first(name, bad.any(axis=tuple(range(-tail, 0))), "a number that is not finite", "finite numbers")


def into(found: NDArray[Any], out: NDArray[Any] | None) -> NDArray[Any]:
    """Return ``out`` with the numbers of ``found``, or ``found`` without it. They may share memory with arguments.

    The arguments were finite: a number that is not is one beyond the range of float64.
    """
    if not np.isfinite(found).all():
        raise ArgumentError("result", "a number that is not finite", "arguments whose products are in the range of float64")
    if out is None:
        return found
    kind = isinstance(out, np.ndarray) and out.dtype == found.dtype and out.shape == found.shape
    if not (kind and out.flags.c_contiguous and out.flags.writeable):
        raise wrong_out(out, found.dtype, found.shape)
    out[...] = found
    return out


def wrong_out(out: Any, dtype: Any, shape: tuple[int, ...]) -> ArgumentError:
    """Return the error of an ``out`` that cannot take numbers of this type and shape."""
    if not isinstance(out, np.ndarray):
        described = f"a value of type {type(out).__name__}"
    elif out.dtype != dtype:
        described = f"an array of {out.dtype}"
    elif out.shape != shape:
        described = f"shape {out.shape}"
    elif not out.flags.c_contiguous:
        described = "an array that is not in C order"
    else:
        described = "an array that is not aligned" if out.flags.writeable else "a read-only array"
    return ArgumentError("out", described, f"a writeable array of {dtype} in C order, shape {shape}")


def leading(size: Whole | Sequence[Whole] | None) -> tuple[int, ...]:
    """Return the leading axes of random elements: none, one or several."""
    if size is None:
        return ()
    try:
        axes = (operator.index(size),) if hasattr(size, "__index__") else tuple(map(operator.index, size))
    except TypeError:
        raise TypeError(f"size: {size!r}, expected an integer or a tuple of integers") from None
    if any(n < 0 for n in axes):
        raise ArgumentError("size", repr(size), "integers ≥ 0")
    return axes


def kept(cache: dict[Any, T], key: Any, make: Callable[[], T]) -> T:
    """Return ``cache[key]``, which is made where it is not there. A full cache begins again."""
    found = cache.get(key)
    if found is None:
        found = make()
        if len(cache) >= KEPT:
            cache.clear()
        cache[key] = found
    return found


def series(ad: Callable[[Any, Any], Any], u: Any, v: Any, q: int) -> Any:
    """Return Σ B_k/k! ad_u^k v up to k = q, with the Bernoulli numbers B_0 = 1, B_1 = −1/2, …"""
    total, term = v + 0.0 * u, v
    with np.errstate(over="ignore", invalid="ignore"):  # told below
        for k in range(1, min(q, COEFFICIENTS) + 1):
            term = ad(u, term)
            if k == 1 or k % 2 == 0:
                total = total + baker(k) * term
    if not np.isfinite(total).all():
        raise ArgumentError("u", f"a sum up to q = {q} that is not finite", "a smaller u, or no q")
    return total


#: The first coefficients of the series, when they are asked for.
_BAKER: dict[int, list[float]] = {}


def first_coefficients(count: int) -> list[float]:
    """Return B_k/k! for k = 0, 1, …"""
    b: list[Fraction] = []
    for k in range(count):
        b.append(Fraction(1) if k == 0 else -sum((math.comb(k + 1, j) * b[j] for j in range(k)), Fraction(0)) / (k + 1))
    return [float(x / math.factorial(k)) for k, x in enumerate(b)]


def baker(k: int) -> float:
    """Return B_k/k!; from k = 60 on, for even k, 2(−1)^(k/2 + 1)/(2π)^k, where ζ(k) is 1."""
    if k < 60:
        return kept(_BAKER, 60, lambda: first_coefficients(60))[k]
    return (2.0 if k % 4 == 2 else -2.0) * (2.0 * math.pi) ** -k


def common(
    name_a: str, a: NDArray[Any], tail_a: int, name_b: str, b: NDArray[Any], tail_b: int
) -> tuple[int, ...]:
    """Return the leading axes of two arrays together. Raise ArgumentError if they do not broadcast."""
    lead_a, lead_b = a.shape[: a.ndim - tail_a], b.shape[: b.ndim - tail_b]
    try:
        return np.broadcast_shapes(lead_a, lead_b)
    except ValueError:
        raise ArgumentError(
            name_b, f"leading axes {lead_b}", f"axes that broadcast with {lead_a} of {name_a}"
        ) from None


def pair(
    name_a: str, a: NDArray[Any], tail_a: int, name_b: str, b: NDArray[Any], tail_b: int
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return two arrays, whose leading axes broadcast."""
    common(name_a, a, tail_a, name_b, b, tail_b)
    return a, b


def together(name_a: str, a: Array, tail_a: int, name_b: str, b: Array, tail_b: int) -> tuple[Array, Array]:
    """Broadcast the leading axes of two arrays."""
    lead = common(name_a, a, tail_a, name_b, b, tail_b)
    wide_a = np.broadcast_to(a, lead + a.shape[a.ndim - tail_a :])
    wide_b = np.broadcast_to(b, lead + b.shape[b.ndim - tail_b :])
    return np.ascontiguousarray(wide_a), np.ascontiguousarray(wide_b)


def elements(name: str, x: Matrices, tail: tuple[int, ...], check: bool = True) -> Array:
    """Return x as elements with these last axes; with ``check`` their numbers must be finite."""
    array = real(name, x)
    if array.ndim < len(tail) or array.shape[array.ndim - len(tail) :] != tail:
        raise ArgumentError(name, f"shape {array.shape}", f"shape (..., {', '.join(map(str, tail))})")
    if check:
        finite(name, array, len(tail))
    return array
