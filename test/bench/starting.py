"""How long starts take: of the node to its first message, of short commands to the next prompt.

A first start of a world with concave meshes that move is one without cached convex parts.
"""
from __future__ import annotations

import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import List, Tuple

from clock import Clock
from server import Server, end, wait

PAIRS = 7
WHEELS = 8   # cog wheels of 5, 6, ... teeth, none of them equal
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


def divisions() -> Tuple[Pairs, float]:
    """First starts beside starts with known parts, s, and processor seconds of a mesh's division.

    The world has `WHEELS` concave meshes that move.
    """
    found, processor = [], []
    for _ in range(3):
        with tempfile.TemporaryDirectory() as folder:
            world = _cog_wheels(folder)
            starts = []
            for _ in range(2):
                clock = Clock()
                with Server(world, environment={"XDG_CACHE_HOME": folder}) as server:
                    wait(lambda c=clock: c.first, 300, "/clock")
                    starts.append(clock.first - server.started)
                    processor.append(_of_ended_children(server.process.pid))
                clock.close()
            found.append((starts[0], starts[1]))
    return found, (statistics.median(processor[::2]) - statistics.median(processor[1::2])) / WHEELS


def _of_ended_children(pid: int) -> float:
    """Processor seconds of the children of a process that have ended."""
    with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as stream:
        fields = stream.read().rpartition(")")[2].split()
    return (int(fields[13]) + int(fields[14])) / os.sysconf("SC_CLK_TCK")


def _cog_wheels(folder: str) -> str:
    """A world of cog wheels, whose meshes are written to the folder."""
    models = ""
    for n in range(WHEELS):
        count = 4 * (n + 5)  # corners of the outline: two far, two near, and so on
        outline = [((0.5, 0.5, 0.35, 0.35)[k % 4], 2.0 * math.pi * k / count)
                   for k in range(count)]
        rows = [f"v 0 0 {z}" for z in (0, 0.2)]
        rows += [f"v {r * math.cos(turn)} {r * math.sin(turn)} {z}"
                 for r, turn in outline for z in (0, 0.2)]
        for k in range(count):
            a, b = 2 * k + 3, 2 * ((k + 1) % count) + 3
            rows += [f"f 1 {b} {a}", f"f 2 {a + 1} {b + 1}", f"f {a} {b} {b + 1}",
                     f"f {a} {b + 1} {a + 1}"]
        path = os.path.join(folder, f"wheel_{n}.obj")
        with open(path, "w", encoding="ascii") as stream:
            stream.write("\n".join(rows) + "\n")
        models += f"""<model name='wheel_{n}'><pose>{2 * n} 0 0.01 0 0 0</pose><link name='link'>
          <collision name='c'><geometry><mesh><uri>file://{path}</uri></mesh></geometry>
          </collision></link></model>"""
    return f"""<?xml version='1.0'?><sdf version='1.6'><world name='default'>
      <include><uri>model://ground_plane</uri></include>{models}</world></sdf>"""


def _seconds(command: List[str]) -> float:
    began = time.perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def ratio(pairs: Pairs) -> float:
    return statistics.median(mine / bare for mine, bare in pairs)


def shown(pairs: Pairs) -> str:
    """Medians, and the ratio with its spread."""
    ratios = [mine / bare for mine, bare in pairs]
    mine, bare = (statistics.median(values) for values in zip(*pairs))
    return (f"{mine:.2f} s = {ratio(pairs):.2f} ({min(ratios):.2f} to {max(ratios):.2f}) times"
            f" {bare:.2f} s")
