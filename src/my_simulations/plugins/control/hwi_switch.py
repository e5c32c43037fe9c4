"""libhwi_switch_gazebo_ros_control.so: joints that controllers drive by any of their interfaces.

Source: cob_gazebo_ros_control. A robot can have several of these plugins, one for each component,
in a namespace of its own and with the joints that a parameter there lists.
"""
from __future__ import annotations

from typing import Any, List

from ...description.transmission import Transmission
from ..context import PluginError
from .gazebo_ros_control import SWITCHING, GazeboRosControl


class HwiSwitchGazeboRosControl(GazeboRosControl):
    """As libgazebo_ros_control.so, with `<filterJointsParam>` and `<stateValidTopic>`."""

    hardware_type = SWITCHING

    def load(self) -> None:
        """Find the joints; offer the controller manager; subscribe to the validity of the state."""
        self._valid = True
        super().load()
        topic = self.context.parameters.text("stateValidTopic")
        if topic:
            self.context.subscribe(topic, "std_msgs/Bool", self._receive_valid)

    def controllable(self, transmissions: List[Transmission]) -> List[Transmission]:
        """Return the transmissions whose joints the parameter lists; all without a filter.

        Raises PluginError: the parameter is missing or is not a list of names.
        """
        parameter = self.context.parameters.text("filterJointsParam")
        if not parameter:
            return transmissions
        names = self.context.parameter(parameter, None)
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise PluginError(f"<filterJointsParam> {parameter}: this parameter must list the names"
                              f" of the joints, it is {names!r}; is the component's configuration"
                              " on the parameter server, in the namespace of the plugin?")
        return [one for one in transmissions if any(joint.name in names for joint in one.joints)]

    def _receive_stop(self, message: Any) -> None:
        self.set_stopped(bool(message.data) or not self._valid)

    def _receive_valid(self, message: Any) -> None:
        """An invalid state stops the joints until the emergency stop is released, as in Gazebo."""
        self._valid = bool(message.data)
        if not self._valid:
            self.set_stopped(True)
