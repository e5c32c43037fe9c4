"""`rosrun controller_manager spawner NAME...`: loads and starts controllers, and unloads them.

All waiting is in wall time: the world may be paused, and /clock need not be there yet.
"""
from __future__ import annotations

import argparse
import os
import sys
import threading
import time
from typing import List, Optional

import rosparam
import rospy
import yaml
from controller_manager_msgs.srv import (
    LoadController,
    SwitchController,
    SwitchControllerRequest,
    UnloadController,
)
from std_msgs.msg import Bool

LOOK_S = 0.05   # between two looks while waiting
TELL_S = 30.0   # between two messages while waiting
HINT = "does the robot have the plugin libgazebo_ros_control.so, and is it in the world?"


def parse_args(args: Optional[List[str]] = None) -> argparse.Namespace:
    """The options of the command."""
    parser = argparse.ArgumentParser(prog="spawner", description="Load and start controllers, and"
                                     " stop and unload them when this program ends.")
    parser.add_argument("--stopped", action="store_true", help="load them only")
    parser.add_argument("--wait-for", metavar="TOPIC",
                        help="begin when this topic (std_msgs/Bool) says true")
    parser.add_argument("--namespace", metavar="NS", default="",
                        help="where the controller_manager is")
    parser.add_argument("--timeout", metavar="T", type=float, default=0.0,
                        help="how long to wait for the controller_manager, in s; 0 or less for"
                        " ever, which is the default")
    parser.add_argument("--no-timeout", action="store_true", help="wait for ever")
    parser.add_argument("--shutdown-timeout", help="has no effect")
    parser.add_argument("controllers", metavar="CONTROLLER", nargs="+",
                        help="names on the parameter server, or YAML files that describe some")
    return parser.parse_args(args)


class Spawner:
    """Calls the controller manager of a namespace."""

    def __init__(self, namespace: str) -> None:
        self._prefix = f"{namespace.rstrip('/')}/" if namespace else ""
        self._load = self._proxy("load_controller", LoadController)
        self._unload = self._proxy("unload_controller", UnloadController)
        self._switch = self._proxy("switch_controller", SwitchController)
        self.loaded: List[str] = []

    def _proxy(self, name: str, kind: type) -> rospy.ServiceProxy:
        return rospy.ServiceProxy(f"{self._prefix}controller_manager/{name}", kind)

    def wait(self, timeout: Optional[float]) -> bool:
        """Wait for the manager, which comes with its robot; False after `timeout` s of it.

        Time before the first /clock does not count.
        """
        begin = told = time.monotonic()
        for proxy in (self._load, self._switch, self._unload):
            rospy.loginfo("spawner waits for %s", proxy.resolved_name)
            while not rospy.is_shutdown():
                try:
                    proxy.wait_for_service(timeout=1.0)
                    break
                except rospy.ROSException:
                    now = time.monotonic()
                    if _before_clock():
                        begin = now
                    elif timeout is not None and now - begin > timeout:
                        return False
                    if now - told > TELL_S:
                        told = now
                        rospy.logwarn("spawner still waits for %s: %s", proxy.resolved_name, HINT)
        return not rospy.is_shutdown()

    def load(self, names: List[str], start: bool) -> bool:
        """Load controllers, and start those that could be loaded."""
        for name in names:
            if self._load(name).ok:
                self.loaded.append(name)
            else:
                rospy.logerr("spawner could not load %s; the simulator's log says why", name)
        if self.loaded and start:
            if not self._switch(self.loaded, [], SwitchControllerRequest.STRICT, False, 0.0).ok:
                rospy.logerr("spawner could not start %s; the simulator's log says why",
                             ", ".join(self.loaded))
                return False
            rospy.loginfo("started controllers: %s", ", ".join(self.loaded))
        return bool(self.loaded)

    def end(self) -> None:
        """Stop and unload what was loaded; the manager may have gone with its robot."""
        try:
            if self.loaded:
                self._switch([], self.loaded, SwitchControllerRequest.BEST_EFFORT, False, 0.0)
            for name in reversed(self.loaded):
                self._unload(name)
        except rospy.ServiceException as fault:
            # At the end of a launch file the simulator often ends first.
            rospy.loginfo("controllers were not unloaded: the manager has ended or refused")
            rospy.logdebug("the call failed: %s", fault)


def _before_clock() -> bool:
    return bool(rospy.get_param("/use_sim_time", False)) and rospy.get_rostime().is_zero()


def _wait_for_true(topic: str) -> bool:
    """Wait until a topic says true."""
    said = threading.Event()
    subscriber = rospy.Subscriber(topic, Bool, lambda message: said.set() if message.data else None)
    while not said.wait(LOOK_S):
        if rospy.is_shutdown():
            return False
    subscriber.unregister()
    return True


def _names(arguments: List[str]) -> List[str]:
    """The controllers; YAML files among the arguments are put on the parameter server."""
    names: List[str] = []
    for argument in arguments:
        if not os.path.exists(argument):
            names.append(argument)
            continue
        with open(argument, encoding="utf-8") as stream:
            described = yaml.safe_load(stream)
        for name, value in described.items():
            rosparam.upload_params(rospy.resolve_name(name), value)
            names.append(name)
    return names


def main() -> int:
    """Returns 1 where there is no manager, or nothing could be loaded."""
    options = parse_args(rospy.myargv(sys.argv)[1:])
    rospy.init_node("spawner", anonymous=True)
    spawner = Spawner(options.namespace)
    endless = options.no_timeout or options.timeout <= 0.0
    if not spawner.wait(None if endless else options.timeout):
        if rospy.is_shutdown():
            return 0
        rospy.logerr("spawner found no controller_manager in namespace %s: %s",
                     rospy.resolve_name(options.namespace) if options.namespace
                     else rospy.get_namespace(), HINT)
        return 1
    if options.wait_for and not _wait_for_true(options.wait_for):
        return 0
    rospy.on_shutdown(spawner.end)
    if not spawner.load(_names(options.controllers), start=not options.stopped):
        return 1
    rospy.spin()
    return 0
