"""The controller manager: loads, switches and unloads controllers by its services.

Source: ros_control, controller_manager. Switches happen at once, also while the world is paused.
"""
from __future__ import annotations

import importlib
from typing import Any, Callable, Dict, List, Mapping, Type

from ..context import Context, PluginError
from .controller import RUNNING, Controller
from .hardware import EFFORT, POSITION, VELOCITY, Hardware

STRICT, BEST_EFFORT = 2, 1
_MESSAGES = "controller_manager_msgs"

TYPES: Mapping[str, str] = {
    "joint_state_controller/JointStateController": "joint_state:JointStateController",
    "position_controllers/JointPositionController": "forward:ForwardCommandController",
    "position_controllers/JointGroupPositionController": "forward:ForwardGroupController",
    "position_controllers/JointTrajectoryController": "joint_trajectory:JointTrajectory",
    "position_controllers/ScaledJointTrajectoryController": "joint_trajectory:JointTrajectory",
    "position_controllers/GripperActionController": "gripper_action:Gripper",
    "velocity_controllers/JointVelocityController": "forward:ForwardCommandController",
    "velocity_controllers/JointGroupVelocityController": "forward:ForwardGroupController",
    "velocity_controllers/JointPositionController": "joint_loops:JointLoop",
    "velocity_controllers/JointTrajectoryController": "joint_trajectory:JointTrajectory",
    "velocity_controllers/ScaledJointTrajectoryController": "joint_trajectory:JointTrajectory",
    "effort_controllers/JointEffortController": "forward:ForwardCommandController",
    "effort_controllers/JointGroupEffortController": "forward:ForwardGroupController",
    "effort_controllers/JointPositionController": "joint_loops:JointLoop",
    "effort_controllers/JointVelocityController": "joint_loops:JointVelocityLoop",
    "effort_controllers/JointGroupPositionController": "joint_loops:JointPositionGroup",
    "effort_controllers/JointTrajectoryController": "joint_trajectory:JointTrajectory",
    "effort_controllers/GripperActionController": "gripper_action:Gripper",
    "diff_drive_controller/DiffDriveController": "diff_drive_controller:DiffDriveController",
    "ackermann_steering_controller/AckermannSteeringController":
        "ackermann_steering_controller:AckermannSteeringController",
    "steer_drive_controller/SteerDriveController":
        "ackermann_steering_controller:AckermannSteeringController",
    "ackermann_drive_controller/AckermannDriveController":
        "ackermann_drive_controller:AckermannDriveController",
    "four_wheel_steering_controller/FourWheelSteeringController":
        "four_wheel_steering_controller:FourWheelSteeringController",
    "mecanum_drive_controller/MecanumDriveController":
        "mecanum_drive_controller:MecanumDriveController",
    "omni_drive_controller/OmniDriveController": "mecanum_drive_controller:OmniDriveController",
    "joint_read_command_controller/JointReadCommandController":
        "joint_state:JointReadCommandController",
    "pal_ros_controllers/CurrentLimitController": "current_limit:CurrentLimitController",
    "cob_omni_drive_controller/WheelController": "omni_drive_controllers:WheelController",
    "cob_omni_drive_controller/OdometryController": "omni_drive_controllers:OdometryController",
    "hector_quadrotor_controllers/PositionController": "quadrotor_controllers:PositionController",
    "hector_quadrotor_controllers/VelocityController": "quadrotor_controllers:VelocityController",
    "hector_quadrotor_controllers/AttitudeController": "quadrotor_controllers:AttitudeController",
    "imu_sensor_controller/ImuSensorController": "sensor_controllers:ImuSensorController",
    "force_torque_sensor_controller/ForceTorqueSensorController":
        "sensor_controllers:ForceTorqueSensorController",
    "franka_control/FrankaStateController": "franka:FrankaStateController",
    "franka_gazebo/FrankaGripperSim": "franka_gripper:FrankaGripper",
    "unitree_legged_control/UnitreeJointController":
        "unitree_joint_controller:UnitreeJointController",
}
"""Classes in this package by type of controller."""

_INTERFACES = {"position_controllers": POSITION, "velocity_controllers": VELOCITY,
               "effort_controllers": EFFORT}
"""The interface through which controllers of a package command their joints."""


