"""The arguments of a run: its span, the times of its output and the settings of its steps, checked."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from ._arrays import Array, number, real, what, whole
from ._errors import ArgumentError

__all__ = ["args_of", "check_stops", "settings_of", "span_of", "times_of"]


def _positive(name: str, x: Any) -> float | None:
    if x is None:
        return None
    if isinstance(x, (bool, np.bool_)):
        raise TypeError(f"{name}: {x!r}, expected a number")
    found = number(name, x)
    if not found > 0:
        raise ArgumentError(name, repr(x), "a number > 0")
    return found


def _count(name: str, x: Any) -> int | None:
    return None if x is None else whole(name, x, 1)


def _flag(name: str, x: Any) -> bool:
    if not isinstance(x, (bool, np.bool_)):
        raise TypeError(f"{name}: {x!r}, expected True or False")
    return bool(x)


def span_of(t_span: Any) -> tuple[float, float]:
    """Return the two times of an argument."""
    if type(t_span) is tuple and len(t_span) == 2 and type(t_span[0]) in (int, float) and type(t_span[1]) in (int, float):
        span: Any = t_span
    else:
        if isinstance(t_span, (tuple, list)) and any(isinstance(t, (str, bytes)) for t in t_span):
            raise TypeError(f"t_span: {t_span!r}, expected two numbers")
        span = real("t_span", t_span)
        if span.shape != (2,):
            raise ArgumentError("t_span", f"shape {span.shape}", "two times")
    try:
        start, end = float(span[0]), float(span[1])
    except OverflowError:
        raise TypeError(f"t_span: {what(span)}, expected two numbers") from None
    if end != end or start - start != 0.0:
        raise ArgumentError("t_span", repr(t_span), "two times, the first one finite")
    return start, end


def args_of(args: Any) -> tuple[Any, ...]:
    """Return the arguments of f as a tuple."""
    if isinstance(args, (str, bytes)) or not isinstance(args, Iterable):
        raise TypeError(f"args: {what(args)}, expected a tuple, as in args=(2.0,)")
    return tuple(args)


def times_of(t_eval: Any, span: tuple[float, float]) -> Array | None:
    """Return the times of the output, which lie in the span."""
    if t_eval is None:
        return None
    times = real("t_eval", t_eval)
    if times.ndim != 1:
        raise ArgumentError("t_eval", f"shape {times.shape}", "a list of times")
    low, high = min(span), max(span)
    if len(times) and not (times.min() >= low and times.max() <= high):
        i = int(np.argmax(~((times >= low) & (times <= high))))
        raise ArgumentError(f"t_eval[{i}]", repr(float(times[i])), f"a time within [{low}, {high}]")
    turns = np.diff(times) * (1.0 if span[1] >= span[0] else -1.0) < 0
    if turns.any():
        i = int(np.argmax(turns)) + 1
        raise ArgumentError(f"t_eval[{i}]", repr(float(times[i])), f"a time after {float(times[i - 1])}, as in the run")
    return times


def settings_of(
    rtol: Any = None,
    atol: Any = None,
    first_step: Any = None,
    min_step: Any = None,
    max_step: Any = None,
    max_steps: Any = None,
    dt: Any = None,
    steps: Any = None,
    stops: Any = (),
    dense_output: Any = False,
    linear: Any = False,
) -> dict[str, Any]:
    """Return the settings of the steps, checked."""
    if dt is not None and steps is not None:
        raise ArgumentError("steps", repr(steps), "only one of dt and steps")
    longest = _positive("max_step", max_step)
    return {
        "rtol": None if rtol is None else number("rtol", rtol),
        "atol": None if atol is None else number("atol", atol),
        "first_step": _positive("first_step", first_step),
        "min_step": _positive("min_step", min_step),
        "max_step": None if longest == float("inf") else longest,
        "max_steps": _count("max_steps", max_steps),
        "dt": _positive("dt", dt),
        "steps": _count("steps", steps),
        "split": False,
        "kinks": [],
        "stops": [] if stops is None or isinstance(stops, tuple) and not stops else _list("stops", stops),
        "dense_output": _flag("dense_output", dense_output),
        "linear": _flag("linear", linear),
    }


def _list(name: str, x: Any) -> list[float]:
    """Return x as a list of numbers."""
    array = np.atleast_1d(real(name, x))
    if array.ndim > 1:
        raise ArgumentError(name, f"shape {array.shape}", "a list of numbers")
    return [float(number) for number in array]


def check_stops(settings: dict[str, Any], span: tuple[float, float]) -> None:
    """Raise ArgumentError for a stop outside of the span."""
    low, high = min(span), max(span)
    for i, stop in enumerate(settings["stops"]):
        if not low <= stop <= high:
            raise ArgumentError(f"stops[{i}]", repr(stop), f"a time within [{low}, {high}]")
