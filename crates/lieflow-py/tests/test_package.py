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
