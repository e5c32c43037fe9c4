"""All services of a node, without a master."""
from __future__ import annotations

import importlib
from typing import Any, List, Tuple

from inline_engine import InlineEngine

from my_simulations.description.world import World
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.endpoints import Endpoint
from my_simulations.ros.interface import SERVES, TABLE
from my_simulations.ros.services.joint_services import JointServices
from my_simulations.ros.services.light_services import LightServices
from my_simulations.ros.services.link_services import LinkServices
from my_simulations.ros.services.model_services import ModelServices
from my_simulations.ros.services.state_services import StateServices
from my_simulations.ros.services.world_services import WorldServices
from my_simulations.ros.services.wrench_services import WrenchServices
from my_simulations.simulator.simulator import Simulator

DOCUMENTS = ("<sdf version='1.6'><model name='m'><link name='l'/></model></sdf>",
             "<sdf version='1.6'><light name='s' type='point'/></sdf>", "<robot name='r'/>", "<sdf",
             "<robot name='r'><link name='l'><inertial><mass value='1'/><inertia ixx='1' ixy='0' "
             "ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link></robot>")


def start(*models: Any) -> Tuple[Simulator, List[Endpoint]]:
    """A world on an engine without physics, and the services that need no master."""
    simulator = Simulator(World(models=list(models)), paused=True, log=lambda issue: None,
                          engine_factory=InlineEngine)
    simulator.start()
    handlers = {
        "joints": JointServices(simulator), "lights": LightServices(simulator),
        "links": LinkServices(simulator), "states": StateServices(simulator),
        "models": ModelServices(simulator, Resolver(), lambda issue: None, 0),
        "world": WorldServices(simulator), "wrenches": WrenchServices(simulator),
    }
    endpoints = []
    for row in TABLE:
        part, _, method = row.handler.partition(".")
        if row.direction == SERVES and part in handlers and "Empty" not in row.type:
            package, kind = row.type.split("/")
            service = getattr(importlib.import_module(f"{package}.srv"), kind)
            endpoints.append(Endpoint(row.name, row.title, service,
                                      getattr(handlers[part], method)))
    return simulator, endpoints
