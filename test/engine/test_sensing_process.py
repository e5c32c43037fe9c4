"""The sensing process: started late, repeatable, and no loss when it dies."""
from __future__ import annotations

import errno
import math
import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
from sensing_scene import DEADLINE_S, body, rows
from waiting import until

from my_simulations.description.light import Light
from my_simulations.description.model import Model
from my_simulations.description.shapes import Box, Mesh, Plane, Sphere
from my_simulations.description.world import World
from my_simulations.engine.process_engine import ProcessEngine
from my_simulations.geometry import Pose
from my_simulations.sensing.api import (
    COLLISIONS,
    DEPTH,
    LABELS,
    RGB,
    VISUALS,
    AddBody,
    Body,
    CameraSpec,
    CastBatch,
    CastRays,
    LoadScene,
    Mount,
    RayBundle,
    RayFan,
    RemoveBody,
    RenderCamera,
    SensingEndedError,
    SensingError,
    SensingUnavailableError,
)
from my_simulations.sensing.process import SensingProcess
from my_simulations.simulator.scene_sensing import SceneSensing
from my_simulations.simulator.simulator import Simulator

FAN = RayFan(31, -math.pi / 2, math.pi / 2, far=20.0)
AHEAD = RayFan(1, far=20.0)
WALL = body("wall", Box((0.2, 10.0, 12.0)), 1)
FLOOR = body("floor", Plane(size=(50.0, 50.0)), 0)
PLACES = rows([Pose(), Pose((5.1, 0.0, 0.0)), Pose((2.0, 0.0, 1.0))])
SPEC = CameraSpec(160, 120)
MOUNT = Mount(pose=Pose((0.0, 0.0, 1.0)))
SUN = Light("sun", "directional", Pose((0, 0, 10)), True, direction=(-0.5, 0.2, -1.0))


@pytest.fixture
def start():
    made = []

    def begin(*arguments, **options):
        sensing = SensingProcess(*arguments, **options)
        made.append(sensing)
        sensing.said = []
        sensing.on_problem(sensing.said.append)
        return sensing

    yield begin
    for sensing in made:
        sensing.close()
        assert sensing.pid == 0


@pytest.fixture
def sensing(start):
    made = start()
    made.change(LoadScene([FLOOR, WALL], [SUN]))
    return made


def ahead(sensing, at=PLACES, **options) -> float:
    found = sensing.cast(CastRays(MOUNT, AHEAD, at=at, **options)).result(DEADLINE_S)
    return float(found.ranges[0])


def picture(sensing, at=PLACES):
    return sensing.render(RenderCamera(MOUNT, SPEC, (RGB, DEPTH, LABELS), at)).result(DEADLINE_S)


def test_nothing_is_started_before_the_first_request(sensing):
    sensing.change(AddBody(body("ball", Sphere(0.5), 2)))
    assert sensing.pid == 0
    assert ahead(sensing) == pytest.approx(1.5, abs=1e-6)
    assert sensing.pid > 0


def test_changes_and_requests_take_effect_in_the_order_of_the_calls(sensing):
    first = sensing.cast(CastRays(MOUNT, AHEAD, at=PLACES))
    sensing.change(AddBody(body("ball", Sphere(0.5), 2)))
    second = sensing.cast(CastRays(MOUNT, AHEAD, at=PLACES))
    sensing.change(AddBody(body("ball", Box((2.0, 2.0, 2.0)), 2)))
    third = sensing.cast(CastRays(MOUNT, AHEAD, at=PLACES))
    sensing.change(RemoveBody("ball"))
    last = sensing.cast(CastRays(MOUNT, AHEAD, at=PLACES))
    found = [one.result(DEADLINE_S).ranges[0] for one in (first, second, third, last)]
    assert found == pytest.approx([5.0, 1.5, 1.0, 5.0], abs=1e-6)


