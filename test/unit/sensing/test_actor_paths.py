"""Where actors are: closed forms that the page keeps, too (actor_path.test.mjs)."""
from __future__ import annotations

import json
from pathlib import Path

import pytest

from my_simulations.description.actor import Actor, Animation, Trajectory, Waypoint
from my_simulations.geometry import Pose
from my_simulations.sensing.actors.path import ActorPath

CASES = json.loads((Path(__file__).parents[2] / "data/actor_paths.json").read_text())["cases"]


def pose_of(numbers):
    return Pose(tuple(numbers[:3]), tuple(numbers[3:]))


def actor_of(told):
    trajectories = [Trajectory(one["id"], one["type"], tension=one["tension"], waypoints=[
        Waypoint(waypoint["time"], pose_of(waypoint["pose"])) for waypoint in one["waypoints"]])
        for one in told["trajectories"]]
    animations = [Animation(one["name"], interpolate_x=one["interpolate_x"])
                  for one in told.get("animations", [])]
    return Actor("man", pose_of(told["pose"]), loop=told["loop"], auto_start=told["auto_start"],
                 delay_start=told["delay_start"], trajectories=trajectories, animations=animations)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["says"])
def test_an_actor_is_where_the_page_has_it(case):
    path = ActorPath(actor_of(case["actor"]), case.get("durations", {}))
    for moment in case["at"]:
        found, expected = path.pose_at(moment["time"]), pose_of(moment["pose"])
        assert found.position == pytest.approx(expected.position, abs=1e-9)
        same = sum(a * b for a, b in zip(found.orientation, expected.orientation))
        assert abs(same) == pytest.approx(1.0, abs=1e-9)
        if "stride" in moment:
            stride = path.stride_at(moment["time"])
            assert (None if stride is None else [*stride]) == moment["stride"], moment


def test_the_script_runs_by_sim_time_and_begins_after_its_delay():
    path = ActorPath(Actor("man", delay_start=1.0, trajectories=[
        Trajectory(waypoints=[Waypoint(0.0), Waypoint(4.0)])]), {})
    assert [path.script_time(time) for time in (0.5, 1.0, 3.0, 5.0, 5.5, 6.5)] == [
        None, 0.0, 2.0, 4.0, 4.0, 0.5]
    assert ActorPath(Actor("man"), {}).script_time(7.0) == 7.0
