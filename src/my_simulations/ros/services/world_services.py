"""Services for the whole world: properties, pause, reset, steps, saving, and its editor."""
from __future__ import annotations

import threading
from typing import Any, Callable, List, Optional

import rospy

from ...description.flatten import flatten_model
from ...description.scoped_names import SCOPE
from ...errors import CommandError
from ...resources.resolver import Resolver
from ...simulator.simulator import Simulator
from .entity_errors import gazebo_prefix
from .physics_parameters import ODE, change_parameters, current_parameters


class WorldServices:
    """get_world_properties, get_model_properties, physics properties, pause and reset."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def get_world(self, _request: Any, response: Any) -> str:
        """Sim time (s) and the names of the models, in load order."""
        response.sim_time = self._simulator.clock.sim_ns / 1e9
        response.model_names = list(self._simulator.models.names())
        response.rendering_enabled = True
        return "got properties"

    def get_model(self, request: Any, response: Any) -> str:
        """Links, collisions and joints of a model, by unscoped names (Gazebo behaviour)."""
        nested = self._simulator.models.nested(request.model_name)
        if nested is not None:
            response.parent_model_name = nested.parent
            model = flatten_model(nested.model)
        else:
            with gazebo_prefix("model does not exist"):
                model = self._simulator.models.get(request.model_name)
        links = [link for link in model.links if SCOPE not in link.name]
        response.canonical_body_name = model.canonical_link or (links[0].name if links else "")
        response.body_names = [link.name for link in links]
        response.geom_names = [collision.name for link in links for collision in link.collisions]
        response.joint_names = [joint.name for joint in model.joints if SCOPE not in joint.name]
        response.child_model_names = list(dict.fromkeys(
            link.name.split(SCOPE)[0] for link in model.links if SCOPE in link.name))
        response.is_static = model.static
        return "got properties"

    def get_physics(self, _request: Any, response: Any) -> str:
        """Step size (s), update rate (Hz, 0: unthrottled), gravity (m/s^2), ODE parameters."""
        values = current_parameters(self._simulator)
        response.time_step = values["time_step"]
        response.pause = self._simulator.clock.paused
        response.max_update_rate = values["max_update_rate"]
        gravity = response.gravity
        gravity.x, gravity.y, gravity.z = self._simulator.physics.gravity
        for parameter in ODE:
            setattr(response.ode_config, parameter.name, values[parameter.name])
        return "got properties"

    def set_physics(self, request: Any, _response: Any) -> str:
        """Set all physics properties; nothing changes if one is rejected."""
        gravity = request.gravity
        change_parameters(self._simulator, {
            "time_step": request.time_step, "max_update_rate": request.max_update_rate,
            "gravity_x": gravity.x, "gravity_y": gravity.y, "gravity_z": gravity.z,
            **{parameter.name: getattr(request.ode_config, parameter.name)
               for parameter in ODE}})
        return "physics engine updated"

    def pause(self, _request: Any, _response: Any) -> str:
        """Pause after the current step."""
        self._simulator.clock.pause()
        return ""

    def unpause(self, _request: Any, _response: Any) -> str:
        self._simulator.clock.unpause()
        return ""

    def reset_world(self, _request: Any, _response: Any) -> str:
        """Reset model poses and velocities; joint positions and sim time are kept (Gazebo)."""
        self._simulator.resets.reset_world()
        return ""

    def reset_simulation(self, _request: Any, _response: Any) -> str:
        """Reset model poses, velocities, joint positions and sim time (Gazebo)."""
        self._simulator.resets.reset_simulation()
        return ""

    def reset_time(self, _request: Any, _response: Any) -> str:
        """Reset sim time to 0; everything else is kept."""
        self._simulator.resets.reset_time()
        return ""


Open = Callable[[], str]
"""Starts the editor of this server unless it runs, and returns its address."""


class EditorService:
    """Starts the world editor on request and returns its URL."""

    def __init__(self, open_editor: Optional[Open]) -> None:
        self._open = open_editor

    def open(self, _request: Any, response: Any) -> str:
        """Start the editor if needed. Raises CommandError: it is not installed or cannot listen."""
        if self._open is None:
            raise CommandError("this node was started without a world editor")
        response.url = self._open()
        return f"the world editor is at {response.url}; gzclient opens it"


_STEPS_PER_COMMAND = 1000
"""Steps per engine command; between two of them a shutdown of the node is noticed."""

_MOST_STEPS = 100000000


class StepService:
    """Executes steps, one request at a time."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._lock = threading.Lock()

    def step(self, request: Any, response: Any) -> str:
        """Execute steps as fast as possible; returns when they are done.

        Raises CommandError: the count is out of range, or the node shuts down.
        """
        steps = request.steps
        if not 0 <= steps <= _MOST_STEPS:
            raise CommandError(f"steps must be between 0 and {_MOST_STEPS}, is {steps}")
        with self._lock:
            left = steps
            while left > 0:
                if rospy.is_shutdown():
                    raise CommandError(f"node is shutting down; {left} steps not executed")
                count = min(left, _STEPS_PER_COMMAND)
                self._simulator.clock.advance(count)
                left -= count
            nanoseconds = self._simulator.clock.sim_ns
        response.sim_time.secs, response.sim_time.nsecs = divmod(nanoseconds, 1000000000)
        return f"{steps} steps executed"


ROOTS = "~save_roots"
"""Parameter: folders below which worlds may be saved; replaces the default list."""


class SaveService:
    """Saves the running world to a file."""

    def __init__(self, simulator: Simulator, resolver: Resolver, caller: str = "") -> None:
        """`caller`: working directory of the user who started the node; an allowed folder."""
        self._caller = caller
        self._simulator = simulator
        self._resolver = resolver

    def save(self, request: Any, response: Any) -> str:
        """Save the world in its current state.

        Raises CommandError: the path is not allowed or cannot be written.
        """
        # Imported with the first request: start-up time counts.
        from ...simulator.saving import default_roots, save_world

        roots = _roots()
        if roots is None:
            roots = default_roots(self._simulator.world.file, self._caller)
        left_out = [] if request.launched else self._simulator.models.launched()
        response.path = save_world(
            self._simulator, request.path, roots=roots, resolver=self._resolver,
            overwrite=request.overwrite, inline=request.inline, state=request.state,
            launched=request.launched)
        without = (f", without models spawned by the launch file: {', '.join(left_out)}"
                   if left_out else "")
        return f"saved to {response.path}{without}"


def _roots() -> Optional[List[str]]:
    roots = rospy.get_param(ROOTS, None)
    if roots is None:
        return None
    if not isinstance(roots, list) or not all(isinstance(root, str) and root for root in roots):
        raise CommandError(f"parameter {rospy.resolve_name(ROOTS)} must be a list of folders,"
                           f" is {roots!r}")
    return roots
