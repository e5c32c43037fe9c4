"""The ROS graph of a submission: a master, the world as the node /gazebo, and the program."""
from __future__ import annotations

import os
import socket
import subprocess
import time
from typing import List, Optional

from ..child_process import child_command, child_environment, wait_or_kill
from ..editor.topic_source import TopicSource
from ..python_api import OpenWorld
from ..resources.resolver import Resolver
from ..ros.lifecycle import master_api
from .assignment import Assignment, ServiceAnswer, Timed, TopicRate
from .held_notices import HeldNotices
from .lockstep import Lockstep
from .mark import CheckResult, GradingError, score_check
from .misnamed_topics import misnamed_topics
from .program import Program

_MASTER_S = 60.0
_CALLER = "/grade"
_POLL_S = 0.05
_UPKEEP_S = 1.0
_PLUGINS_S = 30.0     # wall time
_STEP_S = 0.01        # sim time between two looks at the program, at most
_RATE_SHARE = 0.9     # of the wanted rate: a node needs some time to start


class RosGraph:
    """A world with a program that controls it.

    Args:
        assignment: the assignment.
        world: the open world.
        resolver: finds its files.

    Raises:
        GradingError: the master does not start.
    """

    def __init__(self, assignment: Assignment, world: OpenWorld, resolver: Resolver) -> None:
        self._assignment = assignment
        self._world = world
        self._notices = HeldNotices()
        self.uri, self._master = start_master(self._notices)
        os.environ.update(graph_environment(self.uri))
        from ..ros.attached_node import AttachedNode  # rospy: only programs need it

        self._node = AttachedNode(world.simulator, resolver, self.uri, assignment.may_change_world)
        self._upkeep = time.monotonic()
        self._program: Optional[Program] = None
        self._lockstep: Optional[Lockstep] = None
        self.misnamed: List[str] = []
        """Notes on topics of the program that resemble topics of the world."""

    def run(self, program: Program) -> None:
        """Take a program that has just been started."""
        for check in self._assignment.of(TopicRate):
            self._node.watch(check.topic)
        for check in self._assignment.of(ServiceAnswer):
            self._node.call(check.service, check.type_name)
        self._program = program
        self._lockstep = Lockstep(program, os.getpid(),
                                  self._assignment.limits.processor_seconds,
                                  self._notices.permit)
        self._lockstep.start(lambda: self._world.step(1))

    def step(self, steps: int) -> None:
        """Make steps, then wait until the program has done what follows from them.

        It is stopped during the steps: else the step at which a command takes effect would depend
        on how soon the program has got the messages of the steps before it.
        """
        size = self._world.step_size
        at_once = max(1, round(_STEP_S / size))
        while steps > 0:
            count = min(steps, at_once)
            steps -= count
            if self._program is None or self._lockstep is None:
                self._world.step(count)
                continue
            with self._program.suspended():
                self._world.step(count)
                # Else the pace of their thread would decide in which step a message is sent.
                self._node.wait_for_plugins(_PLUGINS_S)
            self._lockstep.wait(count * size)
        if time.monotonic() > self._upkeep + _UPKEEP_S:
            self._upkeep = time.monotonic()
            self._node.refresh()
            self.look_for_misnamed_topics()

    def look_for_misnamed_topics(self) -> None:
        """Set `misnamed` to the topics that the program uses now; those of before stay, if none."""
        try:
            publishers, subscribers, _ = master_api.call(self.uri, "getSystemState", _CALLER)
        except OSError:
            return
        self.misnamed = misnamed_topics(publishers, subscribers) or self.misnamed

    @property
    def topics(self) -> TopicSource:
        found: TopicSource = self._node.topics
        return found

    @property
    def refused(self) -> str:
        """What the program tried that the assignment does not permit; "" for nothing."""
        names = ", ".join(f"/gazebo/{name}" for name in self._node.refused)
        return f"the program used {names}, which the assignment does not permit" if names else ""

    @property
    def busy(self) -> str:
        """That the program is an endless loop; "" if it waits for the world."""
        if self._lockstep is None or not self._lockstep.never_waits:
            return ""
        return ("the program computes without a pause, such as an endless loop without rospy.sleep"
                " or rospy.Rate")

    def result(self, check: Timed) -> CheckResult:
        """Decide a check of a topic or service."""
        if isinstance(check, TopicRate):
            return self._rate(check)
        if isinstance(check, ServiceAnswer):
            return self._answer(check)
        raise TypeError(type(check).__name__)

    def _rate(self, check: TopicRate) -> CheckResult:
        count, kind = self._node.message_count(check.topic)
        rate = count / check.within if check.within > 0.0 else float(count)
        if not count:
            return score_check(check, 0.0, self._with_end(f"{check.topic} has no messages"))
        if check.type_name and kind != check.type_name:
            return score_check(check, 0.0, f"{check.topic} has messages of the type {kind}, not"
                                      f" {check.type_name}")
        if rate < _RATE_SHARE * check.rate:
            return score_check(check, 0.0, self._with_end(
                f"{check.topic} has {rate:.1f} messages a second, {check.rate:g} are needed"))
        return score_check(check, 1.0)

    def _answer(self, check: ServiceAnswer) -> CheckResult:
        answer = self._node.call_result(check.service)
        if answer is None:
            reason = (f"the service {check.service} did not answer within {check.within:g} s"
                      if self._offers(check.service)
                      else f"no node offers the service {check.service}")
            return score_check(check, 0.0, self._with_end(reason))
        if answer:
            return score_check(check, 0.0, f"the service {check.service} failed: {answer}")
        return score_check(check, 1.0)

    def _offers(self, service: str) -> bool:
        """Whether a node of the graph offers a service."""
        try:
            return bool(master_api.call(self.uri, "lookupService", _CALLER, service))
        except OSError:
            return False

    def _with_end(self, reason: str) -> str:
        end = self._program.why_ended() if self._program is not None else ""
        return f"{reason}; {end}" if end else reason

    def close(self) -> None:
        """End node and master."""
        if self._lockstep is not None:
            self._lockstep.close()
        self._node.close()
        self._master.terminate()
        wait_or_kill(self._master, _MASTER_S)
        self._notices.close()


def graph_environment(uri: str) -> "dict[str, str]":
    """Variables of the nodes of a master."""
    return {"ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1", "ROS_HOSTNAME": "127.0.0.1"}


def start_master(notices: Optional[HeldNotices] = None
                 ) -> "tuple[str, subprocess.Popen[bytes]]":
    """Start a ROS master on a free port; returns its URI and process.

    `notices` permits its notices of publishers; None to send them at once. Raises GradingError.
    """
    port = free_port()
    held = () if notices is None else notices.descriptors
    hold = ["--hold", *map(str, held)] if held else []
    process = subprocess.Popen(
        child_command("grading.prompt_master", *hold, "--core", "-p", str(port)),
        env=child_environment(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL, pass_fds=held)
    until = time.monotonic() + _MASTER_S
    while time.monotonic() < until and process.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return f"http://127.0.0.1:{port}/", process
        time.sleep(_POLL_S)
    process.kill()
    raise GradingError("the ROS master did not start; source the setup.bash of your workspace")


def free_port() -> int:
    """A TCP port that is free now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
