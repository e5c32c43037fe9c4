"""libArduPilotPlugin.so: a vehicle that ArduPilot's software in the loop flies, over UDP.

Elements, defaults, packets and laws are those of ardupilot_gazebo (SITL model `gazebo`): ArduPilot
sends a float for each channel, the plugin answers with time, IMU, attitude, velocity and position
as 17 doubles. Since the first packet the world waits up to 1 s for the packet of each step; after
`<connectionTimeoutMaxCount>` misses in a row the vehicle counts as alone. Where it differs: before
the first packet the plugin checks for one 50 times a second of sim time; the loops of joints run in
the engine; `<frequencyCutoff>` and `<samplingRate>` have no effect, as there.
"""
from __future__ import annotations

import math
import select
import socket
import struct
from dataclasses import replace
from typing import List, NamedTuple, Optional

from ...engine.drive_commands import JointServo, PidGains
from ...geometry import Pose, compose, conjugate, inverse, quat_from_rpy, rotate
from ..base import Plugin
from ..call_slot import CallSlot
from ..context import Joint, PluginError
from ..imu_meter import ImuMeter
from ..parameters import Parameters

_LOOK_HZ = 50.0
_WAIT_S = 1.0          # for the packet of a step
_PACKET_BYTES = 4096
_STATE = struct.Struct("<17d")
_MOTOR_EFFORT = 1e3    # N m, of joints that are set to a rate
_TURNS = {"cw": -1.0, "ccw": 1.0}
_NORTH_EAST_DOWN = Pose(orientation=quat_from_rpy(math.pi, 0.0, 0.0))


class Channel(NamedTuple):
    """A `<control>`: the joint that a float of the packet moves.

    Attributes:
        number: place in the packet.
        joint: the joint.
        kind: VELOCITY, POSITION or EFFORT.
        by_effort: a loop gives an effort, else the rate or the position is set.
        multiplier, offset: the command is multiplier * (float + offset).
        slowdown: by which the joint turns slower than the rotor.
        servo: the loop.
    """

    number: int
    joint: Joint
    kind: str
    by_effort: bool
    multiplier: float
    offset: float
    slowdown: float
    servo: JointServo


