"""libWheelSlipPlugin.so and libgazebo_ros_wheel_slip.so: wheels that slip by what drives them.

Parameters, defaults and law are those of Gazebo: in each `<wheel link_name="...">` two compliances
without a unit, `<slip_compliance_lateral>` and `<slip_compliance_longitudinal>`, the weight that it
carries, `<wheel_normal_force>`, and `<wheel_radius>`, else that of its collision.
`libgazebo_ros_wheel_slip.so` lets dynamic_reconfigure change the compliances of all wheels.
"""
from __future__ import annotations

from typing import Dict, Mapping, Optional

from ...description.model import Link
from ...description.shapes import Cylinder, Sphere
from ..base import Plugin
from ..context import PluginError
from ..parameters import Parameters
from ..reconfigure import Option, Reconfigure, Value

_LATERAL, _LONGITUDINAL = (
    Option(f"slip_compliance_unitless_{way}", -1.0, -1.0, 20.0,
           f"slip by friction, {way}; negative leaves each wheel's own")
    for way in ("lateral", "longitudinal"))


class WheelSlip(Plugin):
    """Tells the physics engine once; it works the slip out in every step."""

    lateral = longitudinal = -1.0
    """Compliances of all wheels instead of their own; negative for none."""

    def load(self) -> None:
        """Read parameters."""
        self.set_wheels()

    def set_wheels(self) -> None:
        """Tell the physics engine."""
        wheels = self.context.parameters.children("wheel")
        if not wheels:
            raise PluginError("it has no <wheel>")
        self._links = {link.name: link for link in self.context.description.links}
        for wheel in wheels:
            self._set(wheel)

    def reset(self) -> None:
        """The engine has begun anew without them."""
        self.set_wheels()

    def _set(self, p: Parameters) -> None:
        name = p.attribute("link_name")
        self.context.link(name)
        axes: Dict[str, str] = {joint.child: joint.name
                                for joint in self.context.description.joints}
        if name not in axes:
            raise PluginError(f"wheel '{name}' turns about no joint")
        radius = p.number("wheel_radius", 0.0) or _radius(self._links.get(name))
        force = p.number("wheel_normal_force", 0.0)
        if not radius or radius <= 0.0:
            raise PluginError(f"wheel '{name}' has no <wheel_radius>, nor a round collision")
        if force <= 0.0:
            raise PluginError(f"wheel '{name}' has no <wheel_normal_force> above 0")
        own = (p.number("slip_compliance_lateral", 0.0),
               p.number("slip_compliance_longitudinal", 0.0))
        lateral, longitudinal = (shared if shared >= 0.0 else one for shared, one in zip(
            (self.lateral, self.longitudinal), own))
        self.context.slip(name, axes[name], radius, force, lateral, longitudinal)


class RosWheelSlip(WheelSlip):
    """The same, with dynamic_reconfigure in the namespace MODEL/wheel_slip or MODEL/NAMESPACE."""

    def load(self) -> None:
        """Read parameters."""
        super().load()
        below = self.context.parameters.text("robotNamespace").strip("/") or "wheel_slip"
        self.context.use_namespace(f"{self.context.model}/{below}")
        Reconfigure(self.context, "", (_LATERAL, _LONGITUDINAL),
                    {_LATERAL.name: self.lateral, _LONGITUDINAL.name: self.longitudinal},
                    self._change)

    def _change(self, values: Mapping[str, Value]) -> None:
        self.lateral = float(values[_LATERAL.name])
        self.longitudinal = float(values[_LONGITUDINAL.name])
        self.set_wheels()


def _radius(link: Optional[Link]) -> Optional[float]:
    """Of the first round collision."""
    for collision in link.collisions if link is not None else ():
        if isinstance(collision.geometry, (Cylinder, Sphere)):
            return collision.geometry.radius
    return None