def test_pictures_follow_late_changes_of_the_scene(sensing):
    assert set(np.unique(picture(sensing).labels)) == {0, 1}
    sensing.change(AddBody(body("ball", Sphere(0.5), 2)))
    assert set(np.unique(picture(sensing).labels)) == {0, 1, 2}
    sensing.change(RemoveBody("wall"))
    assert set(np.unique(picture(sensing).labels)) == {-1, 0, 2}
    sensing.change(LoadScene([WALL]))
    assert set(np.unique(picture(sensing).labels)) == {1}


def test_the_same_request_gives_the_same_bytes_in_another_process_too(start):
    def answers():
        made = start()
        made.change(LoadScene([FLOOR, WALL, body("ball", Sphere(0.5), 2)], [SUN]))
        seen = [picture(made) for _ in range(2)]
        elsewhere = made.render(RenderCamera(Mount(pose=Pose((0.3, 0.2, 1.5))), SPEC, (RGB,),
                                             PLACES)).result(DEADLINE_S)
        assert elsewhere.rgb.tobytes() != seen[0].rgb.tobytes()
        seen.append(picture(made))
        rays = made.cast(CastRays(MOUNT, FAN, at=PLACES)).result(DEADLINE_S)
        return [(one.rgb.tobytes(), one.depth.tobytes(), one.labels.tobytes()) for one in seen], \
            rays.ranges.tobytes()

    first, second = answers(), answers()
    assert first == second
    assert first[0][0] == first[0][1] == first[0][2]


def test_a_killed_process_is_replaced_and_the_scene_is_there_again(sensing):
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    sensing.change(AddBody(body("ball", Sphere(0.5), 2)))
    before, pid = picture(sensing).rgb.tobytes(), sensing.pid
    os.kill(pid, signal.SIGKILL)
    until(lambda: sensing.said, "nobody was told")
    assert "SIGKILL" in sensing.said[0] and "physics goes on" in sensing.said[0]
    assert ahead(sensing) == pytest.approx(1.5, abs=1e-6)
    assert picture(sensing).rgb.tobytes() == before
    assert sensing.pid not in (0, pid)


def test_what_waits_fails_when_the_process_dies_and_says_why(start):
    sensing = start()
    sensing.change(LoadScene([FLOOR]))
    assert ahead(sensing) == math.inf
    os.kill(sensing.pid, signal.SIGSTOP)
    waiting = sensing.cast(CastRays(MOUNT, AHEAD, at=PLACES))
    os.kill(sensing.pid, signal.SIGKILL)
    with pytest.raises(SensingEndedError, match="SIGKILL"):
        waiting.result(DEADLINE_S)


def test_what_waits_fails_when_no_process_can_be_started_and_a_later_one_answers(
        sensing, monkeypatch):
    def refused(*arguments, **options):
        raise OSError(errno.ENOMEM, "Cannot allocate memory")

    with monkeypatch.context() as patched:
        patched.setattr(subprocess, "Popen", refused)
        with pytest.raises(SensingEndedError, match="cannot be started .*Cannot allocate memory"):
            ahead(sensing)
    assert len(sensing.said) == 1 and "physics goes on" in sensing.said[0]
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)


def test_what_waits_fails_when_all_ends_before_a_process_is_started(monkeypatch):
    sensing, begin = SensingProcess(), threading.Event()
    start = sensing._start
    monkeypatch.setattr(sensing, "_start", lambda: begin.wait(DEADLINE_S) and start())
    waiting = sensing.cast(CastRays(MOUNT, AHEAD))
    monkeypatch.setattr(sensing, "_shut_down_wire", begin.set)  # called once it is closing
    sensing.close()
    with pytest.raises(SensingEndedError, match="ended"):
        waiting.result(DEADLINE_S)


