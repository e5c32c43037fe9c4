"""The base class of controllers."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Sequence

from ...engine.drive_commands import PidGains
from ..context import CallHandle, Context, Handle, Publication
from ..finite_messages import subscribe_finite
from .hardware import Hardware, HardwareJoint
from .settings import Settings, offer_gains

INITIALIZED, RUNNING, STOPPED = "initialized", "running", "stopped"


class Controller:
    """A controller of some joints of one robot.

    `load` reads parameters and takes joints; `start` and `stop` are called when it is switched;
    calls that it schedules while running end with it. Raise PluginError for errors of the user.

    Attributes:
        name: below the namespace of the robot; topics and parameters are below it.
        context, hardware: of the robot.
        settings: its parameters.
        period: s between updates that the user has asked for; 0 for none.
        state: "initialized", "running" or "stopped".
        claimed: joints by interface.
        interface: for controllers of a package such as position_controllers.
    """

    interface = ""

    def __init__(self, name: str, context: Context, hardware: Hardware, period: float) -> None:
        self.name, self.context, self.hardware, self.period = name, context, hardware, period
        self.settings = Settings(context, name)
        self.state = INITIALIZED
        self.claimed: Dict[str, List[str]] = {}
        self._handles: List[Handle] = []
        self._timers: List[CallHandle] = []
        self._told = ""

    # -- for subclasses ----------------------------------------------------------------------------

    def load(self) -> None:
        """Read parameters, claim joints, advertise topics."""
        raise NotImplementedError

    def start(self) -> None:
        """Start the controller; it has claimed its joints."""

    def stop(self) -> None:
        """Stop the controller; its joints are released afterwards."""

    def update_hz(self, most: float) -> float:
        """Return the rate that the user has asked for, but at most `most`, Hz."""
        return min(most, 1.0 / self.period) if self.period else most

    def claim_joint(self, interface: str, name: str) -> HardwareJoint:
        """Claim a joint. Raises PluginError."""
        joint = self.hardware.joint(interface, name)
        self.claimed.setdefault(interface, []).append(name)
        return joint

    def publish(self, topic: str, kind: str, queue: int = 1, latch: bool = False) -> Publication:
        """Advertise a topic below the controller's name."""
        made = self.context.publish(f"{self.name}/{topic}", kind, queue, latch)
        self._handles.append(made)
        return made

    def subscribe(self, topic: str, kind: str, call: Callable[[Any], None],
                  checks: bool = False) -> None:
        """Subscribe to a topic below its name; warn of messages while it does not run.

        Messages with NaN or infinity are ignored, unless `call` itself checks its messages.
        """
        def receive(message: Any) -> None:
            if self.state == RUNNING:
                call(message)
            elif self._told != topic:
                self._told = topic
                self.context.warn(f"controller '{self.name}' is not running, and ignores messages"
                                  f" on {topic}")

        name = f"{self.name}/{topic}"
        self._handles.append(self.context.subscribe(name, kind, receive) if checks else
                             subscribe_finite(self.context, name, kind, receive))

    def serve(self, name: str, kind: str, call: Callable[[Any, Any], None]) -> None:
        """Advertise a service below the controller's name."""
        self._handles.append(self.context.serve(f"{self.name}/{name}", kind, call))

    def keep_handle(self, handle: Handle) -> None:
        """Store a handle to close when the controller is unloaded."""
        self._handles.append(handle)

    def offer_gains(self, path: str, joint: HardwareJoint, gains: PidGains,
                    changed: Callable[[PidGains], None] = lambda gains: None) -> None:
        """Let dynamic_reconfigure change gains below its name while a joint follows with them."""
        def apply(wanted: PidGains) -> None:
            changed(wanted)
            joint.retune(wanted)

        self.keep_handle(offer_gains(self.context, f"{self.name}/{path}", gains, apply))

    def every(self, hertz: float, call: Callable[[], None]) -> None:
        """Call a function at a rate in Hz of sim time while the controller runs."""
        self._timers.append(self.context.every(hertz, call))

    def observe(self, hertz: float, call: Callable[[], None],
                topics: Sequence[Publication] = (), **reads: Any) -> None:
        """Call a reading function at a rate while the controller runs; see `Context.observe`."""
        self._timers.append(self.context.observe(hertz, call, topics, **reads))

    def end_calls(self) -> None:
        for timer in self._timers:
            timer.end()
        self._timers = []

    # -- for the manager ---------------------------------------------------------------------------

    def switch_on(self) -> None:
        self.state, self._told = RUNNING, ""
        for interface, names in self.claimed.items():
            for name in names:
                self.hardware.claim(interface, name)
        self.start()

    def switch_off(self) -> None:
        """Stop the controller and release its joints."""
        self.end_calls()
        self.stop()
        self.state = STOPPED
        for names in self.claimed.values():
            for name in names:
                self.hardware.release(name)

    def close(self) -> None:
        """Remove the controller from the ROS graph."""
        for handle in self._handles:
            handle.close()
        self._handles = []
