"""Sends the commands of plugins to the engine."""
from __future__ import annotations

from typing import List, Sequence

from ..engine.drive_commands import JointMotor, JointServo, PlanarVelocity
from ..simulator.simulator import Simulator
from .simulated_context import SimulatedContext


def send_commands(simulator: Simulator, contexts: Sequence[SimulatedContext],
                  revision: int) -> bool:
    """Send the commands of these plugins in as few engine commands as possible.

    Returns False, and leaves some commands, if the models have another revision by now.
    """
    motors: List[JointMotor] = []
    servos: List[JointServo] = []
    planar: List[PlanarVelocity] = []
    for context in contexts:
        commands = context.commands
        motors += commands.motors.values()
        servos += commands.servos.values()
        if commands.planar is not None:
            planar.append(commands.planar)
    # The turn ends with a message that lets the engine go on.
    if (motors or servos or planar) and not simulator.drives.set(
            motors, planar, revision, servos, at_once=False):
        return False
    for context in contexts:
        context.commands.motors.clear()
        context.commands.servos.clear()
        context.commands.planar = None
    return _send_wrenches(simulator, [one for one in contexts if one.commands.wrenches], revision)


def _send_wrenches(simulator: Simulator, contexts: Sequence[SimulatedContext],
                 revision: int) -> bool:
    """As `send_commands`, for the wrenches on links."""
    if not contexts:
        return True
    commands = [(context, link, *push) for context in contexts
              for link, push in context.commands.wrenches.items()]
    ids = simulator.wrenches.swap(
        [context.wrench_ids[link] for context, link, *_ in commands if link in context.wrench_ids],
        [order[1:] for order in commands], revision)
    if ids is None:
        return False
    for (context, link, *_), number in zip(commands, ids):
        context.wrench_ids.pop(link, None)
        if number:
            context.wrench_ids[link] = number
    for context in contexts:
        context.commands.wrenches.clear()
    return True
