"""Many free rigid bodies at once, in SIMD lanes."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _lieflow
from ._arrays import MEMBERSHIP, Array, finite, first, name_of, number, own, real, whole
from .so3 import contains
from ._errors import ArgumentError
from ._types import Matrices, Real, Whole

__all__ = ["FreeBodies"]


class FreeBodies:
    """Many free rigid bodies: ṁ = m × J⁻¹m, and with attitudes ġ = g ω̂.

    Parameters
    ----------
    inertia : (N, 3) or (3,) array_like
        The principal moments of each body, or of all.
    momentum : (N, 3) array_like
        The angular momenta in the bodies.
    attitude : (N, 3, 3) array_like or Rotation, optional
        The rotations from the bodies to space. Without them only the momenta are computed.
    """

    def __init__(self, inertia: ArrayLike, momentum: ArrayLike, attitude: Matrices | None = None) -> None:
        m = real("momentum", momentum)
        if m.ndim != 2 or m.shape[1] != 3:
            raise ArgumentError("momentum", f"shape {m.shape}", "shape (N, 3)")
        finite("momentum", m)
        j = own("inertia", inertia)
        first("inertia", ~((j > 0) & (j < np.inf)), "a number that no moment can be", "finite numbers > 0")
        if j.shape == (3,):
            j = np.ascontiguousarray(np.broadcast_to(j, m.shape))
        if j.shape != m.shape:
            raise ArgumentError("inertia", f"shape {j.shape}", f"shape (3,) or {m.shape}")
        g = None if attitude is None else real("attitude", attitude)
        if g is not None and g.shape != (len(m), 3, 3):
            raise ArgumentError("attitude", f"shape {g.shape}", f"shape ({len(m)}, 3, 3)")
        if g is not None:
            first("attitude", ~contains(g, MEMBERSHIP), "a matrix that is no rotation", "rotations")
        self._inertia = j
        self._bodies = _lieflow.FreeBodies(j, m, g)
        if self._bodies.impossible is not None:
            warnings.warn(self._bodies.impossible, UserWarning, stacklevel=2)

    def advance(self, method: str, h: Real, steps: Whole, threads: Whole = 1) -> None:
        """Take steps of the size h with "rkmk4 exp", "rkmk4 cay" or "rk4-mg". The results are the same for any threads.

        After an error, such as that of a step which one body cannot take, all bodies are as before the call. After Ctrl-C all of
        them are at the end of the same step, and :attr:`nsteps` tells which. Another thread that reads the bodies during the
        call sees them after some of the steps, all of them after the same.

        Cost: some 10 ns for each body and step with momenta alone, on one core with AVX-512.
        """
        self._bodies.advance(name_of("method", method), number("h", h), whole("steps", steps), whole("threads", threads, 1))

    @property
    def nsteps(self) -> int:
        """The steps that the bodies have taken since this object was made."""
        return self._bodies.nsteps

    @property
    def momentum(self) -> Array:
        """The angular momenta in the bodies, (N, 3)."""
        return self._bodies.momentum()

    @property
    def attitude(self) -> Array | None:
        """The rotations from the bodies to space, (N, 3, 3); None without attitudes."""
        return self._bodies.attitude()

    @property
    def energy(self) -> Array:
        """The energies ½ m·J⁻¹m, (N,)."""
        return self._bodies.energy()

    @property
    def inertia(self) -> Array:
        """The principal moments, (N, 3)."""
        return np.array(self._inertia)

    def __len__(self) -> int:
        return len(self._inertia)

    def __repr__(self) -> str:
        return f"<lieflow.FreeBodies: {len(self)} bodies>"

    def __reduce__(self) -> tuple[Any, ...]:
        return (FreeBodies, (self._inertia, *self._bodies.state()))
