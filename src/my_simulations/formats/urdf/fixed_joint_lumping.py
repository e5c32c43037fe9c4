"""Fixed joint lumping: merges the child of a fixed joint into its parent.

Source: Gazebo's converter (sdformat). Clients address the remaining links by name, so the choice of
links and the names of moved elements are part of the interface.

Names in plugins and sensors are updated. Contact sensors refer to collisions; plugins of the model
to a `bodyName` or `frameName`, with an offset to which the transform between the links is added;
grippers, projectors and joints to links. Plugins of sensors keep their `frameName`: it is a tf
frame, which robot_state_publisher still publishes, and the sensor stays where that link was.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping

from ...description.model import WORLD, Model
from ...geometry import Pose, compose, quat_from_rpy, rpy_from_quat
from ..inertia import combine_inertia
from ..xml.binding import to_xml
from ..xml.values import POSE, VECTOR3
from .kinematic_tree import LUMP, Body, Connection, parents_first

_PLACED = ("bodyName", "frameName")
_LINKS = ("gripper_link", "palm_link")
_OFFSETS = (("xyzOffset", "rpyOffset"), ("xyzOffsets", "rpyOffsets"))


@dataclass
class Renamed:
    """Changed names: of lumped links, and of collisions."""

    links: Dict[str, Body] = field(default_factory=dict)
    collisions: Dict[str, str] = field(default_factory=dict)


def rename(model: Model, names: Renamed) -> None:
    """Update the names in all kept XML of the model."""
    if not names.links and not names.collisions:
        return
    model.extra = [_in_xml(xml, names) for xml in model.extra]
    for plugin in model.plugins:
        plugin.xml = _in_xml(plugin.xml, names)
    for link in model.links:
        link.extra = [_in_xml(xml, names) for xml in link.extra]


def _in_xml(xml: str, names: Renamed) -> str:
    from lxml import etree

    if xml.startswith("<frame") or not any(name in xml for name in (*names.links,
                                                                    *names.collisions)):
        return xml
    root = etree.fromstring(xml, etree.XMLParser(recover=True, resolve_entities=False))
    changed = False
    for element in list(root.iter()):
        if isinstance(element.tag, str):
            changed = _in_element(element, names) or changed
    return to_xml(root) if changed else xml


def _in_element(element: Any, names: Renamed) -> bool:
    text = (element.text or "").strip()
    parent = element.getparent()
    inside = parent.tag if parent is not None else ""
    if element.tag == "collision" and inside == "contact":
        return _rename_text(element, names.collisions, text)
    own = inside == "plugin" and parent.getparent() is None
    if own and element.tag in _PLACED and text.lstrip("/") in names.links:
        body = names.links[text.lstrip("/")]
        element.text = _new_link_name(body)
        _move_offset(parent, body.offset)
        return True
    if element.tag in _LINKS or (element.tag in ("parent", "child") and inside == "joint"):
        now = {name: _new_link_name(body) for name, body in names.links.items()}
        return _rename_text(element, now, text)
    if element.tag == "projector" and "/" in text and text.split("/", 1)[0] in names.links:
        link, rest = text.split("/", 1)
        element.text = f"{_new_link_name(names.links[link])}/{rest}"
        return True
    return False


def _rename_text(element: Any, names: Mapping[str, str], text: str) -> bool:
    if text not in names:
        return False
    element.text = names[text]
    return True


def _new_link_name(body: Body) -> str:
    assert body.into is not None
    return body.into.link.name


def _move_offset(parent: Any, way: Pose) -> None:
    """Update the offset beside a name, which is relative to the lumped link."""
    from lxml import etree

    pair = next((pair for pair in _OFFSETS if any(parent.find(tag) is not None for tag in pair)),
                _OFFSETS[0])
    numbers: List[Any] = []
    for tag in pair:
        try:
            numbers.append(VECTOR3.parse(parent.findtext(tag) or "0 0 0"))
        except ValueError:
            return  # the plugin reports it
    offset = compose(way, Pose(numbers[0], quat_from_rpy(*numbers[1])))
    for tag, value in zip(pair, (offset.position, rpy_from_quat(offset.orientation))):
        element = parent.find(tag)
        if element is None:
            if not any(value):
                continue
            element = etree.SubElement(parent, tag)
        element.text = VECTOR3.format(value)


def lump(root: Body) -> List[str]:
    """Lump every body whose fixed joint is not kept; returns `<frame>` elements at their poses."""
    frames: List[str] = []
    for body in parents_first(root):
        if body.up is not None and is_lumped(body.up):
            parent = body.up.parent
            body.into = lumped_into(parent)
            body.offset = compose(parent.offset, body.up.origin)
            _move(body, body.into)
            frames += _frames(body.up)
    return frames


def is_lumped(connection: Connection) -> bool:
    """True for a fixed joint that is lumped; one to a root called `world` is always kept."""
    parent = connection.parent
    from_world = parent.up is None and parent.link.name == WORLD
    return connection.joint.type == "fixed" and not connection.keep and not from_world


def lumped_into(body: Body) -> Body:
    """The body that `body` was lumped into; `body` itself if it was not."""
    return body.into if body.into is not None else body


def _move(child: Body, into: Body) -> None:
    """Append shapes and add the mass of `child` to those of `into`."""
    for stem, collision in child.collisions:
        collision.pose = compose(child.offset, collision.pose)
        into.collisions.append((LUMP + stem, collision))
    for stem, visual in child.visuals:
        visual.pose = compose(child.offset, visual.pose)
        into.visuals.append((LUMP + stem, visual))
    into.inertial = combine_inertia(into.inertial, child.inertial, child.offset)


def _frames(connection: Connection) -> List[str]:
    from xml.sax.saxutils import quoteattr

    joint, parent = connection.joint.name, connection.parent.link.name
    pose = POSE.format(connection.origin)
    return [
        f"<frame name={quoteattr(joint)} attached_to={quoteattr(parent)}><pose>{pose}</pose>"
        "</frame>",
        f"<frame name={quoteattr(connection.child.link.name)} attached_to={quoteattr(joint)}/>",
    ]
