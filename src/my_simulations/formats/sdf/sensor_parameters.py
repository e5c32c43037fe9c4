"""Parameters of a sensor, read from its description and set in its XML.

The tables of the reader define which parameters a sensor can have. Those that the file leaves at
their defaults are listed, too. Source: SDF specification 1.7, sensor.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterator, List, Mapping, Sequence, Tuple

from ...description.sensor import Camera, Sensor
from ...geometry import Pose, is_number
from ..xml.binding import fill
from ..xml.source import Source
from ..xml.tables import Entry, Group, Table, Value
from ..xml.values import BOOL, FLOAT, INT, LIMIT, POSE, TEXT, VECTOR2, VECTOR3, Kind
from .plugin import read_plugin
from .sensor_tables import BLOCKS, CAMERA, FIELDS, SENSOR

_KINDS: Mapping[int, str] = {
    id(BOOL): "flag", id(INT): "integer", id(FLOAT): "number", id(LIMIT): "number",
    id(TEXT): "text", id(VECTOR2): "vector", id(VECTOR3): "vector", id(POSE): "pose"}


@dataclass(frozen=True)
class SensorParameter:
    """A parameter of a sensor.

    Attributes:
        path: elements below the `<sensor>`, e.g. `ray/scan/horizontal/samples`, `noise/@type`; a
            repeated one with its number from 0, e.g. `camera:1/clip/near`. A parameter of a
            plugin: `plugin:NAME/topicName`.
        kind: `flag`, `integer`, `number`, `text`, `vector` or `pose`.
        value: in the description's units.
    """

    path: str
    kind: str
    value: Any


def sensor_parameters(xml: str, sensor: Sensor) -> List[SensorParameter]:
    """Return the parameters that a sensor of these elements can have, and those of its plugins.

    Args:
        xml: the `<sensor>`.
        sensor: its description.
    """
    found = [SensorParameter(path, _KINDS[id(kind)], value)
             for path, kind, value in _values(xml, sensor)]
    for plugin in _parse_element(xml).findall("plugin"):
        found += [SensorParameter(f"plugin:{plugin.get('name', '')}/{child.tag}", "text",
                                  (child.text or "").strip())
                  for child in plugin if isinstance(child.tag, str) and not len(child)]
    return found


def with_parameter(xml: str, sensor: Sensor, path: str, value: Any) -> str:
    """Return the XML of a sensor with another value of one parameter.

    Args:
        xml: the `<sensor>`.
        sensor: its description.
        path: as in `SensorParameter`; a parameter of a plugin is added if it is missing.
        value: JSON, as in `SensorParameter`.

    Raises:
        ValueError: no such parameter, or the value does not fit it.
    """
    root = _parse_element(xml)
    head, _, rest = path.partition("/")
    if head.startswith("plugin:"):
        owner = next((one for one in root.findall("plugin")
                      if one.get("name", "") == head[len("plugin:"):]), None)
        if owner is None or not rest or not isinstance(value, str):
            raise ValueError(f"the sensor has no parameter {path!r}")
        _set_text(owner, rest, value)
    else:
        kind = next((kind for known, kind, _ in _values(xml, sensor) if known == path), None)
        if kind is None:
            raise ValueError(f"the sensor has no parameter {path!r}")
        text = _text(kind, value)
        kind.parse(text)
        if head.startswith("camera:"):
            root = root.findall("camera")[int(head[len("camera:"):])]
            path = rest
        _set_text(root, path, text)
    return _write_element(root)


def _values(xml: str, sensor: Sensor) -> Iterator[Tuple[str, Kind, Any]]:
    yield from _of_children("", SENSOR.children, sensor)
    root = _parse_element(xml)
    for tag, table in BLOCKS.items():
        block = getattr(sensor, FIELDS.get(tag, tag))
        if block is not None and root.find(tag) is not None:
            yield from _of_table(f"{tag}/", table, block)
    for number, camera in enumerate(sensor.cameras):
        yield from _of_table(f"camera:{number}/", CAMERA, camera)


def _of_table(prefix: str, table: Table, owner: Any) -> Iterator[Tuple[str, Kind, Any]]:
    yield from _of_children(prefix, table.children, owner)


def _of_children(prefix: str, children: Mapping[str, Entry],
                 owner: Any) -> Iterator[Tuple[str, Kind, Any]]:
    for name, entry in children.items():
        if isinstance(entry, Value) and not entry.repeated and id(entry.kind) in _KINDS:
            holder = getattr(owner, entry.part) if entry.part else owner
            yield f"{prefix}{name}", entry.kind, getattr(holder, entry.field)
        elif isinstance(entry, Group):
            inner = getattr(owner, entry.part) if entry.part else owner
            for attribute, value in entry.attributes.items():
                yield f"{prefix}{name}/@{attribute}", value.kind, getattr(inner, value.field)
            yield from _of_children(f"{prefix}{name}/", {
                tag: one for tag, one in entry.children.items()
                if not (isinstance(one, Value) and tag in entry.attributes)}, inner)


def _text(kind: Kind, value: Any) -> str:
    """The text of a JSON value. Raises ValueError if it does not fit the kind."""
    name = _KINDS[id(kind)]
    if name == "flag" and isinstance(value, bool):
        return kind.format(value)
    if name == "text" and isinstance(value, str):
        return value
    if name in ("integer", "number") and is_number(value):
        return kind.format(int(value) if name == "integer" and value == int(value) else value)
    if name == "vector" and isinstance(value, list) and all(map(is_number, value)):
        return kind.format(tuple(map(float, value)))
    if name == "pose" and isinstance(value, list) and len(value) == 7 and all(
            map(is_number, value)):
        x, y, z, *turn = map(float, value)
        return kind.format(Pose((x, y, z), (turn[0], turn[1], turn[2], turn[3])))
    raise ValueError(f"{value!r:.60} is not a value of kind {name}")


def _set_text(element: Any, path: str, text: str) -> None:
    from lxml import etree

    for name in path.split("/"):
        if name.startswith("@"):
            element.set(name[1:], text)
            return
        child = element.find(name)
        element = etree.SubElement(element, name) if child is None else child
    element.text = text


def _parse_element(xml: str) -> Any:
    from lxml import etree

    # Prefixes such as `ignition:` are not declared in the fragment.
    return etree.fromstring(xml, etree.XMLParser(recover=True, resolve_entities=False))


def _write_element(element: Any) -> str:
    from lxml import etree

    root = element
    while root.getparent() is not None:
        root = root.getparent()
    text: str = etree.tostring(root, encoding="unicode", with_tail=False)
    return text


ACTING = ("ray", "gpu_ray", "lidar", "gpu_lidar", "camera", "depth", "multicamera",
          "wideanglecamera", "imu", "contact", "gps", "navsat", "magnetometer", "altimeter",
          "force_torque")
"""Sensor types that plugins implement; others are reported as not simulated."""


def read_sensor(element: Any, source: Source) -> Sensor:
    """A sensor. A value that cannot be read is a warning, and its default is used.

    A pose in a named frame is as written; the model reader transforms it.
    """
    sensor = Sensor(element.get("name", ""), file=source.file, line=element.sourceline or 0)
    found = fill(sensor, element, SENSOR, source, [])
    if sensor.type not in ACTING:
        source.report_unused(element)
    for tag, table in BLOCKS.items():
        for child in found.get(tag, ())[:1]:
            block = table.of()
            fill(block, child, table, source, [])
            setattr(sensor, FIELDS.get(tag, tag), block)
    for child in found.get("camera", ()):
        camera = Camera()
        fill(camera, child, CAMERA, source, [])
        sensor.cameras.append(camera)
    sensor.plugins = [read_plugin(child, source) for child in found.get("plugin", ())]
    return sensor


def kept_sensors(extra: Sequence[str], source: Source, lines: Mapping[str, int]) -> List[Sensor]:
    """Read the sensors again from kept XML that was changed.

    Args:
        extra: kept XML of a link or joint.
        source: its file.
        lines: line numbers of its `<sensor>` elements, by name.
    """
    return [read_sensor(_parsed_values(xml, lines), source)
            for xml in extra if xml.startswith("<sensor")]


def _parsed_values(xml: str, lines: Mapping[str, int]) -> Any:
    from lxml import etree

    # Prefixes such as `ignition:` are not declared in the fragment.
    root = etree.fromstring(xml, etree.XMLParser(recover=True, resolve_entities=False))
    first = lines.get(root.get("name", ""), 0)
    for element in root.iter():
        element.sourceline = first + element.sourceline - 1 if first else 0
    return root
