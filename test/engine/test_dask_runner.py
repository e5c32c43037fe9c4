"""A run on a Dask cluster reports a lost scheduler, whichever call fails first."""
from __future__ import annotations

import asyncio
from concurrent.futures import CancelledError

import pytest

pytest.importorskip("distributed")

from my_simulations.errors import CommandError
from my_simulations.studies import dask_runner
from my_simulations.studies.cluster_address import TlsFiles
from my_simulations.studies.dask_runner import DaskRunner
from my_simulations.studies.plan import CasePlan
from my_simulations.studies.study_file import read_study

STUDY = """models:
  box: {file: box.sdf, pose: [0, 0, 1]}
duration: 0.1
vary:
  height: {set: pose.box.z, range: {from: 0.2, to: 0.6, count: 4}}
measure:
  rest: final(pose.box.z)
"""
WORKER = "tls://127.0.0.1:1"


class Recorder:
    def close(self):
        pass


class Future:
    """Of a task whose rows cannot be had any more: its result raises `fault`."""

    key, status = "task", "cancelled"

    def __init__(self, client, fault):
        self.client, self.fault = client, fault

    def add_done_callback(self, called):
        called(self)

    def cancel(self):
        raise AssertionError("a lost scheduler is asked nothing")

    def result(self, timeout):
        raise self.fault


class Client:
    """Loses its scheduler in the call `where`; `fault` is what that call raises."""

    def __init__(self, where, fault, status):
        self.where, self.fault, self.lost_status = where, fault, status
        self.status = "running"
        self.left = []

    def lose(self, where):
        if where == self.where:
            self.status = self.lost_status
            raise self.fault

    def register_plugin(self, plugin, name):
        self.lose("register")

    def nthreads(self):
        self.lose("look")
        return {WORKER: 1}

    def submit(self, *_, **__):
        self.lose("submit")
        self.status = self.lost_status
        return Future(self, self.fault)

    def cancel(self, futures):
        self.left.append("cancel")

    def unregister_worker_plugin(self, name):
        self.left.append("unregister")

    def close(self, timeout):
        raise TimeoutError


@pytest.mark.parametrize("where, fault, status", [
    ("register", OSError("refused"), "running"),
    ("look", OSError("refused"), "running"),
    ("look", AttributeError("no connection"), "connecting"),
    ("look", asyncio.CancelledError(), "closed"),
    ("submit", RuntimeError("the client is closed"), "closed"),
    ("result", CancelledError("connection lost"), "connecting"),
    ("result", AttributeError("no connection"), "connecting"),
    ("result", OSError("refused"), "running")])
def test_a_lost_scheduler_is_told_whichever_call_notices_it(tmp_path, monkeypatch, where, fault,
                                                            status):
    (tmp_path / "box.sdf").write_text(
        '<sdf version="1.6"><model name="box"><link name="l"/></model></sdf>')
    (tmp_path / "s.yaml").write_text(STUDY)
    client = Client(where, fault, status)
    monkeypatch.setattr(dask_runner, "security_of", lambda tls: None)
    said = []
    runner = DaskRunner(CasePlan(read_study(str(tmp_path / "s.yaml"))[0]), Recorder(), set(), 1,
                        "tls://127.0.0.1:2", TlsFiles("", "", ""), lambda row: None, said.append)
    monkeypatch.setattr(runner, "_connect_client", lambda: client)
    with pytest.raises(CommandError) as told:
        runner.run()
    assert "was lost" in str(told.value) and "`study resume` goes on" in str(told.value)
    assert client.left == ([] if status != "running" else ["cancel", "unregister"])
    assert said == ["the cluster could not be told that the study is over: TimeoutError"]
