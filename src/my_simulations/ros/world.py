"""Services about the world as a whole: its models, its physics, its clock."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Dict, List

from gazebo_msgs import srv
from std_srvs.srv import Empty

from ..description.world import OdePhysics
from ..errors import CommandError
from ..simulator.simulator import Simulator
from .convert import finite
from .endpoints import Endpoint
from .entities import in_gazebos_words

SCOPE = "::"
"""Between the names of a nested model and its link."""

ODE_FIELDS = (
    ("auto_disable_bodies", "auto_disable_bodies"),
    ("sor_pgs_precon_iters", "precon_iters"),
    ("sor_pgs_iters", "iters"),
    ("sor_pgs_w", "sor"),
    ("sor_pgs_rms_error_tol", "rms_error_tol"),
    ("contact_surface_layer", "contact_surface_layer"),
    ("contact_max_correcting_vel", "contact_max_correcting_vel"),
    ("cfm", "cfm"),
    ("erp", "erp"),
    ("max_contacts", "max_contacts"),
)
"""Fields of gazebo_msgs/ODEPhysics and of our `OdePhysics`."""


class WorldServices:
    """get_world_properties, get_model_properties, physics properties, pause and reset."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def endpoints(self) -> List[Endpoint]:
        """Its rows of the table."""
        return [
            Endpoint("get_world_properties", "GetWorldProperties", srv.GetWorldProperties,
                     self.get_world),
            Endpoint("get_model_properties", "GetModelProperties", srv.GetModelProperties,
                     self.get_model),
            Endpoint("get_physics_properties", "GetPhysicsProperties", srv.GetPhysicsProperties,
                     self.get_physics),
            Endpoint("set_physics_properties", "SetPhysicsProperties", srv.SetPhysicsProperties,
                     self.set_physics),
            Endpoint("pause_physics", "PausePhysics", Empty, self.pause),
            Endpoint("unpause_physics", "UnpausePhysics", Empty, self.unpause),
            Endpoint("reset_world", "ResetWorld", Empty, self.reset_world),
            Endpoint("reset_simulation", "ResetSimulation", Empty, self.reset_simulation),
        ]

    def get_world(self, _request: Any, response: Any) -> str:
        """Sim time in seconds and the names of the models, in load order."""
        response.sim_time = self._simulator.sim_ns() / 1e9
        response.model_names = list(self._simulator.model_names())
        response.rendering_enabled = True
        return "got properties"

    def get_model(self, request: Any, response: Any) -> str:
        """Links, collisions and joints of a model; names unscoped, as in Gazebo."""
        with in_gazebos_words("model does not exist"):
            model = self._simulator.model(request.model_name)
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
        physics, gravity = self._simulator.physics, self._simulator.gravity
        response.time_step = physics.max_step_size
        response.pause = self._simulator.paused
        response.max_update_rate = physics.real_time_update_rate
        response.gravity.x, response.gravity.y, response.gravity.z = gravity
        for theirs, ours in ODE_FIELDS:
            setattr(response.ode_config, theirs, getattr(physics.ode, ours))
        return "got properties"

    def set_physics(self, request: Any, _response: Any) -> str:
        """Replace all of them; nothing changes when one is refused."""
        step = finite(request.time_step, "time_step")
        rate = finite(request.max_update_rate, "max_update_rate")
        g = request.gravity
        gravity = (finite(g.x, "gravity.x"), finite(g.y, "gravity.y"), finite(g.z, "gravity.z"))
        if step <= 0.0:
            raise CommandError(f"time_step must be greater than 0 s, it is {step}")
        physics = replace(self._simulator.physics, max_step_size=step,
                          real_time_update_rate=max(rate, 0.0), ode=_ode(request.ode_config))
        self._simulator.set_physics(physics, gravity)
        return "physics engine updated"

    def pause(self, _request: Any, _response: Any) -> str:
        """Stop after the running step."""
        self._simulator.pause()
        return ""

    def unpause(self, _request: Any, _response: Any) -> str:
        """Go on."""
        self._simulator.unpause()
        return ""

    def reset_world(self, _request: Any, _response: Any) -> str:
        """Models to their load poses, velocities zero; joints and sim time stay (Gazebo)."""
        self._simulator.reset_world()
        return ""

    def reset_simulation(self, _request: Any, _response: Any) -> str:
        """All of that, joints to their load positions, sim time to zero (Gazebo)."""
        self._simulator.reset_simulation()
        return ""


def _ode(config: Any) -> OdePhysics:
    values: Dict[str, Any] = {}
    for theirs, ours in ODE_FIELDS:
        value = getattr(config, theirs)
        values[ours] = finite(value, f"ode_config.{theirs}") if isinstance(value, float) else value
    return OdePhysics(**values)
