"""`<gazebo>` extensions of URDF. Source: Gazebo's converter.

libpegasus_gazebo_closed_loop_plugin.so: a plugin that closes a kinematic loop of a robot.

Its element is read as an SDF `<joint>`. Elements, defaults and axis are those of
pegasus_gazebo_plugins: a revolute joint at `<position>` and `<rotation>` in the child's frame,
about the y axis of the joint.
"""
from __future__ import annotations

import os
from collections import defaultdict
from dataclasses import replace
from typing import Any, DefaultDict, List, Optional, Sequence, Set

from ...description.model import Model
from ...description.shapes import Material
from ...description.validate import closest_name_hint
from ...geometry import Pose, compose
from ..sdf.collision_visual import fill_material
from ..sdf.material_files import check_script
from ..sdf.model_tables import COLLISION as SDF_COLLISION
from ..sdf.model_tables import VISUAL as SDF_VISUAL
from ..sdf.plugin import read_gripper, read_plugin
from ..xml.binding import fill, set_value, to_xml
from ..xml.source import FaultLevel, Source
from ..xml.tables import Value
from ..xml.values import BOOL, FLOAT, POSE
from .kinematic_tree import Body, Connection
from .urdf_tables import (
    GAZEBO_COLLISION,
    GAZEBO_JOINT,
    GAZEBO_JOINT_AXIS,
    GAZEBO_LINK,
    GAZEBO_LINK_KEPT,
    GAZEBO_MODEL,
)


class Extensions:
    """The `<gazebo>` elements of a robot, by their reference ("" for the model)."""

    def __init__(self, elements: Sequence[Any], source: Source) -> None:
        self._source = source
        self._by_reference: DefaultDict[str, List[Any]] = defaultdict(list)
        self._used: Set[str] = {""}
        self.links: List[Any] = []  # SDF's, of the model
        self.joints: List[Any] = []  # the same
        for element in elements:
            for child in element:
                value = child.get("value")
                if value is not None and not (child.text or "").strip() and not len(child):
                    child.text = value  # both spellings are used in robots
                    del child.attrib["value"]
            self._by_reference[element.get("reference") or ""].append(element)

    def to_model(self, model: Model) -> None:
        """Apply extensions of the model: static, plugins and others; call it first."""
        for block in self._by_reference.get("", ()):
            found = fill(model, block, GAZEBO_MODEL, self._source, model.extra)
            self.links += found.get("link", [])
            self.joints += found.get("joint", [])
            for child in found.get("plugin", ()):
                joint = loop_joint(child)
                if joint is None:
                    model.plugins.append(read_plugin(child, self._source))
                else:
                    self.joints.append(joint)
            model.plugins += [read_gripper(child, self._source)
                              for child in found.get("gripper", ())]

    def to_link(self, body: Body) -> None:
        """Apply extensions of a link and of its collisions and visuals; call before lumping."""
        for block in self._blocks(body.link.name):
            for child in block:
                self._to_link(child, body)

    def to_connection(self, connection: Connection) -> None:
        for block in self._blocks(connection.joint.name):
            for child in block:
                self._to_joint(child, connection)

    def report_unused(self) -> None:
        """Warn about references to unknown links and joints."""
        for reference, blocks in self._by_reference.items():
            if reference not in self._used:
                self._source.warn("reference-unknown", f"there is no link and no joint"
                                  f" {reference!r}; this <gazebo> has no effect", blocks[0])

    def _blocks(self, reference: str) -> List[Any]:
        self._used.add(reference)
        return self._by_reference.get(reference, []) if reference else []

    def _to_link(self, child: Any, body: Body) -> None:
        if not self._set_values(child, body) and not self._merge(child, body):
            self._add_extra(child, body)

    def _set_values(self, child: Any, body: Body) -> bool:
        """Apply tags with a single value."""
        tag, link = child.tag, body.link
        if tag in GAZEBO_COLLISION:
            for _, collision in body.collisions:
                self._set(collision, GAZEBO_COLLISION[tag], child)
        elif tag in GAZEBO_LINK:
            if tag == "dampingFactor" and tag in body.set_tags:
                return True     # sdformat writes an element each time, and the first one counts
            body.set_tags.add(tag)
            for value in GAZEBO_LINK[tag]:
                self._set(link, value, child)
        elif tag == "material":
            named = Material(script_name=(child.text or "").strip(),
                             script_uris=[BUILT_IN_MATERIALS])
            check_script(named, child, self._source)
            for _, visual in body.visuals:
                visual.material = replace(named)
        else:
            return False
        return True

    def _merge(self, child: Any, body: Body) -> bool:
        """Apply tags with SDF elements to the link's own elements."""
        tag, source = child.tag, self._source
        if tag == "collision":
            for _, collision in body.collisions:
                fill(collision, child, SDF_COLLISION, source, collision.extra)
        elif tag == "visual":
            for _, visual in body.visuals:
                found = fill(visual, child, SDF_VISUAL, source, visual.extra)
                for element in found.get("material", ()):
                    visual.material = fill_material(element, source, visual.extra)
        elif tag == "velocity_decay":
            for inner in child:
                decay = _DECAY.get(inner.tag)
                if decay is not None:
                    self._set(body.link, decay, inner)
        else:
            return False
        return True

    def _add_extra(self, child: Any, body: Body) -> None:
        tag = child.tag
        if _is_joint_tag(tag):
            return  # a link and a joint may share their name
        if tag not in GAZEBO_LINK_KEPT and ":" not in tag and tag[0] != "{":
            known = [*GAZEBO_COLLISION, *GAZEBO_LINK, *GAZEBO_LINK_KEPT, "material"]
            self._source.warn("unknown-element", f"element <{tag}> is unknown in <gazebo>; it is"
                              " kept without effect", child, closest_name_hint(tag, known))
        body.link.extra.append(to_xml(child))
        if tag in _TOLD:
            self._source.report_unused(child)

    def _to_joint(self, child: Any, connection: Connection) -> None:
        tag, joint = child.tag, connection.joint
        if tag in GAZEBO_JOINT:
            text = (child.text or "").strip()
            joint.extra += [_nested(path, text) for path in GAZEBO_JOINT[tag] if text]
        elif tag in GAZEBO_JOINT_AXIS:
            if joint.axis is not None:
                self._set(joint.axis, GAZEBO_JOINT_AXIS[tag], child)
        elif tag in _KEEP:
            if _is_true(child.text):
                # preserveFixedJoint wins over disableFixedJointLumping.
                connection.keep = max(connection.keep, _KEEP[tag], key=_RANK.index)
        elif isinstance(tag, str) and tag not in GAZEBO_LINK:
            joint.extra.append(to_xml(child))

    def _set(self, target: Any, value: Value, child: Any) -> None:
        set_value(target, value, child.text or "", child, child.tag, self._source, FaultLevel.ERROR)


