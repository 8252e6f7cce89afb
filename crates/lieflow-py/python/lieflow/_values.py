"""Values of keys: numbers, texts, lists and dicts, from arrays and what else users have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ._arrays import is_masked, quaternions, what

__all__ = ["alike", "is_complex", "part", "plain"]


def is_complex(x: Any) -> bool:
    """Is x a complex number, or are some in it?"""
    if isinstance(x, (list, tuple)):
        return any(is_complex(entry) for entry in x)
    return isinstance(x, complex) or hasattr(x, "__array__") and np.asarray(x).dtype.kind == "c"


def part(x: Any, name: str) -> Any:
    """Return the part ``"real"`` or ``"imag"`` of the numbers in x. What is no number, such as a formula, is real."""
    if isinstance(x, (list, tuple)):
        return [part(entry, name) for entry in x]
    if hasattr(x, "__array__") and not isinstance(x, np.ndarray):
        x = np.asarray(x)
    return getattr(x, name, x if name == "real" else 0.0)


def alike(x: Any) -> str:
    """Return a text that is the same for equal values: 1 and 1.0 are equal, 0.0 and -0.0 too."""
    if isinstance(x, (int, float)) and not isinstance(x, bool):
        return repr(float(x) + 0.0)  # −0.0 + 0.0 is 0.0
    if isinstance(x, dict):
        return f"{{{', '.join(f'{key}: {alike(x[key])}' for key in sorted(x))}}}"
    return f"[{', '.join(map(alike, x))}]" if isinstance(x, list) else repr(x)


def plain(name: str, x: Any) -> Any:
    """Return x as numbers, texts, lists and dicts. Raise TypeError for what is none of them."""
    if type(x) in (str, bool, int, float):
        return x
    if isinstance(x, (str, float, int)):  # of NumPy, or an enumeration
        return next(kind(x) for kind in (str, float, int) if isinstance(x, kind))
    if hasattr(x, "as_file"):  # Samples
        return list(x.as_file())
    if isinstance(x, np.ndarray) or isinstance(x, np.generic):
        if is_masked(x):
            raise TypeError(f"{name}: {what(x)}, expected real numbers")
        if x.dtype.kind not in "fiubU":
            raise TypeError(f"{name}: an array of {x.dtype}, expected real numbers")
        if x.dtype.kind == "f":  # a longdouble is no float of Python
            with np.errstate(over="ignore"):
                x = np.asarray(x, dtype=np.float64)
        return x.tolist()
    if isinstance(x, Mapping):
        return {str(key): plain(f"{name}.{key}", value) for key, value in x.items()}
    if isinstance(x, (list, tuple)):
        return [plain(f"{name}[{i}]", entry) for i, entry in enumerate(x)]
    if hasattr(x, "as_matrix"):  # SciPy's Rotation
        if name == "quaternion":
            return quaternions(x).tolist()
        return x.as_matrix().tolist()
    if hasattr(x, "__array__"):
        return plain(name, np.asarray(x))
    raise TypeError(f"{name}: a value of type {type(x).__name__}, expected numbers, texts, lists, arrays or dicts")
