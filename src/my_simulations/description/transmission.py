"""Transmissions: which hardware interface drives which joint. Source: ROS wiki, urdf/XML."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List


@dataclass
class TransmissionJoint:
    """A joint, and the interfaces through which it is driven (`hardware_interface/...`)."""

    name: str
    interfaces: List[str] = field(default_factory=list)


@dataclass
class Actuator:
    """A motor; `reduction` is its revolutions for one of the joint."""

    name: str
    reduction: float = 1.0
    interfaces: List[str] = field(default_factory=list)


@dataclass
class Transmission:
    """A `<transmission>` of a robot; `type` is e.g. transmission_interface/SimpleTransmission."""

    name: str
    type: str = ""
    namespace: str = ""
    joints: List[TransmissionJoint] = field(default_factory=list)
    actuators: List[Actuator] = field(default_factory=list)
    file: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)
