"""solve_ivp on Lie groups and the manifolds they act on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._arrays import real
from ._errors import ArgumentError, RunError
from ._groups import Group

__all__ = ["CFunction", "Event", "OdeSolution", "Result", "solve_ivp"]

Array = NDArray[np.float64]

#: The tolerances if none are given.
RTOL = 1e-8
ATOL = 1e-8


class Event:
    """An event: the zeros of g(t, y), with what happens there.

    Parameters
    ----------
    g : callable
        g(t, y, *args), a number. Where it changes its sign, the zero is found to rounding of t.
    terminal : int or bool
        The zero that ends the run, from 1. True is 1, and 0 or False is none.
    direction : float
        Only rising zeros for a positive number, only falling ones for a negative number.
    change : callable, optional
        change(t, y, *args) returns the new y. The run goes on from it. It must be on M.
    points : int, optional
        At how many points of each step g is evaluated. The default depends on g.
    name : str, optional
        The name in messages.
    """

    __slots__ = ("change", "direction", "g", "name", "points", "terminal")

    def __init__(
        self,
        g: Callable[..., Any],
        terminal: int | bool = 0,
        direction: float = 0.0,
        change: Callable[..., Any] | None = None,
        points: int | None = None,
        name: str | None = None,
    ) -> None:
        if not callable(g):
            raise TypeError(f"g: a value of type {type(g).__name__}, expected a function of t and y")
        if change is not None and not callable(change):
            raise TypeError(f"change: a value of type {type(change).__name__}, expected a function of t and y")
        if terminal != int(terminal) or terminal < 0:
            raise ArgumentError("terminal", repr(terminal), "an integer ≥ 0, True or False")
        self.g, self.change = g, change
        self.terminal, self.direction = int(terminal), float(direction)
        self.points = None if points is None else int(points)
        self.name = name if name is not None else getattr(g, "__name__", "event")

    def __repr__(self) -> str:
        return f"lieflow.Event({self.name}, terminal={self.terminal}, direction={self.direction})"


def _event(i: int, g: Any) -> Event:
    """An event of SciPy's kind: a function with the attributes terminal and direction."""
    if isinstance(g, Event):
        return g
    if not callable(g):
        raise TypeError(f"events[{i}]: a value of type {type(g).__name__}, expected a function of t and y")
    return Event(g, getattr(g, "terminal", None) or 0, getattr(g, "direction", None) or 0.0)


class CFunction:
    """The address of a C function as f: ``void f(double t, const double *y, double *v, const double *p)``.

    y has the numbers of the point by rows, v gets the value of f and is 0 before, p is ``parameters``. The run calls it
    without the interpreter. A wrong address cannot be seen and ends the program.

    Parameters
    ----------
    function : int, or an object with an address
        An integer, ``numba.cfunc`` (its ``address``), a function of ctypes, or a ``scipy.LowLevelCallable``.
    parameters : array_like
        The numbers p.
    """

    __slots__ = ("address", "function", "parameters")

    def __init__(self, function: Any, parameters: ArrayLike = ()) -> None:
        self.function = function
        self.parameters = [float(x) for x in np.atleast_1d(real("parameters", parameters)).ravel()]
        self.address = _address(function)


def _address(function: Any) -> int:
    import ctypes

    if isinstance(function, bool) or function is None:
        raise TypeError(f"fun: {function}, expected the address of a C function")
    address: Any
    if isinstance(function, (int, np.integer)):
        address = int(function)
    elif hasattr(function, "address") and isinstance(function.address, int):
        address = function.address
    elif hasattr(function, "argtypes") and hasattr(function, "restype"):  # of ctypes
        address = ctypes.cast(function, ctypes.c_void_p).value or 0
    elif type(function).__name__ == "LowLevelCallable":
        return _address(function.function)
    else:
        raise TypeError(f"fun: a value of type {type(function).__name__}, expected the address of a C function")
    if address <= 0:
        raise ArgumentError("fun", f"the address {address}", "the address of a C function")
    return int(address)


class OdeSolution:
    """The solution at all times of a run, from its stored polynomials. f is not called.

    ``sol(t)`` has the shape of t followed by that of y. Times may be in any order. It can be pickled, and used from any
    thread. Error: that of the continuous extension of the method. A time outside of the run is refused.
    """

    __slots__ = ("_curve", "_made_by")

    def __init__(self, curve: _lieflow.Curve, made_by: tuple[Any, ...]) -> None:
        self._curve, self._made_by = curve, made_by

    def __call__(self, t: ArrayLike) -> Array:
        return self._curve.at(t)

    @property
    def t_min(self) -> float:
        """The smallest time."""
        return min(self._curve.t_span)

    @property
    def t_max(self) -> float:
        """The largest time."""
        return max(self._curve.t_span)

    @property
    def n_segments(self) -> int:
        """The number of steps."""
        return self._curve.steps

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return (_restored, (self._made_by, self._curve.numbers()))


