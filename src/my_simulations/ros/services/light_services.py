"""get_light_properties, set_light_properties and delete_light."""
from __future__ import annotations

from dataclasses import replace
from typing import Any, Dict, Tuple

from ...description.light import Light
from ...errors import CommandError
from ...geometry import Pose, norm, scale
from ...simulator.registry import UnknownEntityError
from ...simulator.simulator import Simulator
from ..message_conversion import check_number, check_vector, pose_from_message, vector_of

BRIGHTEST = 1e6
"""Largest accepted colour component or attenuation."""

NO_COLOUR = (0.0, 0.0, 0.0, 0.0)


class LightServices:
    """Reads, changes and deletes lights."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def get(self, request: Any, response: Any) -> str:
        """Diffuse colour and attenuation of a light."""
        light = self._light(request.light_name)
        colour = response.diffuse
        colour.r, colour.g, colour.b, colour.a = light.diffuse
        response.attenuation_constant = light.constant
        response.attenuation_linear = light.linear
        response.attenuation_quadratic = light.quadratic
        return "got properties"

    def set(self, request: Any, _response: Any) -> str:
        """Change a light; colours, attenuations, direction and pose of zeros are left unchanged."""
        with self._simulator.change_lock:
            return self._set(request)

    def _set(self, request: Any) -> str:
        light = self._light(request.light_name)
        changes: Dict[str, Any] = {"cast_shadows": request.cast_shadows}
        for field in ("diffuse", "specular"):
            colour = _colour(getattr(request, field), field)
            if colour != NO_COLOUR:
                changes[field] = colour
        attenuation = {name: check_number(getattr(request, f"attenuation_{name}"), 0.0, BRIGHTEST,
                                     f"attenuation_{name}")
                       for name in ("constant", "linear", "quadratic")}
        if any(attenuation.values()):
            changes.update(attenuation)
        direction = check_vector(vector_of(request.direction), BRIGHTEST, "", "direction")
        if norm(direction) > 0.0:
            changes["direction"] = scale(direction, 1.0 / norm(direction))
        changes["pose"] = _pose(request.pose, light)
        self._simulator.lights.set(light.name, replace(light, **changes))
        return "properties set"

    def delete(self, request: Any, _response: Any) -> str:
        name = self._light(request.light_name).name
        self._simulator.lights.delete(name)
        return f"{name} successfully deleted"

    def _light(self, name: str) -> Light:
        try:
            return self._simulator.lights.get(name)
        except UnknownEntityError as fault:
            lights = ", ".join(light.name for light in self._simulator.lights.all())
            raise CommandError(f"Requested light {name} not found! The world has "
                               f"{lights or 'no lights'}") from fault


def _colour(message: Any, field: str) -> Tuple[float, float, float, float]:
    r, g, b, a = (check_number(getattr(message, part), 0.0, BRIGHTEST, f"{field}.{part}")
                  for part in "rgba")
    return (r, g, b, a)


def _pose(message: Any, light: Light) -> Pose:
    """The pose asked for; where the quaternion is zero, the orientation it has."""
    pose = pose_from_message(message)
    q = message.orientation
    if q.x == q.y == q.z == q.w == 0.0:
        return light.pose if not any(pose.position) else Pose(pose.position, light.pose.orientation)
    return pose
