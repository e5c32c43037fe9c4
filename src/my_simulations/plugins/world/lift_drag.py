"""libLiftDragPlugin.so: lift and drag of a wing, a rudder or a rotor blade.

Parameters, defaults and law are those of Gazebo 11, which is thin-plate theory with a stall:
https://classic.gazebosim.org/tutorials?tut=aerodynamics. As there, the pitching moment (`cma`) does
not act. Where it differs: the velocity in the plane of lift and drag is that without its spanwise
part (the original subtracts the spanwise speed along the flow). The engine computes the force.
"""
from __future__ import annotations

import math

from ...engine.wrench_laws import Wing
from ...geometry import unit
from ..base import Plugin
from ..context import PluginError


class LiftDrag(Plugin):
    """Acts on the link `<link_name>` at its centre of pressure `<cp>`."""

    def load(self) -> None:
        context, p = self.context, self.context.parameters
        self._link = context.link(self.required_text("link_name"))
        stall = p.number("alpha_stall", math.pi / 2.0)
        self._wing = Wing(
            p.number("air_density", 1.2041), p.number("area", 1.0), p.number("a0", 0.0), stall,
            (p.number("cla", 1.0), p.number("cla_stall", 0.0)),
            (p.number("cda", 0.01), p.number("cda_stall", 1.0)), p.vector("cp"),
            unit(p.vector("forward", (1.0, 0.0, 0.0))), unit(p.vector("upward", (0.0, 0.0, 1.0))),
            p.flag("radial_symmetry", False), p.number("control_joint_rad_to_cl", 4.0))
        self._control = self._control_joint(p.text("control_joint_name"))
        self.reset()

    def reset(self) -> None:
        """Forces ended with the reset."""
        self.context.set_wrench_law(self._link.name, self._wing, self._control)

    def _control_joint(self, name: str) -> str:
        """Return the control joint, or ""; report a missing one and ignore it, as in Gazebo."""
        if name:
            try:
                return self.context.joint(name).name
            except PluginError as fault:
                self.context.warn(f"{fault}; <control_joint_name> does nothing")
        return ""
