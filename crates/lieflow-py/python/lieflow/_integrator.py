"""Runs that are taken step by step."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array, name_of, number, real
from ._errors import ArgumentError
from ._fields import Parts
from ._ivp import METHOD, Ready, check_of_problem
from ._problems import Problem
from ._settings import args_of, check_stops, settings_of, span_of
from ._types import Args, Flag, Matrices, Real, Span
from ._unitary import ComplexPoints, of_rotation

__all__ = ["Integrator"]


class Integrator:
    """A run that is taken step by step, with a state that can be read and set.

    Parameters
    ----------
    problem : Problem, callable, Field, Samples or CFunction
        As in :func:`lieflow.solve_ivp`.
    method : str, optional
        The method. The default is that of :func:`lieflow.solve_ivp`.
    t_span : (float, float)
        From when to when; the end may be infinite.
    y0 : array_like, optional
        The start; of a problem the numbers of another state, or the complex array of one that is complex.
    **options
        rtol, atol, first_step, min_step, max_step, max_steps, dt, steps, stops, args, group, action, frame, linear, and for a
        problem quantities, as in :func:`lieflow.solve_ivp`. max_steps is the limit of attempts of each call.

    Examples
    --------
    >>> import lieflow as lf
    >>> run = lf.Integrator(lf.RigidBody(inertia=[1, 2, 3], omega_body=[0.1, 1, 0]), None, (0, float("inf")))
    >>> run.advance_to(10.0)
    >>> run.t, run.y.attitude.shape
    (10.0, (3, 3))
    """

    def __init__(
        self,
        problem: Any,
        method: str | None = None,
        t_span: Span = (0.0, float("inf")),
        y0: Matrices | Mapping[str, Any] | None = None,
        *,
        args: Args = (),
        group: Any = None,
        action: str = "translation",
        frame: str | None = None,
        linear: Flag = False,
        quantities: Sequence[str] | str | None = None,
        **steps: Any,
    ) -> None:
        if method is not None:
            name_of("method", method)
        known = ("rtol", "atol", "first_step", "min_step", "max_step", "max_steps", "dt", "steps", "stops")
        for name in steps:
            if name not in known:
                raise TypeError(f"{name}: not an argument of Integrator, expected one of {', '.join(known)}")
        span, settings, args = span_of(t_span), settings_of(**steps, linear=linear), args_of(args)
        asked = problem.asked(quantities) if isinstance(problem, Problem) else ()
        # Copies, from which a copy of the run is made: the caller may change its arrays and lists.
        self._given = (
            (problem, method, span, copy.deepcopy(y0)),
            {
                "args": args, "group": group, "action": action, "frame": frame, "linear": linear,
                "quantities": asked or quantities, **copy.deepcopy(steps),
            },
        )
        self._split: Any = None
        self._join: Parts | ComplexPoints | None = None
        self._group = group
        check_stops(settings, span)
        if isinstance(problem, Problem):
            check_of_problem(group, frame, action, linear)
            if args:
                raise ArgumentError("args", repr(args), "none: a problem takes no arguments")
            model = problem._model(asked)
            method = method or problem.method
            start = problem._start(y0, model, method)
            self._split = problem._layout(asked).split
            jumps, settings["kinks"] = problem._problem.knots(span)
            settings["stops"] += jumps
            self._run = model.stepper(method, span, start, settings)
        else:
            if quantities is not None:
                raise ArgumentError("quantities", repr(quantities), "none: only a problem has quantities")
            ready = Ready(problem, y0, args, group, action, frame, linear, span)
            settings["linear"] = ready.linear
            settings["stops"] += ready.jumps
            settings["kinks"] = ready.kinks
            self._split = None if ready.layout is None else ready.layout.split
            self._join = ready.layout
            self._run = ready.space.stepper(
                ready.field, method or METHOD, span, ready.flat, settings
            )
        self._problem = problem if isinstance(problem, Problem) else None
        # The call that checks the value of f at the start.
        self._checks = 0 if self._problem is not None else 1

    @property
    def t(self) -> float:
        """The time."""
        return self._run.t

    @property
    def t_end(self) -> float:
        """The end of the span."""
        return self._run.t_end

    @property
    def y(self) -> Any:
        """A copy of the point; of a problem and of parts arrays by name.

        It may be set: ``y = run.y``, change y, ``run.y = y``. Of a problem :attr:`state` is set.
        """
        return self._shown(self._run.row())

    @y.setter
    def y(self, value: Any) -> None:
        if self._problem is not None:
            raise ArgumentError("y", "quantities", "set `state`, the numbers that the method integrates")
        if self._join is not None:
            flat = self._join.join("y", value, True).ravel()
        else:
            array, shape = real("y", of_rotation(self._group, value)), self._run.row().shape
            if array.shape != shape:
                raise ArgumentError("y", f"shape {array.shape}", f"shape {shape}")
            flat = array.ravel()
        self._set("y", flat)

    @property
    def state(self) -> Array:
        """The numbers that the method integrates; they may be set.

        Those of a vector are in their order, of a matrix by rows, of parts vectors first, then rotations, then numbers;
        of a problem a matrix is by columns, and the parts of a pair one after the other. Vectors and attitudes of a body
        are in the frame in which its inertia is given.
        """
        return self._run.state()

    @state.setter
    def state(self, value: ArrayLike) -> None:
        self._set("state", real("state", value).ravel())

    def _set(self, name: str, flat: Array) -> None:
        if not np.isfinite(flat).all():
            raise ArgumentError(name, "a number that is not finite", "finite numbers")
        if flat.size != self._run.state().size:
            raise ArgumentError(name, f"{flat.size} numbers", f"{self._run.state().size} numbers")
        try:
            self._run.set_state(np.ascontiguousarray(flat))
        except ArgumentError as error:
            of, bracket, place = error.argument.partition("[")
            raise ArgumentError((name if of == "y" else of) + bracket + place, error.value, error.expected) from None

    def _shown(self, row: Array) -> Any:
        return row if self._split is None else self._split(row)

    @property
    def nfev(self) -> int | None:
        """The evaluations of f; None if the method does not count them.

        After an exception of f the run is as before the step that failed. Its calls of f do not count, nor is it a rejected
        attempt.
        """
        calls = self._run.stats()[0]
        return None if calls is None else calls + self._checks

    @property
    def nsteps(self) -> int:
        """The accepted steps."""
        return self._run.stats()[1]

    @property
    def nrejected(self) -> int:
        """The rejected attempts."""
        return self._run.stats()[2]

    def step(self) -> float:
        """Take one step, at most to the end of the span. Return the time. RuntimeError if the step fails."""
        return self._run.step()

    def advance_to(self, t: Real) -> None:
        """Take steps until the time is t; the last one ends there. f is not evaluated after t."""
        self._run.advance_to(number("t", t))

    def interpolate(self, t: Real) -> Any:
        """Return the point at a time within the last step, by the dense output of the method."""
        return self._shown(self._run.interpolate(number("t", t)))

    def save(self) -> bytes:
        """Return the state as bytes. They have neither the problem nor the method."""
        return self._run.save()

    def restore(self, state: bytes) -> None:
        """Go on from a state of :meth:`save`, of a run with the same arguments; the results are the same to the bit."""
        self._run.restore(state)

    def __repr__(self) -> str:
        return f"<lieflow.Integrator at t = {self.t}, {self.nsteps} steps>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (*self._given, self.save()))


def _restored(given: tuple[Any, ...], options: dict[str, Any], state: bytes) -> Integrator:
    run = Integrator(*given, **options)
    run.restore(state)
    return run
