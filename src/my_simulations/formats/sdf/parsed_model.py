"""A parsed model, with the frames and joints that its parent has to resolve."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, List, Optional

from ...description.model import Model
from .frame_graph import FrameTree
from .joint import UnresolvedJoint
from .model_flags import ModelFlags


@dataclass
class ParsedModel:
    """A parsed model.

    Attributes:
        model: the model; its pose is in the frame `relative_to`.
        relative_to: name of the frame of the model's pose, "" for the parent's.
        frames: the frames inside the model; None for a model from a URDF file.
        unresolved_joints: joints with a parent or child link outside the model, which the outer
            model or the world resolves.
        flags: the flags that the model sets, which apply to a model that includes it.
    """

    model: Model
    relative_to: str = ""
    frames: Optional[FrameTree] = None
    unresolved_joints: List[UnresolvedJoint] = field(default_factory=list)
    flags: ModelFlags = ModelFlags()


def add_frames_inside(frames: FrameTree, placement: ParsedModel, element: Any) -> None:
    """Add the frames inside a model, by scoped names, to `frames`, which has its model frame."""
    model = placement.model
    if placement.frames is not None:
        frames.include(model.name, placement.frames, element)
    else:
        _add_inner_frames(frames, model, model.name, element)


def _add_inner_frames(frames: FrameTree, model: Model, scope: str, element: Any) -> None:
    for link in model.links:
        name = f"{scope}::{link.name}"
        frames.add(name, link.pose, scope, element, name)
    for nested in model.models:
        inner = f"{scope}::{nested.name}"
        frames.add(inner, nested.pose, scope, element)
        _add_inner_frames(frames, nested, inner, element)
