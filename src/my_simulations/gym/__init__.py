"""Environments for gymnasium (see doc/gymnasium.md); importing this registers the examples."""
from ..workspace_python import require_extra

require_extra("gymnasium")   # finds it among the packages of a workspace, too

from .example_registry import register_environments  # noqa: E402
from .vector import WorldVectorEnv  # noqa: E402
from .world_env import Evaluation, Task, View, WorldEnv  # noqa: E402

__all__ = ["Evaluation", "Task", "View", "WorldEnv", "WorldVectorEnv", "register_environments"]

register_environments()
