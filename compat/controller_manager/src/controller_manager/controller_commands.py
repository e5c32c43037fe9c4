"""`rosrun controller_manager controller_manager COMMAND [NAME...]`."""
from __future__ import annotations

import sys
from typing import Callable, Dict, List

import rospy

from . import controller_manager_interface as manager

USAGE = """Usage: controller_manager COMMAND [NAME...]

Commands:
    load NAME...        load controllers that the parameter server describes
    unload NAME...      unload controllers
    start NAME...       start controllers
    stop NAME...        stop controllers
    spawn NAME...       load and start controllers
    kill NAME...        stop and unload controllers
    list                list the loaded controllers
    list-types          list the types of controllers
    reload-libraries    forget the classes of controllers (--restore: load them again)"""

EACH: Dict[str, List[Callable[[str], bool]]] = {
    "load": [manager.load_controller],
    "unload": [manager.unload_controller],
    "start": [manager.start_controller],
    "stop": [manager.stop_controller],
    "spawn": [manager.load_controller, manager.start_controller],
    "kill": [manager.stop_controller, manager.unload_controller],
}
"""What is called with each name, by command."""

SHORT = {"sp": "spawn", "kl": "kill", "lc": "list", "lt": "list-types"}


def main() -> int:
    """The command; 0 when all of it was done."""
    arguments = rospy.myargv(sys.argv)[1:]
    command = SHORT.get(arguments[0], arguments[0]) if arguments else ""
    if command not in EACH and command not in ("list", "list-types", "reload-libraries"):
        print(USAGE, file=sys.stdout if command in ("", "-h", "--help") else sys.stderr)
        return 0 if command in ("", "-h", "--help") else 1
    try:
        rospy.init_node("controller_manager", anonymous=True)
        return 0 if _done(command, arguments[1:]) else 1
    except rospy.ROSInterruptException:
        return 1
    except (rospy.ServiceException, rospy.ROSException) as fault:
        print(fault, file=sys.stderr)
        return 1


def _done(command: str, names: List[str]) -> bool:
    if command == "list":
        manager.list_controllers()
        return True
    if command == "list-types":
        manager.list_controller_types()
        return True
    if command == "reload-libraries":
        return manager.reload_libraries(True, restore="--restore" in names)
    return all([call(name) for call in EACH[command] for name in names])
