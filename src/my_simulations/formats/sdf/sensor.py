"""SDF sensors of links and joints; their XML is kept in `extra` of the link or joint."""
from __future__ import annotations

from typing import Any, List, Mapping, Sequence

from ...description.sensor import Camera, Sensor
from ..xml.binding import fill
from ..xml.source import Source
from .plugin import read_plugin
from .sensor_tables import BLOCKS, CAMERA, FIELDS, SENSOR

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
    return [read_sensor(_parsed(xml, lines), source) for xml in extra if xml.startswith("<sensor")]


def _parsed(xml: str, lines: Mapping[str, int]) -> Any:
    from lxml import etree

    # Prefixes such as `ignition:` are not declared in the fragment.
    root = etree.fromstring(xml, etree.XMLParser(recover=True, resolve_entities=False))
    first = lines.get(root.get("name", ""), 0)
    for element in root.iter():
        element.sourceline = first + element.sourceline - 1 if first else 0
    return root
