"""Results of runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from functools import partial
from threading import RLock
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow, so3
from ._arrays import MEMBERSHIP, Array, first
from ._errors import ArgumentError, RunError
from ._fields import Parts, Quantities, numbered
from ._unitary import ComplexPoints

__all__ = ["ErrorEstimate", "Layout", "OdeSolution", "Result", "warn_of_events"]


def warn_of_events(result: Result) -> Result:
    """Warn the caller of the caller of steps in which zeros of events may be missed. Return the result."""
    if result._unsure is not None:
        warnings.warn(result._unsure, RuntimeWarning, stacklevel=3)
    return result


class Layout:
    """How the numbers of a row are arrays by name."""

    __slots__ = ("_asked", "_every", "asked", "schema")

    def __init__(self, schema: list[Any], asked: tuple[str, ...]) -> None:
        self.schema, self.asked = schema, asked
        # For each quantity: its name, columns and shape, and of complex numbers the places of the real and imaginary parts in
        # these columns, and the factors of these.
        self._every: list[tuple[str, slice, tuple[int, ...], Any]] = []
        start = 0
        for name, columns, shape, _, parts in schema:
            places, factors = np.array(parts).T if parts else (None, None)
            form = None if places is None else (places.astype(int), factors)
            self._every.append((name, slice(start, start + len(columns)), tuple(shape), form))
            start += len(columns)
        places_of = {entry[0]: entry for entry in self._every}
        self._asked = [places_of[name] for name in asked]

    def split(self, rows: Array, every: bool = False) -> Quantities:
        """Return the arrays of rows, shape (..., n), by the names of quantities: those asked for, or all."""
        out, shape = {}, rows.shape[:-1]
        for name, columns, of_one, form in self._every if every else self._asked:
            numbers: Any = rows[..., columns]
            if form is not None:
                places, factors = form
                re, im = np.moveaxis(numbers[..., places] * factors, -2, 0)
                numbers = re + 1j * im
            out[name] = numbers.reshape(shape + of_one)
        return Quantities(out)

    def columns(self) -> list[str]:
        """Return the names of the columns of what was asked for, in the order of rows."""
        return [column for name, columns, *_ in self.schema if name in self.asked for column in columns]

    def numbers(self, rows: Array) -> Array:
        """Return these columns of rows."""
        asked = [name in self.asked for name, columns, *_ in self.schema for _ in columns]
        return rows[..., np.array(asked, dtype=bool)]

    def drift(self, start: Quantities, rows: Array) -> dict[str, float]:
        """Return the largest |value − value at the start| of what the exact motion keeps."""
        every = self.split(rows, every=True)
        kept = [name for name, _, _, is_kept, _ in self.schema if is_kept]
        return {name: float(np.abs(every[name] - start[name]).max(initial=0.0)) for name in kept}


class OdeSolution:
    """The solution at all times of a run, from its stored polynomials. f is not called.

    ``sol(t)`` has the shape of t followed by that of y; of a problem and of parts it has arrays by name. Times may be in any
    order. It can be pickled, and used from any thread. Error: that of the continuous extension of the method. A time
    outside of the run is refused.

    Where an event ended the run of a problem, the solution goes on to the end of t_span, if that is finite, and ``t_max`` is
    that end. This rest is computed once, when it is first asked for, by the steps of the run again. The limit ``max_steps``
    holds for all of them. Only events that change the state are looked at. If this run fails, times after the last one that it
    reached raise :class:`lieflow.RunError` with the reason. A pickled solution has what was computed, and ends there.
    """

    __slots__ = ("_curve", "_end", "_layout", "_lock", "_lost", "_made_by", "_rest")

    def __init__(
        self,
        curve: _lieflow.Curve,
        made_by: tuple[Any, ...],
        layout: Layout | Parts | ComplexPoints | None,
    ) -> None:
        self._curve, self._made_by, self._layout, self._end = curve, made_by, layout, curve.t_span[1]
        # What computes the curve to the end, until that is done, and why this failed.
        self._rest: Callable[[], tuple[_lieflow.Curve, RunError | None]] | None = None
        self._lost: RunError | None = None
        self._lock = RLock()

    def __call__(self, t: ArrayLike) -> Any:
        """Return the points at t."""
        if self._rest is not None and self._is_beyond(t):
            with self._lock:
                if self._rest is not None:  # no other thread was faster
                    self._curve, self._lost = self._rest()
                    self._rest = None
        if self._lost is not None and self._is_beyond(t):
            raise self._lost.with_traceback(None)
        rows = self._curve.at(t)
        return rows if self._layout is None else self._layout.split(rows)

    def _is_beyond(self, t: ArrayLike) -> bool:
        """Is a time after the end of the curve?"""
        times, end = np.asarray(t), self._curve.t_span[1]
        return times.dtype.kind in "fiu" and bool(((times - end) * (self._end - end) > 0).any())

    def _span(self) -> tuple[float, float]:
        return self._curve.t_span[0], self._end

    @property
    def t_min(self) -> float:
        """The smallest time."""
        return min(self._span())

    @property
    def t_max(self) -> float:
        """The largest time."""
        return max(self._span())

    @property
    def n_segments(self) -> int:
        """The number of steps that are computed."""
        return self._curve.steps

    def __repr__(self) -> str:
        start, end = self._span()
        return f"<lieflow.OdeSolution from t = {start} to {end}, {self.n_segments} steps>"

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return (_restored, (self._made_by, self._curve.numbers(), self._layout))


def _restored(made_by: tuple[Any, ...], numbers: Array, layout: Layout | Parts | ComplexPoints | None) -> OdeSolution:
    where, method, *rest = made_by
    if isinstance(where, tuple):
        linear, y0 = rest
        curve = _lieflow.Space(*where).curve(method, linear, y0, numbers)
    else:
        curve = where._model(*rest).curve(method, numbers)
    return OdeSolution(curve, made_by, layout)


class ErrorEstimate(NamedTuple):
    """How far a run is from another result, at most over all outputs and events.

    ``found_by`` says what it was compared with, ``y`` is the largest distance of the points (the angle where all of them are
    rotations, else the length of the difference; a dict for a problem and for parts), ``t_events`` the largest distance of
    the times of each event.
    """

    found_by: str
    y: Any
    t_events: list[float]


def _are_rotations(x: NDArray[Any]) -> bool:
    """Are all points rotations, to rounding?"""
    return x.shape[1:] == (3, 3) and np.isrealobj(x) and bool(so3.contains(x, 1e-9).all())


def _distance(a: NDArray[Any], b: NDArray[Any]) -> float:
    """The largest distance of the points in a and b: the angle of rotations, or the length of the difference."""
    if len(a) == 0:
        return 0.0
    lengths = np.sqrt((np.abs(a - b).reshape(len(a), -1) ** 2).sum(1))
    if _are_rotations(a) and _are_rotations(b):
        lengths = 2.0 * np.arcsin(np.minimum(lengths / np.sqrt(8.0), 1.0))
    return float(lengths.max())


def _error(a: NDArray[Any], b: NDArray[Any], changed: NDArray[Any] | None) -> float:
    """The error of the points in a, beside those of a second run and those from a changed start."""
    distance = _distance(a, b)
    if changed is None or len(a) == 0:
        return distance
    moved, size = _distance(a, changed), float(np.abs(a).max(initial=0.0))
    return max(distance, moved if moved > 0.1 * size else moved / 16.0)


def _by_rows(x: NDArray[Any]) -> NDArray[Any]:
    """Points as rows of their numbers; there may be none."""
    return x.reshape(len(x), int(np.prod(x.shape[1:])))


class Result:
    """The result of a run. ``r["y"]`` is ``r.y``, as in SciPy.

    Attributes
    ----------
    t : (k,) array
        The times of the output.
    y : (k, ...) array, or Quantities
        The points. **Time is the first axis.** Of a problem and of parts: arrays by name, which are attributes of the
        result, too.
    sol : OdeSolution or None
        The solution at all times, with ``dense_output=True``.
    t_events, y_events : list of arrays
        For each event its zeros and the points there, before a change. Without events they are empty.
    status : int
        0: the end was reached. 1: an event or the callback ended the run. −1: the run failed; all that it reached is here.
    message : str
        The reason.
    success : bool
        True if status ≥ 0.
    nfev, nsteps, nrejected : int
        Evaluations of f, accepted steps, rejected attempts. An implicit method counts those of a Python function only: else
        nfev is None.
    largest_step : float
        The largest accepted step.
    t_end, y_end : float, array
        The end of the run, also of one that failed. ``y_end`` may be the ``y0`` of another run. Of a problem it is a dict of
        its quantities.
    drift : dict
        Of a problem: the largest |value − value at the start| of each invariant, over the output. The start is that of the
        run, also where the output begins later.
    residual : float
        A power of two above the distances from M that were found when the state was corrected to M in the run, and at its
        end. That of y0 is not among them.
    restored : int
        How often the state was corrected to M.
    unsure_steps : int
        The number of steps in which zeros of events may be missed, because the function of an event turns much faster than
        the state. Methods of order below 10 look into long steps only, and where there may be two zeros.
    """

    t: Array
    y: Any
    sol: OdeSolution | None
    t_events: list[Array]
    y_events: list[Any]
    status: int
    message: str
    nfev: int | None
    nsteps: int
    nrejected: int
    largest_step: float
    t_end: float
    y_end: Any
    residual: float
    restored: int
    unsure_steps: int

    def __init__(self, **values: Any) -> None:
        self.__dict__.update(values)

    def __getattr__(self, name: str) -> Any:
        y = self.__dict__.get("y")
        if isinstance(y, Quantities) and name in y:
            return y[name]
        known = f", expected one of {', '.join(y)}" if isinstance(y, Quantities) else ""
        raise AttributeError(f"the result has no {name!r}{known}")

    def __dir__(self) -> list[str]:
        y = self.__dict__.get("y")
        return [*super().__dir__(), *(y if isinstance(y, Quantities) else ())]

    def __getstate__(self) -> dict[str, Any]:
        # f or an event may be a function that cannot be pickled. What repeats a problem without them is a partial.
        state = {name: value for name, value in self.__dict__.items() if name != "_again" or isinstance(value, partial)}
        return {**state, "_first": self._start()} if "_first" in state else state

    def _start(self) -> Quantities | None:
        """The quantities at the start of a problem, which are found when they are asked for; none without rows."""
        first = self.__dict__["_first"]
        return first if isinstance(first, Quantities) else first() if first and len(self.t) else None

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)

    @property
    def drift(self) -> dict[str, float]:
        """Of a problem: the largest |value − value at the start| of each invariant, over the output."""
        layout = self.__dict__.get("_layout")
        if not isinstance(layout, Layout):
            return {}
        start = self._start()
        return {} if start is None or not len(self.t) else layout.drift(start, self.__dict__["_rows"])

    @property
    def success(self) -> bool:
        """True if the end was reached, or an event ended the run."""
        return self.status >= 0

    def check(self) -> Result:
        """Return the result. Raise :class:`lieflow.RunError` if the run failed."""
        if not self.success:
            raise RunError(self.message)
        return self

    def as_rotation(self) -> Any:
        """Return the points as SciPy's Rotation.

        These are rotations (k, 3, 3), unit quaternions (k, 4), or the ``attitude`` or ``quaternion`` of a problem. Other
        points are refused.
        """
        from scipy.spatial.transform import Rotation  # type: ignore[import-untyped, import-not-found, unused-ignore]

        y = self.y
        if isinstance(y, Quantities):
            known = [name for name in ("attitude", "quaternion") if name in y]
            if not known:
                expected = "attitude or quaternion among them; lieflow.so3.as_rotation takes rotations of another name"
                raise ArgumentError("y", f"the quantities {', '.join(y)}", expected)
            y = y[known[0]]
        if y.shape[1:] == (3, 3) and np.isrealobj(y):
            first("y", ~so3.contains(y, MEMBERSHIP), "a matrix that is no rotation", "rotations")
            return Rotation.from_matrix(y)
        if y.shape[1:] == (4,) and np.isrealobj(y):
            off = np.abs(np.linalg.norm(y, axis=1) - 1.0)
            first("y", ~(off <= MEMBERSHIP), "a vector of another length than 1", "unit quaternions")
            return Rotation.from_quat(y, scalar_first=True)
        raise ArgumentError("y", f"shape {y.shape}", "rotations (k, 3, 3) or unit quaternions (k, 4)")

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame: the index is t, the columns are the numbers of y by rows.

        A complex number has two columns: all real parts are there first, then the imaginary parts.
        """
        import pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]

        layout = self.__dict__["_layout"]
        if isinstance(layout, Layout):
            names, rows = layout.columns(), layout.numbers(self.__dict__["_rows"])
        elif isinstance(self.y, Quantities):
            names = layout.columns()
            rows = np.column_stack([_by_rows(self.y[name]) for name in layout._places])
        else:
            numbers = _by_rows(self.y)
            is_complex = np.iscomplexobj(numbers)
            letters = ["re", "im"] if is_complex else ["y"]
            names = [name for letter in letters for name in numbered(letter, self.y.shape[1:])]
            rows = np.hstack([numbers.real, numbers.imag]) if is_complex else numbers
        return pandas.DataFrame(rows, index=pandas.Index(self.t, name="t"), columns=names)

    def estimate_error(self) -> ErrorEstimate:
        """Return how far the outputs and the events are from the exact motion, or from a second run.

        Where steps have one size, the second run has each step in two parts, from a third to two thirds of it: a torque whose
        period divides the steps has other phases there. Where it is quick, a run in steps that end elsewhere looks for jumps of f
        that both passed over. Else it has a tenth of the tolerances; where these are the least that
        rounding allows, ten times the tolerances. Then the estimate is mostly too large.
        Rounding that both share is seen by a third run, from a start whose numbers are changed by 64 ε: the estimate is no
        smaller than a sixteenth of its distance, or than all of it where that is a tenth of the size of the points.
        Where the steps are the same again, because tolerances below rounding choose them, it takes steps of a quarter of
        their mean size. Where it is quick (0.3 s, or the time of the run), a run by tolerances takes at least 2000 steps, so
        that it finds a short pulse of f that the first one passed over. A RuntimeWarning tells that zeros of events may be
        missed in the second run.
        """
        again = self.__dict__.get("_again")
        if again is None:
            raise RunError("the run cannot be repeated: this is a copy of the result without f")
        found_by, other, grown = again(self)
        warn_of_events(other)
        # Where an event changes the state, a row at the end of a step has the new one, and another row the old one.
        changes = [self.t_events[i] for i in self._changes]
        rows = ~np.isin(self.t, np.concatenate([*changes, []]))
        rows = rows if rows.any() else np.ones_like(rows)
        y: Any
        if not len(self.t):
            y = self._error_at_end(other, grown)
        elif isinstance(self.y, Quantities):
            y = {
                name: _error(x[rows], other.y[name][rows], None if grown is None else grown.y[name][rows])
                for name, x in self.y.items()
            }
        else:
            y = _error(self.y[rows], other.y[rows], None if grown is None else grown.y[rows])
        forward = self.t_end >= self.t[0] if len(self.t) else True

        def apart(own: Array, others: Array) -> float:
            # The second run goes on a little after a zero that ended the first.
            more = others[len(own) :]
            late = (more > self.t_end) if forward else (more < self.t_end)
            others = others[: len(own)] if late.all() else others
            return float(np.abs(own - others).max(initial=0.0)) if len(own) == len(others) else float("inf")

        times = [apart(own, others) for own, others in zip(self.t_events, other.t_events)]
        return ErrorEstimate(found_by, y, times)

    def _error_at_end(self, other: Result, grown: Result | None) -> Any:
        """The error of y_end, where a run has no outputs."""
        if self.status != 0 or self._changes:
            raise RunError("no estimate: the run has no outputs, and it did not end at the end of its span without changes")

        ends = [self.y_end, other.y_end] if grown is None else [self.y_end, other.y_end, grown.y_end]

        def error(first: Any, second: Any, changed: Any = None) -> float:
            return _error(first[None], second[None], None if changed is None else changed[None])

        if isinstance(self.y_end, np.ndarray):
            return error(*ends)
        return {name: error(*[end[name] for end in ends]) for name in self.y_end.keys()}

    def keys(self) -> list[str]:
        """Return the names of what the result has, the quantities too, for ``r["y"]`` and ``dict(r)``."""
        own = [*(name for name in self.__dict__ if not name.startswith("_")), "success", "drift"]
        return list(dict.fromkeys([*own, *(self.y if isinstance(self.y, Quantities) else ())]))

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __getitem__(self, name: str) -> Any:
        if name in self:
            return getattr(self, name)
        raise KeyError(f"the result has no {name!r}")

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __repr__(self) -> str:
        if isinstance(self.y, Quantities):
            shape = f"{len(self.t)} rows of {', '.join(self.y)}"
        else:
            shape = f"{len(self.t)} points of shape {self.y.shape[1:]}"
        return f"<lieflow.Result: {shape}, status {self.status}, {self.nsteps} steps, {self.message}>"

