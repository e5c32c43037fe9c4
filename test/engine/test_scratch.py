"""Scratch folders do not outlive who made them."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np
import pytest
from conftest import ball

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Collision, Mesh, MeshData, mesh_key
from my_simulations.engine.commands import LoadModel
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.engine.scratch_folder import Scratch, remove_stale_folders
from my_simulations.geometry import Pose


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, of this process and its children."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


def _pyramid() -> LoadModel:
    """A model that needs a file: it has no faces that are rectangles."""
    mesh = Mesh("pyramid", "/pyramid")
    model = Model("pyramid", static=True, links=[Link("link", collisions=[Collision("c", mesh)])])
    data = MeshData(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float),
                    np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], np.int32))
    return LoadModel(1, model, Pose(), 0, 0, {mesh_key(mesh): data})


def test_a_folder_is_made_when_needed_and_removed_at_the_end(temporary):
    with Scratch() as scratch:
        assert not list(temporary.iterdir())
        with open(os.path.join(scratch.path, "file"), "w", encoding="ascii") as stream:
            stream.write("x")
        remove_stale_folders()
        assert os.listdir(scratch.path) == ["file"]
    assert not list(temporary.iterdir())


def test_an_engine_without_meshes_makes_no_folder(temporary):
    engine = ProcessEngine()
    try:
        assert not engine.submit(LoadModel(1, ball(), Pose(), 0, 0)).result(20).error
        assert not list(temporary.iterdir())
    finally:
        engine.close()


def test_the_folder_of_a_killed_engine_goes_with_it(temporary):
    engine = ProcessEngine()
    try:
        assert not engine.submit(_pyramid()).result(20).error
        assert len(list(temporary.iterdir())) == 1
        os.kill(engine.pid, signal.SIGKILL)
        deadline = time.monotonic() + 60
        while list(temporary.iterdir()):
            assert time.monotonic() < deadline, "the folder is still there"
            time.sleep(0.01)
    finally:
        engine.close()


def test_the_folder_of_a_killed_owner_goes_when_the_next_engine_starts(temporary):
    script = ("import sys; from my_simulations.engine.scratch_folder import Scratch\n"
              "scratch = Scratch(); print(scratch.path, flush=True); sys.stdin.read()\n")
    owner = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True,
                             env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    left = owner.stdout.readline().strip()
    remove_stale_folders()
    assert os.path.isdir(left)   # its owner lives
    owner.kill()
    owner.communicate()
    ProcessEngine().close()
    assert not os.path.exists(left)
