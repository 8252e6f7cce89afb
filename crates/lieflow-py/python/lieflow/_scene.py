"""Scene files, and the scenes that come with lieflow."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import Any

from . import _lieflow
from ._errors import RunError
from ._events import Event
from ._fields import State
from ._problems import Problem, _quietly
from ._result import Layout, Result, warn_of_events

__all__ = ["Scene", "load", "scenes"]


class Scene:
    """A scene: a problem, a method, times and what is computed. :func:`lieflow.load` opens it."""

    def __init__(self, scene: str | os.PathLike[str], settings: Sequence[str] = ()) -> None:
        self._args = (os.fspath(scene), tuple(settings))
        self._scene = _lieflow.Scene(os.fspath(scene), list(settings))
        for text in self._scene.warnings:
            warnings.warn(text, UserWarning, stacklevel=3)

    @property
    def name(self) -> str:
        """The name, that of the file."""
        return self._scene.name

    @property
    def title(self) -> str:
        """The title."""
        return self._scene.title

    @property
    def text(self) -> str:
        """The text of the scene, with the settings."""
        return self._scene.text

    @property
    def problem(self) -> Problem:
        """The problem."""
        return _quietly(self._scene.kind, self._scene.keys())

    @property
    def method(self) -> str:
        """The method."""
        return self._scene.method

    @property
    def t_span(self) -> tuple[float, float]:
        """The span."""
        start, end = self._scene.t_span
        return start, end

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities that are computed, for :func:`lieflow.solve_ivp`.

        Results of :meth:`run` have the columns of ``[output.formulas]``, too: ``result["formulas"]``.
        """
        return tuple(name for name in self._scene.quantities if name != "formulas")

    @property
    def events(self) -> list[Event]:
        """The events, for :func:`lieflow.solve_ivp`. It does not know the names of ``[output.formulas]``."""
        return [Event(when, stop, direction, name=name) for when, stop, direction, name in self._scene.events]

    def run(self) -> Result:
        """Run the scene, without the interpreter. The result has the rows that ``lieflow run`` writes."""
        schema, found = self._scene.run()
        layout = Layout(schema, tuple(self._scene.quantities))
        rows = found["y"]
        found["y"] = layout.split(rows)
        found["y_events"] = [layout.split(y) for y in found["y_events"]]
        problem, form = self.problem, found.pop("form")
        found["y_end"] = State(layout.split(found["y_end"]), found.pop("state"), problem._form_of(form))

        def again(_: Result) -> Any:
            advice = "solve_ivp(scene.problem, scene.t_span, events=scene.events, quantities=scene.quantities)"
            raise RunError(f"a scene is not run again: {advice}.estimate_error() has an estimate")

        result = Result(sol=None, _again=again, _rows=rows, _first=layout.split(rows[:1], every=True), _layout=layout, **found)
        return warn_of_events(result)

    def __repr__(self) -> str:
        return f"lieflow.Scene({self._args[0]!r}{f', {list(self._args[1])}' if self._args[1] else ''})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (Scene, self._args)


def load(scene: str | os.PathLike[str], *, set: Sequence[str] | str = ()) -> Scene:
    """Open a scene by the path of its file or by its bundled name, changed by settings such as ``"time.dt=0.01"``."""
    return Scene(scene, (set,) if isinstance(set, str) else set)


def scenes() -> tuple[str, ...]:
    """Return the names of the bundled scenes."""
    return tuple(_lieflow.bundled())
