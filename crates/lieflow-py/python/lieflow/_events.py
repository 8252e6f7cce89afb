"""Events of runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._arrays import name_of, number, whole
from ._errors import ArgumentError
from ._result import Result
from ._types import Flag, Real, Whole

__all__ = ["Event", "changes_of", "events_of", "for_second_run", "texts_of"]


def _function(g: Any) -> Any:
    if not (callable(g) or isinstance(g, str)):
        raise TypeError(f"g: a value of type {type(g).__name__}, expected a function of t and y, or a formula")
    return g


def _change(change: Any) -> Any:
    if change is not None and not callable(change):
        raise TypeError(f"change: a value of type {type(change).__name__}, expected a function of t and y")
    return change


def _terminal(terminal: Any) -> int:
    return int(terminal) if isinstance(terminal, (bool, np.bool_)) else whole("terminal", terminal)


def _direction(direction: Any) -> float:
    found = number("direction", direction)
    if found != found:
        raise ArgumentError("direction", repr(direction), "a number: its sign tells which zeros count")
    return found


def _points(points: Any) -> int | None:
    return None if points is None else whole("points", points, 1, 100_000)


#: What checks the attributes of an event, also those that are set later.
_CHECKS: dict[str, Callable[[Any], Any]] = {
    "g": _function, "change": _change, "terminal": _terminal, "direction": _direction, "points": _points,
    "name": lambda name: name_of("name", name),
}


class Event:
    """An event: the zeros of g(t, y), with what happens there.

    Parameters
    ----------
    g : callable or str
        g(t, y, *args), a number; or a formula in t and y1, y11, … A problem has the names of its columns. Where it changes
        its sign, the zero is found to rounding of t.
    terminal : int or bool
        The zero that ends the run, from 1. True is 1, and 0 or False is none.
    direction : float
        Only rising zeros for a positive number, only falling ones for a negative number.
    change : callable, optional
        change(t, y, *args) returns the new y. The run goes on from it. It must be on M. The event and a row of ``t_eval`` at
        that time have the y before it; ``sol`` and the row at the end of the step have the new one. Of a problem y is the
        array of the numbers of its state, in the order of :attr:`lieflow.Integrator.state`; a complex state is a complex
        array. Of :class:`lieflow.DrivenBody` these are the attitude by columns and the momentum in space.
    points : int, optional
        At how many points of each step g is evaluated. The default depends on g.
    name : str, optional
        The name in messages.
    """

    __slots__ = ("change", "direction", "g", "name", "points", "terminal")

    def __init__(
        self,
        g: Callable[..., Any] | str,
        terminal: Whole | Flag = 0,
        direction: Real = 0.0,
        change: Callable[..., Any] | None = None,
        points: Whole | None = None,
        name: str | None = None,
    ) -> None:
        self.g, self.change = g, change
        self.terminal, self.direction, self.points = terminal, direction, points
        self.name = name if name is not None else g if isinstance(g, str) else getattr(g, "__name__", "event")

    def __setattr__(self, name: str, value: Any) -> None:
        check = _CHECKS.get(name)
        super().__setattr__(name, value if check is None else check(value))

    def _without_end(self) -> Event:
        """The event that ends no run."""
        return Event(self.g, 0, self.direction, self.change, self.points, self.name)

    def __repr__(self) -> str:
        return f"lieflow.Event({self.name}, terminal={self.terminal}, direction={self.direction})"


def _event(i: int, g: Any) -> Event:
    """An event of SciPy's kind: a function with the attributes terminal and direction."""
    if isinstance(g, Event):
        return g
    if isinstance(g, str):
        return Event(g)
    if not callable(g):
        raise TypeError(f"events[{i}]: a value of type {type(g).__name__}, expected a function of t and y, or a formula")
    return Event(g, getattr(g, "terminal", None) or 0, getattr(g, "direction", None) or 0.0)


def events_of(events: Any) -> list[Event]:
    """Return the events of an argument: none, one or a list."""
    given = events if isinstance(events, (list, tuple)) else () if events is None else (events,)
    return [_event(i, g) for i, g in enumerate(given)]


def changes_of(events: list[Event]) -> list[int]:
    """Return the numbers of the events that change the state."""
    return [i for i, event in enumerate(events) if event.change]


def for_second_run(first: Result, events: list[Event]) -> list[Event]:
    """Return the events of a second run. One that ended the first run may be earlier or later there."""
    return events if first.status == 0 else [event._without_end() for event in events]


def texts_of(events: list[Event]) -> tuple[tuple[str, str], ...]:
    """Return the events that are formulas of a problem, each with its name."""
    return tuple((f"events[{i}]", event.g) for i, event in enumerate(events) if isinstance(event.g, str))
