"""Second runs, which show the error of a first one."""

from __future__ import annotations

from collections.abc import Callable
from time import thread_time
from typing import Any

import numpy as np

from . import _lieflow
from ._arrays import Array
from ._errors import ArgumentError, RunError
from ._result import Result

__all__ = ["Repeated", "beyond", "changed", "finer", "second"]

#: A relative distance of this size is rounding.
ROUNDING = 1e-12
#: Further runs take so many seconds at most.
PATIENCE = 3.0

#: What a run is compared with, its result, and the first run again from a changed start.
Repeated = tuple[str, Result, Result | None]


def changed(start: Array | list[float], change: float) -> Array:
    """Return a start with relative changes of neighbouring numbers in opposite directions."""
    signs = np.resize([1.0, -1.0], np.shape(start))
    other: Array = np.asarray(start) * (1.0 + change * signs)
    return other


def beyond(first: Result, span: tuple[float, float]) -> float:
    """Return the end of a second run. The zero that ended the first may be later there."""
    if first.status == 0:
        return span[1]
    if first._by_callback:
        return first.t_end
    low, high = min(span), max(span)
    end = first.t_end + (first.largest_step if span[1] > span[0] else -first.largest_step)
    return min(max(end, low), high)


def second(run: Callable[..., Result], settings: dict[str, Any], first: Result, t0: float, seconds: float) -> Repeated:
    """Return what a second run is, the run, and the first one again from a start whose last digits are changed.

    The steps of the second run are no more like those of the first than 5 %.
    """
    if not first.nsteps or first.t_end == t0:
        raise RunError("no estimate: the run has no step")
    other_settings = {**settings, "dense_output": False}
    if settings["max_steps"] is not None:
        other_settings["max_steps"] = 10 * settings["max_steps"]
    limits = dict.fromkeys(("rtol", "atol", "first_step", "min_step", "max_step", "steps"))
    found_by, mean = "a second run with each step in two parts", abs(first.t_end - t0) / first.nsteps
    if first._tolerances is None:
        # Where knots have made the steps shorter than they were to be, it is their mean that is split.
        h = min(settings["dt"] or first.largest_step, first.largest_step)
        other = run({**other_settings, **limits, "dt": mean if mean < 0.95 * h else h, "split": True})
    else:
        by_tolerance, other_settings = finer(other_settings, first, t0, seconds)
        other, is_limited = run(other_settings), settings["min_step"] is not None
        if not is_limited and (other.status < 0 or 0.95 * first.nsteps < other.nsteps < 1.05 * first.nsteps):
            # A tolerance below rounding chooses the same steps again. Some methods take a step in two halves.
            found_by = "a second run in steps of a quarter of the mean size"
            other = run({**other_settings, **limits, "dt": mean / 4})
        else:
            found_by = by_tolerance
    if other.status < 0 or len(other.t) < len(first.t):
        raise RunError(f"no estimate: {found_by} ended at t = {other.t_end}: {other.message}")
    grown: Result | None = None
    try:
        grown = run({**settings, "dense_output": False}, _lieflow.LAST_DIGITS)
    except (RunError, ArgumentError):  # it is no start, for its digits
        pass
    same = grown is not None and len(grown.t) == len(first.t)
    found = (found_by, other, grown if same else None)
    return _searched(run, {**other_settings, **limits}, first, found, t0, seconds)


def _apart(a: Result, b: Result) -> float:
    """Return the largest distance of the outputs of two runs, or of their ends, relative to the size of the first."""
    one, other = (a.y, b.y) if len(a.t) else (a.y_end, b.y_end)
    pairs = [(one, other)] if isinstance(one, np.ndarray) else [(one[name], other[name]) for name in one.keys()]
    distances = []
    for x, y in pairs:
        size = np.abs(x).max(initial=0.0)
        distances.append(float(np.abs(x - y[: len(x)]).max(initial=0.0) / (size if size > 0.0 else 1.0)))
    return max(distances)


def _searched(
    run: Callable[..., Result], settings: dict[str, Any], first: Result, found: Repeated, t0: float, seconds: float
) -> Repeated:
    """Return a run whose steps end elsewhere, where it tells that f jumps; else what was found.

    Two runs with the same ends of steps may both pass over a jump. Where steps of the run end at the jumps, it is right: steps
    that have short parts at their ends, too, change nothing.
    """
    found_by, other, grown = found
    quick = _lieflow.time_to_search(first.nsteps, seconds) is not None
    if first._tolerances is not None or first.status != 0 or not quick:
        return found
    size = _lieflow.search_step(abs(first.t_end - t0), first.largest_step)
    known = max(_apart(first, other), ROUNDING, 0.0 if grown is None else _apart(first, grown))
    clock = thread_time()
    search = run({**settings, "dt": size})
    spent = thread_time() - clock
    if search.status < 0 or not _lieflow.is_elsewhere(_apart(first, search), known):
        return found
    nearer = search
    if times := _lieflow.finer(spent, PATIENCE):
        size /= times
        nearer = run({**settings, "dt": size})
    # Points within a step may have a lower order, which is no jump.
    if nearer.status < 0 or not _lieflow.is_elsewhere(_apart(first, nearer), known):
        return found
    h = first.largest_step
    is_nearer = not _lieflow.stays(_apart(first, nearer), _apart(first, search))
    # Knots have not made the steps shorter.
    is_grid = abs(first.t_end - t0) > 0.95 * h * first.nsteps - h
    if is_nearer and is_grid and first.nsteps <= _lieflow.GRADED_MOST:
        parts = run({**settings, "dt": h, "kinks": [*settings["kinks"], *_lieflow.near_ends((t0, first.t_end), h)]})
        if parts.status >= 0 and not _lieflow.is_elsewhere(_apart(first, parts), known):
            return found
    return f"a run in steps of {size:.2g}: f seems to jump in a step, and its jumps are no stops", nearer, grown


def finer(settings: dict[str, Any], first: Result, t0: float, seconds: float) -> tuple[str, dict[str, Any]]:
    """Return what a second run by tolerances is, and its settings, after a first one from t0 that took so many seconds."""
    other = dict(settings)
    rtol, atol = first._tolerances
    factor = _lieflow.other_tolerance(rtol, atol)
    found_by = f"a second run at {'a tenth of' if factor < 1 else 'ten times'} the tolerance"
    # Short steps see what steps by error pass over, such as a pulse.
    short = abs(first.t_end - t0) / _lieflow.SHORT_STEPS
    if short > (settings["min_step"] or 0.0) and _lieflow.time_to_search(first.nsteps, seconds) is not None:
        found_by += f", in at least {_lieflow.SHORT_STEPS} steps"
        other["max_step"] = min(settings["max_step"] or short, short)
        other["first_step"] = settings["first_step"] and min(settings["first_step"], short)
    if first._hardest is not None:
        # A pulse that the first run has found. f need not jump there.
        other["kinks"] = [*settings["kinks"], first._hardest]
    return found_by, {**other, "rtol": rtol * factor, "atol": atol * factor}
