"""libpegasus_gazebo_closed_loop_plugin.so: a plugin that closes a kinematic loop of a robot.

Its element is read as an SDF `<joint>`. Elements, defaults and axis are those of
pegasus_gazebo_plugins: a revolute joint at `<position>` and `<rotation>` in the child's frame,
about the y axis of the joint.
"""
from __future__ import annotations

import os
from typing import Any, Optional

_LIBRARY = "libpegasus_gazebo_closed_loop_plugin.so"
_AT_CHILD = "0 0 0"


def loop_joint(plugin: Any) -> Optional[Any]:
    """Return the SDF `<joint>` of a `<plugin>`; None if the plugin is another one.

    Elements that are missing are missing in the joint, too; its reader reports them.
    """
    if os.path.basename((plugin.get("filename") or "").strip()) != _LIBRARY:
        return None
    from lxml import etree

    joint = etree.Element("joint", name=_text(plugin, "joint"), type="revolute")
    place = f"{_text(plugin, 'position') or _AT_CHILD} {_text(plugin, 'rotation') or _AT_CHILD}"
    etree.SubElement(joint, "pose").text = place
    for role in ("parent", "child"):
        if _text(plugin, role):
            etree.SubElement(joint, role).text = _text(plugin, role)
    etree.SubElement(etree.SubElement(joint, "axis"), "xyz").text = "0 1 0"
    for element in joint.iter():
        element.sourceline = plugin.sourceline
    return joint


def _text(plugin: Any, name: str) -> str:
    return (plugin.findtext(name) or "").strip()