def _restored(made_by: tuple[Any, ...], numbers: Array) -> OdeSolution:
    space, method, linear, y0 = made_by
    curve = _lieflow.Space(*space).curve(method, linear, y0, numbers.tolist())
    return OdeSolution(curve, made_by)


class Result:
    """The result of a run.

    Attributes
    ----------
    t : (k,) array
        The times of the output.
    y : (k, ...) array
        The points. **Time is the first axis.**
    sol : OdeSolution or None
        The solution at all times, with ``dense_output=True``.
    t_events, y_events : list of arrays
        For each event its zeros and the points there, before a change.
    status : int
        0: the end was reached. 1: an event ended the run. −1: the run failed; all that it reached is here.
    message : str
        The reason.
    success : bool
        True if status ≥ 0.
    nfev, nsteps, nrejected : int
        Evaluations of f (None if the method does not count them), accepted steps, rejected attempts.
    t_end, y_end : float, array
        The end of the run.
    residual : float
        A power of two above the distances from M that were found when the state was corrected to M.
    restored : int
        How often the state was corrected to M.
    """

    t: Array
    y: Array
    sol: OdeSolution | None
    t_events: list[Array]
    y_events: list[Array]
    status: int
    message: str
    nfev: int | None
    nsteps: int
    nrejected: int
    t_end: float
    y_end: Array
    residual: float
    restored: int
    group: str | None

    def __init__(self, **values: Any) -> None:
        self.__dict__.update(values)

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
        """Return the points as SciPy's Rotation; for matrices of shape (k, 3, 3) and unit quaternions (k, 4)."""
        from scipy.spatial.transform import Rotation

        if self.y.shape[1:] == (3, 3):
            return Rotation.from_matrix(self.y)
        if self.y.shape[1:] == (4,):
            return Rotation.from_quat(self.y, scalar_first=True)
        raise ArgumentError("y", f"shape {self.y.shape}", "rotations (k, 3, 3) or unit quaternions (k, 4)")

    def to_dataframe(self) -> Any:
        """Return a pandas DataFrame: the index is t, the columns are the numbers of y by rows."""
        import pandas

        places = np.ndindex(*self.y.shape[1:])
        names = ["y" + "".join(str(i + 1) for i in place) for place in places]
        return pandas.DataFrame(self.y.reshape(len(self.t), -1), index=pandas.Index(self.t, name="t"), columns=names)

    def __iter__(self) -> Iterator[str]:
        return iter(self.__dict__)

    def __repr__(self) -> str:
        shape = f"{len(self.t)} points of shape {self.y.shape[1:]}"
        return f"<lieflow.Result: {shape}, status {self.status}, {self.nsteps} steps, {self.message}>"


def _positive(name: str, x: Any, whole: bool = False) -> Any:
    if x is None:
        return None
    if isinstance(x, (str, bytes, complex)):
        raise TypeError(f"{name}: {x!r}, expected a number")
    number = float(x)
    if not number > 0 or (whole and (not np.isfinite(number) or number != int(number))):
        raise ArgumentError(name, repr(x), "an integer > 0" if whole else "a number > 0")
    return int(number) if whole else number


