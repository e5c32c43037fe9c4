#!/usr/bin/env python3
"""Prints what studies cost. Needs no ROS.

usage: studies.py [ROW …]   rows: cost plan (default: all)

`cost` compares the processor time, engines included, of a study in two slots with two processes
that each open one world after the other in a kept engine; the results must be equal.
"""
from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from typing import Dict, List

from my_simulations.python_api import OpenWorld
from my_simulations.studies.case_world import choice_of
from my_simulations.studies.plan import CasePlan
from my_simulations.studies.slot import final_hash
from my_simulations.studies.study_file import read_study
from my_simulations.studies.table import rows_in_order

CASES = 1000
MODEL = """<sdf version="1.7"><model name="box"><link name="link">
<inertial><mass>1</mass><inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
</inertial><collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
</collision></link></model></sdf>"""
SHORT = f"""models:
  box: {{file: box.sdf, pose: [0, 0, 1]}}
duration: 0.5
vary:
  height: {{set: pose.box.z, range: {{from: 0.2, to: 0.6, count: {CASES}}}}}
measure:
  rest: final(pose.box.z)
"""
MILLION = """duration: 1
seeds: 1000
vary:
  height: {set: pose.box.z, range: {from: 0, to: 1, count: 100}}
  mu: {set: friction.box, uniform: [0, 1], samples: 10}
"""


def write(folder: str, text: str) -> str:
    with open(os.path.join(folder, "box.sdf"), "w") as stream:
        stream.write(MODEL)
    path = os.path.join(folder, "s.yaml")
    with open(path, "w") as stream:
        stream.write(text)
    return path


def bare(path: str, part: int) -> None:
    """Every second case, in one kept engine; prints the hash of each."""
    plan = CasePlan(read_study(path)[0])
    world = None
    for case in list(plan.cases())[part::2]:
        choice, _ = choice_of(plan, case)
        if world is None:
            world = OpenWorld(choice)
        else:
            world.open(choice)
        world.step(round(plan.study.duration / world.step_size))
        print(case.id, final_hash(world), world.states().pose["box"][2])
    if world is not None:
        world.close()


def processor_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def cost() -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = write(folder, SHORT)
        spent: Dict[str, List[float]] = {"bare": [], "study": []}
        hashes: Dict[str, str] = {}
        for turn in range(2):
            before = processor_of_children()
            loops = [subprocess.Popen([sys.executable, __file__, "--bare", path, part],
                                      stdout=subprocess.PIPE, text=True) for part in "01"]
            for loop in loops:
                out, _ = loop.communicate()
                hashes.update(line.split()[:2] for line in out.splitlines())
            spent["bare"].append(processor_of_children() - before)
            before = processor_of_children()
            out = os.path.join(folder, f"out{turn}")
            subprocess.run([sys.executable, "-m", "my_simulations.studies", "run", path, "--slots",
                            "2", "--out", out], check=True, capture_output=True)
            spent["study"].append(processor_of_children() - before)
            found = {row.case: row.hash
                     for row in rows_in_order([os.path.join(out, "journal.jsonl")])}
            assert found == hashes and len(found) == CASES
        best = {name: min(values) for name, values in spent.items()}
        print(f"{CASES} short worlds, equal hashes: two bare loops {best['bare']:.1f} s, study in"
              f" two slots {best['study']:.1f} s of processor time:"
              f" {(best['study'] / best['bare'] - 1) * 100:+.1f} % (bar: +5 %)")


def plan() -> None:
    with tempfile.TemporaryDirectory() as folder:
        cases = CasePlan(read_study(write(folder, MILLION))[0])
        began = time.process_time()
        count = sum(1 for _ in cases.cases())
        took = time.process_time() - began
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"planning {count} cases: {took:.1f} s, {memory:.0f} MiB (bar: 60 s, 500 MB)")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--bare"]:
        bare(sys.argv[2], int(sys.argv[3]))
    else:
        for row in sys.argv[1:] or ["cost", "plan"]:
            {"cost": cost, "plan": plan}[row]()
