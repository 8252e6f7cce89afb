"""Arguments are copied, and caches are bounded."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import lieflow as lf

BODY = lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.01, 1.0, 0.0])


def test_a_later_change_of_an_argument_has_no_effect():
    j, m = np.array([1.0, 2.0, 3.0]), np.ones((1, 3))
    bodies = lf.FreeBodies(j[None], m)
    energy = bodies.energy
    j[:] = 7
    assert np.array_equal(bodies.energy, energy) and np.array_equal(pickle.loads(pickle.dumps(bodies)).energy, energy)

    t, v = np.array([0.0, 1.0]), np.ones((2, 3))
    samples = lf.Samples(t, v)
    v[:] = 2
    system = {"group": "SO(3)", "frame": "space", "t_eval": [1.0]}
    for of in (samples, pickle.loads(pickle.dumps(samples)), lf.Field("SO(3)", ["s1", "s2", "s3"], samples=samples)):
        keys = {k: x for k, x in system.items() if k != "group" or not isinstance(of, lf.Field)}
        assert np.abs(lf.solve_ivp(of, (0, 1), np.eye(3), **keys).y[0] - lf.so3.exp([1, 1, 1])).max() < 1e-9
    with pytest.raises(ValueError, match="read-only"):
        samples.values[:] = 3

    w, texts = np.array([0.0, 0.0, 1.0]), ["w1", "w2", "w3"]
    field = lf.Field("SO(3)", texts, w=w)
    lf.solve_ivp(field, (0, 1), np.eye(3), frame="space")
    w[:], texts[2] = 2, "0"
    for of in (field, pickle.loads(pickle.dumps(field))):
        y = lf.solve_ivp(of, (0, 1), np.eye(3), frame="space", t_eval=[1.0]).y[0]
        assert np.abs(y - lf.so3.exp([0, 0, 1])).max() < 1e-9

    form = np.diag([1.0, 2.0])
    group = lf.Gm(form)
    form[:] = 5
    assert group == lf.Gm(np.diag([1.0, 2.0])) and "2.0" in repr(group) and pickle.loads(pickle.dumps(group)) == group

    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.1, 1.0, 0.0])
    exact = body.exact(3.0).attitude
    body.keys["inertia"][0] = 100.0
    assert np.array_equal(pickle.loads(pickle.dumps(body)).exact(3.0).attitude, exact) and body.keys["inertia"][0] == 1.0


def test_the_second_run_begins_where_the_first_did():
    y0 = np.eye(3)
    r = lf.solve_ivp(lambda t, y: [0.0, 1.0, t], (0, 2), y0, group="SO(3)", frame="body", method="rkmk4 exp", steps=50)
    y0[:] = lf.so3.exp([1.0, 0.0, 0.0])
    assert r.estimate_error().y < 1e-5
    state = np.array([0.0, 1.0, 1.0])
    r = lf.solve_ivp(BODY, (0, 2), state, quantities="momentum_body", method="rkmk4 exp", steps=50)
    state[:] = 7
    assert r.estimate_error().y["momentum_body"] < 1e-5


def test_caches_are_bounded():
    body = lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.01, 1.0, 0.0])
    field = lf.Field("SO(3)", [0, 0, 1])
    for c in range(200):
        lf.solve_ivp(body, (0, 0.01), events=f"w2 - {c}", steps=1)
        lf.solve_ivp(field, (0, 0.01), np.eye(3), frame="body", events=f"y11 - {c}", steps=1)
    assert len(body._models) <= 64 and len(field._made) <= 64


def test_a_copy_of_an_integrator_has_the_arguments_of_its_start():
    span, stops, rtol = np.array([0.0, 10.0]), np.array([5.0]), np.array(1e-9)

    def f(t, y):
        return [1.0, 0, 0] if t < 5 else [0, 0, 30.0]

    system = {"group": "SO(3)", "frame": "body", "rtol": rtol, "stops": stops}
    of_list, names = [5.0], ["momentum_body"]
    runs = [
        lf.Integrator(f, "rkmk dop853", span, np.eye(3), **system),
        lf.Integrator(BODY, None, span, stops=of_list, quantities=names),
    ]
    span[1], stops[0], rtol[...], names[0] = 5.0, 7.0, 1e-3, "energy"
    of_list.append(12.0)
    for run in runs:
        other = copy.copy(run)
        run.advance_to(10.0)
        other.advance_to(10.0)
        assert other.nsteps == run.nsteps and np.array_equal(other.state, run.state) and type(other.y) is type(run.y)
    assert list(pickle.loads(pickle.dumps(runs[1])).y) == ["momentum_body"]


def test_fields_samples_and_parts_do_not_change():
    samples = lf.Samples([0.0, 1.0], [[1.0], [2.0]])
    parts = lf.Parts(R="rotation", n="numbers 2")
    field = lf.Field("SO(3)", ["a*s", "b2", "c"], let={"c": ["0"]}, samples=samples, a=1.0, b=np.array([0.0, 3.0]))
    rows = lf.Field("SO(2)", [["0", "w1"], ["-w1", "0"]], w=[1.0])
    of_parts = lf.Field(parts, {"R": ["0", "0", "1"], "n": ["1", "0"]})
    for thing, names in ((samples, ("t", "values", "interpolation", "names")), (parts, ("spaces",)),
                         (field, ("group", "field", "y", "let", "samples", "parameters"))):
        for name in names:
            words = f"^{name}: {type(thing).__name__} does not change; make another one$"
            with pytest.raises(AttributeError, match=words):
                setattr(thing, name, getattr(thing, name))
            with pytest.raises(AttributeError, match=words):
                delattr(thing, name)
    for change in (
        lambda: field.parameters.update(a=2.0), lambda: field.parameters.__setitem__("a", 2.0), lambda: field.let.pop("c"),
        lambda: field.let["c"].__setitem__(0, "1"), lambda: field.parameters["b"].__setitem__(1, 0.0), lambda: field.field.append("1"),
        lambda: rows.field[0].__setitem__(0, "1"), lambda: rows.parameters["w"].__setitem__(0, 2.0),
        lambda: of_parts.field.__setitem__("n", ["0", "0"]), lambda: of_parts.field["n"].clear(), lambda: parts.spaces.clear(),
        lambda: samples.values.__setitem__(0, 5.0), lambda: samples.t.__setitem__(0, 5.0),
    ):
        with pytest.raises((TypeError, ValueError, AttributeError)):
            change()
    for array in (samples.t, samples.values, lf.Samples([0, 1], [1, 2]).values, field.parameters["b"]):
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True
    with pytest.raises(TypeError, match="^parameters: Field does not change; make another one$"):
        field.parameters["a"] = 2.0
    starts = ((field, np.eye(3)), (rows, np.eye(2)), (of_parts, {"R": np.eye(3), "n": [0, 0]}))
    for of, start in starts:
        end = lf.solve_ivp(of, (0, 1), start, frame="body").y_end
        for other in (copy.copy(of), copy.deepcopy(of), pickle.loads(pickle.dumps(of)), eval(repr(of), {"lieflow": lf, "array": np.array})):
            assert repr(other) == repr(of)
            np.testing.assert_equal(lf.solve_ivp(other, (0, 1), start, frame="body").y_end, end)
            with pytest.raises(AttributeError, match="does not change"):
                other.field = ["0", "0", "0"]
    assert copy.deepcopy(parts) == parts and np.array_equal(copy.deepcopy(samples)([0.5]), samples([0.5]))