def solve_ivp(
    fun: Callable[..., Any] | CFunction,
    t_span: Sequence[float],
    y0: ArrayLike,
    *,
    method: str = "rkmk dop853 exp",
    t_eval: ArrayLike | None = None,
    dense_output: bool = False,
    events: Any = None,
    rtol: float | None = None,
    atol: float | None = None,
    first_step: float | None = None,
    min_step: float | None = None,
    max_step: float | None = None,
    max_steps: int | None = None,
    dt: float | None = None,
    steps: int | None = None,
    stops: ArrayLike = (),
    args: tuple[Any, ...] = (),
    group: str | Group | None = None,
    action: str = "translation",
    frame: str | None = None,
    linear: bool = False,
    callback: Callable[[float, Array], Any] | None = None,
) -> Result:
    """Solve ẏ = λ_*(f(t, y))(y) on a manifold M with the action of a Lie group.

    On a group (``action="translation"``) this is ẏ = f y in space, and ẏ = y f in the body. Every point is on M to
    rounding.

    Parameters
    ----------
    fun : callable or CFunction
        f(t, y, *args), the value in 𝔤: 3 numbers ω for SO(3) and unit quaternions, 6 numbers (ω, v) for SE(3), an n×n
        matrix for other groups. With ``linear=True`` it is f(t, *args).
    t_span : (float, float)
        From when to when, forward or backward.
    y0 : array_like
        The start. It must be on M to 1e-6.
    method : str
        A method of lieflow with its tableau and its map.
    t_eval : array_like, optional
        The times of the output, in order, each once. **A time outside of t_span is an error.** By default the ends of
        steps.
    dense_output : bool
        Keep the solution at all times, ``result.sol``.
    events : callable, Event, or a list of them
        Functions g(t, y, *args), with SciPy's attributes ``terminal`` and ``direction``, or :class:`lieflow.Event`.
    rtol, atol : float, optional
        Tolerances for each step. **The defaults are 1e-8, not 1e-3 and 1e-6.** On a group the error is an angle, and the
        tolerance rtol + atol.
    first_step, min_step, max_step, max_steps : optional
        Limits of the adaptive step size.
    dt, steps : optional
        Steps of one size, or so many. Then rtol and atol are not used.
    stops : array_like
        Times at which a step ends, where f or one of its derivatives jumps.
    args : tuple
        Further arguments of f and of the events.
    group : str or Group
        "SO(3)", "SE(3)", "S3" (unit quaternions, real part first), "SO(n)", "SL(n)", "GL(n)", "Sp(2m)", "SO(p,q)" with
        numbers, or a Group.
    action : str
        "translation", "linear" (vectors or columns), "conjugation", "coadjoint", "lagrangian".
    frame : "space" or "body"
        The frame of f. It must be given for ``action="translation"``.
    linear : bool
        f depends only on t. Methods for linear equations, as "magnus4", then fit.
    callback : callable, optional
        callback(t, y) is called at each point of the output. If it returns True, the run ends.

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
    span = real("t_span", t_span)
    if span.shape != (2,):
        raise ArgumentError("t_span", f"shape {span.shape}", "two times")
    if np.isnan(span).any() or not np.isfinite(span[0]):
        raise ArgumentError("t_span", repr(t_span), "two times, the first one finite")
    if group is None:
        raise ArgumentError("group", "None", 'the name of a group, such as "SO(3)"')
    if not isinstance(group, (str, Group)):
        raise TypeError(f"group: a value of type {type(group).__name__}, expected a name or a Group")
    form: tuple[int, list[float]] | None = None
    name = group if isinstance(group, str) else group.name
    if isinstance(group, Group) and group._args[3] is not None:
        form = (group.n, [float(x) for x in group._args[3].ravel()])
    for key, text in (("method", method), ("action", action)):
        if not isinstance(text, str):
            raise TypeError(f"{key}: a value of type {type(text).__name__}, expected a name")
    if not (frame is None or isinstance(frame, str)):
        raise TypeError(f"frame: a value of type {type(frame).__name__}, expected \"space\" or \"body\"")
    start = real("y0", y0)
    space_args = (name, form, action, frame, start.shape)
    space = _lieflow.Space(*space_args)
    if not np.isfinite(start).all():
        place = tuple(int(i) for i in np.argwhere(~np.isfinite(start))[0])
        raise ArgumentError(f"y0[{', '.join(map(str, place))}]", repr(float(start[place])), "a finite number")

    field: tuple[Any, Any]
    if isinstance(fun, CFunction):
        if args:
            raise ArgumentError("args", repr(args), "no arguments: the numbers of a CFunction are its parameters")
        field = (fun.address, fun.parameters)
    elif callable(fun) and not hasattr(fun, "address"):
        field = (fun, list(args))
    elif isinstance(fun, int) or hasattr(fun, "address"):
        field = (_address(fun), [float(x) for x in args])
    else:
        raise TypeError(f"fun: a value of type {type(fun).__name__}, expected a function of t and y")

    given = events if isinstance(events, (list, tuple)) else () if events is None else (events,)
    planned = [_event(i, g) for i, g in enumerate(given)]
    times = None
    if t_eval is not None:
        rows = real("t_eval", t_eval)
        if rows.ndim != 1:
            raise ArgumentError("t_eval", f"shape {rows.shape}", "a list of times")
        low, high = min(span), max(span)
        outside = ~((rows >= low) & (rows <= high))
        if outside.any():
            i = int(np.argmax(outside))
            raise ArgumentError(f"t_eval[{i}]", repr(float(rows[i])), f"a time within [{low}, {high}]")
        times = rows.tolist()
    if dt is not None and steps is not None:
        raise ArgumentError("steps", repr(steps), "only one of dt and steps")
    settings = {
        "rtol": RTOL if rtol is None else float(rtol),
        "atol": ATOL if atol is None else float(atol),
        "first_step": _positive("first_step", first_step),
        "min_step": _positive("min_step", min_step),
        "max_step": None if max_step is None or np.isinf(max_step) else _positive("max_step", max_step),
        "max_steps": _positive("max_steps", max_steps, whole=True),
        "dt": _positive("dt", dt),
        "steps": _positive("steps", steps, whole=True),
        "t_eval": times,
        "stops": np.atleast_1d(real("stops", stops)).tolist(),
        "dense_output": bool(dense_output),
        "linear": bool(linear),
    }
    flat = start.ravel().tolist()
    parts = [(e.g, f"events[{i}] ({e.name})", e.direction, e.terminal, e.change, e.points) for i, e in enumerate(planned)]
    found = _lieflow.solve(space, field, method, (float(span[0]), float(span[1])), flat, settings, parts, callback)
    curve = found.pop("curve")
    made_by = (space_args, method, bool(linear), flat)
    return Result(sol=None if curve is None else OdeSolution(curve, made_by), group=name, **found)
