"""Every kind of problem as a class. Made by tests/stub_of_problems.py."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._fields import Quantities, Samples
from ._result import Layout
from ._types import Flag, HasMatrix, Real, Whole
from ._unitary import ComplexState

Array = NDArray[np.float64]
# Numbers may be formulas of the parameters, as in ["5*deg", 0, "w"].
Numbers = ArrayLike | Sequence[Any]
COLUMNS: int

class Problem:
    kind: ClassVar[str]
    equation: ClassVar[str]
    key_table: ClassVar[tuple[tuple[str, str, str, bool, str, str], ...]]
    quantity_table: ClassVar[tuple[tuple[str, tuple[str, ...], str, str], ...]]
    _keys: dict[str, Any]
    _problem: _lieflow.Problem
    def __init__(self, **keys: Any) -> None: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def keys(self) -> dict[str, Any]: ...
    def replace(self, **keys: Any) -> Any: ...
    @property
    def method(self) -> str: ...
    @property
    def quantities(self) -> tuple[str, ...]: ...
    @property
    def invariants(self) -> tuple[str, ...]: ...
    @property
    def facts(self) -> dict[str, float]: ...
    @property
    def notes(self) -> tuple[str, ...]: ...
    def columns(self, quantity: str) -> tuple[str, ...]: ...
    def methods(self, quantities: Sequence[str] | str | None = None) -> tuple[str, ...]: ...
    def orders(
        self, method: str, quantities: Sequence[str] | str | None = None
    ) -> tuple[int | None, int | None]: ...
    def exact(
        self, t: ArrayLike, quantities: Sequence[str] | str | None = None, *, t0: Real = 0.0
    ) -> Quantities | None: ...
    def asked(self, quantities: Sequence[str] | str | None) -> tuple[str, ...]: ...
    def _both(
        self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...]
    ) -> tuple[_lieflow.Model, Layout]: ...
    def _model(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> _lieflow.Model: ...
    def _layout(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> Layout: ...
    def _complex_state(self) -> ComplexState | None: ...
    def _form(self, model: _lieflow.Model, method: str) -> tuple[str, str, str]: ...
    def _form_of(self, form: str) -> tuple[str, str, str]: ...
    def _start(self, y0: Any, model: _lieflow.Model, method: str) -> Array | None: ...

def problem_of(kind: str, keys: dict[str, Any]) -> Problem: ...
def _quietly(kind: str, keys: dict[str, Any]) -> Problem: ...

KINDS: dict[str, type[Problem]]

class BeamLine(Problem):
    def __init__(
        self,
        *,
        elements: Sequence[Any],
        particle: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Composed(Problem):
    def __init__(
        self,
        *,
        parts: Sequence[Any],
        invariants: Mapping[str, Any] | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DensityMatrix(Problem):
    def __init__(
        self,
        *,
        hamiltonian: Sequence[Any] | NDArray[Any] | None = None,
        hamiltonian_imaginary: Sequence[Any] | NDArray[Any] | None = None,
        energies: Numbers | None = None,
        coupling: Numbers | None = None,
        coupling_imaginary: Numbers | None = None,
        frequency: Real | str | None = None,
        phase: Real | str | None = None,
        pulse: Numbers | None = None,
        hbar: Real | str | None = None,
        density: Numbers | None = None,
        density_imaginary: Numbers | None = None,
        amplitudes: Numbers | None = None,
        amplitudes_imaginary: Numbers | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DoubleBracket(Problem):
    def __init__(
        self,
        *,
        matrix: Numbers,
        order: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DrivenBody(Problem):
    def __init__(
        self,
        *,
        inertia: Numbers | None = None,
        inverse_inertia: Numbers | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: Numbers | None = None,
        momentum_body: Numbers | None = None,
        omega_space: Numbers | None = None,
        momentum_space: Numbers | None = None,
        attitude: Numbers | HasMatrix | None = None,
        quaternion: Numbers | HasMatrix | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        weight: Numbers | None = None,
        thruster: Numbers | None = None,
        damping: Real | str | None = None,
        control: Numbers | None = None,
        torque: str | Real | Numbers | None = None,
        torque_space: str | Real | Numbers | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Euler(Problem):
    def __init__(
        self,
        *,
        algebra: str,
        hamiltonian: str | Real | None = None,
        inverse_inertia: Numbers | None = None,
        momentum: Numbers,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Fluid(Problem):
    def __init__(
        self,
        *,
        surface: str,
        n: Whole | str,
        random: Mapping[str, Any] | None = None,
        jets: Sequence[Any] | NDArray[Any] | None = None,
        modes: Sequence[Any] | NDArray[Any] | None = None,
        vortices: Sequence[Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class HeavyTop(Problem):
    def __init__(
        self,
        *,
        inertia: Numbers | None = None,
        inverse_inertia: Numbers | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: Numbers | None = None,
        momentum_body: Numbers | None = None,
        omega_space: Numbers | None = None,
        momentum_space: Numbers | None = None,
        attitude: Numbers | HasMatrix | None = None,
        quaternion: Numbers | HasMatrix | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        weight: Numbers,
        vertical: Numbers | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Hill(Problem):
    def __init__(
        self,
        *,
        a: Numbers,
        q: Numbers,
        period: Real | str,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Kirchhoff(Problem):
    def __init__(
        self,
        *,
        inertia: Numbers,
        mass: Numbers,
        angular_momentum: Numbers,
        linear_momentum: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Lorentz(Problem):
    def __init__(
        self,
        *,
        charge_to_mass: Real | str,
        electric: Numbers,
        magnetic: Numbers,
        velocity: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Lyapunov(Problem):
    def __init__(
        self,
        *,
        x: Numbers,
        variables: Sequence[Any] | NDArray[Any] | None = None,
        field: str | Real | Numbers,
        let: Mapping[str, Any] | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Mathieu(Problem):
    def __init__(
        self,
        *,
        a: Real | str,
        q: Real | str,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class MatrixOde(Problem):
    def __init__(
        self,
        *,
        group: str,
        action: str | None = None,
        field: Sequence[Any] | NDArray[Any],
        field_imaginary: Sequence[Any] | NDArray[Any] | None = None,
        start: Numbers | None = None,
        start_imaginary: Numbers | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Oja(Problem):
    def __init__(
        self,
        *,
        a: Numbers,
        x: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class QrFlow(Problem):
    def __init__(
        self,
        *,
        matrix: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Riccati(Problem):
    def __init__(
        self,
        *,
        c: Numbers,
        d: Numbers | None = None,
        b: Numbers,
        p: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidBodies(Problem):
    def __init__(
        self,
        *,
        bodies: Sequence[Any],
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidBody(Problem):
    def __init__(
        self,
        *,
        inertia: Numbers | None = None,
        inverse_inertia: Numbers | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: Numbers | None = None,
        momentum_body: Numbers | None = None,
        omega_space: Numbers | None = None,
        momentum_space: Numbers | None = None,
        attitude: Numbers | HasMatrix | None = None,
        quaternion: Numbers | HasMatrix | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidBodyN(Problem):
    def __init__(
        self,
        *,
        mass_moments: Numbers | None = None,
        inertia: Numbers | None = None,
        momentum: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidMotion(Problem):
    def __init__(
        self,
        *,
        attitude: Numbers | HasMatrix | None = None,
        quaternion: Numbers | HasMatrix | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        omega: str | Real | Numbers,
        velocity: str | Real | Numbers,
        frame: str | None = None,
        position: Numbers | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Schrodinger(Problem):
    def __init__(
        self,
        *,
        hamiltonian: Sequence[Any] | NDArray[Any] | None = None,
        hamiltonian_imaginary: Sequence[Any] | NDArray[Any] | None = None,
        energies: Numbers | None = None,
        coupling: Numbers | None = None,
        coupling_imaginary: Numbers | None = None,
        frequency: Real | str | None = None,
        phase: Real | str | None = None,
        pulse: Numbers | None = None,
        hbar: Real | str | None = None,
        amplitudes: Numbers,
        amplitudes_imaginary: Numbers | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class SphericalPendulum(Problem):
    def __init__(
        self,
        *,
        gravity_over_length: Real | str,
        direction: Numbers,
        velocity: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Spin(Problem):
    def __init__(
        self,
        *,
        field: Numbers,
        rate: Real | str,
        moment: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class SpinChain(Problem):
    def __init__(
        self,
        *,
        spins: Sequence[Any] | NDArray[Any] | None = None,
        wave: Mapping[str, Any] | None = None,
        ring: Flag | None = None,
        exchange: str | Real | Numbers | None = None,
        dm: str | Real | Numbers | None = None,
        anisotropy: str | Real | Numbers | None = None,
        field: str | Real | Numbers | None = None,
        damping: Real | str | None = None,
        samples: Samples | Path | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Subspace(Problem):
    def __init__(
        self,
        *,
        a: Numbers,
        x: Numbers,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Toda(Problem):
    def __init__(
        self,
        *,
        positions: Numbers | None = None,
        momenta: Numbers | None = None,
        matrix: Numbers | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

__all__ = [
    "BeamLine",
    "Composed",
    "DensityMatrix",
    "DoubleBracket",
    "DrivenBody",
    "Euler",
    "Fluid",
    "HeavyTop",
    "Hill",
    "KINDS",
    "Kirchhoff",
    "Lorentz",
    "Lyapunov",
    "Mathieu",
    "MatrixOde",
    "Oja",
    "Problem",
    "QrFlow",
    "Riccati",
    "RigidBodies",
    "RigidBody",
    "RigidBodyN",
    "RigidMotion",
    "Schrodinger",
    "SphericalPendulum",
    "Spin",
    "SpinChain",
    "Subspace",
    "Toda",
    "problem_of",
]
