"""Environments for gymnasium (see doc/gymnasium.md); importing this registers the examples."""
from typing import TYPE_CHECKING, Any

from .example_registry import register_environments

if TYPE_CHECKING:
    from .vector import WorldVectorEnv
    from .world_env import Judgement, Task, View, WorldEnv

__all__ = ["Judgement", "Task", "View", "WorldEnv", "WorldVectorEnv", "register_environments"]

register_environments()


def __getattr__(name: str) -> Any:
    # Gymnasium imports this package while it is being imported itself, to learn the names.
    if name == "WorldVectorEnv":
        from .vector import WorldVectorEnv

        return WorldVectorEnv
    if name in __all__:
        from . import world_env

        return getattr(world_env, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
