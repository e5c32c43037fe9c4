"""What a spawn and a delete cost the node does not grow with the number of models."""
from __future__ import annotations

from types import SimpleNamespace

import pytest
from geometry_msgs.msg import Pose, Quaternion
from work_count import bytecodes

from my_simulations.description.world import World
from my_simulations.engine.inline_engine import InlineEngine
from my_simulations.engine.kinematic_backend import KinematicBackend
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.plugins.plugin_starter import PluginStarter
from my_simulations.ros.services.model_services import ModelServices
from my_simulations.simulator.simulator import Simulator
from my_simulations.simulator.spawn_advice import NEIGHBOURS

BOX = ("<robot name='b'><link name='link'><inertial><mass value='1'/><inertia ixx='.1' ixy='0'"
       " ixz='0' iyy='.1' iyz='0' izz='.1'/></inertial><collision><geometry><box size='1 1 1'/>"
       "</geometry></collision></link></robot>")
FEW, MANY = NEIGHBOURS + 6, NEIGHBOURS + 306


@pytest.fixture
def services():
    simulator = Simulator(World(), engine_factory=lambda: InlineEngine(KinematicBackend),
                          paused=True, log=lambda issue: None)
    simulator.start()
    starter = PluginStarter(simulator, lambda issue: None)
    yield ModelServices(simulator, Resolver(), lambda issue: None, changed=starter.settle)
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
    came, gone = {}, {}
    for number in range(MANY):
        if number + 1 in (FEW, MANY):
            came[number + 1] = bytecodes(lambda n=number: spawn(services, n))
        else:
            spawn(services, number)
    for left in range(MANY, 0, -1):
        number = (left * 7) % MANY  # in no order of theirs
        if left in (FEW, MANY):
            gone[left] = bytecodes(lambda n=number: delete(services, n))
        else:
            delete(services, number)
    # A look at each of 300 more would take thousands; the wait for the engine differs a little.
    assert abs(came[MANY] - came[FEW]) < 300 and came[FEW] > 1000
    assert abs(gone[MANY] - gone[FEW]) < 300 and gone[FEW] > 100
