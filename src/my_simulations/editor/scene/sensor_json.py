"""The sensors of a link or joint as the page gets them: the parameters that each can have."""
from __future__ import annotations

from typing import Any, Dict, List, Union

from ...description.model import Joint, Link
from ...formats.sdf.sensor_parameters import sensor_parameters
from .plain_json import plain


def sensor_documents(holder: Union[Link, Joint]) -> List[Dict[str, Any]]:
    """The protocol's `Sensor`s of a link or joint."""
    texts = [xml for xml in holder.extra if xml.startswith("<sensor")]
    return [{"name": sensor.name, "type": sensor.type,
             "parameters": [{"path": one.path, "kind": one.kind, "value": plain(one.value)}
                            for one in sensor_parameters(xml, sensor)]}
            for sensor, xml in zip(holder.sensors, texts)]
