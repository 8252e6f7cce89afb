"""The package itself: its stub, its import, its examples."""

from __future__ import annotations

import doctest
import os
import pathlib
import re
import subprocess
import sys

import pytest

import lieflow
import lieflow as lf

ROOT = pathlib.Path(os.environ.get("LIEFLOW_DOCS", "."))
PAGES = [page for page in (ROOT / "README.md", ROOT / "docs/python.md") if page.exists()]


def test_the_stubs_are_those_of_the_modules(tmp_path):
    pytest.importorskip("mypy")
    # NumPy 2.5 has aliases of arrays that look like functions.
    allowed = tmp_path / "allowed"
    allowed.write_text("lieflow\\..*\\.(Array|Complex)\n")
    options = ["--ignore-missing-stub", "--ignore-unused-allowlist", "--allowlist", str(allowed)]
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "lieflow", *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_typed():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "-p", "lieflow"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


PROGRAM = """
from pathlib import Path
from typing import Any
import numpy as np
import lieflow as lf

class Rotation:
    def as_matrix(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        return np.eye(3)

def f(t: float, y: Any, *args: Any) -> Any:
    return [0.0, 0.0, 1.0]

turn, eye, eight = Rotation(), np.eye(3), np.int64(8)
half, yes = np.float32(0.5), np.True_

# Arrays are lists.
lf.Schrodinger(hamiltonian=np.array([[1, 1j], [-1j, 1]]), amplitudes=np.array([1, 0]))
lf.DensityMatrix(hamiltonian=np.eye(2, dtype=complex), density=np.eye(2) / 2)
lf.MatrixOde(group="so", field=np.zeros((3, 3)))
lf.SpinChain(spins=np.eye(3), ring=yes, damping=half)
lf.Fluid(surface="sphere", n=eight, jets=np.ones((1, 2)), modes=np.ones((1, 4)))
lf.DrivenBody(inertia=[1, 2, 3], omega_body=[1, 0, 0], samples=Path("rates.csv"))
# Rotations of SciPy are arrays.
lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0], attitude=turn)
lf.RigidBody(inertia=[1, 2, 3], omega_body=[1, 0, 0], quaternion=turn)
lf.FreeBodies(np.ones(3), np.ones((1, 3)), turn).advance("rkmk4", half, eight, threads=eight)
lf.so3.log(turn), lf.so3.Ad(turn, [1, 0, 0]), lf.so3.contains(turn, half), lf.se3.log(turn), lf.SO(3).log(turn)
lf.solve_ivp(f, (0, 1), turn, group="SO(3)", frame="body")
# Numbers of NumPy are numbers.
lf.SO(eight), lf.SO(eight, eight), lf.GL(eight), lf.U(eight), lf.so3.random((eight, 2)), lf.SO(3).dexpinv(eye, eye, q=eight)
lf.expm(eye, threads=eight), lf.Event(f, terminal=yes, direction=half, points=eight)
lf.solve_ivp(f, (np.int64(0), half), eye, group="SO(3)", frame="body", rtol=half, dt=eight, steps=eight, dense_output=yes, args=[2.0])
run = lf.Integrator(f, None, np.array([0.0, 1.0]), eye, group="SO(3)", frame="body", linear=yes, args=[2.0], max_steps=eight)
run.advance_to(half)
run.interpolate(eight)
# What is wrong is refused.
lf.SO("3")  # type: ignore[arg-type]
lf.U(2.5)  # type: ignore[arg-type]
lf.so3.log(f)  # type: ignore[arg-type]
lf.SpinChain(spins=[[1, 0, 0]], ring="yes")  # type: ignore[arg-type]
lf.SpinChain(spins=[[1, 0, 0]], ring=1)  # type: ignore[arg-type]
lf.Fluid(surface="sphere", n=2.5)  # type: ignore[arg-type]
lf.RigidBodies(bodies=eye)  # type: ignore[arg-type]
lf.RigidBody(inertia=turn, omega_body=[1, 0, 0])  # type: ignore[arg-type]
lf.RigidBody(omega=[1, 0, 0])  # type: ignore[call-arg]
lf.Event(f, direction="up")  # type: ignore[arg-type]
lf.solve_ivp(f, (0, 1), eye, steps=half)  # type: ignore[arg-type]
lf.solve_ivp(f, (0, 1), eye, rtol="1e-3")  # type: ignore[arg-type]
lf.solve_ivp(f, (0, 1), eye, args="ab")  # type: ignore[arg-type]
lf.solve_ivp(f, (0, 1), eye, args=2.0)  # type: ignore[arg-type]
lf.solve_ivp(f, "01", eye)  # type: ignore[arg-type]
lf.Integrator(f, None, 1.0, eye)  # type: ignore[arg-type]
lf.Integrator(f, linear="yes")  # type: ignore[arg-type]
"""


def test_numbers_of_numpy_and_rotations_of_scipy_have_the_types_of_arguments(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), str(tmp_path / "program.py")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_only_numpy_is_imported():
    code = "import sys, lieflow; print([m for m in ('scipy', 'numba', 'pandas', 'matplotlib') if m in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[]"


def test_examples_of_the_package():
    for module in (lf, lf.so3, lf.se3, lieflow._fields, lieflow._integrator):
        assert doctest.testmod(module).failed == 0


@pytest.mark.skipif(not PAGES, reason="the documentation is not beside the tests")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_examples_of_the_documentation(page, tmp_path, monkeypatch):
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(), re.S)
    assert blocks
    monkeypatch.chdir(tmp_path)
    for block in blocks:
        exec(compile(block, str(page), "exec"), names)
