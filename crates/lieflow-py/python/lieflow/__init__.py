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
from ._bodies import FreeBodies
from ._errors import ArgumentError, RunError
from ._events import Event
from ._fields import CFunction, Field, Parts, Quantities, Samples
from ._groups import GL, SL, SO, Gm, Group, Sp, expm
from ._integrator import Integrator
from ._ivp import solve_ivp
from ._lieflow import __version__
from ._problems import (
    Problem,
    BeamLine,
    Composed,
    DensityMatrix,
    DoubleBracket,
    DrivenBody,
    Euler,
    Fluid,
    HeavyTop,
    Hill,
    Kirchhoff,
    Lorentz,
    Lyapunov,
    Mathieu,
    MatrixOde,
    Oja,
    QrFlow,
    Riccati,
    RigidBodies,
    RigidBody,
    RigidBodyN,
    RigidMotion,
    Schrodinger,
    SphericalPendulum,
    Spin,
    SpinChain,
    Subspace,
    Toda,
    problem_of,
)
from ._result import ErrorEstimate, OdeSolution, Result
from ._scene import Scene, load, scenes
from ._unitary import U, Unitary

__all__ = [
    "ArgumentError",
    "BeamLine",
    "CFunction",
    "Composed",
    "DensityMatrix",
    "DoubleBracket",
    "DrivenBody",
    "ErrorEstimate",
    "Euler",
    "Event",
    "Field",
    "Fluid",
    "FreeBodies",
    "GL",
    "Gm",
    "Group",
    "HeavyTop",
    "Hill",
    "Integrator",
    "Kirchhoff",
    "Lorentz",
    "Lyapunov",
    "Mathieu",
    "MatrixOde",
    "OdeSolution",
    "Oja",
    "Parts",
    "Problem",
    "QrFlow",
    "Quantities",
    "Result",
    "Riccati",
    "RigidBodies",
    "RigidBody",
    "RigidBodyN",
    "RigidMotion",
    "RunError",
    "SL",
    "SO",
    "Samples",
    "Scene",
    "Schrodinger",
    "Sp",
    "SphericalPendulum",
    "Spin",
    "SpinChain",
    "Subspace",
    "Toda",
    "U",
    "Unitary",
    "__version__",
    "expm",
    "load",
    "problem_of",
    "scenes",
    "se3",
    "so3",
    "solve_ivp",
]
