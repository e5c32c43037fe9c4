"""Documents of SDF 1.0, whose values are attributes."""
import pytest
from reading import errors, warnings, world_of

from my_simulations.description.shapes import Box
from my_simulations.resources.resolver import Resolver

ARM = """
<physics type="ode"><gravity xyz="0 0 -5"/><ode><solver type="quick" dt="0.002" iters="30"/></ode>
</physics>
<scene><ambient rgba="0.1 0.2 0.3 1"/><shadows enabled="false" rgba="0 0 0 1"/>
<fog rgba="0 0 1 1" type="linear" start="2"/></scene>
<model name="m" static="false"><origin pose="0 0 1 0 0 0"/>
<link name="a" gravity="false"><inertial mass="10"><damping linear="0.1" angular="0.2"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial>
<visual name="v" cast_shadows="false"><geometry><box size="1 1 2"/></geometry>
<material script="Gazebo/Green"><color rgba="0.5 0.5 0.5 1"/></material></visual>
<collision name="c" laser_retro="100"><geometry><box size="1 1 2"/></geometry>
<surface><friction><ode mu="0.5" mu2="0.2"/></friction></surface></collision></link>
<link name="b"><origin pose="0 0 0 0 0 1.5707963267948966"/></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/>
<axis xyz="1 0 0"><limit lower="-1" upper="1" effort="9"/></axis></joint></model>
"""


def test_values_in_attributes_are_read():
    world, issues = world_of(ARM, "1.0")
    assert errors(issues) == [] and warnings(issues) == []
    assert world.gravity == (0, 0, -5)
    assert (world.physics.max_step_size, world.physics.ode.iters) == (0.002, 30)
    assert world.scene.ambient == (0.1, 0.2, 0.3, 1) and world.scene.shadows is False
    assert (world.scene.fog.type, world.scene.fog.color) == ("linear", (0, 0, 1, 1))
    model = world.models[0]
    link = model.links[0]
    assert model.pose.position == (0, 0, 1) and not link.gravity
    assert (link.inertial.mass, link.inertial.iyy, link.linear_decay) == (10, 2, 0.1)
    visual, collision = link.visuals[0], link.collisions[0]
    assert visual.geometry == collision.geometry == Box((1, 1, 2))
    assert visual.material.script_name == "Gazebo/Green"
    assert visual.material.diffuse == (0.5, 0.5, 0.5, 1) and not visual.cast_shadows
    assert (collision.surface.mu, collision.surface.mu2) == (0.5, 0.2)
    joint = model.joints[0]
    assert (joint.parent, joint.child, joint.axis.lower, joint.axis.effort) == ("a", "b", -1, 9)
    # An axis of that time is in the model frame.
    assert joint.axis.xyz == pytest.approx((0, -1, 0))


@pytest.mark.parametrize("version", ["1.0", "1.2"])
def test_an_include_by_file_name_names_a_model_of_the_database(tmp_path, version):
    (tmp_path / "crate").mkdir()
    (tmp_path / "crate" / "model.sdf").write_text(
        '<sdf version="1.6"><model name="crate"><link name="l"/></model></sdf>')
    world, issues = world_of('<include filename="crate.model"/>', version,
                             Resolver([str(tmp_path)]))
    assert [model.name for model in world.models] == ["crate"] and errors(issues) == []


def test_the_content_of_a_plugin_is_left_alone():
    world, _ = world_of('<plugin name="p" filename="f"><a size="1"/></plugin>', "1.0")
    assert '<a size="1"/>' in world.plugins[0].xml


def test_a_normal_map_and_the_collisions_of_a_contact_sensor_become_what_newer_versions_ask_for():
    world, issues = world_of(
        '<model name="m"><link name="l"><visual name="v"><geometry><box size="1 1 1"/></geometry>'
        '<material script="Gazebo/Red" normal_map="bumps.png"/></visual>'
        '<sensor name="s" type="contact"><contact><collision name="c"/></contact></sensor>'
        '<sensor name="t" type="camera"><camera><save enabled="true" path="/tmp"/></camera>'
        "</sensor></link></model>", "1.0")
    assert errors(issues) == []
    link = world.models[0].links[0]
    assert link.visuals[0].extra == [
        '<material><shader type="normal_map_tangent_space"><normal_map>bumps.png</normal_map>'
        "</shader></material>"]
    assert "<contact><collision>c</collision></contact>" in link.extra[0]
    assert '<save enabled="true" path="/tmp"/>' in link.extra[1]
