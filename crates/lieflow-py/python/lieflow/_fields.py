"""Fields that are not Python functions: formulas, samples, C functions; and systems of parts."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._arrays import Array, finite, kept, name_of, own, real
from ._errors import ArgumentError, together
from ._groups import Group
from ._unchanging import Constants, Unchanging, unchanging
from ._values import plain

__all__ = ["CFunction", "Field", "Parts", "Quantities", "Samples"]


class Quantities(dict[str, NDArray[Any]]):
    """Arrays by name, which are attributes, too: ``y["attitude"]`` is ``y.attitude``."""

    def __missing__(self, name: str) -> NDArray[Any]:
        raise KeyError(self._words(name))

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in self:
            raise AttributeError(self._words(name))
        return self[name]

    def _words(self, name: str) -> str:
        """The words for a name that is not there."""
        return f"no quantity {name!r}, expected one of {', '.join(self)}; a problem has those of quantities="

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __reduce__(self) -> tuple[type[Quantities], tuple[dict[str, NDArray[Any]]]]:
        return (Quantities, (dict(self),))


def numbered(name: str, shape: tuple[int, ...]) -> list[str]:
    """Return the names of the numbers of an array, from 1: ``y12``, and ``y1_12`` where a dimension is above 10."""
    between = "_" if len(shape) > 1 and max(shape) > 10 else ""
    return [name + between.join(str(i + 1) for i in place) for place in np.ndindex(*shape)]


class State(Constants, Quantities):
    """The quantities at the end of a run of a problem. Another run goes on from them: ``y0=result.y_end``.

    They cannot be changed: the numbers of the point stand behind them.
    """

    def __init__(self, quantities: dict[str, NDArray[Any]], numbers: NDArray[np.float64], of: tuple[str, str, str]) -> None:
        super().__init__(
            quantities,
            "y_end: it cannot be changed; give y0 the numbers of a state, as lieflow.Integrator.state has them, or make a "
            "problem with another start by replace()",
        )
        for array in self.values():
            array.setflags(write=False)
        self._numbers, self._of = numbers, of

    def __reduce__(self) -> tuple[Any, ...]:
        return (State, (dict(self), self._numbers, self._of))


class CFunction:
    """The address of a C function as f: ``void f(double t, const double *y, double *v, const double *p)``.

    y has the numbers of the point by rows, v gets the value of f and is 0 before, p is ``parameters``. A complex number, as
    on U(n), is two of them: re, im. Of :class:`lieflow.Parts` both have vectors first, then rotations, then numbers. The
    run calls it without the interpreter. A wrong address cannot be seen and ends the program.

    Parameters
    ----------
    function : int, or an object with an address
        An integer, ``numba.cfunc`` (its ``address``), a function of ctypes, a ``PyCapsule``, or a
        ``scipy.LowLevelCallable`` without ``user_data``, of any of its forms.
    parameters : array_like
        The numbers p.
    """

    __slots__ = ("address", "function", "parameters")

    def __init__(self, function: Any, parameters: ArrayLike = ()) -> None:
        self.function = function
        self.parameters = [float(x) for x in np.atleast_1d(real("parameters", parameters)).ravel()]
        self.address = address(function)

    def __repr__(self) -> str:
        return f"lieflow.CFunction({self.function!r}, {self.parameters})"


def address(function: Any) -> int:
    """Return the address of a C function."""
    import ctypes

    if isinstance(function, bool) or function is None:
        raise TypeError(f"fun: {function}, expected the address of a C function")
    found: Any
    if isinstance(function, (int, np.integer)):
        found = int(function)
    elif hasattr(function, "address") and isinstance(function.address, int):
        found = function.address
    elif hasattr(function, "argtypes") and hasattr(function, "restype"):  # of ctypes
        found = ctypes.cast(function, ctypes.c_void_p).value or 0
    elif type(function).__name__ == "LowLevelCallable":
        if function.user_data is not None:
            raise ArgumentError("fun", "a LowLevelCallable with user_data", "one without; its numbers are `parameters`")
        # The capsule with the address, whatever the function is.
        return address(tuple.__getitem__(function, 0))
    elif type(function).__name__ == "PyCapsule":
        api = ctypes.pythonapi
        api.PyCapsule_GetName.restype, api.PyCapsule_GetName.argtypes = ctypes.c_char_p, [ctypes.py_object]
        api.PyCapsule_GetPointer.restype = ctypes.c_void_p
        api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
        found = api.PyCapsule_GetPointer(function, api.PyCapsule_GetName(function))
    else:
        raise TypeError(f"fun: a value of type {type(function).__name__}, expected the address of a C function")
    if not 0 < found <= 2 * sys.maxsize + 1:
        raise ArgumentError("fun", f"the address {found}", "the address of a C function")
    return int(found)


#: Samples of more times are printed in short.
SHOWN = 50


class Samples(Unchanging):
    """Sampled values as a function of time.

    As f of :func:`lieflow.solve_ivp` it is a function of t alone; a step ends at each time where it is not smooth. Of
    :class:`lieflow.Parts` its columns are the values of the parts, in the order of the parts. As the
    key ``samples`` of a problem its columns are variables of the formulas. Samples do not change: others are made anew.

    Parameters
    ----------
    t : (k,) array_like
        Increasing times, at least two.
    values : (k, n) or (k,) array_like
        The values at these times.
    interpolation : {"linear", "cubic", "previous", "mean-rate"}
        Straight lines; the cubic spline, not-a-knot; the value of each time, held until the next time; or, of increments over the interval before each time, the rate whose
        integrals they are.
    names : sequence of str, optional
        The names of the columns in formulas. The default is those of a DataFrame, else s1, s2, …, of one column s.
    """

    __slots__ = ("_sampled", "interpolation", "names", "t", "values")

    t: Array
    values: Array
    interpolation: str
    names: tuple[str, ...]

    def __init__(
        self, t: ArrayLike, values: ArrayLike, interpolation: str = "linear", names: Sequence[str] | None = None
    ) -> None:
        if names is None and isinstance(labels := getattr(values, "columns", None), Iterable):
            names = [str(name) for name in labels]  # of a table
        times, rows = own("t", t), own("values", values)
        if times.ndim != 1:
            raise ArgumentError("t", f"shape {times.shape}", "shape (k,)")
        if rows.ndim == 1:
            rows = rows[:, None]
        if rows.ndim != 2 or len(rows) != len(times) or rows.shape[1] == 0:
            raise ArgumentError("values", f"shape {rows.shape}", f"shape ({len(times)}, n) with at least one column")
        n = rows.shape[1]
        of = tuple(names) if names is not None else ("s",) if n == 1 else tuple(f"s{j + 1}" for j in range(n))
        for j, name in enumerate(of):
            name_of(f"names[{j}]", name)
        if len(of) != n:
            raise ArgumentError("names", f"{len(of)} names", f"{n}, one for each column")
        if len(set(of)) < n:
            twice = next(name for name in of if of.count(name) > 1)
            raise ArgumentError("names", f"{twice!r} twice", "another name for each column")
        self._set(t=times, values=rows, interpolation=name_of("interpolation", interpolation), names=of)
        columns = [np.ascontiguousarray(column) for column in rows.T]
        self._sampled = _lieflow.SampledField(times, columns, interpolation)

    def __call__(self, t: ArrayLike) -> Array:
        """Return the values at t, the shape of t followed by (n,). A time outside of the samples is refused."""
        return self._sampled.at(t)

    def as_file(self) -> tuple[str, str]:
        """Return a name and the text of a CSV file with the same numbers."""
        rows = np.column_stack([self.t, self.values]).tolist()
        lines = [",".join(["t", *self.names]), *(",".join(map(repr, row)) for row in rows)]
        return ("samples", "\n".join(lines) + "\n")

    def __repr__(self) -> str:
        if len(self.t) > SHOWN:
            columns = f"of {', '.join(self.names)}, {self.interpolation}"
            return f"<lieflow.Samples: {len(self.t)} times from {self.t[0]} to {self.t[-1]} {columns}>"
        t, values = self.t.tolist(), self.values.tolist()
        return f"lieflow.Samples({t}, {values}, {self.interpolation!r}, {self.names})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Samples, (self.t, self.values, self.interpolation, self.names))


#: What a result or its y, a dict, has, which no part can be called. A part `y` is `r.y["y"]`.
TAKEN = frozenset(
    "sol t t_events y_events t_end y_end nfev nsteps nrejected restored residual unsure_steps status message success drift "
    "largest_step smallest_step keys check as_rotation to_dataframe estimate_error "
    "items values get copy pop popitem update clear setdefault fromkeys".split()
)


class Parts(Unchanging):
    """A system of rotations, vectors and numbers, as the ``group`` of a run. Then y is a dict of arrays.

    ``lf.Parts(R="rotation", x="vector", m="numbers 3")``:

    ============  ===========  =============================  ==========================
    space         y            f                              equation
    ============  ===========  =============================  ==========================
    rotation      (3, 3)       (3,), the angular velocity ω   Ṙ = ω̂ R, or R ω̂ (body)
    vector        (3,)         (3,), the angular velocity ω   ẋ = ω × x; the length stays
    numbers k     (k,)         (k,), the derivative           ẏ = f
    number        ()           a number                       ẏ = f
    ============  ===========  =============================  ==========================
    """

    __slots__ = ("_places", "spaces")

    spaces: dict[str, str]

    def __init__(self, **spaces: str) -> None:
        if not spaces:
            raise ArgumentError("spaces", "none", 'at least one part, such as R="rotation"')
        self._set(spaces=unchanging(spaces, self._refusal("spaces")))
        sizes: dict[str, tuple[int, int, tuple[int, ...]]] = {}
        for name, space in spaces.items():
            if name in TAKEN or name.startswith("_"):
                raise ArgumentError("spaces", repr(name), "another name: a result of a run or its y has this one, or it begins with _")
            if not isinstance(space, str):
                raise TypeError(f"{name}: a value of type {type(space).__name__}, expected the name of a space")
            word, _, count = space.partition(" ")
            if space == "vector":
                sizes[name] = (3, 3, (3,))
            elif space == "rotation":
                sizes[name] = (9, 3, (3, 3))
            elif space == "number":
                sizes[name] = (1, 1, ())
            elif word == "numbers" and count.isdecimal() and int(count) > 0:
                sizes[name] = (int(count), int(count), (int(count),))
            else:
                raise ArgumentError(name, repr(space), '"rotation", "vector", "number" or "numbers k"')
        # Vectors, then rotations, then numbers.
        order = sorted(spaces, key=lambda name: ["v", "r", "n"].index(spaces[name][0]))
        self._places: dict[str, tuple[slice, slice, tuple[int, ...]]] = {}
        point = value = 0
        for name in order:
            of_point, of_value, shape = sizes[name]
            self._places[name] = (slice(point, point + of_point), slice(value, value + of_value), shape)
            point, value = point + of_point, value + of_value

    @property
    def name(self) -> str:
        """The name in messages."""
        return ", ".join(f"{name}: {space}" for name, space in self.spaces.items())

    def counts(self) -> tuple[int, int, int]:
        """Return the numbers of vectors, of rotations and of single numbers."""
        places = self._places
        numbers = sum(p[0].stop - p[0].start for n, p in places.items() if self.spaces[n][0] == "n")
        return (sum(s == "vector" for s in self.spaces.values()), sum(s == "rotation" for s in self.spaces.values()), numbers)

    def split(self, y: Array) -> Quantities:
        """Return the parts of points, shape (..., n)."""
        lead = y.shape[:-1]
        return Quantities({name: y[..., self._places[name][0]].reshape(lead + self._places[name][2]) for name in self.spaces})

    def join(self, name: str, parts: Mapping[str, Any], point: bool) -> Array:
        """Return the numbers of a dict of parts: of a point, or of a value of f."""
        if not isinstance(parts, Mapping):
            raise TypeError(f"{name}: a value of type {type(parts).__name__}, expected a dict of {', '.join(self.spaces)}")
        for key in parts:
            if key not in self.spaces:
                raise ArgumentError(f"{name}[{key!r}]", "no part has this name", f"one of {', '.join(self.spaces)}")
        flat = []
        for key, (of_point, of_value, shape) in self._places.items():
            if key not in parts:
                raise ArgumentError(f"{name}[{key!r}]", "missing", "a value for each part")
            array = real(f"{name}[{key!r}]", parts[key])
            count = of_value.stop - of_value.start
            wanted = shape if point or shape == () else (count,)
            if array.shape != wanted:
                raise ArgumentError(f"{name}[{key!r}]", f"shape {array.shape}", f"shape {wanted}")
            if point:
                finite(f"{name}[{key!r}]", array)
            flat.append(array.ravel())
        return np.concatenate(flat)

    def in_order(self, values: Array) -> Array:
        """Return the columns of values of f, which are in the order of the parts, in the order of the point."""
        places, at = {}, 0
        for name in self.spaces:
            _, of_value, _ = self._places[name]
            places[name] = range(at, at := at + of_value.stop - of_value.start)
        return values[:, [i for name in self._places for i in places[name]]]

    def columns(self) -> list[str]:
        """Return the names of the numbers of a point in formulas."""
        names: list[str] = []
        for name, (_, _, shape) in self._places.items():
            names += numbered(name, shape)
        return names

    def __repr__(self) -> str:
        return f"lieflow.Parts({', '.join(f'{name}={space!r}' for name, space in self.spaces.items())})"

    def __eq__(self, other: object) -> bool:
        return list(self.spaces.items()) == list(other.spaces.items()) if isinstance(other, Parts) else NotImplemented

    def __hash__(self) -> int:
        return hash(tuple(self.spaces.items()))

    def __reduce__(self) -> tuple[Any, ...]:
        return (_parts, (self.spaces,))


def _parts(spaces: dict[str, str]) -> Parts:
    return Parts(**spaces)


class Field(Unchanging):
    """A field as formulas. A run calls it without the interpreter. It does not change.

    Parameters
    ----------
    group : str, Group or Parts
        The group, as in :func:`lieflow.solve_ivp`.
    field : list of formulas, or for Parts a dict of them
        The components of f(t, y). A formula is a text or a number; a single text may have a vector as its value.
    y : str
        The name of y in the formulas: ``y1``, … are the components of a vector, ``y11``, … those of a matrix by rows, and
        ``y`` is the whole. Parts have their own names.
    let : dict, optional
        Formulas with names, which other formulas use.
    samples : Samples, optional
        Functions of t, by the names of their columns.
    **parameters : float or array_like
        Constants by name. The entries of an array ``J`` are ``J1``, ``J2``, … or ``J11``, …

    Examples
    --------
    >>> import numpy as np, lieflow as lf
    >>> body = lf.Field("SO(3)", ["dot(m, [y11, y21, y31])/J1", "dot(m, [y12, y22, y32])/J2", "dot(m, [y13, y23, y33])/J3"],
    ...                 m=[0.0, 2.75, 2.75], J=[1.0, 4.0, 18.0])
    >>> lf.solve_ivp(body, (0, 10), np.eye(3), frame="body").success
    True
    """

    __slots__ = ("_made", "field", "group", "let", "parameters", "samples", "y")

    group: str | Group | Parts
    field: Any
    y: str
    let: dict[str, Any]
    samples: Samples | None
    parameters: dict[str, Any]

    def __init__(
        self,
        group: str | Group | Parts,
        field: Any,
        /,
        *,
        y: str = "y",
        let: Mapping[str, Any] | None = None,
        samples: Samples | None = None,
        **parameters: Any,
    ) -> None:
        if not isinstance(group, (str, Group, Parts)):
            raise TypeError(f"group: a value of type {type(group).__name__}, expected a name, a Group or Parts")
        name_of("y", y)
        if samples is not None and not isinstance(samples, Samples):
            raise TypeError(f"samples: a value of type {type(samples).__name__}, expected lieflow.Samples")
        for name, x in parameters.items():
            real(name, x)
        # Copies: a later change of an argument has no effect.
        values = {"field": field, "let": dict(let or {}), "parameters": parameters}
        self._set(group=group, y=y, samples=samples)
        self._set(**{name: unchanging(x, self._refusal(name)) for name, x in values.items()})
        self._made: dict[Any, _lieflow.Formulas] = {}

    def formulas(
        self, texts: Any, shape: tuple[int, ...], value: tuple[int, ...], is_complex: bool = False
    ) -> _lieflow.Formulas:
        """Return formulas in t and the numbers of y of this shape, with values of another.

        The last axis of complex numbers has Re and Im.
        """
        made = (repr(texts), shape, value, is_complex)
        return kept(self._made, made, lambda: self._read(texts, shape, value, is_complex))

    def _read(self, texts: Any, shape: tuple[int, ...], value: tuple[int, ...], is_complex: bool) -> _lieflow.Formulas:
        texts = plain("field", texts)
        if isinstance(self.group, Parts):
            columns = self.group.columns()
        elif is_complex:
            columns = [part + index for index in numbered("", shape[:-1]) for part in ("re", "im")]
        else:
            columns = numbered(self.y, shape)
        if isinstance(self.group, Parts) and value != ():
            if not isinstance(texts, Mapping) or set(texts) != set(self.group.spaces):
                raise ArgumentError("field", repr(texts), f"a dict with formulas of {', '.join(self.group.spaces)}")
            row, places, names = 0, self.group._places, [repr(name) for name in self.group._places]
            entries, counts = [texts[name] for name in places], [p[1].stop - p[1].start for p in places.values()]
        else:
            flat = texts
            if len(value) == 2 and isinstance(texts, list) and texts and isinstance(texts[0], list):
                flat = [text for row in texts for text in row]
            entries, counts, names = [flat], [int(np.prod(value, dtype=int))], None
            row = value[1] if flat is not texts else 0
        keys: dict[str, Any] = {"field": entries}
        constants: dict[str, float] = {}
        for name, x in self.parameters.items():
            array = real(name, x)
            for constant, number in zip(numbered(name, array.shape), array.ravel()):
                if constant in constants:
                    raise ArgumentError(name, f"the constant {constant!r} twice", "another name")
                constants[constant] = float(number)
        keys["parameters"] = constants
        if self.let:
            keys["let"] = plain("let", self.let)
        if self.samples is not None:
            keys["samples"] = list(self.samples.as_file())
            keys["interpolation"] = self.samples.interpolation
        place = partial(_of_part, names=names, row=row)  # the first index is that of the part
        try:
            return _lieflow.Formulas(columns, counts, keys, place)
        except ArgumentError as error:
            wrong = [error, *error.others]
            for one in wrong:
                one.argument = place(one.argument)
            raise together(wrong) from None

    def __repr__(self) -> str:
        group = repr(self.group)
        more = "".join(f", {name}={value!r}" for name, value in self.parameters.items())
        let = f", let={self.let!r}" if self.let else ""
        samples = f", samples={self.samples!r}" if self.samples is not None else ""
        y = f", y={self.y!r}" if self.y != "y" else ""
        return f"lieflow.Field({group}, {self.field!r}{y}{let}{samples}{more})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_field, (self.group, self.field, self.y, self.let, self.samples, self.parameters))


def _of_part(argument: str, names: list[str] | None, row: int) -> str:
    """The path of a formula: by the name of its part, without one, or in rows of this length."""
    if not argument.startswith("field["):
        return argument
    part, _, rest = argument.removeprefix("field[").partition("]")
    if names is not None:
        return f"field[{names[int(part)]}]{rest}"
    if row and rest:
        i, j = divmod(int(rest[1:].partition("]")[0]), row)
        return f"field[{i}][{j}]"
    return f"field{rest}"


def _field(group: Any, field: Any, y: str, let: Any, samples: Any, parameters: dict[str, Any]) -> Field:
    return Field(group, field, y=y, let=let, samples=samples, **parameters)
