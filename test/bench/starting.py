"""How long starts take: of the node to its first message, of short commands to the next prompt."""
from __future__ import annotations

import statistics
import subprocess
import sys
import time
from typing import List, Tuple

from clock import Clock
from server import Server, end, wait

PAIRS = 7
OBJECT = "MY_OBJECT"
Pairs = List[Tuple[float, float]]


def first_messages(world: str) -> Pairs:
    """Seconds to the first /clock of the node, and to the first message of a bare rospy node."""
    found = []
    for _ in range(PAIRS):
        clock = Clock()
        with Server(world) as server:
            wait(lambda c=clock: c.first, 30, "/clock")
            mine = clock.first - server.started
        clock.close()
        found.append((mine, _bare_node()))
    return found


def _bare_node() -> float:
    clock = Clock("/bare_clock")
    started = time.perf_counter()
    process = subprocess.Popen([sys.executable, __file__.rsplit("/", 1)[0] + "/bare_node.py"],
                               stdout=subprocess.DEVNULL)
    try:
        wait(lambda: clock.first, 30, "/bare_clock")
        return clock.first - started
    finally:
        end(process)
        clock.close()


def prompts(world: str) -> Pairs:
    """Seconds of `spawn_object.py MY_OBJECT` and of `python3 -c "import rospy"`, to their ends."""
    program = subprocess.run(["catkin_find", "--first-only", "--libexec", "my_simulations",
                              "spawn_object.py"], stdout=subprocess.PIPE, text=True, check=True)
    found = []
    with Server(world):
        import rospy
        from gazebo_msgs.srv import DeleteModel
        rospy.wait_for_service("/gazebo/delete_model", 30)
        delete = rospy.ServiceProxy("/gazebo/delete_model", DeleteModel)
        rospy.set_param("/objects", {OBJECT: {
            "model": f"my_simulations/objects/{OBJECT}.urdf", "position": [0, 0, 0],
            "orientation": [0, 0, 0]}})
        for _ in range(PAIRS):
            found.append((_seconds([program.stdout.strip(), OBJECT]),
                          _seconds([sys.executable, "-c", "import rospy"])))
            delete(OBJECT)
    return found


def _seconds(command: List[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def ratio(pairs: Pairs) -> float:
    """The median of the pairs' ratios."""
    return statistics.median(mine / bare for mine, bare in pairs)


def shown(pairs: Pairs) -> str:
    """Medians, and the ratio with its spread."""
    ratios = [mine / bare for mine, bare in pairs]
    mine, bare = (statistics.median(values) for values in zip(*pairs))
    return (f"{mine:.2f} s = {ratio(pairs):.2f} ({min(ratios):.2f} to {max(ratios):.2f}) times"
            f" {bare:.2f} s")
