"""SDF models: links, joints, nested models, and their frames."""
from __future__ import annotations

import enum
from dataclasses import replace
from typing import Any, List, Optional, Sequence, Set, Tuple

from ...description.cost_budget import MODEL_BUDGET, budget_faults, cost_of
from ...description.model import WORLD, Link, Model
from ...description.validate import (
    closest_name_hint,
    find_own_faults,
    link_names,
    name_and_pose_faults,
)
from ...errors import Issue, Severity
from ...geometry import IDENTITY, Pose, compose, inverse
from ..include_overrides import IncludeOverrides
from ..xml.binding import fill
from ..xml.source import FaultLevel, Source
from .frame_graph import FrameError, FrameTree
from .include import read_include
from .joint import UnresolvedJoint, is_complete, place_axes, read_joint, reverse_axes
from .link import LinkReader, free_name, must_be_static, relative_to
from .model_flags import apply_include_flags, first_link, own_flags
from .model_tables import FRAME, MODEL
from .parsed_model import ParsedModel, add_frames_inside
from .plugin import read_gripper, read_plugin

ROOT = "__model__"
DEEPEST = 50
"""Greatest depth of nested models; files of Gazebo and of robots have 2 or 3 levels."""
MOST_NESTED = MODEL_BUDGET.links
"""Greatest number of models inside one, at all depths. Each has a link at least."""
MOST_NESTED_OF_ALL = 10_000
"""Greatest number of nested models of a document; each takes 0.1 ms of processor time."""


def read_model(element: Any, source: Source, changes: Optional[IncludeOverrides] = None,
               static: bool = False, outer: Sequence[str] = (), alone: bool = True) -> ParsedModel:
    """A model; faults that make it unusable are counted as fatal in the source's log.

    Args:
        element: a `<model>` of SDF 1.7 (see `upgrade`).
        source: its file.
        changes: overrides of an `<include>`.
        static: True if an outer model is static.
        outer: names of the models around it, outermost first.
        alone: False if joints may refer to links of other models.
    """
    return _ModelReader(
        element, source, changes or IncludeOverrides(), static, tuple(outer), alone
    ).read()


class _End(enum.Enum):
    """Where the links of a joint are: in this model, possibly in an outer one, or nowhere."""

    HERE = 1
    ELSEWHERE = 2
    NOWHERE = 3


