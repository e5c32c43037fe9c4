"""`gazebo`: server and editor together; a ROS node if there is a master, else without ROS."""
from __future__ import annotations

import importlib.util
import sys
import threading
from typing import List, Optional

from . import gzserver_command
from .signals import exit_on_signals, ignore_signals


def main(argv: Optional[List[str]] = None) -> int:
    """Run a world with its editor until a signal ends it.

    Returns 0 after SIGINT or SIGTERM, 1 if the node could not start.
    """
    words = sys.argv if argv is None else argv
    exit_on_signals()
    from ..ros.lifecycle import master_api

    no_ros = ""
    if importlib.util.find_spec("rospy") is None:   # a master can run beside a virtual environment
        no_ros = "this Python has no rospy"
    elif master_api.fault_of(master_api.master_uri(words), "/gazebo"):
        no_ros = "no ROS master found"
    if no_ros:
        from . import standalone

        status = standalone.main(words, "gazebo", no_ros)
        ignore_signals()
        return status
    threading.Thread(target=_show, args=(words,), daemon=True).start()
    return gzserver_command.main(words, program="gazebo", gui=True)


def _show(words: List[str]) -> None:
    """Show the editor's URL as soon as the node has set it."""
    import time

    from ..editor.web_browser import show
    from ..ros.lifecycle import master_api

    name, uri = master_api.node_name(words, "gazebo"), master_api.master_uri(words)
    until = time.monotonic() + 60.0
    while time.monotonic() < until:
        try:
            found = master_api.call(uri, "getParam", name, f"{name}/my_simulations/editor_url")
        except OSError:
            return
        if isinstance(found, str) and master_api.running_node(uri, name) is not None:
            show(found, "gazebo")
            return
        time.sleep(0.25)
