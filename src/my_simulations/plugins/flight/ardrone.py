"""libhector_gazebo_quadrotor_state_controller.so: the states, navdata and cameras of an AR.Drone.

Parameters, defaults and topics are those of cvg_sim_gazebo_plugins (tum_simulator). The thrust of
each state comes from libhector_gazebo_quadrotor_simple_controller.so of the same model. Where it
differs: `<imuTopic>` and `<stateTopic>` are ignored, navdata show the true state; `<landTopic>` is
respected; a reset lands the drone; `/ardrone/reset`, which has no effect, is not there. Navdata
need the package ardrone_autonomy; without it the drone flies all the same.
"""
from __future__ import annotations

import math
from typing import Any, List, Optional

from ...geometry import Vec3, rpy_from_quat, scale
from ...sensing.sensor_models import acceleration_between
from ..base import Plugin
from ..context import Context, Handle, PluginError, Publication
from ..frames import stamp_message
from ..time_out import Stopwatch
from .flight_states import FlightState, FlightStates
from .quadrotor_simple_controller import to_heading

_HERTZ = 200.0
_FLIGHT_S = 1200.0             # a full battery
_CAMERAS = ("front", "bottom")
_CAMERA_TOPICS = (("image_raw", "sensor_msgs/Image"), ("camera_info", "sensor_msgs/CameraInfo"))
_LOOK_HERTZ = 5.0              # at which subscribers of the camera topics are noticed


class ArdroneStateController(Plugin):
    """Publishes the navdata of the link `<bodyName>`, or of the model's first one."""

    def load(self) -> None:
        context, p = self.enter_namespace()
        self._link = context.link(p.text("bodyName"))
        self._charge, self._charge_ns = 100.0, context.now_ns    # percent, and when
        self._is_flying = False
        self._states = FlightStates(context, p, self._follow_state)
        self._camera_switch = _CameraSwitch(context)
        self._begin_motion()
        try:
            self._navdata: Optional[Publication] = context.publish(
                p.text("navdataTopic", "/ardrone/navdata"), "ardrone_autonomy/Navdata", 25)
        except PluginError as missing:
            self._navdata = None
            context.warn(f"no navdata: {missing}")
        else:
            context.observe(_HERTZ, self._publish, [self._navdata], resume=self._begin_motion)

    def reset(self) -> None:
        self._states.reset()
        self._charge, self._is_flying = 100.0, False
        self._charge_ns = self.context.now_ns
        self._begin_motion()

    def clock_set(self) -> None:
        """Continue with the present charge of the battery."""
        self._charge_ns = self.context.now_ns
        self._states.clock_set()
        self._begin_motion()

    def _follow_state(self) -> None:
        was_flying, self._is_flying = self._is_flying, self._states.state is not FlightState.LANDED
        if self._is_flying == was_flying:
            return
        # A new battery for each flight, as in the original.
        self._charge = 100.0 if self._is_flying else self._drained()
        self._charge_ns = self.context.now_ns

    def _drained(self) -> float:
        """The charge of the battery after a time of flight, percent."""
        seconds = max(0, self.context.now_ns - self._charge_ns) * 1e-9
        return self._charge - seconds / _FLIGHT_S * 100.0

    def _begin_motion(self) -> None:
        """Measure accelerations from the present time and velocity on."""
        self._velocity, self._stopwatch = self._link.twist.linear, Stopwatch(self.context)

    def _publish(self) -> None:
        context, pose, velocity = self.context, self._link.pose, self._link.twist.linear
        roll, pitch, yaw = rpy_from_quat(pose.orientation)
        altitude = self._states.altitude if self._states.has_sonar else pose.position[2]
        message = stamp_message(context, "ardrone_autonomy/Navdata", "ardrone_base_link")
        message.batteryPercent = self._drained() if self._is_flying else self._charge
        message.state = int(self._states.state)
        message.rotX, message.rotY, message.rotZ = map(math.degrees, (roll, pitch, yaw))
        message.altd = int((altitude or 0.0) * 1000.0)
        message.vx, message.vy, message.vz = scale(to_heading(yaw, velocity), 1000.0)
        x, y, z = to_heading(yaw, self._acceleration(velocity))
        message.ax, message.ay, message.az = x / 10.0, y / 10.0, z / 10.0 + 1.0
        message.tm = context.now_ns * 1e-3
        assert self._navdata is not None
        self._navdata.publish(message)

    def _acceleration(self, velocity: Vec3) -> Vec3:
        """The mean acceleration since the last call, m/s^2."""
        before, self._velocity = self._velocity, velocity
        return acceleration_between(before, velocity, self._stopwatch.lap())


class _CameraSwitch:
    """Republishes one of the drone's two cameras; the service `ardrone/togglecam` changes it.

    It subscribes to the camera only while its own topics have subscribers.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._camera = 0
        self._topics: List[Publication] = []
        self._inputs: List[Optional[Handle]] = []
        for name, kind in _CAMERA_TOPICS:
            self._topics.append(context.publish(f"/ardrone/{name}", kind))
            self._inputs.append(None)
        context.serve("ardrone/togglecam", "std_srvs/Empty",
                      lambda request, response: self._toggle())
        context.every(_LOOK_HERTZ, self._follow_subscribers)

    def _toggle(self) -> None:
        self._camera = 1 - self._camera
        for number in range(len(self._topics)):
            self._disconnect(number)
        self._follow_subscribers()

    def _follow_subscribers(self) -> None:
        for number, topic in enumerate(self._topics):
            if not topic.wanted:
                self._disconnect(number)
            elif self._inputs[number] is None:
                name, kind = _CAMERA_TOPICS[number]
                self._inputs[number] = self._context.subscribe(
                    f"/ardrone/{_CAMERAS[self._camera]}/{name}", kind, self._relay(topic))

    def _relay(self, topic: Publication) -> Any:
        return lambda message: topic.publish(message)

    def _disconnect(self, number: int) -> None:
        handle, self._inputs[number] = self._inputs[number], None
        if handle is not None:
            handle.close()
