"""`rosrun controller_manager unspawner NAME...`: stops controllers until it ends itself."""
from __future__ import annotations

import sys
import threading
from typing import Set

import rospy
from controller_manager_msgs.srv import (
    ListControllers,
    SwitchController,
    SwitchControllerRequest,
)

EVERY_S = 3.0   # of wall time


def main() -> int:
    """Returns 1 without names."""
    names = set(rospy.myargv(sys.argv)[1:])
    if not names or names & {"-h", "--help"}:
        print("Usage: unspawner NAME...\n\nStops controllers, and starts them again when this"
              " program ends.")
        return 0 if names else 1
    rospy.init_node("unspawner", anonymous=True)
    switch = rospy.ServiceProxy("controller_manager/switch_controller", SwitchController)
    listing = rospy.ServiceProxy("controller_manager/list_controllers", ListControllers)
    switch.wait_for_service()
    listing.wait_for_service()
    stopped: Set[str] = set()
    ended = threading.Event()

    def restart() -> None:
        ended.set()
        if stopped:
            switch(start_controllers=sorted(stopped), stop_controllers=[],
                   strictness=SwitchControllerRequest.BEST_EFFORT, start_asap=False, timeout=0.0)

    rospy.on_shutdown(restart)
    while not rospy.is_shutdown():
        running = {one.name for one in listing().controller if one.state == "running"} & names
        if running:
            rospy.loginfo("stopping controllers: %s", ", ".join(sorted(running)))
            switch(start_controllers=[], stop_controllers=sorted(running),
                   strictness=SwitchControllerRequest.BEST_EFFORT, start_asap=False, timeout=0.0)
            stopped |= running
        ended.wait(EVERY_S)
    return 0