class ControllerManager:
    """The controllers of one robot.

    Args:
        context: of the plugin, with its namespace set.
        hardware: the joints.
        period: s between updates that the user has asked for; 0 for none.
        claimed: called when a controller has claimed joints and started.
    """

    def __init__(self, context: Context, hardware: Hardware, period: float = 0.0,
                 claimed: Callable[[], None] = lambda: None) -> None:
        self._context, self._hardware, self._period = context, hardware, period
        self._on_claim = claimed
        self._loaded: Dict[str, Controller] = {}
        self._types: Dict[str, str] = {}
        for name, kind, answer in (
                ("list_controllers", "ListControllers", self._list),
                ("list_controller_types", "ListControllerTypes", self._list_types),
                ("load_controller", "LoadController", self._load_asked),
                ("unload_controller", "UnloadController", self._unload_asked),
                ("switch_controller", "SwitchController", self._switch_asked),
                ("reload_controller_libraries", "ReloadControllerLibraries", self._reload)):
            context.serve(f"controller_manager/{name}", f"{_MESSAGES}/{kind}", answer)

    @property
    def controllers(self) -> Dict[str, Controller]:
        return dict(self._loaded)

    @property
    def claimed(self) -> List[str]:
        """The joints of the running controllers."""
        return [name for one in self._loaded.values() if one.state == RUNNING
                for names in one.claimed.values() for name in names]

    # -- what can be asked -------------------------------------------------------------------------

    def load(self, name: str) -> None:
        """Load a controller that the parameters describe. Raises PluginError."""
        if name in self._loaded:
            raise PluginError(f"a controller named '{name}' is loaded already")
        kind = self._context.parameter(f"{name}/type", None)
        if not isinstance(kind, str):
            raise PluginError(f"parameter {name}/type is missing: is the controller's configuration"
                              " on the parameter server, in the namespace of the robot?")
        made = self._class_of(kind)(name, self._context, self._hardware, self._period)
        made.interface = _INTERFACES.get(kind.partition("/")[0], made.interface)
        try:
            made.load()
        except Exception:
            made.close()
            raise
        self._loaded[name], self._types[name] = made, kind

    def unload(self, name: str) -> None:
        """Unload a controller that does not run. Raises PluginError."""
        found = self._loaded.get(name)
        if found is None:
            raise PluginError(f"there is no controller '{name}'")
        if found.state == RUNNING:
            raise PluginError(f"controller '{name}' is running")
        del self._loaded[name]
        found.close()

    def switch(self, start: List[str], stop: List[str], strictness: int = BEST_EFFORT) -> None:
        """Stop and start controllers. Raises PluginError; then nothing has changed."""
        strict = strictness == STRICT
        stopping = self._find_controllers(stop, "stopped", strict)
        starting = self._find_controllers(start, "started", strict)
        off: List[Controller] = []
        on: List[Controller] = []
        for one in stopping:
            if one.state == RUNNING:
                off.append(one)
            elif strict:
                raise PluginError(f"controller '{one.name}' cannot be stopped: it does not run")
        for one in starting:
            if one.state != RUNNING or one in off:
                on.append(one)
            elif strict:
                raise PluginError(f"controller '{one.name}' is running already")
        self._check_resources([one for one in self._loaded.values() if one in on or (
            one.state == RUNNING and one not in off)])
        for one in off:
            one.switch_off()
        for one in on:
            self._start(one)

    def restart(self) -> None:
        """Restart all running controllers at the present joint positions."""
        running = [one for one in self._loaded.values() if one.state == RUNNING]
        for one in running:
            one.switch_off()
        self._hardware.set_idle()
        for one in running:
            self._start(one)

    def close(self) -> None:
        for one in self._loaded.values():
            if one.state == RUNNING:
                one.switch_off()
            one.close()
        self._loaded.clear()

    # -- inside ------------------------------------------------------------------------------------

    def _start(self, one: Controller) -> None:
        try:
            one.switch_on()
        except PluginError:
            one.switch_off()
            raise
        if one.claimed:
            self._on_claim()

    def _class_of(self, kind: str) -> Type[Controller]:
        where = TYPES.get(kind)
        if where is None:
            raise PluginError(f"there is no controller of type {kind}; there are"
                              f" {', '.join(sorted(TYPES))}")
        module, _, name = where.partition(":")
        made: Type[Controller] = getattr(importlib.import_module(f"{__package__}.{module}"), name)
        return made

    def _find_controllers(self, names: List[str], verb: str, strict: bool) -> List[Controller]:
        missing = [name for name in names if name not in self._loaded]
        if missing and strict:
            raise PluginError(f"controller '{missing[0]}' cannot be {verb}: it is not loaded")
        return [self._loaded[name] for name in dict.fromkeys(names) if name in self._loaded]

    @staticmethod
    def _check_resources(controllers: List[Controller]) -> None:
        owners: Dict[str, str] = {}
        for one in controllers:
            for names in one.claimed.values():
                for name in names:
                    other = owners.setdefault(name, one.name)
                    if other != one.name:
                        raise PluginError(f"controllers '{other}' and '{one.name}' both drive joint"
                                          f" '{name}'")

    # -- services ----------------------------------------------------------------------------------

    def _try_call(self, what: str, call: Callable[..., None], *arguments: Any) -> bool:
        """Return whether a call succeeded; report a failure to the user."""
        try:
            call(*arguments)
            return True
        except PluginError as fault:
            self._context.warn(f"could not {what}: {fault}")
        except Exception as fault:  # a controller's own fault: the others continue
            self._context.warn(f"could not {what}: {type(fault).__name__}: {fault}")
        return False

    def _list(self, _: Any, response: Any) -> None:
        response.controller = []
        for name, one in self._loaded.items():
            found = self._context.message(f"{_MESSAGES}/ControllerState")
            found.name, found.type, found.state = name, self._types[name], one.state
            found.claimed_resources = []
            for interface, names in one.claimed.items():
                used = self._context.message(f"{_MESSAGES}/HardwareInterfaceResources")
                used.hardware_interface, used.resources = interface, sorted(names)
                found.claimed_resources.append(used)
            response.controller.append(found)

    def _list_types(self, _: Any, response: Any) -> None:
        response.types = sorted(TYPES)
        response.base_classes = ["controller_interface::ControllerBase"] * len(TYPES)

    def _load_asked(self, request: Any, response: Any) -> None:
        response.ok = self._try_call(f"load controller '{request.name}'", self.load, request.name)

    def _unload_asked(self, request: Any, response: Any) -> None:
        response.ok = self._try_call(f"unload controller '{request.name}'", self.unload,
                                     request.name)

    def _switch_asked(self, request: Any, response: Any) -> None:
        response.ok = self._try_call("switch controllers", self.switch,
                                     list(request.start_controllers),
                                     list(request.stop_controllers), request.strictness)

    def _reload(self, request: Any, response: Any) -> None:
        if self._loaded and not request.force_kill:
            self._context.warn("could not reload the controller libraries: controllers are loaded;"
                               " unload them, or set force_kill")
            response.ok = False
            return
        self.close()
        response.ok = True