class _ModelReader:
    def __init__(self, element: Any, source: Source, changes: IncludeOverrides, static: bool,
                 outer: Tuple[str, ...], alone: bool) -> None:
        self._element = element
        self._source = source
        self._changes = changes
        self._outer_static = static
        self._outer = outer
        self._alone = alone
        self._frames = FrameTree(ROOT)
        self._links = LinkReader(source, self._frames)
        self._elements = self._links.elements
        self._declared: List[Tuple[str, Any]] = []  # <frame>s

    def read(self) -> ParsedModel:
        element, source, changes = self._element, self._source, self._changes
        if not (self._outer or source.trail):
            source.log.includes = 0
        model = Model(element.get("name", ""))
        self._elements[id(model)] = element
        found = fill(model, element, MODEL, source, model.extra)
        placement = ParsedModel(model, relative_to(found), self._frames)
        self._apply(changes, placement)
        included = self._read_includes(self._within_depth(found.get("include", ()), model), model,
                                       placement)
        static = model.static or self._outer_static
        model.plugins = [read_plugin(plugin, source) for plugin in found.get("plugin", ())]
        model.plugins += [read_gripper(gripper, source) for gripper in found.get("gripper", ())]
        model.plugins += changes.plugins
        model.links = self._links.read_all(found.get("link", ()), static)
        self._force_static_if_needed(model, static)
        for child in found.get("frame", ()):
            self._frame(child)
        nested = self._within_number(self._within_depth(found.get("model", ()), model), model)
        waiting = self._add_nested(nested, included, model, static)
        joints = self._read_joints(found.get("joint", ()))
        model.canonical_link = model.canonical_link or first_link(
            element, {child: inner.model for child, inner in included})
        self._frames.body = model.canonical_link or next(link_names(model), "")
        names = set(link_names(model))
        for one in (*joints, *waiting):
            self._elements[id(one.joint)] = one.element
            self._look_up(one, names)
            self._frames.add(one.joint.name, one.joint.pose,
                             one.scoped(relative_to(one.found)) or self._joint_base(one.joint),
                             one.element, self._joint_base(one.joint))
        self._place(model)
        ends = [(one, self._place_joint(one, model, names)) for one in (*joints, *waiting)]
        model.joints = [one.joint for one, end in ends if end is _End.HERE] + model.joints
        placement.unresolved_joints = [one for one, end in ends if end is _End.ELSEWHERE]
        self._apply_placement_frame(element.get("placement_frame") or "", model)
        self._check(model)
        return placement

    def _apply(self, changes: IncludeOverrides, placement: ParsedModel) -> None:
        model = placement.model
        if changes.name is not None:
            model.name = changes.name
        if changes.pose is not None:
            model.pose, placement.relative_to = changes.pose, changes.relative_to

    def _force_static_if_needed(self, model: Model, static: bool) -> None:
        for link in model.links:
            if not static and must_be_static(link):
                self._source.warn("static-forced", f"model {model.name!r} is made static: its link"
                                  f" {link.name!r} has a heightmap or image collision",
                                  self._elements[id(link)])
                model.static = True
                return

    def _frame(self, element: Any) -> None:
        probe = Link(element.get("name", ""))
        found = fill(probe, element, FRAME, self._source, [])
        attached = element.get("attached_to") or ""
        # Without `relative_to` the pose is in the frame of `attached_to`.
        self._frames.add(probe.name, probe.pose, relative_to(found) or attached, element, attached)
        self._declared.append((probe.name, element))

    def _within_depth(self, elements: Sequence[Any], model: Model) -> Sequence[Any]:
        """The nested models; none, with an issue, at depth `DEEPEST`."""
        if len((*self._outer, model.name)) < DEEPEST:
            return elements
        for child in elements:
            self._source.report(FaultLevel.ERROR, "models-too-deep", "models are nested deeper than"
                                f" {DEEPEST} levels; this one is skipped", child)
        return ()

    def _within_number(self, elements: Sequence[Any], model: Model) -> Sequence[Any]:
        """The nested models; none if the model, or the document until here, has too many."""
        if self._outer or not elements:
            return elements
        log, count = self._source.log, sum(1 for _ in self._element.iter("model")) - 1
        log.nested += count
        if count <= MOST_NESTED and log.nested <= MOST_NESTED_OF_ALL:
            return elements
        why = (f"{count} nested models; {MOST_NESTED} are possible" if count > MOST_NESTED else
               f"nested models beyond the {MOST_NESTED_OF_ALL} that one document may have")
        self._source.report(FaultLevel.FATAL, "model-too-large", f"model {model.name!r} has {why}",
                            self._element, "divide it into several models or files")
        return ()

    def _read_includes(self, elements: Sequence[Any], model: Model,
                       placement: ParsedModel) -> List[Tuple[Any, ParsedModel]]:
        """The included models; applies their flags to this model."""
        included: List[Tuple[Any, ParsedModel]] = []
        placement.flags = own_flags(model, self._element)
        for child in elements:
            static = model.static or self._outer_static
            inner = read_include(child, self._source, read_model, static,
                                 (*self._outer, model.name))
            if isinstance(inner, ParsedModel):
                included.append((child, inner))
                placement.flags = apply_include_flags(
                    model, self._element, [(one, other.flags) for one, other in included],
                    self._source)
                self._override_static(placement)
        self._override_static(placement)
        return included

    def _override_static(self, placement: ParsedModel) -> None:
        """Apply the `<static>` of this model's own include, which has precedence."""
        if self._changes.static is not None:
            placement.model.static = self._changes.static
            placement.flags = replace(placement.flags, static=self._changes.static)

    def _add_nested(self, elements: Sequence[Any], included: Sequence[Tuple[Any, ParsedModel]],
                    model: Model, static: bool) -> List[UnresolvedJoint]:
        """Add nested models; returns their joints with links outside of them."""
        path = (*self._outer, model.name)
        waiting: List[UnresolvedJoint] = []
        for child in elements:
            placement = read_model(child, self._source, static=static, outer=path, alone=False)
            waiting += self._adopt(placement, child, model)
        for child, placement in included:
            if (child.get("merge") or "").strip().lower() in ("true", "1"):
                self._merge(placement, child, model)
            else:
                placement.model.static = model.static  # as set by `apply_include_flags`
                waiting += self._adopt(placement, child, model)
        return waiting

    def _adopt(self, placement: ParsedModel, element: Any, model: Model) -> List[UnresolvedJoint]:
        inner = placement.model
        self._elements[id(inner)] = element
        taken = {one.name for one in model.models}
        if inner.name in taken:
            free = free_name(inner.name, taken)
            self._source.tolerate("name-repeated", f"there are two models named {inner.name!r} in"
                                  f" {model.name!r}; the second is renamed to {free!r}", element,
                                  "names are unique within a model")
            inner.name = free
        model.models.append(inner)
        body = inner.canonical_link or next(link_names(inner), "")
        self._frames.add(inner.name, inner.pose, placement.relative_to, element,
                         f"{inner.name}::{body}" if body else "")
        if placement.relative_to:
            self._links.given_in.append((inner, inner.name, ""))
        add_frames_inside(self._frames, placement, element)
        return [one.moved_out(inner.name) for one in placement.unresolved_joints]

    def _merge(self, placement: ParsedModel, element: Any, model: Model) -> None:
        """Merge the contents of a model into this one. Source: SDF spec 1.9, include."""
        inner = placement.model
        proxy = f"_merged__{inner.name}__{ROOT}"
        self._frames.add(proxy, inner.pose, placement.relative_to, element)
        items: List[Any] = [*inner.links, *inner.models]
        for item in items:
            self._elements[id(item)] = element
            self._frames.add(item.name, item.pose, proxy, element,
                             item.name if isinstance(item, Link) else "")
            self._links.given_in.append((item, item.name, ""))
        if placement.frames is not None:
            self._frames.merge(proxy, placement.frames, element)
        for joint in inner.joints:
            self._elements[id(joint)] = element
        model.links += inner.links
        model.joints += inner.joints
        model.models += inner.models
        model.plugins += inner.plugins
        model.extra += [xml for xml in inner.extra if not xml.startswith("<frame")]

    def _read_joints(self, elements: Sequence[Any]) -> List[UnresolvedJoint]:
        """The joints; of two with one name the first, as in Gazebo."""
        joints: List[UnresolvedJoint] = []
        taken: Set[str] = set()
        for element in elements:
            one = UnresolvedJoint(*read_joint(element, self._source), element)
            joint = one.joint
            if self._links.world:
                for role in ("parent", "child"):
                    if getattr(joint, role) == WORLD:
                        setattr(joint, role, self._links.world)
            if joint.name and joint.name in taken:
                self._source.tolerate("name-repeated", f"there are two joints named {joint.name!r};"
                                      " the second is skipped", element,
                                      "names are unique within a model")
            elif is_complete(one, self._source):
                taken.add(joint.name)
                joints.append(one)
        return joints

    def _joint_base(self, joint: Any) -> str:
        return joint.child if joint.child in self._frames and joint.child != WORLD else ROOT

    def _look_up(self, one: UnresolvedJoint, names: Set[str]) -> None:
        """Find parent and child by their plain or scoped names."""
        joint = one.joint
        for role in ("parent", "child"):
            name = getattr(joint, role)
            for candidate in self._spellings(name, one.scope):
                if candidate in names or candidate in self._frames:
                    setattr(joint, role, candidate)
                    break

    def _spellings(self, name: str, scope: str) -> List[str]:
        found = [f"{scope}{name}"] if scope and name != WORLD else []
        found.append(name)
        path = (*self._outer, self._element.get("name", ""))
        for start in range(len(path)):
            prefix = "::".join(path[start:]) + "::"
            if name.startswith(prefix):
                found.append(name[len(prefix):])
        return found

    def _place(self, model: Model) -> None:
        """Transform every pose in a named frame to the frame that the description uses."""
        for thing, frame, link in self._links.given_in:
            element = self._elements[id(thing)]
            pose = self._pose_of(frame, element)
            if pose is None:
                continue  # as written
            if link:
                base = self._pose_of(link, element) or IDENTITY
                pose = compose(inverse(base), compose(pose, thing.pose))
            thing.pose = pose
        for name, element in self._declared:
            self._pose_of(name, element)
            self._body_of(name, element)

    def _pose_of(self, frame: str, element: Any) -> Optional[Pose]:
        """The pose of a frame; None, with an issue, if unknown (the pose is used as written)."""
        try:
            return self._frames.pose(frame)
        except FrameError as fault:
            self._source.tolerate("frame-unknown", f"{fault}; the pose of this <{element.tag}> is"
                                  " taken without it", element)
            return None

    def _body_of(self, name: str, element: Any) -> str:
        try:
            return self._frames.body_of(name)
        except FrameError as fault:
            self._source.tolerate("frame-unknown", f"{fault}; this <{element.tag}> is attached to"
                                  " the model", element)
            return name

    def _place_joint(self, one: UnresolvedJoint, model: Model, names: Set[str]) -> "_End":
        """Transform a joint to the frame of its child link, if both links are known."""
        joint, element = one.joint, one.element
        at: Optional[Pose] = IDENTITY
        if joint.child in self._frames or joint.child == WORLD:
            at = self._pose_of(joint.name, element)
        moved = bool(relative_to(one.found)) and at is not None
        for role in ("parent", "child"):
            name = getattr(joint, role)
            if name not in names and name != WORLD and name in self._frames:
                setattr(joint, role, self._body_of(name, element))
                moved = moved or role == "child"
        ends = (joint.parent, joint.child)
        strangers = [name for name in ends if name and name != WORLD and name not in names]
        if strangers:
            if not self._alone and (self._outer or any("::" in name for name in strangers)):
                return _End.ELSEWHERE
            self._source.tolerate("joint-link-unknown", f"joint {joint.name!r} names"
                                  f" {' and '.join(map(repr, strangers))}, which the model does not"
                                  " have; the joint is skipped", element,
                                  closest_name_hint(strangers[0], sorted(names)))
            return _End.NOWHERE
        if joint.child == WORLD and joint.parent in names:
            # In the description the world can only be the parent.
            joint.parent, joint.child = WORLD, joint.parent
            joint.pose = self._from(joint.child, at or IDENTITY, element)
            place_axes(joint, one.found, self._source, self._pose_in(one), model.pose.orientation)
            reverse_axes(joint)
        elif joint.child in names:
            if moved:
                joint.pose = self._from(joint.child, at or IDENTITY, element)
            place_axes(joint, one.found, self._source, self._pose_in(one), model.pose.orientation)
        return _End.HERE

    def _from(self, frame: str, at: Pose, element: Any) -> Pose:
        return compose(inverse(self._pose_of(frame, element) or IDENTITY), at)

    def _pose_in(self, one: UnresolvedJoint) -> Any:
        """Returns frame poses by names as used in the joint's own model, or by full names."""
        def pose(name: str) -> Pose:
            scoped = one.scoped(name)
            return self._frames.pose(scoped if scoped in self._frames else name)

        return pose

    def _apply_placement_frame(self, frame: str, model: Model) -> None:
        """Set the model pose from the pose of its placement frame. Source: SDF spec 1.8."""
        frame = self._changes.placement_frame or frame
        if frame:
            model.pose = compose(model.pose,
                                 inverse(self._pose_of(frame, self._element) or IDENTITY))

    def _check(self, model: Model) -> None:
        """Report the faults of the complete model, located at their elements."""
        found = [*find_own_faults(model, self._outer_static),
                 *(fault for nested in model.models for fault in name_and_pose_faults(nested)),
                 *([] if self._outer else budget_faults(cost_of(model), model))]
        for fault in found:
            element = self._elements.get(id(fault.subject))
            if element is None:
                continue  # inside a nested model, which reported it
            self._source.log.add(
                Issue(fault.severity, fault.code, fault.message, hint=fault.hint,
                      **self._source.where(element)),
                fatal=fault.severity is Severity.ERROR,
            )
