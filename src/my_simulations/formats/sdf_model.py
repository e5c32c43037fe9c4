"""SDF models: links, joints, nested models, and the frames that place them."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Set, Tuple

from ..description.model import WORLD, Inertial, Link, Model, PluginSpec
from ..description.validate import faults, link_names
from ..errors import Issue, Severity
from ..geometry import IDENTITY, Pose, compose, inverse
from .sdf_frames import FrameFault, FrameTree
from .sdf_joint import place_axes, read_joint, reverse_axes
from .sdf_shapes import read_collision, read_visual
from .sdf_tables import FRAME, INERTIAL, LINK, MODEL
from .source import Level, Source
from .tables import Found, fill, to_xml

ROOT = "__model__"


@dataclass
class Changes:
    """What an include says about the model it brings; None where it is silent."""

    name: Optional[str] = None
    pose: Optional[Pose] = None
    relative_to: str = ""
    static: Optional[bool] = None
    plugins: List[PluginSpec] = field(default_factory=list)


@dataclass
class Placement:
    """A model that was read, and the frame its pose is given in ("" for the parent's)."""

    model: Model
    relative_to: str = ""


def read_model(element: Any, source: Source, changes: Optional[Changes] = None,
               static: bool = False) -> Placement:
    """A model; faults that make it unusable are counted as fatal in the source's log.

    Args:
        element: `<model>`, of a document of version 1.7 (see `sdf_versions`).
        source: the file.
        changes: by an `<include>`.
        static: True when an outer model is static.
    """
    return _ModelReader(element, source, changes or Changes(), static).read()


def read_plugin(element: Any) -> PluginSpec:
    """A `<plugin>`, kept whole."""
    return PluginSpec(element.get("name", ""), element.get("filename", ""), to_xml(element))


def relative_to(found: Found) -> str:
    """The frame that the `<pose>` of an element names, "" for none."""
    for pose in found.get("pose", ()):
        return pose.get("relative_to") or ""
    return ""


class _ModelReader:
    def __init__(self, element: Any, source: Source, changes: Changes, static: bool) -> None:
        self._element = element
        self._source = source
        self._changes = changes
        self._outer_static = static
        self._frames = FrameTree(ROOT)
        self._elements: Dict[int, Any] = {}  # by id of what was made of them
        self._given_in: List[Tuple[Any, str, str]] = []  # (thing with a pose, frame, link)

    def read(self) -> Placement:
        element, source, changes = self._element, self._source, self._changes
        model = Model(element.get("name", ""))
        self._elements[id(model)] = element
        found = fill(model, element, MODEL, source, model.extra)
        placement = Placement(model, relative_to(found))
        self._apply(changes, placement)
        static = model.static or self._outer_static
        model.plugins = [read_plugin(plugin) for plugin in found.get("plugin", ())]
        model.plugins += changes.plugins
        for child in found.get("link", ()):
            self._link(child, model, static)
        for child in found.get("frame", ()):
            self._frame(child)
        self._nested(found, model, static)
        joints = [(read_joint(child, source), child) for child in found.get("joint", ())]
        for (joint, inside), child in joints:
            self._elements[id(joint)] = child
            model.joints.append(joint)
            self._frames.add(joint.name, joint.pose,
                             relative_to(inside) or self._joint_base(joint), child)
        self._place(model)
        for (joint, inside), child in joints:
            self._place_joint(joint, inside, model, child)
        self._check(model)
        return placement

    def _apply(self, changes: Changes, placement: Placement) -> None:
        model = placement.model
        if changes.name is not None:
            model.name = changes.name
        if changes.pose is not None:
            model.pose, placement.relative_to = changes.pose, changes.relative_to
        if changes.static is not None:
            model.static = changes.static

    def _link(self, element: Any, model: Model, static: bool) -> None:
        source = self._source
        link = Link(element.get("name", ""))
        self._elements[id(link)] = element
        found = fill(link, element, LINK, source, link.extra)
        self._frames.add(link.name, link.pose, relative_to(found), element)
        if relative_to(found):
            self._given_in.append((link, link.name, ""))
        for child in found.get("inertial", ()):
            link.inertial = Inertial()
            # A static model ignores its inertia, whatever it says (SDF spec, model/static).
            inside = fill(link.inertial, child, INERTIAL, source, link.extra,
                          Level.WARNING if static else None)
            self._elements[id(link.inertial)] = child
            self._note_pose(link.inertial, inside, link)
        self._elements.setdefault(id(link.inertial), element)
        for child in found.get("collision", ()):
            collision = read_collision(child, source, static, link.extra)
            if collision is not None:
                link.collisions.append(collision[0])
                self._elements[id(collision[0])] = child
                self._note_pose(*collision, link)
        for child in found.get("visual", ()):
            visual = read_visual(child, source, link.extra)
            if visual is not None:
                link.visuals.append(visual[0])
                self._elements[id(visual[0])] = child
                self._note_pose(*visual, link)
        self._distinct("collision", link.collisions, link)
        self._distinct("visual", link.visuals, link)
        model.links.append(link)

    def _note_pose(self, thing: Any, found: Found, link: Link) -> None:
        frame = relative_to(found)
        if frame:
            self._given_in.append((thing, frame, link.name))

    def _distinct(self, kind: str, items: List[Any], link: Link) -> None:
        """Give a suffix to names that are repeated, and a name to what has none."""
        used: Set[str] = set()
        for item in items:
            wanted = item.name or f"{link.name}_{kind}"
            name, count = wanted, 0
            while name in used:
                count += 1
                name = f"{wanted}_{count}"
            if name != item.name:
                self._source.warn(
                    "name-changed", f"{kind} {item.name!r} of link {link.name!r} is called"
                    f" {name!r}, since names are unique within a link", self._elements[id(item)],
                )
                item.name = name
            used.add(name)

    def _frame(self, element: Any) -> None:
        probe = Link(element.get("name", ""))
        found = fill(probe, element, FRAME, self._source, [])
        # The frame of reference is what it is attached to, where the pose does not say.
        base = relative_to(found) or element.get("attached_to") or ""
        self._frames.add(probe.name, probe.pose, base, element)

    def _nested(self, found: Found, model: Model, static: bool) -> None:
        from .sdf_include import read_include

        placements = [(read_model(child, self._source, static=static), child)
                      for child in found.get("model", ())]
        for child in found.get("include", ()):
            included = read_include(child, self._source, static=static)
            if included is not None and isinstance(included, Placement):
                placements.append((included, child))
        for placement, child in placements:
            inner = placement.model
            self._elements[id(inner)] = child
            model.models.append(inner)
            self._frames.add(inner.name, inner.pose, placement.relative_to, child)
            if placement.relative_to:
                self._given_in.append((inner, inner.name, ""))
            _add_inner_frames(self._frames, inner, inner.name, child)

    def _joint_base(self, joint: Any) -> str:
        return joint.child if joint.child and joint.child != WORLD else ROOT

    def _place(self, model: Model) -> None:
        """Bring every pose given in a named frame to the frame the description uses."""
        for thing, frame, link in self._given_in:
            element = self._elements[id(thing)]
            pose = self._pose_of(frame, element)
            if link:
                pose = compose(inverse(self._pose_of(link, element)), compose(pose, thing.pose))
            thing.pose = pose

    def _pose_of(self, frame: str, element: Any) -> Pose:
        try:
            return self._frames.pose(frame)
        except FrameFault as fault:
            self._source.report(Level.FATAL, "frame-unknown", str(fault), element)
            return IDENTITY

    def _place_joint(self, joint: Any, found: Found, model: Model, element: Any) -> None:
        names = set(link_names(model))
        if joint.child not in names and not (joint.child == WORLD and joint.parent in names):
            return  # reported with the other faults of the model
        if relative_to(found):
            base = self._pose_of(self._joint_base(joint), element)
            joint.pose = compose(inverse(base), self._pose_of(joint.name, element))
        turned = joint.child == WORLD
        if turned:
            # The description knows the world as a parent only.
            joint.parent, joint.child = WORLD, joint.parent
            joint.pose = compose(inverse(self._pose_of(joint.child, element)),
                                 self._pose_of(joint.name, element))
        place_axes(joint, found, self._source, self._frames.pose, model.pose.orientation)
        if turned:
            reverse_axes(joint)

    def _check(self, model: Model) -> None:
        """The faults of the finished model, at the places they come from."""
        for fault in faults(model, self._outer_static):
            element = self._elements.get(id(fault.subject))
            if element is None:
                continue  # inside a nested model, which has said so itself
            self._source.log.add(
                Issue(fault.severity, fault.code, fault.message, hint=fault.hint,
                      **self._source.where(element)),
                fatal=fault.severity is Severity.ERROR,
            )


def _add_inner_frames(frames: FrameTree, model: Model, scope: str, element: Any) -> None:
    for link in model.links:
        frames.add(f"{scope}::{link.name}", link.pose, scope, element)
    for nested in model.models:
        inner = f"{scope}::{nested.name}"
        frames.add(inner, nested.pose, scope, element)
        _add_inner_frames(frames, nested, inner, element)
