"""Transmissions: which hardware interface drives which joint. Source: ROS wiki, urdf/XML."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List


@dataclass
class TransmissionJoint:
    """A joint of a transmission.

    Attributes:
        name: name of the joint.
        interfaces: its hardware interfaces, e.g. `hardware_interface/EffortJointInterface`.
    """

    name: str
    interfaces: List[str] = field(default_factory=list)


@dataclass
class Actuator:
    """A motor of a transmission.

    Attributes:
        name: name of the actuator.
        reduction: revolutions of the motor for one of the joint.
        interfaces: its hardware interfaces.
    """

    name: str
    reduction: float = 1.0
    interfaces: List[str] = field(default_factory=list)


@dataclass
class Transmission:
    """A `<transmission>` of a robot.

    Attributes:
        name: name of the transmission.
        type: class of the transmission, e.g. `transmission_interface/SimpleTransmission`.
        namespace: `<robotNamespace>`; "" for none.
        joints: the driven joints.
        actuators: the motors.
        file, line: where it was read.
    """

    name: str
    type: str = ""
    namespace: str = ""
    joints: List[TransmissionJoint] = field(default_factory=list)
    actuators: List[Actuator] = field(default_factory=list)
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
