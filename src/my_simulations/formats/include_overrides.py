"""Changes that an `<include>` or a spawn request makes to the model."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import List, Optional

from ..description.model import PluginSpec
from ..geometry import Pose


@dataclass
class IncludeOverrides:
    """Values that replace those of an included model. Source: SDF spec 1.7, include.

    Attributes:
        name: name of the model; None keeps its own.
        pose: pose of the model in the frame `relative_to`; None keeps its own.
        relative_to: name of the frame of `pose`, "" for the parent's.
        static: whether the model is static; None keeps its own value.
        plugins: plugins to add to those of the model.
        extra: XML of children with a namespace prefix, which SDF ignores, to add to the kept XML
            of the model.
        placement_frame: frame inside the model that `pose` places, "" for the model frame (SDF
            1.8).
    """

    name: Optional[str] = None
    pose: Optional[Pose] = None
    relative_to: str = ""
    static: Optional[bool] = None
    plugins: List[PluginSpec] = field(default_factory=list)
    extra: List[str] = field(default_factory=list)
    placement_frame: str = ""
