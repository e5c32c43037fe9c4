"""libWheelSlipPlugin.so and libgazebo_ros_wheel_slip.so: wheels that slip by what drives them.

Parameters, defaults and law are those of Gazebo: in each `<wheel link_name="...">` two compliances
without a unit, `<slip_compliance_lateral>` and `<slip_compliance_longitudinal>`, the weight that it
carries, `<wheel_normal_force>`, and `<wheel_radius>`, else that of its collision.
`libgazebo_ros_wheel_slip.so` lets dynamic_reconfigure change the compliances of all wheels.
"""
from __future__ import annotations

from typing import List, Mapping, NamedTuple, Tuple

from ...description.shapes import Cylinder, Sphere
from ..base import Plugin
from ..context import PluginError
from ..parameters import Parameters
from ..reconfigure import Option, Reconfigure, Value

_LATERAL, _LONGITUDINAL = (
    Option(f"slip_compliance_unitless_{way}", -1.0, -1.0, 20.0,
           f"slip by friction, {way}; negative leaves each wheel's own")
    for way in ("lateral", "longitudinal"))


class _Wheel(NamedTuple):
    """A wheel that slips: m, N, and its own compliances, lateral and longitudinal."""

    link: str
    joint: str
    radius: float
    force: float
    compliances: Tuple[float, float]


class WheelSlip(Plugin):
    """Passes the parameters to the physics engine, which computes the slip in every step."""

    lateral = longitudinal = -1.0
    """Compliances of all wheels; if negative, each wheel uses its own."""

    def load(self) -> None:
        """Read parameters; report and skip a wheel that cannot slip, as in Gazebo."""
        elements = self.context.parameters.children("wheel")
        if not elements:
            raise PluginError("it has no <wheel>")
        self._wheels: List[_Wheel] = []
        for element in elements:
            try:
                self._wheels.append(self._read(element))
            except PluginError as fault:
                self.context.warn(f"{fault}; this <wheel> does nothing")
        if not self._wheels:
            raise PluginError("none of its <wheel>s can slip")
        self.set_wheels()

    def set_wheels(self) -> None:
        """Pass the compliances to the physics engine."""
        for wheel in self._wheels:
            lateral, longitudinal = (shared if shared >= 0.0 else own for shared, own in zip(
                (self.lateral, self.longitudinal), wheel.compliances))
            self.context.set_wheel_slip(wheel.link, wheel.joint, wheel.radius, wheel.force, lateral,
                              longitudinal)

    def reset(self) -> None:
        """Set the wheels again; the engine forgets them at a reset."""
        self.set_wheels()

    def _read(self, p: Parameters) -> _Wheel:
        name, description = p.attribute("link_name"), self.context.description
        if not name:
            raise PluginError("a <wheel> has no link_name")
        own = self.context.scoped(name).partition("::")[2]
        shapes = [collision.geometry for link in description.links if link.name == own
                  for collision in link.collisions]
        if len(shapes) != 1:
            raise PluginError(f"wheel '{name}' has {len(shapes)} collisions instead of one")
        joints = [joint.name for joint in description.joints if joint.child == own]
        if len(joints) != 1:
            raise PluginError(f"wheel '{name}' is the child of {len(joints)} joints instead of one")
        self.context.joint(joints[0])
        radius, force = p.number("wheel_radius", 0.0), p.number("wheel_normal_force", 0.0)
        if radius <= 0.0 and isinstance(shapes[0], (Cylinder, Sphere)):
            radius = shapes[0].radius
        if radius <= 0.0:
            raise PluginError(f"wheel '{name}' has no <wheel_radius>, nor a round collision")
        if force <= 0.0:
            raise PluginError(f"wheel '{name}' has no <wheel_normal_force> above 0")
        compliances = (p.number("slip_compliance_lateral", 0.0),
                       p.number("slip_compliance_longitudinal", 0.0))
        return _Wheel(name, joints[0], radius, force, compliances)


class RosWheelSlip(WheelSlip):
    """The same, with dynamic_reconfigure in the namespace MODEL/wheel_slip or MODEL/NAMESPACE."""

    def load(self) -> None:
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
