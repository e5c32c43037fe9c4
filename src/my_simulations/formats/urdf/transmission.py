"""URDF's transmissions. Source: ROS wiki, urdf/XML/Transmission."""
from __future__ import annotations

from typing import Any, List, Optional

from ...description.model import Model
from ...description.transmission import Actuator, Transmission, TransmissionJoint
from ...resources.resolver import Resolver
from ..include_overrides import IncludeOverrides
from ..xml.binding import fill
from ..xml.parsing import parse
from ..xml.source import FaultLevel, IssueCollector, Source
from ..xml.tables import Kept, Part, Table, Use, Value
from ..xml.values import FLOAT, TEXT

_TYPE = Value("interfaces", TEXT, repeated=True)

TRANSMISSION_JOINT = Table("joint", TransmissionJoint, {
    "hardwareInterface": _TYPE, "role": Kept(use=Use.IGNORED),
    "mechanicalReduction": Kept(use=Use.IGNORED), "offset": Kept(use=Use.IGNORED),
}, level=FaultLevel.WARNING, use=Use.PLUGINS, known_attributes=("name",))

ACTUATOR = Table("actuator", Actuator, {
    "hardwareInterface": _TYPE, "mechanicalReduction": Value("reduction", FLOAT),
    "role": Kept(use=Use.IGNORED), "motorTorqueConstant": Kept(use=Use.IGNORED),
}, level=FaultLevel.WARNING, use=Use.PLUGINS, known_attributes=("name",))

TRANSMISSION = Table("transmission", Transmission, {
    "type": Value("type", TEXT), "joint": Part(), "actuator": Part(),
    "robotNamespace": Value("namespace", TEXT),
    "leftActuator": Kept(use=Use.IGNORED), "rightActuator": Kept(use=Use.IGNORED),
    "flexJoint": Kept(use=Use.IGNORED), "rollJoint": Kept(use=Use.IGNORED),
    "gap_joint": Kept(use=Use.IGNORED), "passive_joint": Kept(use=Use.IGNORED),
    "mechanicalReduction": Kept(use=Use.IGNORED), "compensator": Kept(use=Use.IGNORED),
    "simulated_actuated_joint": Kept(use=Use.IGNORED), "use_simulated_gripper_joint": Kept(
        use=Use.IGNORED), "motorTorqueConstant": Kept(use=Use.IGNORED),
}, attributes={"type": Value("type", TEXT)}, level=FaultLevel.WARNING, use=Use.PLUGINS,
    known_attributes=("name",))


def transmissions_of(text: str, name: str) -> List[Transmission]:
    """The transmissions of a URDF document; `name` stands for its file. Raises InputError."""
    log = IssueCollector()
    root = parse(text, name, log)
    source = Source(name, "", Resolver(), _no_robot, log)
    return [read_transmission(child, source) for child in root.findall("transmission")]


def _no_robot(element: Any, source: Source, overrides: Optional[IncludeOverrides]) -> Model:
    raise NotImplementedError("transmissions include nothing")


def read_transmission(element: Any, source: Source) -> Transmission:
    """A `<transmission>`, in the current form or that of 2012 (type as an attribute)."""
    found_in = Transmission(element.get("name", ""), file=source.file,
                            line=element.sourceline or 0)
    found = fill(found_in, element, TRANSMISSION, source, [])
    for child in found.get("joint", ()):
        joint = TransmissionJoint(child.get("name", ""))
        fill(joint, child, TRANSMISSION_JOINT, source, [])
        found_in.joints.append(joint)
    for child in found.get("actuator", ()):
        actuator = Actuator(child.get("name", ""))
        fill(actuator, child, ACTUATOR, source, [])
        found_in.actuators.append(actuator)
    return found_in
