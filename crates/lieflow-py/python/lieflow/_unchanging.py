"""What does not change: runs read what was made from it."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._arrays import is_masked, read_only

__all__ = ["Constants", "Unchanging", "unchanging"]


class Unchanging:
    """An object whose public attributes are set once, when it is made."""

    __slots__ = ()

    def _set(self, **values: Any) -> None:
        """Set attributes of an object that is made."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _refusal(self, name: str) -> str:
        """The words for a change of an attribute."""
        return f"{name}: {type(self).__name__} does not change; make another one"

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            raise AttributeError(self._refusal(name))
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        raise AttributeError(self._refusal(name))


class Constants(dict[str, Any]):
    """A dict that does not change."""

    def __init__(self, values: Mapping[str, Any], refusal: str) -> None:
        super().__init__(values)
        self._refusal = refusal

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError(self._refusal)

    __setitem__ = __delitem__ = __ior__ = update = pop = popitem = clear = setdefault = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return (Constants, (dict(self), self._refusal))


def unchanging(x: Any, refusal: str) -> Any:
    """Return a copy of x that does not change: tuples, read-only arrays, dicts that refuse with these words."""
    if isinstance(x, Mapping):
        return Constants({name: unchanging(value, refusal) for name, value in x.items()}, refusal)
    if isinstance(x, (list, tuple)):
        return tuple(unchanging(entry, refusal) for entry in x)
    if hasattr(x, "as_matrix"):  # SciPy's Rotation
        x = x.as_matrix()
    if hasattr(x, "__array__") and not isinstance(x, np.generic):
        return read_only(np.array(x, subok=is_masked(x)))  # a reader refuses what is masked
    return copy.deepcopy(x)
