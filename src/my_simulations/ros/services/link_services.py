"""get_link_properties and set_link_properties."""
from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from ...description.model import Inertial
from ...description.validate import inertial_faults
from ...errors import CommandError
from ...geometry_messages import fill_pose
from ...simulator.simulator import Simulator
from ..message_conversion import check_number, pose_from_message
from .entity_errors import gazebo_prefix

MOMENTS = tuple(field.name for field in fields(Inertial) if field.name.startswith("i"))

HEAVIEST = 1e12
"""Largest accepted mass (kg) and moment of inertia (kg m^2)."""


class LinkServices:
    """Reads and sets the inertial properties of links."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def get(self, request: Any, response: Any) -> str:
        """Mass (kg), centre of mass and inertia axes in the link frame, moments (kg m^2)."""
        with gazebo_prefix("link not found"):
            link = self._simulator.models.link(request.link_name)
        fill_pose(response.com, link.inertial.pose)
        response.gravity_mode, response.mass = link.gravity, link.inertial.mass
        for name in MOMENTS:
            setattr(response, name, getattr(link.inertial, name))
        return "got properties"

    def set(self, request: Any, _response: Any) -> str:
        """Replace all of them; moments are about the centre of mass, along the axes of `com`."""
        with gazebo_prefix("link not found"):
            link = self._simulator.models.link(request.link_name)
        inertial = replace(
            link.inertial, mass=check_number(request.mass, -HEAVIEST, HEAVIEST, "mass", "kg"),
            pose=pose_from_message(request.com, "com"),
            **{name: check_number(getattr(request, name), -HEAVIEST, HEAVIEST, name, "kg m^2")
               for name in MOMENTS})
        for fault in inertial_faults(inertial, link.name):
            raise CommandError(fault.message)
        with gazebo_prefix("link not found"):
            self._simulator.models.set_link_inertial(request.link_name, inertial,
                                                     request.gravity_mode)
        return "properties set"