class ArduPilot(Plugin):
    """Receives motor commands at `<fdm_port_in>`, sends states to `<fdm_port_out>`."""

    _socket: Optional[socket.socket] = None

    def load(self) -> None:
        p = self.context.parameters
        blocks = p.children("control") or p.children("rotor")
        self._channels = [self._channel(block, number) for number, block in enumerate(blocks)]
        self._find_imu(p.text("imuName", "imu_sensor"))
        self._to_airplane = p.pose("modelXYZToAirplaneXForwardZDown")
        self._to_ned = p.pose("gazeboXYZToNED") if p.text("gazeboXYZToNED") else _NORTH_EAST_DOWN
        self._most_misses = p.integer("connectionTimeoutMaxCount", 10)
        self._answer = (p.text("fdm_addr", "127.0.0.1"), p.integer("fdm_port_out", 9003))
        self._listen(p.text("listen_addr", "127.0.0.1"), p.integer("fdm_port_in", 9002))
        self._timer = CallSlot()
        self._wait_for_first()

    def _channel(self, p: Parameters, number: int) -> Channel:
        kind = p.text("type", "VELOCITY")
        if kind not in ("VELOCITY", "POSITION", "EFFORT"):
            self.context.warn(f"<type> {kind} of a <control> is not VELOCITY, POSITION or EFFORT;"
                              " VELOCITY is used")
            kind = "VELOCITY"

        def gain(name: str, default: float) -> float:
            return p.number(name, p.number(f"vel_{name}", default))

        most = max(abs(gain("cmd_max", 1.0)), abs(gain("cmd_min", -1.0)))
        servo = JointServo(0, "effort", of_rate=kind == "VELOCITY", gains=None if kind == "EFFORT"
                           else PidGains(gain("p_gain", 0.1), gain("i_gain", 0.0),
                                         gain("d_gain", 0.0), -abs(gain("i_min", 0.0)),
                                         abs(gain("i_max", 0.0))),
                           most_effort=most if most > 0.0 and kind != "EFFORT" else math.inf)
        said = p.attribute("channel") or p.attribute("id")
        turning = p.text("turningDirection")
        multiplier = _TURNS[turning] if turning in _TURNS else p.number("turningDirection", 1.0)
        return Channel(int(said) if said.isdigit() else number, self.context.joint(
            p.text("jointName")), kind, p.flag("useForce", True),
            p.number("multiplier", multiplier), p.number("offset", 0.0),
            p.number("rotorVelocitySlowdownSim", 1.0) or 1.0, servo)

    def _find_imu(self, name: str) -> None:
        """Find the sensor by its name, below the model of the plugin or with the scopes above."""
        imus = {f"{link}::{sensor.name}": (link, sensor) for link, sensor in self.context.sensors()
                if sensor.type == "imu"}
        found = imus.get(self._scope_sensor(name)) or next(
            (imu for own, imu in imus.items()
             if name in (imu[1].name, own) or name.endswith(f"::{own}")), None)
        if found is None:
            raise PluginError(f"the model has no sensor of type imu named '{name}'")
        self._imu = ImuMeter(self.context, self.context.link(found[0]), found[1].pose)

    def _scope_sensor(self, name: str) -> str:
        """The name of a sensor of the plugin's nested model in the outermost model; "" for none."""
        link, _, sensor = name.rpartition("::")
        try:
            return f"{self.context.scoped(link).partition('::')[2]}::{sensor}" if link else ""
        except PluginError:   # the name has the scopes above the plugin's model
            return ""

    def _listen(self, address: str, port: int) -> None:
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.setblocking(False)
        try:
            opened.bind((address, port))
        except (OSError, OverflowError) as fault:
            opened.close()
            raise PluginError(f"cannot listen to {address}:{port}: {fault}") from fault
        self._socket = opened

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()

    def reset(self) -> None:
        """Wait for the first packet of ArduPilot again."""
        self._wait_for_first()

    clock_set = reset

    # -- the connection --------------------------------------------------------------------------

    def _wait_for_first(self) -> None:
        self._misses = 0
        self._timer.set(self.context.every(_LOOK_HZ, self._await_packet))

    def _await_packet(self) -> None:
        """Follow ArduPilot from its first packet on."""
        floats = self._receive_packet(0.0)
        if floats is not None:
            self._imu.restart()
            self._timer.set(self.context.every(0.0, self._step))
            self._follow(floats)

    def _step(self) -> None:
        """Follow the command of this step, and answer with the state."""
        floats = self._receive_packet(_WAIT_S)
        if floats is None:
            self._misses += 1
            if self._misses > self._most_misses:
                self.context.warn("ArduPilot has stopped sending packets; the motors stop")
                self._drive([0.0] * (1 + max(one.number for one in self._channels)))
                self._wait_for_first()
            return
        self._follow(floats)

    def _follow(self, floats: List[float]) -> None:
        """Drive the joints, and answer with the state."""
        self._misses = 0
        self._drive(floats)
        assert self._socket is not None
        try:
            self._socket.sendto(self._state(), self._answer)
        except OSError as fault:   # no listener yet, or a full buffer: the next one counts
            self.context.info(f"a state was not sent to ArduPilot: {fault}")

    def _receive_packet(self, wait: float) -> Optional[List[float]]:
        """The last packet that has come, waiting `wait` s for one; None without one."""
        assert self._socket is not None
        if not select.select([self._socket], [], [], wait)[0]:
            return None
        packet = b""
        while select.select([self._socket], [], [], 0.0)[0]:
            packet = self._socket.recv(_PACKET_BYTES)
        count = len(packet) // 4
        found = list(struct.unpack(f"<{count}f", packet[:4 * count]))
        return found if all(map(math.isfinite, found)) else None

    # -- joints and state ------------------------------------------------------------------------

    def _drive(self, floats: List[float]) -> None:
        for channel in self._channels:
            if channel.number >= len(floats):
                self.context.warn(f"a packet of {len(floats)} floats has none for channel"
                                  f" {channel.number}")
                continue
            value = max(-1.0, min(1.0, floats[channel.number]))
            self._command(channel, channel.multiplier * (value + channel.offset))

    def _command(self, channel: Channel, value: float) -> None:
        if channel.by_effort or channel.kind == "EFFORT":
            if channel.kind == "VELOCITY":
                value /= channel.slowdown
            channel.joint.set_servo(replace(channel.servo, target=value))
        elif channel.kind == "VELOCITY":
            channel.joint.drive(value, _MOTOR_EFFORT)
        else:
            self.context.set_joint_positions({channel.joint.name: value})

    def _state(self) -> bytes:
        context, sample = self.context, self._imu.measure()
        pose = compose(inverse(self._to_ned), compose(context.pose, self._to_airplane))
        x, y, z, w = pose.orientation
        velocity = rotate(conjugate(self._to_ned.orientation), context.twist.linear)
        return _STATE.pack(context.now_ns * 1e-9, *sample.angular_velocity,
                           *sample.linear_acceleration, w, x, y, z, *velocity, *pose.position)
