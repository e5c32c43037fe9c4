"""Simulators of worlds, started with an engine in this process or in another one."""
from __future__ import annotations

import contextlib

from inline_engine import InlineEngine
from kinematic_backend import KinematicBackend

from my_simulations.simulator.simulator import Simulator


def started(world, backend=KinematicBackend, *, engine=None, log=lambda issue: None, paused=True,
            **options):
    """Return a simulator that was started.

    `backend`: of an engine in this process; `engine`: creates another engine instead.
    """
    made = Simulator(world, engine_factory=engine or (lambda: InlineEngine(backend)), log=log,
                     paused=paused, **options)
    made.start()
    return made


@contextlib.contextmanager
def running(*arguments, **options):
    """As `started`; the simulator is closed at the end."""
    made = started(*arguments, **options)
    try:
        yield made
    finally:
        made.close()
