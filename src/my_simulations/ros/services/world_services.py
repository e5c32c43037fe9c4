"""Services for the whole world: models, physics properties, pause and reset."""
from __future__ import annotations

from typing import Any

from ...description.scoped_names import SCOPE
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
