"""help() of every function and of every problem."""

from __future__ import annotations

import inspect
import pydoc
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROTATION

import lieflow as lf

GROUPS = [lf.SO(4), lf.GL(3), lf.U(2)]
NAMES = ["exp", "log", "cay", "cay_inv", "dexp", "dexpinv", "dcay", "dcayinv", "project", "Ad", "ad", "coad", "contains", "random"]
FUNCTIONS = [
    *((f"so3.{name}", getattr(lf.so3, name)) for name in lf.so3.__all__),
    *((f"se3.{name}", getattr(lf.se3, name)) for name in lf.se3.__all__),
    *((f"{group.name}.{name}", getattr(group, name)) for group in GROUPS for name in NAMES),
]


@pytest.mark.parametrize(("name", "function"), FUNCTIONS, ids=lambda x: x if isinstance(x, str) else "")
def test_every_map_has_a_help(name, function):
    text = inspect.getdoc(function)
    first, *rest = text.split("\n")
    assert first.endswith((".", ":")) or (not rest or rest[0] != ""), text
    assert first.startswith("Return")
    # The compiled ones have all there; the others are in a module or a class that says it.
    if not inspect.isroutine(function) or inspect.isbuiltin(function):
        for word in ("Errors:", "Source:", "hape" if name.startswith(("SO", "GL")) or ".d" in name or name.endswith("exp_on") else "(...", "out="):
            assert word in text, (word, text)
        if ".d" in name:
            assert "ight-trivialised" in text


def test_the_modules_state_errors_and_source():
    for thing in (lf.so3, lf.se3, lf.Group, lf.Unitary):
        assert all(word in thing.__doc__ for word in ("Errors:", "Source:", "out=")), thing


@pytest.mark.parametrize("made", [lf.RigidBody, lf.HeavyTop, lf.Fluid, lf.Riccati])
def test_a_problem_states_its_laws(made):
    text = pydoc.render_doc(made)
    assert made.equation.split("\n")[0] in text
    has_laws = {lf.RigidBody: "energy", lf.HeavyTop: "energy", lf.Fluid: "enstrophy"}.get(made)
    if has_laws is None:
        assert "Laws" not in text
    else:
        laws = text[text.index("Laws") :]
        assert "The exact motion keeps" in laws and has_laws in laws
    parameters = inspect.signature(made).parameters
    assert list(parameters) == [name for name, *_ in made.key_table]
    assert all(parameters[name].kind is inspect.Parameter.KEYWORD_ONLY for name in parameters)


def test_keys_and_quantities_have_their_dimensions():
    text = pydoc.render_doc(lf.HeavyTop)
    assert "omega_body : shape (3,), optional [angle/time]" in text
    assert "energy : energy [mass·length²/time²]" in text
    dimensions = {name: dimension for name, *_, dimension in lf.Kirchhoff.key_table}
    assert dimensions["mass"] == "mass" and dimensions["parameters"] == ""


def test_stubtest_without_options():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "lieflow"], capture_output=True, text=True)
    # Of NumPy 2.5 aliases of arrays look like functions; that is no fault of a signature.
    assert "__signature__" not in done.stdout and "is not present in stub" not in done.stdout, done.stdout


def test_the_help_says_what_a_run_needs():
    text = " ".join(lf.solve_ivp.__doc__.split())
    for words in ("the maps cay and pade22 leave det = 1", "f is not evaluated at a stop", "rtol·min(1, 10·(angle of the step))"):
        assert words in text, words
    of = {}
    for method in ("rkmk dop853", "rkmk dopri5 cay", "cf43", "rk dopri5", "rkmk4", "magnus43"):
        runs = [{"rtol": 1e-8}, {"atol": 1e-8}]
        steps = [lf.solve_ivp(lambda t, y: [np.cos(t), 0, 1], (0, 5), np.eye(3), method=method, **ROTATION, **keys).nsteps for keys in runs]
        of[method] = steps[0] == steps[1]
    assert of == {method: method.startswith("rkmk d") for method in of}
    assert "is two of them: re, im" in " ".join(lf.CFunction.__doc__.split())
