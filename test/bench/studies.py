#!/usr/bin/env python3
"""Prints what studies cost. Needs no ROS.

usage: studies.py [ROW …]   rows: cost plan poison dask (default: cost plan)

`cost` compares the processor time, engines included, of a study in two slots with two processes
that each open one world after the other in a kept engine; the results must be equal.
`poison` ends the engine of every fiftieth of 1000 cases in each attempt.
`dask` compares the processor time of more cases, all processes included, on a cluster of one worker
with two threads and in two slots of one machine; what starts once is not in it.
"""
from __future__ import annotations

import collections
import contextlib
import io
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from typing import Dict, Iterator, List

from my_simulations.python_api import OpenWorld
from my_simulations.studies.case_world import world_choice_of
from my_simulations.studies.command import main
from my_simulations.studies.plan import Case, CasePlan
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
        choice, _ = world_choice_of(plan, case)
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


def poison() -> None:
    def kill(case: Case, attempt: int, world: OpenWorld) -> None:
        if case.index % 50 == 7:
            os.kill(world.simulator.engine_pid, signal.SIGSEGV)

    with tempfile.TemporaryDirectory() as folder:
        path, out = write(folder, SHORT), os.path.join(folder, "out")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            began = time.monotonic()
            main(["study", "run", path, "--slots", "2", "--out", out], hook=kill)
            took = time.monotonic() - began
        rows = list(rows_in_order([os.path.join(out, "journal.jsonl")]))
        counts = collections.Counter(row.status for row in rows)
        hashes: Dict[str, str] = {}
        for part in "01":
            told = subprocess.run([sys.executable, __file__, "--bare", path, part], check=True,
                                  stdout=subprocess.PIPE, text=True).stdout
            hashes.update(line.split()[:2] for line in told.splitlines())
        equal = sum(row.hash == hashes[row.case] for row in rows if row.status == "ok")
        print(f"{len(rows)} worlds, 20 of them poisoned, two slots: {dict(counts)}, {equal} hashes"
              f" equal to those of two bare loops, {took:.0f} s"
              " (bar: 980 ok, 20 crashed, all equal)")


def dask() -> None:
    spent: Dict[str, List[float]] = {"here": [], "dask": []}
    for count in (500, 3000):
        with tempfile.TemporaryDirectory() as folder:
            path = write(folder, SHORT.replace(f"count: {CASES}", f"count: {count}"))
            command = [sys.executable, "-m", "my_simulations.studies", "run", path, "--out"]
            before = processor_of_children()
            subprocess.run([*command, os.path.join(folder, "here"), "--slots", "2"], check=True,
                           capture_output=True)
            spent["here"].append(processor_of_children() - before)
            before = processor_of_children()
            with local_cluster(folder) as options:
                subprocess.run([*command, os.path.join(folder, "dask"), *options], check=True,
                               capture_output=True)
            spent["dask"].append(processor_of_children() - before)
            tables = []
            for name in ("here", "dask"):
                with open(os.path.join(folder, name, "results.csv")) as stream:
                    tables.append(stream.read())
            assert tables[0] == tables[1]
    more = {name: values[1] - values[0] for name, values in spent.items()}
    print(f"2500 more short worlds, equal tables: two slots {more['here']:.1f} s, Dask"
          f" {more['dask']:.1f} s of processor time:"
          f" {(more['dask'] / more['here'] - 1) * 100:+.1f} % (bar: +5 %); what starts once:"
          f" {spent['here'][0] - more['here'] / 5:.1f} and"
          f" {spent['dask'][0] - more['dask'] / 5:.1f} s")


@contextlib.contextmanager
def local_cluster(folder: str) -> Iterator[List[str]]:
    """A scheduler and a worker of two threads; yields what names them to `study run`."""
    new = "req -newkey rsa:2048 -nodes"
    for words in (f"{new} -x509 -days 1 -subj /CN=a -keyout ca.key -out ca.pem",
                  f"{new} -subj /CN=s -keyout s.key -out s.csr",
                  "x509 -req -in s.csr -CA ca.pem -CAkey ca.key -CAcreateserial -out s.pem"):
        subprocess.run(["openssl", *words.split()], cwd=folder, check=True, capture_output=True)
    tls = ["--tls-ca-file", "ca.pem", "--tls-cert", "s.pem", "--tls-key", "s.key"]
    scheduler = os.path.join(folder, "scheduler.json")
    started = [subprocess.Popen(
        [sys.executable, "-m", f"distributed.cli.dask_{kind}", "--no-dashboard", "--host",
         "127.0.0.1", "--scheduler-file", scheduler, *words, *tls], cwd=folder,
        stderr=subprocess.DEVNULL) for kind, words in (
            ("scheduler", ["--protocol", "tls", "--port", "0"]),
            ("worker", ["--no-nanny", "--nthreads", "2"]))]
    try:
        while not os.path.exists(scheduler):
            time.sleep(0.05)
        yield ["--on", f"dask:{scheduler}", "--tls-ca", os.path.join(folder, "ca.pem"),
               "--tls-cert", os.path.join(folder, "s.pem"),
               "--tls-key", os.path.join(folder, "s.key")]
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()


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
            {"cost": cost, "plan": plan, "poison": poison, "dask": dask}[row]()