BUILT_IN_MATERIALS = "file://media/materials/scripts/gazebo.material"
_DECAY = {"linear": Value("linear_decay", FLOAT), "angular": Value("angular_decay", FLOAT)}
_TOLD = ("projector", "audio_source", "audio_sink", "battery", "plugin")
_PLACED = ("<sensor", "<light", "<projector")
_KEEP = {"preserveFixedJoint": "fixed", "disableFixedJointLumping": "revolute"}
_RANK = ["", "revolute", "fixed"]


def _is_joint_tag(tag: str) -> bool:
    return tag in GAZEBO_JOINT or tag in GAZEBO_JOINT_AXIS or tag in _KEEP


def _is_true(text: Any) -> bool:
    try:
        return BOOL.parse(text or "false")
    except ValueError:
        return False


def _nested(path: str, text: str) -> str:
    from xml.sax.saxutils import escape

    xml = escape(text)
    for tag in reversed(path.split("/")):
        xml = f"<{tag}>{xml}</{tag}>"
    return xml


def move_to_lumped_link(xml: str, offset: Pose) -> str:
    """Transform the pose in the kept XML of a link into the link that it was lumped into."""
    from lxml import etree

    if not xml.startswith(_PLACED):
        return xml
    # Prefixes such as `ignition:` are not declared in the fragment.
    element = etree.fromstring(xml, etree.XMLParser(recover=True, resolve_entities=False))
    pose = element.find("pose")
    own = Pose()
    if pose is None:
        pose = etree.Element("pose")
        element.insert(0, pose)
    elif (pose.text or "").strip():
        try:
            own = POSE.parse(pose.text)
        except ValueError:
            return xml  # the sensor reader reports it
    pose.text = POSE.format(compose(offset, own))
    return to_xml(element)


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
