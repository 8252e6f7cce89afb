"""The package itself: its stub, its import, its examples."""

from __future__ import annotations

import doctest
import os
import pathlib
import re
import subprocess
import sys

import pytest

import lieflow as lf

DOCS = pathlib.Path(os.environ.get("LIEFLOW_DOCS", "docs/python.md"))


def test_the_stub_is_that_of_the_module():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "lieflow._lieflow"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_is_typed():
    pytest.importorskip("mypy")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--disable-error-code", "import-untyped", "-p", "lieflow"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_only_numpy_is_imported():
    code = "import sys, lieflow; print([m for m in ('scipy', 'numba', 'pandas', 'matplotlib') if m in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[]"


def test_examples_of_the_package():
    for module in (lf, lf.so3, lf.se3):
        assert doctest.testmod(module).failed == 0


@pytest.mark.skipif(not DOCS.exists(), reason="the documentation is not beside the tests")
def test_examples_of_the_documentation():
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", DOCS.read_text(), re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, str(DOCS), "exec"), names)
