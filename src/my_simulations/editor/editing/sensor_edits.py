"""Sensors of links and joints: one parameter changes, a sensor comes or goes."""
from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, List, Optional, Tuple, Union

from ...description.model import Joint, Link, Model
from ...description.sensor import Sensor
from ...errors import CommandError
from ...formats.sdf.sensor_parameters import with_parameter
from ...resources.resolver import Resolver
from ...robot_templates.sensor_links import sensor_alone
from .inserts import entity_of_text
from .model_parts import free_name

_SENSOR = re.compile(r"(.+)::sensor:(.+)\Z", re.DOTALL)


def sensor_of(rest: str) -> Optional[Tuple[str, str]]:
    """Return the names of holder and sensor in `LINK::sensor:NAME`; None for another name."""
    found = _SENSOR.match(rest)
    return (found.group(1), found.group(2)) if found else None


def sensor_xml(holder: Union[Link, Joint]) -> List[str]:
    """Return the XML of the sensors of a link or joint, in the order of its `sensors`."""
    return [xml for xml in holder.extra if xml.startswith("<sensor")]


def with_sensor_value(model: Model, rest: str, path: str, value: Any, resolver: Resolver) -> Model:
    """Return the model with another value of a parameter of a sensor.

    Args:
        model: the model.
        rest: `LINK::sensor:NAME` or `JOINT::sensor:NAME`.
        path: of the parameter; see `sensor_parameters.SensorParameter`.
        value: JSON.
        resolver: for reading the changed sensor.

    Raises CommandError, InputError.
    """
    holder, sensor, xml = _find_sensor(model, rest)
    if path == "pose" and re.search(r"<pose\s[^>]*relative_to", xml):
        raise CommandError(f"the pose of sensor {sensor.name!r} is relative to a named frame; edit "
                           "it in the file")
    try:
        changed = with_parameter(xml, sensor, path, value)
    except ValueError as fault:
        raise CommandError(f"{path}: {fault}") from fault
    new = _read_sensor(changed, resolver)
    if path != "pose":
        new = replace(new, pose=sensor.pose)
    new = replace(new, file=sensor.file, line=sensor.line)
    return _with_holder(model, holder, replace(
        holder, sensors=[new if one is sensor else one for one in holder.sensors],
        extra=[changed if one is xml else one for one in holder.extra]))


def with_new_sensor(model: Model, link_name: str, kind: str,
                    resolver: Resolver) -> Tuple[Model, str]:
    """Return the model with a new sensor of a link, and the sensor's name. Raises CommandError.

    `kind`: `camera`, `laser` or `imu`.
    """
    link = next((one for one in model.links if one.name == link_name), None)
    if link is None:
        raise CommandError(f"model {model.name!r} has no link {link_name!r}")
    taken = {sensor.name for one in _holders(model) for sensor in one.sensors}
    name = free_name(kind, taken)
    xml = sensor_alone(kind, name, link_name.replace("::", "_"))
    return _with_holder(model, link, replace(
        link, sensors=[*link.sensors, _read_sensor(xml, resolver)], extra=[*link.extra, xml])), name


def without_sensor(model: Model, rest: str) -> Model:
    """Return the model without the sensor `LINK::sensor:NAME`. Raises CommandError."""
    holder, sensor, xml = _find_sensor(model, rest)
    return _with_holder(model, holder, replace(
        holder, sensors=[one for one in holder.sensors if one is not sensor],
        extra=[one for one in holder.extra if one is not xml]))


def _find_sensor(model: Model, rest: str) -> Tuple[Union[Link, Joint], Sensor, str]:
    names = sensor_of(rest)
    for holder in _holders(model):
        for sensor, xml in zip(holder.sensors, sensor_xml(holder)):
            if (holder.name, sensor.name) == names:
                return holder, sensor, xml
    raise CommandError(f"model {model.name!r} has no sensor {rest!r}")


def _holders(model: Model) -> List[Union[Link, Joint]]:
    return [*model.links, *model.joints]


def _with_holder(model: Model, old: Union[Link, Joint], new: Union[Link, Joint]) -> Model:
    return replace(model, links=[new if one is old else one for one in model.links],  # type: ignore
                   joints=[new if one is old else one for one in model.joints])  # type: ignore


def _read_sensor(xml: str, resolver: Resolver) -> Sensor:
    text = f'<sdf version="1.7"><model name="m"><link name="link">{xml}</link></model></sdf>'
    model, issues = entity_of_text(text, resolver)
    odd = next((issue for issue in issues if issue.code in ("bad-value", "value-odd")), None)
    if odd is not None:
        raise CommandError(odd.message)
    assert isinstance(model, Model)
    return model.links[0].sensors[0]
