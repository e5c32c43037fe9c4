"""Upgrades older SDF documents to 1.7, one version at a time, in place.

Source: the conversion rules of the SDF specification, and for 1.0 and 1.1, with values in
attributes, documents of 2011 and 2012. The reader supports 1.7 only.
"""
from __future__ import annotations

import math
import os
from typing import Any, Callable, List, Mapping, Tuple

from ...geometry import normalised, rpy_from_quat
from ...resources.model_config import NEWEST, version_of
from ..xml.source import FaultLevel, Source
from ..xml.values import parse_numbers

_STAYS = ("name", "version", "type")
_NOT_TYPED = ("solver", "fog")
_TEXT = ("rgba", "angle", "link", "enabled")
"""Attributes that become the text of their element."""

_TEXT_OF: Mapping[str, str] = {"gravity": "xyz", "direction": "xyz", "linear_velocity": "xyz"}
_RENAMED: Mapping[str, str] = {"color": "diffuse"}
_BUILT_IN = "file://media/materials/scripts/gazebo.material"


def values_to_elements(root: Any) -> None:
    """Upgrade a document of version 1.0 or 1.1 to 1.2, in place."""
    for element in list(root):
        _convert(element)


def includes_by_uri(root: Any) -> None:
    """Convert `<include filename="name.model"/>` (before 1.3) to the URI of a database model."""
    from lxml import etree

    for include in root.iter("include"):
        name = include.attrib.pop("filename", None)
        if name and include.find("uri") is None:
            stem = os.path.splitext(name)[0]
            etree.SubElement(include, "uri").text = name if "://" in name else f"model://{stem}"


def _convert(element: Any) -> None:
    from lxml import etree

    if not isinstance(element.tag, str) or element.tag == "plugin":
        return
    for child in list(element):
        _convert(child)
    for name, value in list(element.items()):
        # `save`, of a camera, still has an attribute in 1.7.
        if element.tag in ("include", "save") or (name == "pose" and element.tag == "origin") or (
                name in _STAYS and element.tag not in _NOT_TYPED):
            continue
        del element.attrib[name]
        if element.tag == "shadows" and name != "enabled":
            continue
        if element.tag == "material" and name == "script":
            script = etree.SubElement(element, "script")
            etree.SubElement(script, "uri").text = _BUILT_IN
            etree.SubElement(script, "name").text = value
        elif element.tag == "material" and name == "normal_map":
            shader = etree.SubElement(element, "shader", type="normal_map_tangent_space")
            etree.SubElement(shader, name).text = value
        elif (name in _TEXT and not (element.tag == "fog")) or _TEXT_OF.get(element.tag) == name:
            element.text = value
        elif element.find(name) is None:
            etree.SubElement(element, "color" if name == "rgba" else name).text = value
    parent = element.getparent()
    if parent is not None:
        _convert_inside(element, parent)


def _convert_inside(element: Any, parent: Any) -> None:
    """Conversions that depend on the parent of an element."""
    if parent.tag == "contact" and element.tag == "collision":
        element.text = element.attrib.pop("name", element.text)  # of a contact sensor
    if parent.tag == "material":
        element.tag = _RENAMED.get(element.tag, element.tag)
    if element.tag == "damping" and parent.tag == "inertial":
        element.tag = "velocity_decay"
        parent.getparent().append(element)


WORLD_AXES = "__world__"
"""`expressed_in` of an axis that old files gave in world coordinates (no name of the format)."""


def upgrade(root: Any, source: Source) -> Any:
    """The root of a document of any known version, upgraded to 1.7."""
    version = _version(root, source)
    if version > NEWEST:
        source.warn(
            "sdf-newer", f"SDF {root.get('version')} is newer than 1.7; unknown elements are"
            " kept without effect", root,
        )
        _from_1_9(root, source)
    for before, step in _STEPS:
        if version < before:
            step(root)
    return root


def _version(root: Any, source: Source) -> Tuple[int, ...]:
    text = root.get("version")
    if text is None:
        source.warn("sdf-version", "the version is missing; read as SDF 1.7", root)
        return NEWEST
    version = version_of(text)
    if not version:
        source.warn("sdf-version", f"{text!r} is not a version; read as SDF 1.7", root)
        return NEWEST
    return version


def _all(root: Any, *tags: str) -> List[Any]:
    """The elements of these names, but none in plugins, whose parameters are their own.

    Source: sdformat 9, Converter::ConvertDescendantsImpl.
    """
    return [one for one in root.iter(*tags) if next(one.iterancestors("plugin"), None) is None]


def _rename(parent: Any, old: str, new: str) -> None:
    for element in parent.findall(old):
        element.tag = new