def test_a_process_that_hangs_holds_nobody_up_and_is_replaced(start):
    sensing = start(patience=1.0)
    sensing.change(LoadScene([FLOOR, WALL]))
    until(lambda: _answers(sensing), "no answer")
    os.kill(sensing.pid, signal.SIGSTOP)
    futures = [sensing.cast(CastRays(MOUNT, FAN, at=PLACES * 100)) for _ in range(300)]
    with pytest.raises(SensingError, match="waiting already"):
        futures[-1].result(0.0)
    with pytest.raises(SensingEndedError, match="has not answered"):
        futures[0].result(DEADLINE_S)
    until(lambda: _answers(sensing), "no other process came")


def _answers(sensing) -> bool:
    try:
        return ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    except SensingError:
        return False


def test_a_process_that_dies_again_and_again_is_left_alone_until_the_world_changes(
        start, monkeypatch):
    sensing = start()
    sensing.change(LoadScene([FLOOR, WALL]))
    with monkeypatch.context() as broken:
        broken.setattr("my_simulations.sensing.process.child_command",
                       lambda *words: [sys.executable, "-c", "import sys; sys.exit(3)"])
        for _ in range(3):
            with pytest.raises(SensingEndedError, match="code 3"):
                ahead(sensing)
        with pytest.raises(SensingUnavailableError, match="until the world changes"):
            ahead(sensing)
    sensing.change(LoadScene([FLOOR, WALL]))
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)


def test_a_request_that_does_not_fit_into_the_wire_at_once_is_sent_whole(sensing):
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    os.kill(sensing.pid, signal.SIGSTOP)   # it reads nothing, the wire fills up
    rays = RayBundle(np.zeros((20000, 3)), np.tile((1.0, 0.0, 0.0), (20000, 1)), far=20.0)
    futures = [sensing.cast(CastRays(MOUNT, rays, at=PLACES)) for _ in range(3)]
    sensing.change(RemoveBody("wall"))
    futures.append(sensing.cast(CastRays(MOUNT, rays, at=PLACES)))
    os.kill(sensing.pid, signal.SIGCONT)
    found = [one.result(DEADLINE_S).ranges[[0, -1]] for one in futures]
    assert np.array(found) == pytest.approx(np.array([[5.0] * 2] * 3 + [[math.inf] * 2]), abs=1e-6)


def test_pictures_that_end_their_process_are_given_up_though_rays_are_answered(monkeypatch):
    code = ("import os; from my_simulations.sensing.camera.renderer import Renderer; "
            "Renderer.__init__ = lambda self, trouble: os._exit(4); "
            "import runpy, sys; sys.argv = ['-m'] + sys.argv[1:]; "
            "runpy.run_module('my_simulations.sensing', run_name='__main__')")
    monkeypatch.setattr("my_simulations.sensing.process.child_command",
                        lambda module, *words: [sys.executable, "-c", code, *words])
    sim = Simulator(World(), engine_factory=ProcessEngine, paused=True, log=lambda issue: None)
    scene = SceneSensing(sim, lambda issue: None)

    def cast():
        future = scene.cast(MOUNT, AHEAD, False, 0, PLACES)
        scene.send()
        return future.result(DEADLINE_S).ranges[0]

    def taken():
        [future] = scene.render([(MOUNT, SPEC, (RGB,))], 0, PLACES)
        return future.result(DEADLINE_S)

    try:
        for _ in range(3):
            assert cast() == math.inf
            with pytest.raises(SensingEndedError, match="code 4"):
                taken()
        with pytest.raises(SensingUnavailableError, match="cameras stay off until the world"):
            taken()
        assert cast() == math.inf
    finally:
        scene.close()
        sim.close()


@pytest.mark.parametrize("change,said", [
    ({"near": 1.0, "far": 1.0}, "near to far"), ({"near": 0.0}, "near to far"),
    ({"far": math.inf}, "near to far"), ({"near": math.nan}, "near to far"),
    ({"hfov": 0.0}, "angle of view"), ({"hfov": 3.2}, "angle of view"),
    ({"width": 40000}, "40000 x 120")])
