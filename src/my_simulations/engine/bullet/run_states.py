"""Read and set the engine's internal state from earlier steps (see `engine.run_state`)."""
from __future__ import annotations

from typing import Dict, Mapping, Tuple

from ..run_state import ReadRunState, RunState, SetRunState
from .bodies import Body, Part
from .helper_set import HelperSet


class RunStates:
    """The run state of the helpers of a world.

    Args:
        helpers: the helpers.
        bodies: by PyBullet's number.
        rows: link rows to bodies and their parts.
    """

    def __init__(self, helpers: HelperSet, bodies: Dict[int, Body],
                 rows: Mapping[int, Tuple[Body, Part]]) -> None:
        self._helpers = helpers
        self._bodies = bodies
        self._rows = rows

    def read(self, _: ReadRunState) -> RunState:
        helpers = self._helpers
        resting = dict(helpers.settling.held)
        for body in self._bodies.values():
            place = helpers.restored_sleep.place_of(body)
            if place is not None:
                resting[body.lead_row] = place
        return RunState(
            tuple(resting.items()),
            helpers.forces.servos.memories(), helpers.forces.loop_memories(),
            helpers.forces.damper_memories(), helpers.settling.parting_end,
            tuple(body.lead_row for body in helpers.divergence.stopped))

    def set(self, command: SetRunState) -> None:
        state, forces = command.state, self._helpers.forces
        forces.servos.resume(state.servos)
        forces.resume_loops(state.loops)
        forces.resume_dampers(state.dampers)
        self._helpers.settling.resume_parting(state.parting_end)
        self._helpers.divergence.stop(self._rows[row][0] for row in state.stopped)
        self._helpers.restored_sleep.put(
            (self._rows[row][0], place) for row, place in state.resting)
