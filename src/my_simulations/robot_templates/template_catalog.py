"""The templates that the editor offers, by name."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping, Sequence, Tuple

from ..errors import CommandError
from .arm import ARM, arm_with_gripper
from .cars import car_parameters, differential_drive, four_wheels
from .sensor_links import (
    CAMERA,
    HEIGHT,
    IMU,
    LASER,
    NAMESPACE,
    camera_on_post,
    imu_box,
    laser_on_post,
)
from .template_parameters import Parameter, Values, checked_values, number


@dataclass(frozen=True)
class Template:
    """A kind of robot or sensor.

    Attributes:
        name: how requests name it.
        title: for people.
        description: one sentence.
        parameters: what can be chosen; the first is the name of the model.
        build: returns SDF text for checked values.
    """

    name: str
    title: str
    description: str
    parameters: Sequence[Parameter]
    build: Callable[[Values], str]

    def sdf(self, given: Mapping[str, Any]) -> str:
        """SDF text with one model. Raises CommandError for values that are not allowed."""
        return self.build(checked_values(self.parameters, given))


def _with_name(default: str, *more: Parameter) -> Tuple[Parameter, ...]:
    return (Parameter("name", "Model name", default), *more)


TEMPLATES: Tuple[Template, ...] = (
    Template("differential_drive", "Differential drive",
             "A robot car with two driven wheels and a caster, and with sensors of your choice",
             _with_name("car", *car_parameters(0.4, 0.24, 3.0, 0.08)), differential_drive),
    Template("four_wheels", "Four wheels",
             "A skid-steered robot car with four driven wheels, and with sensors of your choice",
             _with_name("rover", *car_parameters(0.5, 0.3, 6.0, 0.1)), four_wheels),
    Template("arm", "Arm with gripper",
             "A robot arm with four joints and a gripper, fixed to the world, for the Joints panel",
             _with_name("arm", *ARM), arm_with_gripper),
    Template("camera", "Camera", "A camera on a post that publishes images",
             _with_name("camera_post", HEIGHT, NAMESPACE, *CAMERA), camera_on_post),
    Template("laser", "Laser scanner", "A laser scanner on a post that publishes scans",
             _with_name("laser_post",
                        number("height", "Height above the ground", 0.4, "m", 0.1, 10.0),
                        NAMESPACE, *LASER), laser_on_post),
    Template("imu", "IMU", "A free box with an IMU on it",
             _with_name("imu_box", number("size", "Size of the box", 0.2, "m", 0.02, 2.0),
                        number("mass", "Mass of the box", 1.0, "kg", 0.01, 1000.0),
                        NAMESPACE, *IMU), imu_box),
)


def template_named(name: str) -> Template:
    """The template of a name. Raises CommandError."""
    for one in TEMPLATES:
        if one.name == name:
            return one
    raise CommandError(f"unknown template {name!r:.60}; templates: "
                       + ", ".join(one.name for one in TEMPLATES))
