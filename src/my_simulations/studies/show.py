"""Shows one case of a study in the world editor."""
from __future__ import annotations

import os
import shutil
from typing import List

from .case_world import open_case
from .plan import Case, CasePlan


def write_world(plan: CasePlan, case: Case, path: str) -> str:
    """Write the world of a case, as it stands before the first step; returns the file.

    Raises:
        InputError: the world cannot be used.
        CommandError: it cannot be written.
    """
    with open_case(plan, case) as world:
        return world.save_world(path, overwrite=True)


def launch_command(world: str) -> List[str]:
    """What opens a world in the editor, paused."""
    return ["roslaunch", "gazebo_ros", "empty_world.launch", f"world_name:={world}", "paused:=true"]


def can_launch() -> bool:
    """Whether ROS is there, and this shell knows its packages."""
    return shutil.which("roslaunch") is not None and bool(os.environ.get("ROS_PACKAGE_PATH"))
