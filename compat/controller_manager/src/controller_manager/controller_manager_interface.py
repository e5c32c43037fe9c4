"""Loads, starts, stops and lists controllers. Names and results are those that scripts import.

Each function waits for its service, prints what has happened, and says whether it succeeded.
"""
from __future__ import annotations

from typing import Any, Sequence

import rospy
from controller_manager_msgs.srv import (
    ListControllers,
    ListControllerTypes,
    LoadController,
    ReloadControllerLibraries,
    SwitchController,
    SwitchControllerRequest,
    UnloadController,
)


def _call(name: str, kind: Any, *arguments: Any) -> Any:
    name = f"controller_manager/{name}"
    rospy.wait_for_service(name)
    return rospy.ServiceProxy(name, kind)(*arguments)


def list_controller_types() -> None:
    """Print the types that can be loaded."""
    for kind in _call("list_controller_types", ListControllerTypes).types:
        print(kind)


def list_controllers() -> None:
    """Print the loaded controllers, their interfaces and states."""
    found = _call("list_controllers", ListControllers).controller
    if not found:
        print("No controllers are loaded")
    for one in found:
        interfaces = "+".join(sorted({each.hardware_interface for each in one.claimed_resources}))
        print(f"'{one.name}' - '{interfaces}' ( {one.state} )")


def reload_libraries(force_kill: bool, restore: bool = False) -> bool:
    """Forget the classes of controllers; `restore`: load again what was loaded."""
    before = _call("list_controllers", ListControllers).controller if restore else []
    done = bool(_call("reload_controller_libraries", ReloadControllerLibraries, force_kill).ok)
    print("Reloaded the libraries" if done
          else "Could not reload the libraries: controllers are still loaded")
    for one in before:
        load_controller(one.name)
    running = [one.name for one in before if one.state == "running"]
    if running:
        _switch(running, [], SwitchControllerRequest.BEST_EFFORT)
    return done


def load_controller(name: str) -> bool:
    """Load a controller that the parameter server describes."""
    done = bool(_call("load_controller", LoadController, name).ok)
    print(f"Loaded '{name}'" if done else f"Error when loading '{name}'")
    return done


def unload_controller(name: str) -> bool:
    """Unload a controller that does not run."""
    done = bool(_call("unload_controller", UnloadController, name).ok)
    print(f"Unloaded '{name}' successfully" if done else f"Error when unloading '{name}'")
    return done


def start_controller(name: str) -> bool:
    """Start one."""
    return start_stop_controllers(start_controllers=[name])


def start_controllers(names: Sequence[str]) -> bool:
    """Start some at once."""
    return start_stop_controllers(start_controllers=names)


def stop_controller(name: str) -> bool:
    """Stop one."""
    return start_stop_controllers(stop_controllers=[name])


def stop_controllers(names: Sequence[str]) -> bool:
    """Stop some at once."""
    return start_stop_controllers(stop_controllers=names)


def start_stop_controllers(start_controllers: Sequence[str] = (),
                           stop_controllers: Sequence[str] = ()) -> bool:
    """Start some and stop others in the same step: all of it, or nothing."""
    started, stopped = list(start_controllers), list(stop_controllers)
    done = _switch(started, stopped, SwitchControllerRequest.STRICT)
    if not done:
        print(f"Error when starting {started} and stopping {stopped}")
    if done and started:
        print(f"Started {started} successfully")
    if done and stopped:
        print(f"Stopped {stopped} successfully")
    return done


def _switch(start: Sequence[str], stop: Sequence[str], strictness: int) -> bool:
    return bool(_call("switch_controller", SwitchController, list(start), list(stop), strictness,
                      False, 0.0).ok)
