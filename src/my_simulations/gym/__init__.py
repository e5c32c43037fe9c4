"""Environments for gymnasium (see doc/gymnasium.md); importing this registers the examples."""
from .example_registry import register_environments
from .vector import WorldVectorEnv
from .world_env import Evaluation, Task, View, WorldEnv

__all__ = ["Evaluation", "Task", "View", "WorldEnv", "WorldVectorEnv", "register_environments"]

register_environments()
