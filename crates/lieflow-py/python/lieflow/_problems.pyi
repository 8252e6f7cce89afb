"""Every kind of problem as a class. Made by tests/stub_of_problems.py."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _lieflow
from ._fields import Quantities, Samples
from ._result import Layout
from ._unitary import ComplexState

Array = NDArray[np.float64]
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
    def orders(self, method: str) -> tuple[int | None, int | None]: ...
    def exact(
        self, t: ArrayLike, quantities: Sequence[str] | str | None = None, *, t0: float = 0.0
    ) -> Quantities | None: ...
    def asked(self, quantities: Sequence[str] | str | None) -> tuple[str, ...]: ...
    def _both(
        self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...]
    ) -> tuple[_lieflow.Model, Layout]: ...
    def _model(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> _lieflow.Model: ...
    def _layout(self, asked: tuple[str, ...], events: tuple[tuple[str, str], ...] = ()) -> Layout: ...
    def _complex_state(self) -> ComplexState | None: ...
    def _form(self, model: _lieflow.Model, method: str) -> tuple[str, str, str]: ...
    def _start(self, y0: Any, model: _lieflow.Model, method: str) -> Array | None: ...

def problem_of(kind: str, keys: dict[str, Any]) -> Problem: ...
def _quietly(kind: str, keys: dict[str, Any]) -> Problem: ...

KINDS: dict[str, type[Problem]]

class BeamLine(Problem):
    def __init__(
        self,
        *,
        elements: Sequence[Any],
        particle: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Composed(Problem):
    def __init__(
        self,
        *,
        parts: Sequence[Any],
        invariants: Mapping[str, Any] | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DensityMatrix(Problem):
    def __init__(
        self,
        *,
        hamiltonian: Sequence[Any] | None = None,
        hamiltonian_imaginary: Sequence[Any] | None = None,
        energies: ArrayLike | None = None,
        coupling: ArrayLike | None = None,
        coupling_imaginary: ArrayLike | None = None,
        frequency: float | None = None,
        phase: float | None = None,
        pulse: ArrayLike | None = None,
        hbar: float | None = None,
        density: ArrayLike | None = None,
        density_imaginary: ArrayLike | None = None,
        amplitudes: ArrayLike | None = None,
        amplitudes_imaginary: ArrayLike | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DoubleBracket(Problem):
    def __init__(
        self,
        *,
        matrix: ArrayLike,
        order: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class DrivenBody(Problem):
    def __init__(
        self,
        *,
        inertia: ArrayLike | ArrayLike | None = None,
        inverse_inertia: ArrayLike | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: ArrayLike | None = None,
        momentum_body: ArrayLike | None = None,
        omega_space: ArrayLike | None = None,
        momentum_space: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        weight: ArrayLike | None = None,
        thruster: ArrayLike | None = None,
        damping: float | None = None,
        control: ArrayLike | None = None,
        torque: str | float | Sequence[str | float] | None = None,
        torque_space: str | float | Sequence[str | float] | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Euler(Problem):
    def __init__(
        self,
        *,
        algebra: str,
        hamiltonian: str | float | None = None,
        inverse_inertia: ArrayLike | None = None,
        momentum: ArrayLike | ArrayLike,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Fluid(Problem):
    def __init__(
        self,
        *,
        surface: str,
        n: int,
        random: Mapping[str, Any] | None = None,
        jets: Sequence[Any] | None = None,
        modes: Sequence[Any] | None = None,
        vortices: Sequence[Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class HeavyTop(Problem):
    def __init__(
        self,
        *,
        inertia: ArrayLike | ArrayLike | None = None,
        inverse_inertia: ArrayLike | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: ArrayLike | None = None,
        momentum_body: ArrayLike | None = None,
        omega_space: ArrayLike | None = None,
        momentum_space: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        weight: ArrayLike,
        vertical: ArrayLike | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Hill(Problem):
    def __init__(
        self,
        *,
        a: ArrayLike,
        q: ArrayLike,
        period: float,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Kirchhoff(Problem):
    def __init__(
        self,
        *,
        inertia: ArrayLike,
        mass: ArrayLike,
        angular_momentum: ArrayLike,
        linear_momentum: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Lorentz(Problem):
    def __init__(
        self,
        *,
        charge_to_mass: float,
        electric: ArrayLike,
        magnetic: ArrayLike,
        velocity: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Lyapunov(Problem):
    def __init__(
        self,
        *,
        x: ArrayLike,
        variables: Sequence[Any] | None = None,
        field: str | float | Sequence[str | float],
        let: Mapping[str, Any] | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Mathieu(Problem):
    def __init__(
        self,
        *,
        a: float,
        q: float,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class MatrixOde(Problem):
    def __init__(
        self,
        *,
        group: str,
        action: str | None = None,
        field: Sequence[Any],
        field_imaginary: Sequence[Any] | None = None,
        start: ArrayLike | None = None,
        start_imaginary: ArrayLike | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Oja(Problem):
    def __init__(
        self,
        *,
        a: ArrayLike,
        x: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class QrFlow(Problem):
    def __init__(
        self,
        *,
        matrix: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Riccati(Problem):
    def __init__(
        self,
        *,
        c: ArrayLike,
        d: ArrayLike | None = None,
        b: ArrayLike,
        p: ArrayLike,
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
        inertia: ArrayLike | ArrayLike | None = None,
        inverse_inertia: ArrayLike | None = None,
        shape: Mapping[str, Any] | None = None,
        omega_body: ArrayLike | None = None,
        momentum_body: ArrayLike | None = None,
        omega_space: ArrayLike | None = None,
        momentum_space: ArrayLike | None = None,
        attitude: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        euler: Mapping[str, Any] | None = None,
        fixed: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidBodyN(Problem):
    def __init__(
        self,
        *,
        mass_moments: ArrayLike | None = None,
        inertia: ArrayLike | None = None,
        momentum: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class RigidMotion(Problem):
    def __init__(
        self,
        *,
        omega: str | float | Sequence[str | float],
        velocity: str | float | Sequence[str | float],
        frame: str | None = None,
        attitude: ArrayLike | None = None,
        position: ArrayLike | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Schrodinger(Problem):
    def __init__(
        self,
        *,
        hamiltonian: Sequence[Any] | None = None,
        hamiltonian_imaginary: Sequence[Any] | None = None,
        energies: ArrayLike | None = None,
        coupling: ArrayLike | None = None,
        coupling_imaginary: ArrayLike | None = None,
        frequency: float | None = None,
        phase: float | None = None,
        pulse: ArrayLike | None = None,
        hbar: float | None = None,
        amplitudes: ArrayLike,
        amplitudes_imaginary: ArrayLike | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class SphericalPendulum(Problem):
    def __init__(
        self,
        *,
        gravity_over_length: float,
        direction: ArrayLike,
        velocity: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Spin(Problem):
    def __init__(
        self,
        *,
        field: ArrayLike,
        rate: float,
        moment: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class SpinChain(Problem):
    def __init__(
        self,
        *,
        spins: Sequence[Any] | None = None,
        wave: Mapping[str, Any] | None = None,
        ring: bool | None = None,
        exchange: str | float | Sequence[str | float] | None = None,
        dm: str | float | Sequence[str | float] | None = None,
        anisotropy: str | float | Sequence[str | float] | None = None,
        field: str | float | Sequence[str | float] | None = None,
        damping: float | None = None,
        samples: Samples | str | None = None,
        interpolation: str | None = None,
        let: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Subspace(Problem):
    def __init__(
        self,
        *,
        a: ArrayLike,
        x: ArrayLike,
        parameters: Mapping[str, Any] | None = None,
    ) -> None: ...

class Toda(Problem):
    def __init__(
        self,
        *,
        positions: ArrayLike | None = None,
        momenta: ArrayLike | None = None,
        matrix: ArrayLike | None = None,
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
