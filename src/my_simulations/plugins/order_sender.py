"""Takes what plugins have ordered to the engine."""
from __future__ import annotations

from typing import List, Sequence

from ..engine.drive_commands import JointMotor, JointServo, PlanarVelocity
from ..simulator.simulator import Simulator
from .simulated_context import SimulatedContext


def send_orders(simulator: Simulator, contexts: Sequence[SimulatedContext], revision: int) -> bool:
    """Send the orders of these plugins in as few commands as there can be.

    False, and some are left, where the models are not those of the revision any more.
    """
    motors: List[JointMotor] = []
    servos: List[JointServo] = []
    planar: List[PlanarVelocity] = []
    for context in contexts:
        orders = context.orders
        motors += orders.motors.values()
        servos += orders.servos.values()
        if orders.planar is not None:
            planar.append(orders.planar)
    if (motors or servos or planar) and not simulator.drives.set(motors, planar, revision, servos):
        return False
    for context in contexts:
        context.orders.motors.clear()
        context.orders.servos.clear()
        context.orders.planar = None
    return _send_pushes(simulator, [one for one in contexts if one.orders.pushes], revision)


def _send_pushes(simulator: Simulator, contexts: Sequence[SimulatedContext],
                 revision: int) -> bool:
    if not contexts:
        return True
    orders = [(context, link, *push) for context in contexts
              for link, push in context.orders.pushes.items()]
    ids = simulator.wrenches.swap(
        [context.push_ids[link] for context, link, *_ in orders if link in context.push_ids],
        [order[1:] for order in orders], revision)
    if ids is None:
        return False
    for (context, link, *_), number in zip(orders, ids):
        context.push_ids.pop(link, None)
        if number:
            context.push_ids[link] = number
    for context in contexts:
        context.orders.pushes.clear()
    return True
