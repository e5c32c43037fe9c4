"""What a spawn and a delete cost the node does not grow with the number of models."""
from __future__ import annotations

from types import SimpleNamespace

import pytest
from geometry_msgs.msg import Pose, Quaternion
from running_simulator import started
from work_count import lines_run

from my_simulations.description.world import World
from my_simulations.plugins.running import ModelPlugins
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.plugins.plugin_starter import PluginStarter
from my_simulations.ros.services.model_services import ModelServices
from my_simulations.simulator.spawn_advice import NEIGHBOURS

BOX = ("<robot name='b'><link name='link'><inertial><mass value='1'/><inertia ixx='.1' ixy='0'"
       " ixz='0' iyy='.1' iyz='0' izz='.1'/></inertial><collision><geometry><box size='1 1 1'/>"
       "</geometry></collision></link></robot>")
FEW, MANY = NEIGHBOURS + 6, NEIGHBOURS + 306
SAMPLES = 5


@pytest.fixture
def services():
    simulator = started(World())
    starter = PluginStarter(simulator, lambda issue: None)
    yield ModelServices(simulator, Resolver(), lambda issue: None,
                        changed=starter.wait_until_loaded)
    simulator.close()


def spawn(services, number):
    pose = Pose(orientation=Quaternion(w=1.0))
    pose.position.x = 3.0 * number
    services.spawn_urdf(SimpleNamespace(
        model_name=f"b{number}", model_xml=BOX, robot_namespace="", initial_pose=pose,
        reference_frame=""), None)


def delete(services, number):
    services.delete(SimpleNamespace(model_name=f"b{number}"), None)


def test_no_other_model_is_looked_at_when_one_comes_or_goes(services):
    came, gone = {FEW: [], MANY: []}, {FEW: [], MANY: []}

    def counted(found, there, call, number):
        """Count the work of one of the calls while there are about FEW or MANY models."""
        near = [count for count in found if count - SAMPLES < there <= count]
        if near:
            found[near[0]].append(lines_run(lambda: call(services, number)))
        else:
            call(services, number)

    for number in range(MANY):
        counted(came, number + 1, spawn, number)
    for left in range(MANY, 0, -1):
        counted(gone, left, delete, (left * 7) % MANY)  # in no order of theirs
    # A look at each of 300 more would take hundreds. A wait for the engine takes more now and
    # then, so the least of several is compared.
    assert abs(min(came[MANY]) - min(came[FEW])) < 60 and min(came[FEW]) > 500
    assert abs(min(gone[MANY]) - min(gone[FEW])) < 60 and min(gone[FEW]) > 100


def test_a_look_for_plugins_passes_by_models_without(services):
    followed = ModelPlugins(services._simulator, lambda running, entity: None)
    looks = []
    for number in range(MANY):
        spawn(services, number)
        if number >= MANY - SAMPLES or FEW - SAMPLES <= number < FEW:
            looks.append(lines_run(followed.update))
    assert abs(min(looks[:SAMPLES]) - min(looks[SAMPLES:])) < 20 and min(looks) > 10
