"""The tests run on the installed wheel, outside of the source tree."""

from __future__ import annotations

import signal

import numpy as np
import pytest

# A shell that starts a program in the background lets it ignore interrupts, which some tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)

J = np.array([1.0, 4.0, 18.0])
M = np.array([0.0, 2.75, 2.75])


def body(t: float, r: np.ndarray) -> np.ndarray:
    """ω of a torque-free body, in the body."""
    return (M @ r) / J


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)
