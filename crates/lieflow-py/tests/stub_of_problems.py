"""Prints the stub of the classes of problems: ``python stub_of_problems.py > _problems.pyi``."""

from __future__ import annotations

import inspect

import lieflow as lf
from lieflow import _problems

HEAD = '''"""Every kind of problem as a class. Made by tests/stub_of_problems.py."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._fields import Quantities, Samples
from ._result import Layout
from ._types import Flag, HasMatrix, Real, Whole
from ._unitary import ComplexState

Array = NDArray[np.float64]
# Numbers may be formulas of the parameters, as in ["5*deg", 0, "w"].
Numbers = ArrayLike | Sequence[Any]
COLUMNS: int

class Problem:
    kind: ClassVar[str]
    equation: ClassVar[str]
    key_table: ClassVar[tuple[tuple[str, str, str, bool, str, str], ...]]
    quantity_table: ClassVar[tuple[tuple[str, tuple[str, ...], str, str], ...]]
    _keys: dict[str, Any]
    _problem: _lieflow.Problem
    def __init__(self, **keys: Any) -> None: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def keys(self) -> dict[str, Any]: ...
    def replace(self, **keys: Any) -> Any: ...
    @property
    def method(self) -> str: ...
    @property
    def quantities(self) -> tuple[str, ...]: ...
    @property
    def invariants(self) -> tuple[str, ...]: ...
    @property
    def facts(self) -> dict[str, float]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    def columns(self, quantity: str) -> tuple[str, ...]: ...
    def methods(self, quantities: Sequence[str] | str | None = None) -> tuple[str, ...]: ...
    def orders(
        self, method: str, quantities: Sequence[str] | str | None = None
    ) -> tuple[int | None, int | None]: ...
    def exact(
        self, t: ArrayLike, quantities: Sequence[str] | str | None = None, *, t0: Real = 0.0
    ) -> Quantities | None: ...
    def asked(self, quantities: Sequence[str] | str | None) -> tuple[str, ...]: ...
    def _both(
        self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...]
    ) -> tuple[_lieflow.Model, Layout]: ...
    def _model(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> _lieflow.Model: ...
    def _layout(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> Layout: ...
    def _complex_state(self) -> ComplexState | None: ...
    def _form(self, model: _lieflow.Model, method: str) -> tuple[str, str, str]: ...
    def _form_of(self, form: str) -> tuple[str, str, str]: ...
    def _start(self, y0: Any, model: _lieflow.Model, method: str) -> Array | None: ...

def problem_of(kind: str, keys: dict[str, Any]) -> Problem: ...
def _quietly(kind: str, keys: dict[str, Any]) -> Problem: ...

KINDS: dict[str, type[Problem]]
'''


#: The types of arguments for those that the kinds state.
WIDER = {"bool": "Flag", "int": "Whole", "float": "Real", "Samples": "Samples | Path"}


def type_of(name: str, what: str, of: str) -> str:
    """Return the type of a key, whose values may be those of NumPy and of SciPy."""
    types = [WIDER.get(one, one) for one in dict.fromkeys(of.split(" | "))]
    if of == "Sequence[Any]" and "a dict of" not in what:
        types.append("NDArray[Any]")
    if name in ("attitude", "quaternion"):
        types.append("HasMatrix")
    return " | ".join(types)


def stub() -> str:
    """Return the text of the stub."""
    text = [HEAD]
    for made in sorted(_problems.KINDS.values(), key=lambda made: made.__name__):
        keys = "".join(
            f"        {name}: {type_of(name, what, of)}{' | None = None' if optional else ''},\n"
            for name, what, of, optional, *_ in made.key_table
        )
        text.append(f"class {made.__name__}(Problem):\n    def __init__(\n        self,\n        *,\n{keys}    ) -> None: ...\n")
    names = sorted(["KINDS", "Problem", "problem_of", *(made.__name__ for made in _problems.KINDS.values())])
    text.append("__all__ = [\n" + "".join(f'    "{name}",\n' for name in names) + "]\n")
    return "\n".join(text)


def signature_of(made: type[lf.Problem]) -> str:
    """Return the signature that help() shows."""
    return str(inspect.signature(made))


if __name__ == "__main__":
    print(stub(), end="")
