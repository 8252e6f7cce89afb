"""Types of arguments, for type checkers: numbers of NumPy are numbers, and rotations of SciPy are arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Args", "Flag", "HasMatrix", "Matrices", "Real", "Span", "Whole"]


class HasMatrix(Protocol):
    """SciPy's Rotation or RigidTransform."""

    def as_matrix(self) -> Any:
        """Return the matrices."""


#: Arrays of rotations or of motions.
Matrices = ArrayLike | HasMatrix
#: A whole number.
Whole = int | np.integer[Any]
#: A real number.
Real = float | np.floating[Any] | np.integer[Any]
#: True or False.
Flag = bool | np.bool_
#: Two times.
Span = Sequence[Real] | NDArray[Any]
#: The arguments of f after t and y. A text is none.
Args = tuple[Any, ...] | list[Any] | NDArray[Any]
