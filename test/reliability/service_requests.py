"""All services of a node, without a master, and requests of their types."""
from __future__ import annotations

import importlib
from typing import Any, List, Tuple

from grammars import words
from hypothesis import strategies as st
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
NAMES = st.sampled_from(("a", "b", "a::link", "b::hinge", "", "world", "hinge", "base", "new"))
sane = st.sampled_from((0.0, 0.5, 1.0, 2.0))
strange = st.sampled_from((float("nan"), float("inf"), 1e308, -1e300, 5e-324, -1.0))
numbers = st.integers(0, 29).flatmap(lambda n: strange if n == 29 else sane)
SIZES = {"bool": st.booleans(), "float64": numbers, "float32": numbers,
         "string": st.integers(0, 9).flatmap(
             lambda n: words if n == 9 else st.sampled_from(DOCUMENTS) if n == 8 else NAMES)}


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


def requests(endpoints: List[Endpoint]) -> Any:
    """Pairs of a service and a request."""
    return st.sampled_from(endpoints).flatmap(
        lambda endpoint: st.tuples(st.just(endpoint), message(endpoint.type._request_class)))


def message(kind: Any) -> Any:
    """Messages of a class, every field with values that may fit."""
    fields = {name: field(of) for name, of in zip(kind.__slots__, kind._slot_types)}
    return st.fixed_dictionaries(fields).map(lambda given: kind(**given))


def field(kind: str) -> Any:
    """Values of a field's type, in the range that a client can send."""
    if kind.endswith("]"):
        return st.lists(field(kind.partition("[")[0]), max_size=3)
    if kind in SIZES:
        return SIZES[kind]
    if kind in ("time", "duration"):
        import genpy

        make = genpy.Time if kind == "time" else genpy.Duration
        return st.tuples(st.integers(0, 10), st.integers(0, 999999999)).map(lambda t: make(*t))
    if "/" in kind:
        package, name = kind.split("/")
        return message(getattr(importlib.import_module(f"{package}.msg"), name))
    bits = int("".join(filter(str.isdigit, kind)) or 8)
    return (st.integers(0, 2**bits - 1) if kind.startswith("u")
            else st.integers(-2**(bits - 1), 2**(bits - 1) - 1))
