"""Real-time factors of the node at full speed beside bare PyBullet, in turns.

Both hold their world ready; one stands while the other is measured. So a pair is a second or two
apart, and what else the machine does at that time meets both.
"""
from __future__ import annotations

import statistics
import subprocess
import sys
from types import TracebackType
from typing import List, NamedTuple, Optional, Type

import scenes
from clock import Clock
from server import Server, end, wait

PAIRS = 7
SECONDS = 1.0


class Bare:
    """PyBullet alone with the same bodies, in a process of its own. A context manager."""

    def __init__(self, kind: str, count: int, sleeping: bool) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__.rsplit("/", 1)[0] + "/bare.py", kind, str(count),
             str(int(sleeping))], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True)
        self.factor(0.1)

    def factor(self, seconds: float) -> float:
        """Sim seconds a second of wall time, over so many of these."""
        assert self._process.stdin is not None and self._process.stdout is not None
        print(seconds, file=self._process.stdin, flush=True)
        return 0.001 * float(self._process.stdout.readline())

    def __enter__(self) -> "Bare":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], fault: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        end(self._process)
        self._process.stdout.close()


class Pace(NamedTuple):
    """Real-time factors by pairs, and whether all boxes stand where they were put."""

    ours: List[float]
    bare: List[float]
    stand: bool

    @property
    def ratios(self) -> List[float]:
        """Ours of bare, pair by pair."""
        return [mine / alone for mine, alone in zip(self.ours, self.bare)]

    @property
    def ratio(self) -> float:
        """The median of the pairs' ratios."""
        return statistics.median(self.ratios)

    def __str__(self) -> str:
        return (f"{statistics.median(self.ours):.3g} = {self.ratio:.2f} ({min(self.ratios):.2f} to "
                f"{max(self.ratios):.2f}) of bare {statistics.median(self.bare):.3g}"
                + ("" if self.stand else ", FALLEN"))


def measured(kind: str, count: int, sleeping: bool) -> Pace:
    """The pace of boxes; the node publishes `/clock` to a subscriber."""
    import rospy
    from gazebo_msgs.srv import GetModelState
    from std_srvs.srv import Empty
    clock = Clock()
    ours, alone = [], []
    with Server(scenes.world(kind, count, sleeping, 0.0)), Bare(kind, count, sleeping) as bare:
        rospy.wait_for_service("/gazebo/get_world_properties", 60)
        pause, go_on = (rospy.ServiceProxy(f"/gazebo/{what}_physics", Empty, persistent=True)
                        for what in ("pause", "unpause"))
        wait(lambda: clock.sim > (4.0 if sleeping else 0.3), 120, "settled world")
        for _ in range(PAIRS):
            pause()
            alone.append(bare.factor(SECONDS))
            heard = clock.count
            go_on()
            wait(lambda heard=heard: clock.count > heard + 1, 60, "steps")
            ours.append(clock.factor(SECONDS))
        pause()
        get = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState, persistent=True)
        stand = all(abs(get(f"b{n}", "").pose.position.z - at[2]) < 0.05
                    for n, at in enumerate(scenes.positions(kind, count)))
    clock.close()
    return Pace(ours, alone, stand)