def _to_1_4(root: Any) -> None:
    from lxml import etree

    includes_by_uri(root)
    for physics in _all(root, "physics"):
        _rename(physics, "update_rate", "real_time_update_rate")
        for path in ("ode/solver/dt", "bullet/dt"):
            old = physics.find(path)
            if old is not None and physics.find("max_step_size") is None:
                etree.SubElement(physics, "max_step_size").text = old.text
            if old is not None:
                old.getparent().remove(old)
    for origin in _all(root, "origin"):
        if origin.get("pose") is not None:
            origin.tag = "pose"
            origin.text = origin.attrib.pop("pose")


def _to_1_5(root: Any) -> None:
    from lxml import etree

    for axis in _all(root, "axis", "axis2"):
        if axis.getparent().tag == "joint" and axis.find("use_parent_model_frame") is None:
            etree.SubElement(axis, "use_parent_model_frame").text = "true"
    # Defaults that differ before 1.5.
    if _all(root, "collide_bitmask"):
        for collision in _all(root, "collision"):
            if collision.find("geometry") is not None:
                _default(collision, "surface/contact/collide_bitmask", "1")
    for sensor in _all(root, "force_torque"):
        _default(sensor, "frame", "parent")
    for actor in _all(root, "actor"):
        if actor.get("static") is not None:
            _default(actor, "static", actor.attrib.pop("static"))


def _default(element: Any, path: str, text: str) -> None:
    """Write a default into the document where it has no value."""
    from lxml import etree

    for tag in path.split("/"):
        child = element.find(tag)
        if child is None:
            child = etree.SubElement(element, tag)
            child.text = text if path.endswith(tag) else None
        element = child


def _to_1_6(root: Any) -> None:
    for physics in _all(root, "physics"):
        world = physics.getparent()
        if world is None or world.tag != "world":
            continue  # the physics of a joint
        for name in ("gravity", "magnetic_field"):
            for element in physics.findall(name):
                physics.remove(element)
                if world.find(name) is None:
                    world.append(element)
    for imu in _all(root, "imu"):
        for noise in imu.findall("noise"):
            imu.remove(noise)
            _imu_noise(imu, noise)


_IMU = (("rate", "angular_velocity"), ("accel", "linear_acceleration"))
_NOISE = ("mean", "stddev", "bias_mean", "bias_stddev")


def _imu_noise(imu: Any, noise: Any) -> None:
    """Convert one noise for all axes to one for each (1.6)."""
    from lxml import etree

    for old, new in _IMU:
        given = noise.find(old)
        if given is None or imu.find(new) is not None:
            continue
        parent = etree.SubElement(imu, new)
        for axis in "xyz":
            one = etree.SubElement(etree.SubElement(parent, axis), "noise")
            one.set("type", (noise.findtext("type") or noise.get("type") or "none").strip())
            for name in _NOISE:
                if given.find(name) is not None:
                    etree.SubElement(one, name).text = given.findtext(name)


def _to_1_7(root: Any) -> None:
    from lxml import etree

    for pose in _all(root, "pose"):
        frame = pose.attrib.pop("frame", None) if pose.attrib else None
        if frame:
            pose.set("relative_to", frame)
    for flag in _all(root, "use_parent_model_frame"):
        axis = flag.getparent()
        axis.remove(flag)
        if (flag.text or "").strip().lower() in ("true", "1"):
            xyz = axis.find("xyz")
            if xyz is None:
                xyz = etree.SubElement(axis, "xyz")
                xyz.text = "0 0 1"
            parent = axis.getparent().findtext("parent") or ""
            # If the parent is the world, Gazebo uses such an axis in the world frame.
            xyz.set("expressed_in", WORLD_AXES if parent.strip() == "world" else "__model__")


def _from_1_9(root: Any, source: Source) -> None:
    """Convert poses in degrees or with a quaternion to the form of 1.7."""
    for pose in _all(root, "pose"):
        if not pose.attrib:
            continue
        degrees = (pose.attrib.pop("degrees", "") or "").strip().lower() in ("true", "1")
        quaternion = pose.attrib.pop("rotation_format", "") == "quat_xyzw"
        if not (degrees or quaternion) or not (pose.text or "").strip():
            continue
        try:
            if quaternion:
                x, y, z, *q = parse_numbers(pose.text, 7)
                angles = rpy_from_quat(normalised((q[0], q[1], q[2], q[3])))
            else:
                x, y, z, *rpy = parse_numbers(pose.text, 6)
                angles = (math.radians(rpy[0]), math.radians(rpy[1]), math.radians(rpy[2]))
        except ValueError as fault:
            source.report(FaultLevel.FATAL, "bad-value", f"<pose>: {fault}", pose)
            pose.text = ""
            continue
        pose.text = " ".join(repr(value) for value in (x, y, z, *angles))


_STEPS: List[Tuple[Tuple[int, ...], Callable[[Any], None]]] = [
    ((1, 2), values_to_elements), ((1, 4), _to_1_4), ((1, 5), _to_1_5), ((1, 6), _to_1_6),
    ((1, 7), _to_1_7),
]
