#!/usr/bin/env python3
"""Prints how long spawn_object.py and remove_object.py take with 500 objects.

usage: object_tools.py        in a shell that has sourced the workspace, on a quiet machine
"""
from __future__ import annotations

import subprocess
import sys
import time
from typing import List, Tuple

import scenes
from server import Server, master, wait

COUNT = 500
FILES = ("ball.urdf", "MY_OBJECT.urdf", "lab_table.urdf", "crate.urdf.xacro", "barrel.sdf")


def listed(files: Tuple[str, ...]) -> dict:
    """An object list of the files by turns, on a grid with 2 m between."""
    return {f"object_{n}": {"model": f"my_simulations/objects/{files[n % len(files)]}",
                            "position": [2.0 * (n % 25), 2.0 * (n // 25), 0.0],
                            "orientation": [0, 0, 0]} for n in range(COUNT)}


def timed(words: List[str]) -> float:
    """Seconds that a tool took; it must end well."""
    began = time.perf_counter()
    subprocess.run(["rosrun", "my_simulations", *words], stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def main() -> int:
    with master() as uri, Server(scenes.world("boxes", 0, True, 1000.0)):
        from xmlrpc.client import ServerProxy
        parameters = ServerProxy(uri)
        wait(lambda: parameters.lookupService("/bench", "/gazebo/spawn_urdf_model")[0] == 1, 30,
             "simulator")
        for what, files in (("of one file", FILES[:1]), ("of five files, xacro among them", FILES)):
            parameters.setParam("/bench", "/objects", listed(files))
            for tool in ("spawn_object.py", "spawn_object.py", "remove_object.py"):
                took = timed([tool, "all"])
                print(f"{tool}, {COUNT} objects {what}: {took:.2f} s (bar 5 s)", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
