"""Machines without disk, memory, processor or a right clock: told, harmless, and over with them."""
from __future__ import annotations

import ast
import asyncio
import json
import os
import resource
import signal
import time
from pathlib import Path

import pytest
from editor_case import Case, Refused, box
from ledger import Client, agree, floating
from proofs import scaled
from scarce import Disk, starved
from waiting import until

import my_simulations
from my_simulations.errors import CommandError
from my_simulations.formats.reading import read_world
from my_simulations.geometry import STILL, Pose
from my_simulations.resources.resolver import Resolver
from my_simulations.simulator import supervisor
from my_simulations.simulator.saving import save_world

DISKS = {"full": Disk.full, "read-only": Disk.read_only}


@pytest.fixture
def disk(tmp_path):
    made = Disk(str(tmp_path / "disk"))
    yield made
    made.close()


def names(path):
    return sorted(model.name for model in read_world(path, Resolver()).world.models)


@pytest.mark.parametrize("fault", DISKS)
def test_a_world_that_cannot_be_written_keeps_its_old_file(disk, fault, record):
    simulator = floating(box("first"))
    path, refused = os.path.join(disk.folder, "kept.world"), 0
    try:
        save_world(simulator, path, roots=[disk.folder])
        old = Path(path).read_bytes()
        with DISKS[fault](disk):
            for n in range(scaled(5, 200)):
                # Enough models that no rest of the disk holds them.
                simulator.models.spawn(box(f"more{n}"), Pose((3.0 * n, 0.0, 0.0)))
                with pytest.raises(CommandError, match="cannot write .*kept.world"):
                    save_world(simulator, path, roots=[disk.folder], overwrite=True)
                refused += 1
                assert Path(path).read_bytes() == old
            simulator.clock.advance(10)  # the world does not need a disk
        assert set(os.listdir(disk.folder)) == {"kept.world"}  # no unfinished files
        save_world(simulator, path, roots=[disk.folder], overwrite=True)
        assert names(path) == sorted(simulator.models.names())
    finally:
        simulator.close()
    record(f"{fault} disk: saving", refused=refused, lost=0, own_disk=disk.mounted)


@pytest.mark.parametrize("fault", DISKS)
def test_an_editor_whose_home_cannot_be_written_says_so_and_keeps_edits_later(
        disk, fault, record, tmp_path):
    home = Path(disk.folder) / "home"
    home.mkdir()
    case = Case(home, [box("a")])
    folder = home / "cache" / "autosave"

    def kept():
        found = [path for path in folder.glob("*.world") if "unit_box" in path.read_text()]
        return bool(found) and all(json.loads(path.read_text()) for path in folder.glob("*.json"))

    async def edit(browser):
        with DISKS[fault](disk):
            await browser.edit("insert", shape="sphere")
            with pytest.raises(Refused):
                await browser.ask("save", path="mine")
            await browser.until(lambda: any(
                push["type"] == "issue" and push["issue"]["code"] == "autosave"
                for push in browser.pushes))
            await browser.edit("insert", shape="cylinder")
            await browser.until(
                lambda: browser.model("unit_sphere") and browser.model("unit_cylinder"))
        await browser.edit("insert", shape="box")
        until = time.monotonic() + 60.0
        while not kept():
            assert time.monotonic() < until, "the autosave"
            await asyncio.sleep(0.02)
        await browser.ask("save", path="mine")

    try:
        case.browse(edit)
        assert {"a", "unit_box", "unit_cylinder", "unit_sphere"} == set(
            names(str(case.worlds / "mine.world")))
    finally:
        case.close()
    record(f"{fault} home: editor", edits=3, lost=0, own_disk=disk.mounted)


