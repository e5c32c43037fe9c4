"""A Gazebo Classic substitute for ROS 1, on PyBullet.

Files are read into a description; a simulator keeps the description and the clock; an engine in its
own process moves it; ROS, the editor, the command line and programs in Python are front ends of the
simulator.

From Python: `my_simulations.open_world(...)`, see `my_simulations.python_api`, and
`my_simulations.replay(...)`, see `my_simulations.cli.replay_command`.
"""
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .cli.replay_command import replay
    from .python_api import OpenWorld, open_world

__version__ = "0.1.0"
__all__ = ["OpenWorld", "__version__", "open_world", "replay"]


def __getattr__(name: str) -> Any:
    # The node imports this package and must not pay for NumPy and the readers.
    if name in ("OpenWorld", "open_world", "replay"):
        from .workspace_packages import use_workspace_packages

        use_workspace_packages()
        try:
            if name == "replay":
                from .cli.replay_command import replay

                return replay
            from . import python_api
        except ModuleNotFoundError as missing:
            from .workspace_python import advice

            raise ImportError(advice(missing.name or "")) from missing
        return getattr(python_api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
