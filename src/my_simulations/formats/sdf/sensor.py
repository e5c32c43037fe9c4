"""SDF sensors, of links and of joints; their XML is kept by who holds them."""
from __future__ import annotations

from typing import Any, List, Mapping, Sequence

from ...description.sensor import Camera, Sensor
from ..xml.binding import fill
from ..xml.source import Source
from .plugin import read_plugin
from .sensor_tables import BLOCKS, CAMERA, FIELDS, SENSOR

ACTING = ("ray", "gpu_ray", "lidar", "gpu_lidar", "camera", "depth", "multicamera", "imu",
          "contact", "gps", "navsat", "magnetometer", "altimeter", "force_torque")
"""Types for which there are plugins here; what else does nothing is said."""


def read_sensor(element: Any, source: Source) -> Sensor:
    """A sensor. A value that cannot be read is a warning, and its default is used.

    A pose in a named frame is as it is written; who knows the frames moves it.
    """
    sensor = Sensor(element.get("name", ""), file=source.file, line=element.sourceline or 0)
    found = fill(sensor, element, SENSOR, source, [])
    if sensor.type not in ACTING:
        source.tell_unused(element)
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
    """The sensors among XML that was kept, after it was changed.

    Args:
        extra: of a link or joint.
        source: the file.
        lines: of its `<sensor>` elements, by name.
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