def test_an_engine_without_memory_is_replaced_and_loses_nothing(record, monkeypatch):
    monkeypatch.setattr(supervisor, "_RAPID_S", 0.0)
    simulator = floating(*[box(f"kept{n}", (3.0 * n, 0.0, 5.0)) for n in range(10)])
    rounds, refused = scaled(3, 60), 0
    try:
        for n in range(rounds):
            pid = simulator.engine_pid
            with open(f"/proc/{pid}/statm", encoding="ascii") as stream:
                used = int(stream.read().split()[0]) * resource.getpagesize()
            resource.prlimit(pid, resource.RLIMIT_AS, (used, used))
            there = sorted(simulator.models.names())
            for k in range(300):
                name = f"round{n}_{k}"
                try:
                    simulator.models.spawn(box(name), Pose((3.0 * k, 10.0 + n, 0.0)))
                except CommandError as refusal:
                    assert str(refusal)
                    refused += 1
                else:
                    there.append(name)
                if simulator.engine_pid != pid:
                    break
            if simulator.engine_pid == pid:  # the engine survived the limit
                resource.prlimit(pid, resource.RLIMIT_AS, (used, used))
                os.kill(pid, signal.SIGKILL)
                until(lambda gone=pid: simulator.engine_pid not in (gone, 0), "another engine")
            assert sorted(simulator.models.names()) == sorted(there)
            simulator.states.set_model_state("kept0", Pose((0.0, 0.0, 5.0 + n)), STILL)
            assert simulator.states.model_state("kept0")[0].position[2] == pytest.approx(5.0 + n)
            for name in simulator.models.names():
                if name.startswith("round"):
                    simulator.models.delete(name)
    finally:
        simulator.close()
    record("engine without memory", rounds=rounds, refused=refused, lost=0)


WALL_CLOCK = {
    "editor/library/autosave.py": "when changes were kept, for people, and how long they are kept",
    "editor/transport/hub.py": "when an issue was shown, for people",
    "engine/convex/cache.py": "age of unfinished files",
}
"""Modules that ask for the time of day, and what for: nothing that runs depends on it."""


def test_nothing_that_runs_depends_on_the_time_of_day():
    root = Path(my_simulations.__file__).parent
    asking = set()
    for path in root.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute) and (
                    isinstance(node.value, ast.Name)
                    and (node.value.id, node.attr) in {("time", "time"), ("datetime", "now"),
                                                       ("datetime", "utcnow"), ("date", "today")}):
                asking.add(path.relative_to(root).as_posix())
    assert asking == set(WALL_CLOCK)


def test_a_clock_that_jumps_changes_nothing(record, monkeypatch):
    simulator = floating(box("a"))
    real, shift = time.time, [0.0]
    monkeypatch.setattr(time, "time", lambda: real() + shift[0])
    monkeypatch.setattr(time, "time_ns", lambda: int((real() + shift[0]) * 1e9))
    client = Client(simulator, 0, 20)
    jumps = scaled(20, 2000)
    try:
        pid = simulator.engine_pid
        client.start()
        for n in range(jumps):
            shift[0] = (-1) ** n * 10.0 ** (n % 9)
            done = client.done
            until(lambda before=done: client.done > before, "an answer after a jump")
        client.stop()
        assert client.wrong == []
        models = agree_with_box(simulator, client)
        assert simulator.engine_pid == pid
    finally:
        simulator.close()
    record("clock jumps", jumps=jumps, operations=client.done, models=models, wrong=0)


def agree_with_box(simulator, client):
    simulator.models.delete("a")
    return agree(simulator, [client])


def test_a_starved_machine_is_slow_and_loses_nothing(record):
    simulator = floating()
    clients = [Client(simulator, number, 10) for number in range(3)]
    seconds, loops = scaled(6, 600), 8 * (os.cpu_count() or 1)
    try:
        pid = simulator.engine_pid
        os.setpriority(os.PRIO_PROCESS, pid, 19)
        with starved(loops):
            for client in clients:
                client.start()
            end = time.monotonic() + seconds
            stops = 0
            while time.monotonic() < end:
                os.kill(pid, signal.SIGSTOP)
                time.sleep(0.3)
                os.kill(pid, signal.SIGCONT)
                time.sleep(0.3)
                stops += 1
            done = sum(client.done for client in clients)
            until(lambda: sum(client.done for client in clients) > done, "an answer")
        for client in clients:
            client.stop()
        assert [wrong for client in clients for wrong in client.wrong] == []
        models = agree(simulator, clients)
        assert simulator.engine_pid == pid  # no healthy engine was ended
    finally:
        simulator.close()
    record("starved machine", busy_processes=loops, stops=stops, models=models, wrong=0,
           operations=sum(client.done for client in clients))
