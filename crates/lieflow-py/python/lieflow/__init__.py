"""Lie group integrators: solve_ivp on matrix Lie groups and the manifolds they act on.

>>> import numpy as np, lieflow as lf
>>> def f(t, R):                                      # a torque-free body, by its attitude
...     return ([0.0, 2.75, 2.75] @ R) / [1.0, 4.0, 18.0]
>>> r = lf.solve_ivp(f, (0, 100), np.eye(3), group="SO(3)", frame="body", rtol=1e-9, atol=1e-12)
>>> bool(abs(r.y[-1].T @ r.y[-1] - np.eye(3)).max() < 1e-13)
True
"""

from __future__ import annotations

from . import se3, so3
from ._errors import ArgumentError, RunError
from ._groups import GL, SO, Gm, Group, Sp, expm
from ._ivp import CFunction, Event, OdeSolution, Result, solve_ivp
from ._lieflow import __version__

__all__ = [
    "ArgumentError",
    "CFunction",
    "Event",
    "GL",
    "Gm",
    "Group",
    "OdeSolution",
    "Result",
    "RunError",
    "SO",
    "Sp",
    "__version__",
    "expm",
    "se3",
    "so3",
    "solve_ivp",
]
