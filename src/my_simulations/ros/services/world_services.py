"""Services about the world as a whole: its models, its physics, its clock."""
from __future__ import annotations

from typing import Any

from ...description.scoped_names import SCOPE
from ...simulator.simulator import Simulator
from .entity_errors import in_gazebos_words
from .physics_parameters import ODE, change, present


class WorldServices:
    """get_world_properties, get_model_properties, physics properties, pause and reset."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def get_world(self, _request: Any, response: Any) -> str:
        """Sim time in seconds and the names of the models, in load order."""
        response.sim_time = self._simulator.clock.sim_ns / 1e9
        response.model_names = list(self._simulator.models.names())
        response.rendering_enabled = True
        return "got properties"

    def get_model(self, request: Any, response: Any) -> str:
        """Links, collisions and joints of a model; names unscoped, as in Gazebo."""
        with in_gazebos_words("model does not exist"):
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
        """Step size (s), rate (Hz of steps, 0 unthrottled), gravity and the stored ODE values."""
        values = present(self._simulator)
        response.time_step = values["time_step"]
        response.pause = self._simulator.clock.paused
        response.max_update_rate = values["max_update_rate"]
        gravity = response.gravity
        gravity.x, gravity.y, gravity.z = self._simulator.physics.gravity
        for parameter in ODE:
            setattr(response.ode_config, parameter.name, values[parameter.name])
        return "got properties"

    def set_physics(self, request: Any, _response: Any) -> str:
        """Replace all of them; nothing changes when one is refused."""
        gravity = request.gravity
        change(self._simulator, {
            "time_step": request.time_step, "max_update_rate": request.max_update_rate,
            "gravity_x": gravity.x, "gravity_y": gravity.y, "gravity_z": gravity.z,
            **{parameter.name: getattr(request.ode_config, parameter.name)
               for parameter in ODE}})
        return "physics engine updated"

    def pause(self, _request: Any, _response: Any) -> str:
        """Stop after the running step."""
        self._simulator.clock.pause()
        return ""

    def unpause(self, _request: Any, _response: Any) -> str:
        """Go on."""
        self._simulator.clock.unpause()
        return ""

    def reset_world(self, _request: Any, _response: Any) -> str:
        """Models to their load poses, velocities zero; joints and sim time stay (Gazebo)."""
        self._simulator.resets.reset_world()
        return ""

    def reset_simulation(self, _request: Any, _response: Any) -> str:
        """All of that, joints to their load positions, sim time to zero (Gazebo)."""
        self._simulator.resets.reset_simulation()
        return ""

    def reset_time(self, _request: Any, _response: Any) -> str:
        """Sim time to zero, everything else goes on as it is."""
        self._simulator.resets.reset_time()
        return ""
