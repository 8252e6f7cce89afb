"""The tests run on the installed wheel, outside of the source tree."""

from __future__ import annotations

import signal
import threading
import time

import numpy as np
import pytest

import lieflow as lf

# A shell that starts a program in the background lets it ignore interrupts, which some tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)

J = np.array([1.0, 4.0, 18.0])
M = np.array([0.0, 2.75, 2.75])

ROTATION = {"group": "SO(3)", "frame": "body"}
BODY = lf.RigidBody(inertia=[1.0, 2.0, 3.0], omega_body=[0.01, 1.0, 0.0])
PARTS = lf.Parts(R="rotation", n="numbers 2")
START = {"R": np.eye(3), "n": [0.0, 1.0]}


def body(t: float, r: np.ndarray) -> np.ndarray:
    """ω of a torque-free body, in the body."""
    return (M @ r) / J


def turn(t, y):
    """ω of a rotation about the third axis."""
    return [0.0, 0.0, 1.0]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(7)


def interrupted(call):
    """The time from an interrupt to the end of a call that takes much longer."""
    sent = []

    def send():
        time.sleep(0.2)
        sent.append(time.perf_counter())
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

    thread = threading.Thread(target=send)
    thread.start()
    try:
        call()
        thread.join()
        time.sleep(0.1)
    except KeyboardInterrupt:
        late = time.perf_counter() - sent[0]
        thread.join()
        return late
    pytest.fail("the call ended before the interrupt")


def turns_during(call, *args, **options):
    """How often this thread has a turn during a call of another thread. A call that held the interpreter would let none pass."""
    thread = threading.Thread(target=call, args=args, kwargs=options)
    thread.start()
    turns = 0
    while thread.is_alive():
        turns += 1
        time.sleep(0.0005)
    return turns
