"""Scenes beside solve_ivp: what a scene has, a run takes."""

from __future__ import annotations

import numpy as np
import pytest

import lieflow as lf


@pytest.mark.parametrize("name", lf.scenes())
def test_the_problem_of_a_scene_is_run_by_solve_ivp(name):
    scene = lf.load(name)
    start, end = scene.t_span
    end = end if np.isinf(end) else min(end, start + 2.0)
    r = lf.solve_ivp(scene.problem, (start, end), events=scene.events, quantities=scene.quantities)
    assert r.success and tuple(r.y) == scene.quantities
    estimate = r.estimate_error()
    assert set(estimate.y) == set(scene.quantities) and len(estimate.t_events) == len(scene.events)


def test_the_advice_for_the_error_of_a_scene():
    scene = lf.load("flips")
    r = scene.run()
    advice = "solve_ivp(scene.problem, scene.t_span, events=scene.events, quantities=scene.quantities).estimate_error()"
    with pytest.raises(lf.RunError) as caught:
        r.estimate_error()
    assert advice in str(caught.value)
    assert max(eval(f"lf.{advice}").t_events) < 1e-8


def test_events_of_a_scene_are_those_of_its_run():
    for name in ("flips", "nutating-top"):
        scene = lf.load(name)
        own, other = scene.run(), lf.solve_ivp(scene.problem, scene.t_span, events=scene.events, quantities=scene.quantities)
        assert own.status == other.status and len(own.t_events) == len(scene.events) == len(other.t_events)
        for a, b in zip(own.t_events, other.t_events):
            assert len(a) == len(b) > 0 and np.abs(a - b).max() < 1e-4
    flip, half = lf.load("flips").events
    assert (flip.name, flip.g, flip.terminal, flip.direction) == ("flip", "m2", 6, 0.0)
    assert (half.name, half.terminal, half.direction) == ("half-way", 0, -1.0)


def test_formulas_of_a_scene_are_in_its_result():
    scene = lf.load("nutating-top")
    r = scene.run()
    assert set(r.y) == {*scene.quantities, "formulas"}
    assert np.abs(r["formulas"] - np.degrees(r.nutation)).max() < 1e-12
