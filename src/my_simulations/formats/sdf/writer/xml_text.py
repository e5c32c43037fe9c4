"""XML of written SDF: values, kept fragments at their original place, and the document."""
from __future__ import annotations

import functools
import math
import re
from typing import Any, Callable, Dict, List, Mapping, Optional

from lxml import etree

from ....geometry import Pose, Quat, Vec3, quat_from_rpy, rpy_from_quat
from ...xml.tables import Entry, Group, Kept, Part, Table
from ...xml.values import Kind, PathPose, PoseKind, whole_turn

_PREFIX = re.compile(r"[<\s/]([A-Za-z_][\w.-]*):[A-Za-z_][\w.-]*[\s=/>]")
_DECLARED = re.compile(r"\bxmlns:([A-Za-z_][\w.-]*)\s*=")
_MOST_ROUNDS = 16


def write_value(parent: Any, tag: str, kind: Kind, value: Any = None,
                text: Optional[str] = None) -> None:
    """A child element with a value, or with its text."""
    if text is None:
        text = kind.format(value)
    if isinstance(kind, PoseKind):
        text = stable_pose_text(kind.parse(text), isinstance(kind, PathPose))
    etree.SubElement(parent, tag).text = text


def stable_pose_text(pose: Pose, of_path: bool = False) -> str:
    """The text of a pose that does not change when it is read and written again.

    The conversion of angles to a quaternion and back changes their last digits, so angles are
    rounded to 1e-14 rad: 0.4 stays 0.4, and saving a loaded world gives the same text. `of_path`:
    see `PathPose`.
    """
    x, y, z, w = (value + 0.0 for value in pose.orientation)  # -0.0 becomes 0.0
    angles = _stable_rpy((x, y, z, w))
    if of_path:
        angles = whole_turn(angles, pose.orientation)
    return " ".join(_decimal(value) for value in (*pose.position, *angles))


@functools.lru_cache(maxsize=1024)
def _stable_rpy(orientation: Quat) -> Vec3:
    """Roll, pitch and yaw (rad) that stay the same when they are read and written again."""
    angles = _round_angles(rpy_from_quat(orientation))
    if _read_again(angles) != angles:
        angles = _round_angles(_snap_pitch(angles))
    seen: List[Vec3] = []
    # Near a pitch of 90 degrees the error is larger; it converges after a few conversions.
    while angles not in seen and len(seen) < _MOST_ROUNDS:
        seen.append(angles)
        angles = _read_again(angles)
    if angles in seen:
        angles = min(seen[seen.index(angles):])
    return angles


def _read_again(angles: Vec3) -> Vec3:
    return _round_angles(rpy_from_quat(quat_from_rpy(*angles)))


def _snap_pitch(angles: Vec3) -> Vec3:
    """Angles within 2e-9 rad of a pitch of 90 degrees, set to exactly that, with roll 0.

    There only rounding errors separate yaw and roll, which would never converge.
    """
    roll, pitch, yaw = angles
    if math.cos(pitch) > 2e-9:
        return angles
    turn = yaw - roll if pitch > 0 else yaw + roll
    return (0.0, math.copysign(math.pi / 2, pitch), math.remainder(turn, 2.0 * math.pi))


def _round_angles(angles: Vec3) -> Vec3:
    """Angles rounded to 1e-14 rad; roll and yaw more coarsely near a pitch of 90 degrees."""
    lost = -math.log10(max(math.cos(angles[1]), 1e-5))
    digits = 14 - math.floor(lost)
    return (round(angles[0], digits), round(angles[1], 14), round(angles[2], digits))


def _decimal(value: float) -> str:
    return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def append_fragment(element: Any, xml: str, table: Table) -> None:
    """Add a kept fragment below `element`, at its original place.

    A fragment from deeper down is wrapped in the tags of its parents, which are found or created as
    long as the table reads them in parts.
    """
    _merge(element, parse_fragment(xml), table.children)


def _merge(parent: Any, fragment: Any, children: Mapping[str, Entry]) -> None:
    entry = children.get(fragment.tag)
    if isinstance(entry, (Group, Part)) and not fragment.attrib and len(fragment) == 1:
        inside = entry.children if isinstance(entry, Group) else _part_children(fragment.tag)
        if inside is not None and _is_kept(fragment[0], inside):
            there = parent.find(fragment.tag)
            if there is None:
                there = etree.SubElement(parent, fragment.tag)
            _merge(there, fragment[0], inside)
            return
    parent.append(fragment)


def _part_children(tag: str) -> Optional[Mapping[str, Entry]]:
    from ..model_tables import AXIS, INERTIAL, MATERIAL, PHYSICS

    tables = {"axis": AXIS, "axis2": AXIS, "inertial": INERTIAL, "material": MATERIAL,
              "physics": PHYSICS}
    found = tables.get(tag)
    return found.children if found is not None else None


def _is_kept(fragment: Any, children: Mapping[str, Entry]) -> bool:
    """Whether the innermost element of a fragment is one that the table keeps as XML."""
    entry = children.get(fragment.tag)
    if isinstance(entry, Group) and not fragment.attrib and len(fragment) == 1:
        return _is_kept(fragment[0], entry.children)
    return entry is None or isinstance(entry, Kept)


def parse_fragment(xml: str) -> Any:
    """Parse a fragment: declare its prefixes and drop white space between tags."""
    missing = sorted(set(_PREFIX.findall(xml)) - set(_DECLARED.findall(xml)) - {"xml", "xmlns"})
    declared = "".join(f' xmlns:{prefix}="urn:{prefix}"' for prefix in missing)
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True, recover=True,
        remove_blank_text=True, remove_comments=True, remove_pis=True, encoding="utf-8",
    )
    root = etree.fromstring(f"<all{declared}>{xml}</all>".encode(), parser)
    fragment = root[0]
    root.remove(fragment)
    fragment.tail = None
    return fragment


def _is_uri(text: str) -> bool:
    """Whether lxml accepts this text as a namespace; else it stays where the file has it."""
    try:
        etree.Element("all", nsmap={"prefix": text})
    except ValueError:
        return False
    return True


def serialize_sdf(version: str, write: Callable[[Any], None]) -> bytes:
    """Return the bytes of an SDF document whose root `write` fills."""
    root = etree.Element("sdf", version=version)
    write(root)
    prefixes: Dict[str, str] = {}
    for element in root.iter():
        prefixes.update({prefix: uri for prefix, uri in element.nsmap.items()
                         if prefix and prefixes.get(prefix) != uri and _is_uri(uri)})
    if prefixes:
        etree.cleanup_namespaces(root, top_nsmap=dict(sorted(prefixes.items())))
    etree.indent(root, space="  ")
    text: bytes = etree.tostring(root, encoding="utf-8", xml_declaration=False)
    return b'<?xml version="1.0" encoding="utf-8"?>\n' + text + b"\n"
