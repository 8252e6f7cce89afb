"""Arrays from arguments: real numbers in C order, or a TypeError that names the argument."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import ArgumentError

__all__ = ["real", "together", "value", "what"]


def what(x: Any) -> str:
    """Describe a value that is no array of real numbers."""
    if x is None:
        return "None"
    if isinstance(x, np.ndarray):
        return f"an array of {x.dtype}"
    if isinstance(x, (str, bytes)):
        return f"the text {x!r}"
    return f"a value of type {type(x).__name__}"


def real(name: str, x: Any) -> NDArray[np.float64]:
    """Return x as an array of float64 in C order. Raise TypeError if it has other things than real numbers."""
    try:
        array = np.asarray(x)
    except ValueError:
        raise TypeError(f"{name}: rows of different lengths, expected real numbers in an array") from None
    if array.dtype.kind not in "fiub":
        if array.size == 0 and array.dtype.kind == "O" and x is not None:
            array = array.astype(float)
        else:
            found = f"complex numbers ({array.dtype})" if array.dtype.kind == "c" else what(x)
            raise TypeError(f"{name}: {found}, expected real numbers")
    array = np.asarray(array, dtype=np.float64)
    if not (array.flags.c_contiguous and array.flags.aligned and type(array) is np.ndarray):
        array = np.array(array, dtype=np.float64, order="C", copy=True, subok=False)
    return array


def value(name: str, x: Any, shape: tuple[int, ...], t: float) -> NDArray[np.float64]:
    """Return the value of a function of the user at t. Raise TypeError if it has another shape."""
    expected = "one number" if shape == () else f"{'real numbers of ' if len(shape) > 1 else ''}shape {shape}"
    if len(shape) == 1:
        expected = f"{shape[0]} numbers"
    try:
        array = real(name, x)
    except TypeError:
        raise TypeError(f"{name} returned {what(x)} at t = {t}, expected {expected}") from None
    if shape == () and array.size == 1:
        array = array.reshape(())
    if array.shape != shape:
        raise TypeError(f"{name} returned an array of shape {array.shape} at t = {t}, expected {expected}")
    return array


def together(
    name_a: str, a: NDArray[np.float64], tail_a: int, name_b: str, b: NDArray[np.float64], tail_b: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Broadcast the leading axes of two arrays."""
    lead_a, lead_b = a.shape[: a.ndim - tail_a], b.shape[: b.ndim - tail_b]
    try:
        lead = np.broadcast_shapes(lead_a, lead_b)
    except ValueError:
        raise ArgumentError(
            name_b, f"leading axes {lead_b}", f"axes that broadcast with {lead_a} of {name_a}"
        ) from None
    wide_a = np.broadcast_to(a, lead + a.shape[a.ndim - tail_a :])
    wide_b = np.broadcast_to(b, lead + b.shape[b.ndim - tail_b :])
    return np.ascontiguousarray(wide_a), np.ascontiguousarray(wide_b)