def test_a_camera_with_impossible_numbers_is_refused_and_the_process_stays(sensing, change, said):
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    before = sensing.pid
    with pytest.raises(SensingError, match=said) as refused:
        sensing.render(RenderCamera(MOUNT, replace(SPEC, **change), (RGB, DEPTH),
                                    at=PLACES)).result(DEADLINE_S)
    assert not isinstance(refused.value, SensingEndedError)
    assert np.isfinite(picture(sensing).depth).any()
    assert sensing.pid == before


def test_what_is_not_installed_is_named_with_what_to_install(start, monkeypatch, tmp_path):
    for name in ("embreex", "moderngl"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise ImportError('not for this Python')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    command = "my_simulations.sensing.process.child_environment"
    monkeypatch.setattr(command, lambda: {**os.environ, "PYTHONPATH": os.pathsep.join(
        [str(tmp_path), *sys.path])})
    sensing = start()
    sensing.change(LoadScene([FLOOR]))
    with pytest.raises(SensingUnavailableError, match="pip install embreex"):
        ahead(sensing)
    with pytest.raises(SensingUnavailableError, match="pip install moderngl"):
        picture(sensing)
    assert sensing.pid


def test_a_sensor_on_a_link_that_the_state_lacks_is_refused_and_bodies_without_rows_unseen(
        sensing):
    sensing.change(AddBody(body("late", Sphere(0.5), 7)))
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    with pytest.raises(SensingError, match="no link 7"):
        sensing.cast(CastRays(Mount(7), AHEAD, at=PLACES)).result(DEADLINE_S)
    assert 7 not in picture(sensing).labels


def test_sensors_of_one_state_are_answered_together_and_fail_each_by_itself(sensing):
    one, other = sensing.cast(CastRays(MOUNT, FAN, at=PLACES)), CastRays(Mount(7), AHEAD)
    first, second, third = sensing.cast_all(CastBatch(
        (CastRays(MOUNT, FAN), other, CastRays(MOUNT, FAN, VISUALS)), PLACES)).result(DEADLINE_S)
    alone = one.result(DEADLINE_S)
    assert np.array_equal(first.ranges, alone.ranges)
    assert np.array_equal(first.link_rows, alone.link_rows)
    assert isinstance(second, SensingError)
    assert third.ranges == pytest.approx(alone.ranges, abs=1e-6)


def test_an_unreadable_mesh_is_left_out_and_named_once_for_rays_and_once_for_cameras(sensing):
    gone = Mesh("model://none/a.dae", "/nowhere/a.dae")
    sensing.change(AddBody(body("gone", gone, 2)))
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
    picture(sensing)
    picture(sensing)
    assert len(sensing.said) == 2
    assert all("model://none/a.dae" in text for text in sensing.said)


def test_rays_see_collisions_or_visuals(sensing):
    glass = body("glass", Sphere(0.5), 2, transparency=1.0)
    sensing.change(AddBody(glass))
    assert ahead(sensing, sees=COLLISIONS) == pytest.approx(1.5, abs=1e-6)
    assert ahead(sensing, sees=VISUALS) == pytest.approx(5.0, abs=1e-6)


def test_a_fan_and_a_bundle_of_the_same_rays_see_the_same(sensing):
    fan = sensing.cast(CastRays(MOUNT, FAN, at=PLACES)).result(DEADLINE_S)
    yaw = np.linspace(-math.pi / 2, math.pi / 2, 31)
    ways = np.stack([np.cos(yaw), np.sin(yaw), np.zeros(31)], axis=1)
    bundle = sensing.cast(CastRays(MOUNT, RayBundle(np.zeros((31, 3)), ways, far=20.0),
                                   at=PLACES)).result(DEADLINE_S)
    assert np.array_equal(fan.ranges, bundle.ranges)
    assert np.array_equal(fan.link_rows, bundle.link_rows)


def test_a_model_without_links_is_nothing_to_see(sensing):
    sensing.change(AddBody(Body("empty", Model("empty"), 0)))
    assert ahead(sensing) == pytest.approx(5.0, abs=1e-6)
