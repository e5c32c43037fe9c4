"""The walk of an actor with ActorPlugin: speed, bounds, turns, and who shows it."""
from __future__ import annotations

import math

import pytest

from my_simulations.description.actor import Actor, Animation, Trajectory, Waypoint
from my_simulations.description.plugin import PluginSpec
from my_simulations.description.random_walk import with_random_walk
from my_simulations.description.world import World
from my_simulations.geometry import Pose, quat_from_rpy, rpy_from_quat
from my_simulations.plugins.registry import PluginRegistry
from my_simulations.resources.resolver import Resolver
from my_simulations.sensing.actors.path import ActorPath
from my_simulations.sensing.scene import scenery

PLUGIN = "<plugin><target>0 -5 1.2138</target><target_weight>1.15</target_weight></plugin>"


def actor(name="person", xml=PLUGIN, library="libActorPlugin.so", animation="walking"):
    return Actor(name, pose=Pose((-1.0, 2.0, 1.25), quat_from_rpy(math.pi / 2.0, 0.0, 0.0)),
                 animations=[Animation(animation, "walk.dae", interpolate_x=True)],
                 trajectories=[Trajectory(0, "walking", waypoints=[Waypoint()])],
                 plugins=[PluginSpec("walk", library, xml)])


def sampled(one, seconds, dt=0.05):
    path = ActorPath(with_random_walk(one), {"walking": 1.0})
    return [path.pose_at(n * dt) for n in range(round(seconds / dt))]


def places(poses):
    return [pose.position[:2] for pose in poses]


def test_it_walks_at_its_speed_within_the_bounds_and_faces_its_way():
    poses = sampled(actor(), 200.0)
    fastest = 0.0
    for before, after in zip(poses, poses[1:]):
        way = math.dist(before.position[:2], after.position[:2])
        fastest = max(fastest, way / 0.05)
        if way > 0.04:   # on its way, not at a corner
            heading = math.atan2(after.position[1] - before.position[1],
                                 after.position[0] - before.position[0])
            yaw = rpy_from_quat(after.orientation)[2]
            assert math.remainder(heading - yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=0.35)
    assert 0.9 < fastest < 1.3
    assert all(-3.3 < x < 3.8 and -10.3 < y < 2.3 for x, y in places(poses))


def test_it_reaches_its_first_target_and_goes_on():
    found = places(sampled(actor(), 100.0))
    reached = min(range(len(found)), key=lambda n: math.dist(found[n], (0.0, -5.0)))
    assert math.dist(found[reached], (0.0, -5.0)) < 0.1
    assert max(math.dist(place, (0.0, -5.0)) for place in found[reached:]) > 2.0


def test_its_way_depends_on_its_name_only():
    one, other = actor("one"), actor("other")
    assert with_random_walk(one) == with_random_walk(actor("one"))
    assert places(sampled(one, 60.0)) != places(sampled(other, 60.0))


def test_the_weight_of_the_target_sets_the_speed():
    slow = actor(xml="<plugin><target_weight>0.5</target_weight></plugin>")
    found = places(sampled(slow, 100.0, 1.0))
    ways = sorted(math.dist(one, other) for one, other in zip(found, found[1:]))
    assert ways[len(ways) // 2] == pytest.approx(0.4, abs=0.02)


@pytest.mark.parametrize("one", [
    actor(library="libother.so"), actor(animation="running")], ids=["plugin", "animation"])
def test_other_actors_keep_their_script(one):
    assert with_random_walk(one) is one


def test_a_weight_that_is_no_number_is_the_default():
    xml = "<plugin><target_weight>x</target_weight></plugin>"
    assert with_random_walk(actor(xml=xml)) == replaced(
        with_random_walk(actor(xml="<plugin/>")), xml)


def replaced(one, xml):
    one.plugins = [PluginSpec("walk", "libActorPlugin.so", xml)]
    return one


def test_cameras_and_rays_see_the_walk():
    (figure,) = scenery(World("w", actors=[actor()]), None, Resolver()).figures
    assert figure.actor == with_random_walk(actor())


def test_no_warning_names_the_plugin():
    assert PluginRegistry().is_provided("libActorPlugin.so")
