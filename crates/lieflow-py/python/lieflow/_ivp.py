"""solve_ivp on Lie groups and the manifolds they act on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lieflow
from ._arrays import MEMBERSHIP, Array, finite, kept, name_of, real, value
from ._errors import ArgumentError, RunError
from ._events import Event, changes_of, events_of, for_second_run, texts_of
from ._fields import CFunction, Field, Parts, Quantities, Samples, State, address
from ._groups import Group
from ._problems import Problem
from ._result import Layout, OdeSolution, Result, warn_of_events
from ._second_run import Repeated, beyond, changed, second
from ._settings import args_of, check_stops, settings_of, span_of, times_of
from ._types import Args, Flag, Matrices, Real, Span, Whole
from ._unitary import ComplexPoints, ComplexState, Unitary, four_numbers, is_su2, is_unitary_name, of_rotation

__all__ = ["solve_ivp"]


#: The method if none is given.
METHOD = "rkmk dop853 exp"


#: The last spaces: to make one again costs more than a short run.
_SPACES: dict[Any, _lieflow.Space] = {}


def _space(*given: Any) -> _lieflow.Space:
    return kept(_SPACES, given, lambda: _lieflow.Space(*given))


class Ready:
    """A field of the user on its space, ready to run."""

    __slots__ = (
        "args", "calls", "field", "flat", "group", "jumps", "kinks", "layout", "linear", "parts", "shape", "space", "space_args",
    )

    def __init__(
        self, fun: Any, y0: Any, args: tuple[Any, ...], group: Any, action: Any, frame: Any, linear: Flag,
        span: tuple[float, float],
    ) -> None:
        if isinstance(fun, Field):
            if group is not None and group != fun.group:
                raise ArgumentError("group", repr(group), "none: the Field has its group")
            group = fun.group
        if group is None:
            raise ArgumentError("group", "None", 'the name of a group, such as "SO(3)"')
        if not isinstance(group, (str, Group, Unitary, Parts)):
            raise TypeError(f"group: a value of type {type(group).__name__}, expected a name, a Group, U(n) or Parts")
        name_of("action", action)
        if not (frame is None or isinstance(frame, str)):
            raise TypeError(f"frame: a value of type {type(frame).__name__}, expected \"space\" or \"body\"")
        y0 = of_rotation(group, y0)
        self.parts = group if isinstance(group, Parts) else None
        self.layout: Parts | ComplexPoints | None = self.parts
        if isinstance(group, Unitary) or isinstance(group, str) and is_unitary_name(group):
            # SU(2) is the group of unit quaternions, too.
            if isinstance(group, Unitary) or not is_su2(group) or not four_numbers(y0):
                self.layout = ComplexPoints()
        start = real("y0", y0) if self.layout is None else self.layout.join("y0", y0, True)
        name: Any = group
        if isinstance(group, Parts):
            name = group.counts()
        elif isinstance(group, Group):
            form = group._args[3]
            name = group.name if form is None else (group.n, tuple(form.ravel().tolist()))
        elif isinstance(group, Unitary):
            name = group.name
        self.group = group
        self.space_args = (name, action, frame, start.shape)
        self.space = _space(*self.space_args)
        if isinstance(self.layout, ComplexPoints):
            self.layout = ComplexPoints(tuple(self.space.point[:-1]), tuple(self.space.value[:-1]))
        finite("y0", start)
        self.flat, self.shape = start.ravel().tolist(), start.shape
        self.linear, self.args = bool(linear), list(args)
        self.jumps: list[float] = []
        self.kinks: list[float] = []
        self.field = self._field(fun, span)
        self.calls = isinstance(self.field, tuple) and callable(self.field[0])

    def _field(self, fun: Any, span: tuple[float, float]) -> Any:
        if isinstance(fun, (CFunction, Field, Samples)) and self.args:
            expected = "no arguments: the constants of a Field, of Samples and of a CFunction are its own"
            raise ArgumentError("args", repr(tuple(self.args)), expected)
        if isinstance(fun, CFunction):
            return (fun.address, fun.parameters)
        if isinstance(fun, Field):
            if isinstance(self.layout, ComplexPoints):
                expected = "a function; formulas have real values (lf.MatrixOde and lf.Schrodinger have complex ones)"
                raise ArgumentError("fun", f"formulas for {self.group}", expected)
            formulas = fun.formulas(fun.field, self.shape, tuple(self.space.value))
            if self.linear and formulas.depends_on_y:
                raise ArgumentError("linear", "True", "False: the formulas of f depend on y")
            self.jumps, self.kinks = formulas.knots(span)
            self.linear = self.linear or self.space.has_linear_methods and not formulas.depends_on_y
            return formulas
        if isinstance(fun, Samples):
            if fun.values.shape[1] != int(np.prod(self.space.value)):
                expected = f"{int(np.prod(self.space.value))}, a value of f at each time"
                raise ArgumentError("fun", f"samples of {fun.values.shape[1]} columns", expected)
            if isinstance(self.group, Parts):
                fun = Samples(fun.t, self.group.in_order(fun.values), fun.interpolation)
            self.jumps, self.kinks = fun._sampled.knots(span)
            self.linear = self.linear or self.space.has_linear_methods
            return fun._sampled
        if hasattr(fun, "argtypes") and hasattr(fun, "restype") or type(fun).__name__ == "LowLevelCallable":
            raise TypeError(f"fun: a value of type {type(fun).__name__}, expected lf.CFunction(fun, parameters) of it")
        if callable(fun) and not hasattr(fun, "address"):
            return (self._on_layout(fun), self.args)
        if isinstance(fun, (int, np.integer)) and not isinstance(fun, bool):
            raise TypeError(f"fun: {fun}, expected a function of t and y; an address of a C function goes through lf.CFunction")
        if hasattr(fun, "address"):
            return (address(fun), [float(x) for x in self.args])
        raise TypeError(f"fun: a value of type {type(fun).__name__}, expected a function of t and y")

    def _on_layout(self, fun: Any) -> Any:
        """f of parts or of complex arrays as f of real numbers."""
        layout = self.layout
        if layout is None:
            return fun
        if self.linear:
            return lambda t, *args: _joined(layout.join, "f", t, fun(t, *args), False)

        def of_numbers(t: float, y: Array, *args: Any) -> Array:
            return _joined(layout.join, "f", t, fun(t, layout.split(y), *args), False)

        return of_numbers

    def event(self, i: int, event: Event, field: Any) -> tuple[Any, ...]:
        """Return the parts of an event."""
        change, layout = event.change, self.layout
        g: Any = event.g
        if isinstance(g, str):
            group = self.group.name if isinstance(self.group, Unitary) else self.group
            maker = field if isinstance(field, Field) else Field(group, g)
            try:
                g = maker.formulas(g, self.shape, (), isinstance(layout, ComplexPoints))
            except ArgumentError as error:
                raise ArgumentError(f"events[{i}]", error.value, error.expected) from None
        elif layout is not None:
            of_layout = g
            g = lambda t, y, *args: of_layout(t, layout.split(y), *args)  # noqa: E731
        name = f"events[{i}] ({event.name})"
        if layout is None and change is not None and self.shape == (4,):
            of_group = change
            change = lambda t, y, *args: of_rotation(self.group, of_group(t, y, *args))  # noqa: E731
        elif layout is not None and change is not None:
            of_parts = change

            def change(t: float, y: Array, *args: Any) -> Array:
                return _joined(layout.join, f"change of events[{i}]", t, of_parts(t, layout.split(y), *args), True)

        elif change is not None and self.shape == (4, 4) and self.space.value == [6]:
            change = _of_motions(f"change of {name}", change)
        return (g, name, event.direction, event.terminal, change, event.points)


def _joined(join: Callable[..., Array], name: str, t: float, *x: Any) -> Array:
    """The numbers of the value of a function of the user at t. Raise TypeError for another value."""
    try:
        return join(f"{name} at t = {t}", *x)
    except ArgumentError as error:
        raise TypeError(str(error)) from None


def _of_motions(name: str, change: Callable[..., Any]) -> Callable[..., Array]:
    """A change of matrices of SE(3), whose last row is looked at: a run has no place for it."""

    def checked(t: float, y: Array, *args: Any) -> Array:
        found = value(name, change(t, y, *args), (4, 4), t)
        for j, right in enumerate((0, 0, 0, 1)):
            if abs(found[3, j] - right) > MEMBERSHIP:
                expected = f"{right}: the last row of [R x; 0 1] is [0, 0, 0, 1]"
                raise ArgumentError(f"{name} at t = {t}, y[3, {j}]", str(float(found[3, j])), expected)
        return found

    return checked


def solve_ivp(
    fun: Callable[..., Any] | CFunction | Field | Samples | Problem,
    t_span: Span,
    y0: Matrices | Mapping[str, Any] | None = None,
    *,
    method: str | None = None,
    t_eval: ArrayLike | None = None,
    dense_output: Flag = False,
    events: Any = None,
    rtol: Real | None = None,
    atol: Real | None = None,
    first_step: Real | None = None,
    min_step: Real | None = None,
    max_step: Real | None = None,
    max_steps: Whole | None = None,
    dt: Real | None = None,
    steps: Whole | None = None,
    stops: ArrayLike = (),
    args: Args = (),
    group: str | Group | Unitary | Parts | None = None,
    action: str = "translation",
    frame: str | None = None,
    linear: Flag = False,
    quantities: Sequence[str] | str | None = None,
    callback: Callable[[float, Any], Any] | None = None,
) -> Result:
    """Solve ẏ = λ_*(f(t, y))(y) on a manifold M with the action of a Lie group.

    On a group (``action="translation"``) this is ẏ = f y in space, and ẏ = y f in the body. Every point is on M to
    rounding, but for rk and the Gauss methods in space; on SL(n) and SU(n) with n > 2 the maps cay and pade22 leave det = 1 by the error of the method.

    Parameters
    ----------
    fun : callable, Problem, Field, Samples or CFunction
        f(t, y, *args), the value in 𝔤: 3 numbers ω for SO(3) and unit quaternions, 6 numbers (ω, v) for SE(3), an n×n
        matrix for other groups. With ``linear=True`` it is f(t, *args). A problem such as ``lf.RigidBody(…)`` has its own
        start, group and frame.
    t_span : (float, float)
        From when to when, forward or backward.
    y0 : array_like
        The start. It must be on M to 1e-6. Of Parts it is a dict. A problem has its own; here is then the ``y_end`` of
        another run, the numbers of a state in the order of :attr:`lieflow.Integrator.state`, or the complex array of one
        that is complex.
    method : str, optional
        A method of lieflow with its tableau and its map. The default is "rkmk dop853 exp"; of a problem its
        own, where ``dense_output`` can keep the points within its steps.
    t_eval : array_like, optional
        The times of the output, in order, each once. **A time outside of t_span is an error.** By default the ends of
        steps.
    dense_output : bool
        Keep the solution at all times, ``result.sol``.
    events : callable, text, Event, or a list of them
        Functions g(t, y, *args), with SciPy's attributes ``terminal`` and ``direction``; columns and formulas, of complex
        numbers ``re11``, ``im11`` and so on; or :class:`lieflow.Event`.
    rtol, atol : float, optional
        Tolerances for each step. **The defaults are those of scenes, 1e-14 for methods of order 8; beside the one that is
        given the other is 0.** On a group the error is an angle, and the tolerance rtol + atol. Methods that compare two
        points of M, which are all but rkmk with a pair and Taylor series, have rtol·min(1, 10·(angle of the step)) in place
        of rtol.
    first_step, min_step, max_step, max_steps : optional
        Limits of the adaptive step size.
    dt, steps : optional
        Steps of one size, or so many. Then rtol, atol and the limits of the step size are refused. The last step, and
        that before a stop, may be shorter; after a stop the steps of this size begin again.
    stops : array_like, optional
        Times at which a step ends, where f or one of its derivatives jumps. f is not evaluated at a stop. Those of samples
        are added. With ``steps`` a stop between two of them is one step more.
    args : tuple
        Further arguments of f, of the events and of their changes. The callback has none.
    group : str, Group or Parts
        "SO(3)", "SE(3)", "S3" (unit quaternions, real part first), "SO(n)", "SL(n)", "GL(n)", "Sp(2m)", "SO(p,q)" with
        numbers, a Group, or Parts.
    action : str
        "translation": ẏ = f y in space, ẏ = y f in the body. "linear": ẏ = f y of vectors or columns, on SO(3) ẏ = f × y.
        "conjugation": ẏ = f y − y f. "coadjoint": ẏ = −ad*_f y, which is f × y on SO(3) and y fᵀ − fᵀ y of matrices, on
        U(n) with f† (**a body has f = −ω**, ẏ = y × ω). "lagrangian": ẏ = c − aᵀ y − y a − y b y with f = [a b; c −aᵀ].
    frame : "space" or "body"
        The frame of f. It must be given for ``action="translation"``.
    linear : bool
        f depends only on t. Methods for linear equations, as "magnus4", then fit, in both frames.
    quantities : list of str, optional
        Of a problem: what is computed.
    callback : callable, optional
        callback(t, y), without ``args``, is called at each point of the output. If it returns True, the run ends there.

    Returns
    -------
    Result
        A run that fails has status −1, and all that it reached. :meth:`Result.check` raises.

    Raises
    ------
    ArgumentError
        An argument that cannot be used, with its name, value and what was expected.
    TypeError
        An argument or a value of f of another type.

    Notes
    -----
    An exception in f, in an event or in the callback ends the run and leaves as the same object.
    Source: H. Munthe-Kaas, High order Runge–Kutta methods on manifolds, Appl. Numer. Math. 29 (1999).
    """
    span = span_of(t_span)
    if method is not None:
        name_of("method", method)
    args = args_of(args)
    if not (callback is None or callable(callback)):
        raise TypeError(f"callback: a value of type {type(callback).__name__}, expected a function of t and y")
    planned = events_of(events)
    if math.isinf(span[1]) and callback is None and not any(event.terminal for event in planned):
        raise ArgumentError("t_span", f"({span[0]}, {span[1]})", "an end, or an event with terminal")
    settings = settings_of(
        rtol, atol, first_step, min_step, max_step, max_steps, dt, steps, stops, dense_output, linear
    )
    times = times_of(t_eval, span)
    check_stops(settings, span)
    if isinstance(fun, Problem):
        check_of_problem(group, frame, action, linear)
        if args and not any(callable(event.g) or event.change for event in planned):
            raise ArgumentError("args", repr(args), "none: a problem takes no arguments, and no event is a function")
        return warn_of_events(_of_problem(fun, span, y0, method, settings, times, planned, quantities, callback, args))
    if quantities is not None:
        raise ArgumentError("quantities", repr(quantities), "none: only a problem has quantities")
    space = args, group, action, frame
    method = METHOD if method is None else method
    return warn_of_events(_of_field(fun, span, y0, method, settings, times, planned, callback, space))


def _of_field(
    fun: Any, span: tuple[float, float], y0: Any, method: str, settings: dict[str, Any], times: Array | None,
    events: list[Event], callback: Any, space: tuple[Any, Any, Any, Any],
) -> Result:
    ready = Ready(fun, y0, *space, settings["linear"], span)
    own = {
        **settings, "linear": ready.linear, "stops": [*settings["stops"], *ready.jumps],
        "kinks": [*settings["kinks"], *ready.kinks],
    }
    parts = [ready.event(i, event, fun) for i, event in enumerate(events)]
    told = callback
    if callback is not None and ready.layout is not None:
        layout = ready.layout
        told = lambda t, y: callback(t, layout.split(y))  # noqa: E731
    clock = thread_time()
    found = _lieflow.solve(ready.space, ready.field, ready.args, method, span, ready.flat, own, times, parts, told)
    seconds = thread_time() - clock
    curve, _ = found.pop("curve"), found.pop("state")
    if found["nfev"] is not None:
        found["nfev"] += 1  # the call that checks the value of f at the start
    if ready.layout is not None:
        found["y"] = ready.layout.split(found["y"])
        found["y_events"] = [ready.layout.split(y) for y in found["y_events"]]
        found["y_end"] = ready.layout.split(found["y_end"])
    found["message"] = _reason(found)
    made_by = (ready.space_args, method, ready.linear, ready.flat)
    sol = None if curve is None else OdeSolution(curve, made_by, ready.layout)

    def again(result: Result) -> Repeated:
        others = for_second_run(result, events)

        def run(finer: dict[str, Any], change: float = 0.0) -> Result:
            start: Any = np.reshape(changed(ready.flat, change), ready.shape)  # y0, which may have changed
            start = start if ready.layout is None else ready.layout.split(start)
            return _of_field(fun, (span[0], beyond(result, span)), start, method, finer, result.t, others, None, space)

        return second(run, settings, result, span[0], seconds)

    return Result(sol=sol, _layout=ready.layout, _again=again, _changes=changes_of(events), **found)


def _reason(found: dict[str, Any]) -> str:
    """Why a run ended, with the formula that has no value."""
    lost, message = found.pop("lost"), found["message"]
    return f"{message}: {lost}" if lost is not None and found["status"] < 0 else message


def _one(t: float, y: Any) -> float:
    """The function of an event without zeros."""
    return 1.0


def check_of_problem(group: Any, frame: Any, action: str, linear: Flag) -> None:
    """Raise ArgumentError for an argument of a field beside a problem."""
    for name, value, default in (("group", group, None), ("frame", frame, None), ("action", action, "translation")):
        if value != default:
            raise ArgumentError(name, repr(value), "none: a problem has its own")
    if linear:
        raise ArgumentError("linear", repr(linear), "none: a problem knows whether it is linear")


def _of_problem(
    problem: Problem, span: tuple[float, float], y0: Any, method: str | None, settings: dict[str, Any],
    times: Array | None, events: list[Event], quantities: Any, callback: Any, args: tuple[Any, ...],
) -> Result:
    asked = problem.asked(quantities)
    texts = texts_of(events)
    model, layout = problem._both(asked, texts)
    if method is None:
        method = problem.method
        by_error = settings["dt"] is None and settings["steps"] is None
        # The points within a step of some methods, as Magnus methods, are shorter steps, and no numbers to keep.
        if settings["dense_output"] and not model.keeps_points(method)[by_error]:
            method = METHOD
    parts, number = [], 0
    for i, event in enumerate(events):
        g: Any = event.g
        if isinstance(g, str):
            g, number = number, number + 1
        else:
            g = _of_rows(g, layout, args)
        change = None if event.change is None else _of_state(event.change, problem._complex_state(), args, i)
        parts.append((g, f"events[{i}] ({event.name})", event.direction, event.terminal, change, event.points))
    told = None if callback is None else _of_rows(callback, layout, ())
    jumps, kinks = problem._problem.knots(span)
    own = {**settings, "stops": [*settings["stops"], *jumps], "kinks": [*settings["kinks"], *kinks]}
    start = problem._start(y0, model, method)
    clock = thread_time()
    found = model.solve(method, span, start, own, times, parts, told)
    seconds = thread_time() - clock
    found["message"] = _reason(found)
    curve, rows = found.pop("curve"), found["y"]
    found["y"] = layout.split(rows)
    found["y_events"] = [layout.split(y) for y in found["y_events"]]
    found["y_end"] = State(layout.split(found["y_end"]), found.pop("state"), problem._form(model, method))
    sol = None if curve is None else OdeSolution(curve, (problem, method, asked, texts), layout)
    by_event = found["status"] == 1 and not found["_by_callback"]
    if sol is not None and by_event and found["t_end"] != span[1] and math.isfinite(span[1]):

        def rest() -> tuple[_lieflow.Curve, RunError | None]:
            # Events without a change keep their places, so that the steps are the same, but have no zeros.
            on = [(part[0] if part[4] else _one, *part[1:3], 0, *part[4:]) for part in parts]
            whole, reason, cause = curve, None, None
            try:
                again = model.solve(method, span, start, own, None, on, None)
                whole, reason = again["curve"] or curve, None if again["status"] == 0 else _reason(again)
            except Exception as error:
                reason, cause = f"{type(error).__name__}: {error}", error
            if reason is None:
                return whole, None
            lost = RunError(f"t: the solution ends at {whole.t_span[1]}; its rest failed: {reason}")
            lost.__cause__ = cause
            return whole, lost

        sol._end, sol._rest = span[1], rest

    def first() -> Quantities:
        is_start = found["t"][0] == span[0]
        row = rows[0] if is_start else model.stepper(method, span, start, own).row()
        return layout.split(row[None], every=True)

    again: Any = partial(_problem_again, problem, span, start, method, settings, (asked, events, args), seconds)
    if any(callable(event.g) or event.change for event in events):
        repeat = again
        again = lambda result: repeat(result)  # noqa: E731, functions of the user need not pickle
    return Result(
        sol=sol, _rows=rows, _first=first, _layout=layout, _again=again, _changes=changes_of(events), **found
    )


def _problem_again(
    problem: Problem, span: tuple[float, float], start: Array | None, method: str, settings: dict[str, Any],
    given: tuple[tuple[str, ...], list[Event], tuple[Any, ...]], seconds: float, result: Result,
) -> Repeated:
    """The exact motion or a second run of a problem, beside a result whose run took so many seconds."""
    asked, events, args = given
    model, layout = problem._both(asked, texts_of(events))
    plain = start is None and len(result.t) > 0 and not changes_of(events)
    # Euler angles and quaternions are those of the rows, up to turns and signs.
    found = model.exact(span[0], result.t, method, result._rows) if plain else None
    exact = None if found is None else layout.split(found)
    if exact is not None and not events:
        return "the exact motion", Result(y=exact, t_events=[], _unsure=None), None
    others = for_second_run(result, events)

    def run(finer: dict[str, Any], change: float = 0.0) -> Result:
        of = start if change == 0.0 else changed(model.start(method) if start is None else start, change)
        return _of_problem(problem, (span[0], beyond(result, span)), of, method, finer, result.t, others, asked, None, args)

    found_by, other, grown = second(run, settings, result, span[0], seconds)
    if exact is not None:
        exactly = Result(y=exact, t_events=other.t_events, _unsure=other._unsure)
        return "the exact motion, and the events by " + found_by, exactly, None
    return found_by, other, grown


def _of_rows(g: Callable[..., Any], layout: Layout, args: tuple[Any, ...]) -> Callable[..., Any]:
    """A function of t and the quantities as one of t and a row."""

    def of_row(t: float, row: Array) -> Any:
        return g(t, layout.split(row), *args)

    return of_row


def _of_state(
    change: Callable[..., Any], form: ComplexState | None, args: tuple[Any, ...], i: int
) -> Callable[..., Any]:
    """A change of the state, which may be complex, as one of its numbers."""

    def of_numbers(t: float, numbers: Array) -> Any:
        if form is None:
            return change(t, numbers, *args)
        return _joined(form.join, f"change of events[{i}]", t, change(t, form.split(numbers), *args))

    return of_numbers
