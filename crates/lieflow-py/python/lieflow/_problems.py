"""Every kind of problem as a class, made from the kinds of the library."""

from __future__ import annotations

import copy
import inspect
import pathlib
import warnings
from collections.abc import Iterable, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from . import _lieflow
from ._arrays import Array, complex_numbers, finite, kept, name_of, number, own, real, what
from ._errors import ArgumentError
from ._fields import Quantities, Samples, State
from ._result import Layout
from ._types import Real
from ._unchanging import Unchanging
from ._unitary import ComplexState
from ._values import alike, is_complex, part, plain

#: Numbers may be formulas of the parameters, as in ``["5*deg", 0, "w"]``.
Numbers = ArrayLike | Sequence[Any]

#: A quantity with more columns is given only when it is asked for.
COLUMNS = 64


class Problem(Unchanging):
    """A problem of one kind, such as :class:`lieflow.RigidBody`: its equation, its parameters and its start.

    The keys are those of scene files. Values are numbers, lists, arrays, texts, dicts (``let``, ``parameters``), SciPy's
    Rotation, and :class:`lieflow.Samples` for ``samples``. Where a kind has the keys ``x`` and ``x_imaginary``, complex
    numbers for ``x`` are both.
    """

    #: The name of the kind in scene files.
    kind: ClassVar[str] = ""
    #: The equations of motion.
    equation: ClassVar[str] = ""
    #: The keys: name, what its value is, its type, whether it may be left out, what it means, its dimension in words.
    key_table: ClassVar[tuple[tuple[str, str, str, bool, str, str], ...]] = ()
    #: What can be asked for: name, columns, meaning, dimension in words.
    quantity_table: ClassVar[tuple[tuple[str, tuple[str, ...], str, str], ...]] = ()

    def __init__(self, **keys: Any) -> None:
        self._make(keys)
        self._warn(3)

    def _refusal(self, name: str) -> str:
        return f"{name}: a problem does not change; replace({name}=...) returns another one"

    def _warn(self, level: int) -> None:
        for text in self._problem.warnings:
            warnings.warn(text, UserWarning, stacklevel=level)

    def _make(self, keys: dict[str, Any]) -> None:
        if not type(self).kind:
            raise TypeError("Problem is the base of the kinds, such as lieflow.RigidBody")
        keys = {name: value for name, value in keys.items() if value is not None}
        samples = keys.get("samples")
        if isinstance(samples, Samples):
            keys.setdefault("interpolation", samples.interpolation)
        elif isinstance(samples, (str, pathlib.Path)):
            keys["samples"] = [str(samples), pathlib.Path(samples).read_text()]
        keys = type(self)._in_parts(keys)
        self._keys = {name: plain(name, value) for name, value in keys.items()}
        self._problem = _lieflow.Problem(type(self).kind, self._keys)
        self._models: dict[Any, tuple[_lieflow.Model, Layout]] = {}
        self._complex: tuple[ComplexState | None] | None = None

    @classmethod
    def _in_parts(cls, keys: dict[str, Any]) -> dict[str, Any]:
        """The keys, where one of complex numbers is two: ``start`` and ``start_imaginary``."""
        names = {name for name, *_ in cls.key_table}
        both = {name: f"{name}_imaginary" for name in keys if f"{name}_imaginary" in names and is_complex(keys[name])}
        for name, imaginary in both.items():
            if imaginary in keys:
                raise ArgumentError(imaginary, repr(keys[imaginary]), f"none: {name} has complex numbers")
        real = {name: part(x, "real") if name in both else x for name, x in keys.items()}
        return {**real, **{imaginary: part(keys[name], "imag") for name, imaginary in both.items()}}

    @property
    def keys(self) -> dict[str, Any]:
        """The keys and their values, as a copy."""
        return copy.deepcopy(self._keys)

    def replace(self, **keys: Any) -> Any:
        """Return the problem with other values of these keys. None takes a key away."""
        # Another value is both parts of it.
        for name in [name for name in keys if f"{name}_imaginary" in self._keys]:
            keys.setdefault(f"{name}_imaginary", None)
        # Other samples have their own interpolation.
        if "samples" in keys:
            keys.setdefault("interpolation", None)
        changed = _quietly(type(self).kind, {**self._keys, **keys})
        changed._warn(3)
        return changed

    @property
    def method(self) -> str:
        """The method that runs take by default."""
        return self._problem.method

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that results have by default."""
        return tuple(self._problem.quantities)

    @property
    def invariants(self) -> tuple[str, ...]:
        """The quantities that the exact motion keeps."""
        return tuple(self._problem.invariants(list(self.quantities)))

    @property
    def facts(self) -> dict[str, float]:
        """What is known before any run, by name."""
        return dict(self._problem.facts)

    @property
    def notes(self) -> tuple[str, ...]:
        """Changes that were made to numbers, and warnings."""
        return tuple(self._problem.notes)

    def columns(self, quantity: str) -> tuple[str, ...]:
        """Return the names of the columns of a quantity, which texts of events may use."""
        return tuple(self._problem.columns(quantity))

    def methods(self, quantities: Sequence[str] | str | None = None) -> tuple[str, ...]:
        """Return the names of the methods that run on it, where these quantities are computed."""
        return tuple(self._model(self.asked(quantities), ()).methods())

    def orders(
        self, method: str, quantities: Sequence[str] | str | None = None
    ) -> tuple[int | None, int | None]:
        """Return the order of the steps of a method, and that of its dense output; None for one that is exact.

        The quantities decide which state the method integrates, as in :meth:`methods`.
        """
        return self._model(self.asked(quantities)).orders(name_of("method", method))

    def exact(self, t: ArrayLike, quantities: Sequence[str] | str | None = None, *, t0: Real = 0.0) -> Quantities | None:
        """Return the exact motion at the times t, from the start at t0; None where it is not known.

        Shapes: that of t, followed by that of each quantity. Error: some 1e-14 times the phase that the motion has passed.
        """
        asked = self.asked(quantities)
        times = real("t", t)
        found = self._model(asked, ()).exact(number("t0", t0), np.ascontiguousarray(times.ravel()), self.method)
        if found is None:
            return None
        return self._layout(asked, ()).split(found.reshape(times.shape + found.shape[1:]))

    def asked(self, quantities: Sequence[str] | str | None) -> tuple[str, ...]:
        """Return the quantities that are asked for, or the default ones."""
        if quantities is None:
            return self.quantities
        if not isinstance(quantities, Iterable):
            raise TypeError(f"quantities: {quantities!r}, expected names")
        given = (quantities,) if isinstance(quantities, str) else tuple(quantities)
        if not all(isinstance(name, str) for name in given):
            raise TypeError("quantities: expected names")
        return tuple(dict.fromkeys(self._problem.named(name) for name in given))

    def _both(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...]) -> tuple[_lieflow.Model, Layout]:
        """The model of these quantities, of what the motion keeps, and of events."""
        def make() -> tuple[_lieflow.Model, Layout]:
            laws = [name for name in self._problem.invariants(list(asked)) if len(self._problem.columns(name)) <= COLUMNS]
            model = self._problem.model(list(dict.fromkeys([*asked, *laws])), None, list(events))
            return (model, Layout(model.schema, asked))

        return kept(self._models, (asked, events), make)

    def _model(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> _lieflow.Model:
        return self._both(asked, events)[0]

    def _layout(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> Layout:
        return self._both(asked, events)[1]

    def _complex_state(self) -> ComplexState | None:
        """The complex array of the state, if it is complex."""
        if self._complex is None:
            names = self._problem.state(list(self.quantities))
            model = self._problem.model(names, None, [])
            (_, _, shape, _, parts), *others = model.schema
            is_real = others or not parts
            size = 0 if is_real else len(model.start(self.method))
            self._complex = (None if is_real else ComplexState(tuple(shape), size, model.by_parts),)
        return self._complex[0]

    def _form(self, model: Any, method: str) -> tuple[str, str, str]:
        """What the numbers of a state are of: the kind, the form of the model, and the keys if these say what is not there."""
        return self._form_of(model.form(method))

    def _form_of(self, form: str) -> tuple[str, str, str]:
        """What the numbers of a state of this form of the model are of."""
        # The attitude of a free body is a state alone: the keys have its momentum.
        if type(self).kind == "rigid-body" and form.endswith(("RigidBodyAttitude", "RigidBodyQuaternion")):
            return type(self).kind, form, alike(self._keys)
        if type(self).kind == "composed":
            return type(self).kind, form, repr([(part.get("name"), part.get("space")) for part in self._keys["parts"]])
        # What stands beside the state.
        return type(self).kind, form, alike({name: self._keys.get(name) for name in ("surface", "particle", "algebra")})

    def _start(self, y0: Any, model: Any, method: str) -> Array | None:
        """The numbers of another state: the end of a run, these numbers, or a complex array."""
        if y0 is None:
            return None
        if isinstance(y0, State):
            form = self._form(model, method)
            if y0._of[:2] == form[:2] and y0._of != form and form[0] == "rigid-body":
                expected = "that of a run with the same keys; replace(momentum_body=..., attitude=...) begins with its last row"
                raise ArgumentError("y0", "an attitude alone, whose momentum the keys of the other problem say", expected)
            if y0._of[:2] == form[:2] and y0._of != form:
                if form[0] == "composed":
                    raise ArgumentError("y0", "the end of a run of other parts", "the same parts in the same order")
                expected = "the same surface, particle and algebra"
                raise ArgumentError("y0", f"the end of a run of another {type(self).__name__}", expected)
            if y0._of != form:
                expected = f"the end of a run of {type(self).kind!r} with the same quantities, by a method on the same state"
                raise ArgumentError("y0", f"the end of another run, of {y0._of[0]!r}", expected)
            return y0._numbers
        if isinstance(y0, dict):
            expected = (
                "the y_end of a run, the numbers of a state, as lieflow.Integrator.state has them, or replace() with the keys "
                "of a start"
            )
            raise ArgumentError("y0", "quantities by name", expected)
        state = self._complex_state()
        if state is None:
            numbers = own("y0", y0)
            if numbers.ndim != 1:
                expected = "a list of the numbers of a state, as lieflow.Integrator.state has them"
                raise ArgumentError("y0", f"shape {numbers.shape}", expected)
            finite("y0", numbers)
            return numbers
        z = complex_numbers("y0", y0)
        finite("y0", z)
        if z.shape == (state.size,) and not z.imag.any():
            return np.ascontiguousarray(z.real)
        return state.join("y0", z)

    def __repr__(self) -> str:
        keys = ", ".join(f"{name}={value!r}" for name, value in self._keys.items())
        return f"lieflow.{type(self).__name__}({keys})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and isinstance(other, Problem) and self._keys == other._keys

    def __hash__(self) -> int:
        return hash((type(self).__name__, alike(self._keys)))

    def __reduce__(self) -> tuple[Any, ...]:
        return (_quietly, (type(self).kind, self._keys))


def problem_of(kind: str, keys: dict[str, Any]) -> Problem:
    """Return the problem of a kind by its name in scene files."""
    if kind not in KINDS:
        import difflib

        near = difflib.get_close_matches(kind, KINDS, 1)
        hint = f"`{near[0]}`? one of " if near else "one of "
        raise ArgumentError("kind", repr(kind), hint + ", ".join(KINDS))
    made = _quietly(kind, keys)
    made._warn(3)
    return made


def _quietly(kind: str, keys: dict[str, Any]) -> Problem:
    """The problem of a kind, whose warnings are known."""
    made: Problem = object.__new__(KINDS[kind])
    made._make(keys)
    return made


def _class_name(kind: str) -> str:
    return "".join(word[:1].upper() + word[1:] for word in kind.split("-"))


def _document(kind: dict[str, Any]) -> str:
    """The text of help()."""
    import textwrap

    def entry(head: str, text: str) -> str:
        return head + "\n" + textwrap.indent(textwrap.fill(text, 100), "    ")

    def of(dimension: str) -> str:
        return f" [{dimension}]" if dimension else ""

    keys = [
        entry(f"{name} : {what}{', optional' if optional else ''}{of(dimension)}", text)
        for name, text, what, optional, _, dimension in kind["keys"]
    ]
    quantities = [
        entry(f"{name} : {', '.join(columns)}{of(dimension)}", text) for name, columns, text, dimension in kind["quantities"]
    ]
    laws = [name if every else f"{name} (in some of these problems)" for name, every in kind["laws"]]
    head = f"{kind['summary'][:1].upper()}{kind['summary'][1:]}.\n\n{kind['equation']}"
    parts = {"Parameters": keys, "Quantities": quantities, "Laws": [entry("The exact motion keeps", ", ".join(laws))] if laws else []}
    return head + "".join(f"\n\n{title}\n{'-' * len(title)}\n" + "\n".join(lines) for title, lines in parts.items() if lines)


class _Help:
    """The text of help(), made when it is asked for."""

    def __init__(self, kind: dict[str, Any]) -> None:
        self.kind = kind

    def __get__(self, instance: object, owner: type) -> str:
        return _document(self.kind)


def _make(kind: dict[str, Any]) -> type[Problem]:
    def init(self: Problem, *values: Any, **keys: Any) -> None:
        if values:
            name = type(self).__name__
            raise TypeError(f"{name}: {what(values[0])} without a name, expected keys by name, as {kind['keys'][0][0]}=...")
        self._make(keys)
        self._warn(3)

    names = inspect.Signature([
        inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD),
        *(
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None if optional else inspect.Parameter.empty)
            for name, _, _, optional, _, _ in kind["keys"]
        ),
    ])
    init.__name__, init.__signature__ = "__init__", names  # type: ignore[attr-defined]
    entries = {
        "__module__": "lieflow",
        "__doc__": _Help(kind),
        "__init__": init,
        "kind": kind["name"],
        "equation": kind["equation"],
        "key_table": tuple(
            (name, what, of, optional, text, dimension) for name, text, what, optional, of, dimension in kind["keys"]
        ),
        "quantity_table": tuple(
            (name, tuple(columns), text, dimension) for name, columns, text, dimension in kind["quantities"]
        ),
    }
    return type(_class_name(kind["name"]), (Problem,), entries)


#: The classes by the names of their kinds.
KINDS: dict[str, type[Problem]] = {kind["name"]: _make(kind) for kind in _lieflow.kinds()}

globals().update({made.__name__: made for made in KINDS.values()})

__all__ = ["KINDS", "Problem", "problem_of", *(made.__name__ for made in KINDS.values())]
