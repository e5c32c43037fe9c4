"""Measures real-time factors of the node at full speed and of bare PyBullet alternately.

Both keep their world loaded; one is paused while the other is measured. So the two measurements of
a pair are a second or two apart, and other load of the machine affects both.
"""
from __future__ import annotations

import statistics
import subprocess
import sys
from types import TracebackType
from typing import List, NamedTuple, Optional, Type

import scenes
from clock import Clock
from server import Server, end, processor, wait

PAIRS = 7
SECONDS = 1.0


class Factors(NamedTuple):
    """Sim seconds a second of wall time, and of the stepping process's processor time."""

    wall: float
    busy: float


class Bare:
    """PyBullet alone with the same bodies, in a process of its own. A context manager."""

    def __init__(self, kind: str, count: int, sleeping: bool) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__.rsplit("/", 1)[0] + "/bare.py", kind, str(count),
             str(int(sleeping))], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL, text=True)
        self.factors(0.1)

    def factors(self, seconds: float) -> Factors:
        """Make steps for so many seconds of wall time."""
        assert self._process.stdin is not None and self._process.stdout is not None
        print(seconds, file=self._process.stdin, flush=True)
        wall, busy = map(float, self._process.stdout.readline().split())
        return Factors(0.001 * wall, 0.001 * busy)

    def __enter__(self) -> "Bare":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], fault: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        end(self._process)
        self._process.stdout.close()


class Pace(NamedTuple):
    """Factors by pairs, and whether all boxes stand where they were put."""

    ours: List[Factors]
    bare: List[Factors]
    stand: bool

    @property
    def factor(self) -> float:
        """Our median by wall time."""
        return statistics.median(one.wall for one in self.ours)

    @property
    def ratios(self) -> List[float]:
        """Ours of bare, pair by pair, by wall time."""
        return [mine.wall / alone.wall for mine, alone in zip(self.ours, self.bare)]

    @property
    def by_processor(self) -> float:
        """The median of the ratios by the engine's processor time, which a busy machine leaves."""
        return statistics.median(mine.busy / alone.busy
                                 for mine, alone in zip(self.ours, self.bare))

    @property
    def ratio(self) -> float:
        """The median of the pairs' ratios."""
        return statistics.median(self.ratios)

    def __str__(self) -> str:
        alone = statistics.median(one.wall for one in self.bare)
        return (f"{self.factor:.3g} = {self.ratio:.2f} ({min(self.ratios):.2f} to "
                f"{max(self.ratios):.2f}) of bare {alone:.3g}, {self.by_processor:.2f} by processor"
                + ("" if self.stand else ", FALLEN"))


def measured(kind: str, count: int, sleeping: bool) -> Pace:
    """The pace of boxes; the node publishes `/clock` to a subscriber."""
    import rospy
    from gazebo_msgs.srv import GetModelState
    from std_srvs.srv import Empty
    clock = Clock()
    ours, alone = [], []
    with Server(scenes.world(kind, count, sleeping, 0.0)) as server, \
            Bare(kind, count, sleeping) as bare:
        rospy.wait_for_service("/gazebo/get_world_properties", 60)
        pause, go_on = (rospy.ServiceProxy(f"/gazebo/{what}_physics", Empty, persistent=True)
                        for what in ("pause", "unpause"))
        wait(lambda: clock.sim > (4.0 if sleeping else 1.5), 120, "settled world")
        for _ in range(PAIRS):
            pause()
            alone.append(bare.factors(SECONDS))
            heard = clock.count
            go_on()
            wait(lambda heard=heard: clock.count > heard + 1, 60, "steps")
            engine, sim = server.pids()[1:2], clock.sim
            busy = processor(engine)
            wall = clock.factor(SECONDS)
            ours.append(Factors(wall, (clock.sim - sim) / max(processor(engine) - busy, 0.01)))
        pause()
        get = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState, persistent=True)
        stand = all(abs(get(f"b{n}", "").pose.position.z - at[2]) < 0.05
                    for n, at in enumerate(scenes.positions(kind, count)))
    clock.close()
    return Pace(ours, alone, stand)
