"""`<gazebo>` tags of URDF."""
import pytest
from reading import URDF_INERTIAL, codes, errors, robot_joint, robot_link, robot_of, warnings

BOX = '<geometry><box size="1 1 1"/></geometry>'
BODY = robot_link("l", URDF_INERTIAL + f"<collision>{BOX}</collision>" * 2
                  + f"<visual>{BOX}</visual>")
HINGE = (BODY + robot_link("m") + robot_joint("j", "l", "m", "continuous"))


def link_with(inside):
    model, issues = robot_of(BODY + f'<gazebo reference="l">{inside}</gazebo>')
    return model.links[0], issues


def test_contact_tags_set_every_collision_of_the_link():
    link, issues = link_with(
        "<mu1>0.1</mu1><mu2>0.2</mu2><fdir1>1 0 0</fdir1><kp>1000</kp><kd>2</kd>"
        "<minDepth>0.01</minDepth><maxVel>0.5</maxVel><maxContacts>3</maxContacts>"
        "<laserRetro>9</laserRetro>")
    assert issues == []
    for collision in link.collisions:
        surface = collision.surface
        assert (surface.mu, surface.mu2, surface.fdir1) == (0.1, 0.2, (1, 0, 0))
        assert (surface.kp, surface.kd, surface.min_depth, surface.max_vel) == (1000, 2, 0.01, 0.5)
        assert (collision.max_contacts, collision.laser_retro) == (3, 9)


def test_a_value_may_stand_in_an_attribute():
    link, issues = link_with('<mu1 value="0.1"/><turnGravityOff value="true"/>')
    assert issues == [] and link.collisions[0].surface.mu == 0.1 and not link.gravity


def test_link_tags_set_the_link():
    link, issues = link_with("<selfCollide>true</selfCollide><turnGravityOff>1</turnGravityOff>"
                             "<dampingFactor>0.3</dampingFactor><kinematic>true</kinematic>")
    assert issues == []
    assert (link.self_collide, link.gravity, link.kinematic) == (True, False, True)
    assert (link.linear_decay, link.angular_decay) == (0.3, 0.3)
    link, _ = link_with("<turnGravityOff>false</turnGravityOff><velocity_decay><linear>0.1</linear>"
                        "</velocity_decay>")
    assert (link.gravity, link.linear_decay, link.angular_decay) == (True, 0.1, 0)


def test_a_material_is_a_script_of_the_built_in_library():
    link, issues = link_with("<material>Gazebo/Red</material>")
    material = link.visuals[0].material
    assert issues == [] and material.script_name == "Gazebo/Red"
    assert material.script_uris == ["file://media/materials/scripts/gazebo.material"]


def test_sdf_in_collision_and_visual_is_merged_into_each():
    link, issues = link_with(
        "<collision><surface><bounce><restitution_coefficient>0.7</restitution_coefficient>"
        "</bounce></surface></collision><visual><material><diffuse>1 0 0 1</diffuse></material>"
        "<transparency>0.5</transparency></visual>")
    assert issues == []
    assert [c.surface.restitution for c in link.collisions] == [0.7, 0.7]
    assert link.visuals[0].material.diffuse == (1, 0, 0, 1)
    assert link.visuals[0].transparency == 0.5


def test_sensors_are_kept_and_unknown_tags_are_kept_with_a_warning():
    link, issues = link_with('<sensor name="s" type="ray"/><tubroGravity>1</tubroGravity>')
    assert link.extra == ['<sensor name="s" type="ray"/>', "<tubroGravity>1</tubroGravity>"]
    assert warnings(issues) == ["unknown-element"] and not errors(issues)


def test_several_blocks_for_one_link_all_count():
    model, _ = robot_of(BODY + '<gazebo reference="l"><mu1>0.1</mu1></gazebo>'
                        '<gazebo reference="l"><mu2>0.2</mu2></gazebo>')
    surface = model.links[0].collisions[0].surface
    assert (surface.mu, surface.mu2) == (0.1, 0.2)


def test_tags_without_reference_are_the_models():
    xml = '<plugin name="p" filename="lib.so"><robotNamespace>/r</robotNamespace></plugin>'
    model, issues = robot_of(BODY + f"<gazebo><static>true</static>{xml}</gazebo>"
                             "<gazebo><self_collide>true</self_collide></gazebo>")
    assert codes(issues) == []
    assert model.static and model.self_collide
    assert [(p.name, p.filename, p.xml) for p in model.plugins] == [("p", "lib.so", xml)]


def test_static_counts_without_a_reference_only():
    model, _ = robot_of(BODY + '<gazebo reference="l"><static>true</static></gazebo>')
    assert not model.static


def test_joint_tags_become_sdf_of_the_joint():
    model, issues = robot_of(HINGE + '<gazebo reference="j"><stopCfm>0.1</stopCfm>'
                             "<springReference>0.5</springReference>"
                             "<springStiffness>7</springStiffness>"
                             "<implicitSpringDamper>1</implicitSpringDamper>"
                             "<provideFeedback>true</provideFeedback></gazebo>")
    (joint,) = model.joints
    assert issues == []
    assert (joint.axis.spring_reference, joint.axis.spring_stiffness) == (0.5, 7)
    assert joint.extra == [
        "<physics><ode><limit><cfm>0.1</cfm></limit></ode></physics>",
        "<physics><ode><implicit_spring_damper>1</implicit_spring_damper></ode></physics>",
        "<physics><provide_feedback>true</provide_feedback></physics>",
        "<physics><ode><provide_feedback>true</provide_feedback></ode></physics>"]


def test_a_reference_to_nothing_is_a_warning():
    _, issues = robot_of(BODY + '<gazebo reference="gone"><mu1>1</mu1></gazebo>')
    assert codes(issues) == ["reference-unknown"] and not errors(issues)


@pytest.mark.parametrize("tag", ["mu1", "kp", "maxContacts", "turnGravityOff"])
def test_a_value_that_is_none_is_an_error(tag):
    _, issues = link_with(f"<{tag}>much</{tag}>")
    assert set(errors(issues)) == {"bad-value"}
    assert issues[0].xpath.startswith("/robot/gazebo/")


def test_an_undeclared_prefix_in_a_sensor_survives_lumping():
    model, issues = robot_of(
        robot_link("a") + robot_link("b") + robot_joint("ab", "a", "b", xyz="0 0 1")
        + '<gazebo reference="b"><sensor name="s" type="ray"><ignition:x>1</ignition:x></sensor>'
        "</gazebo>")
    assert errors(issues) == []
    assert "<pose>0 0 1 0 0 0</pose>" in model.links[0].extra[0]
    assert "x>1<" in model.links[0].extra[0]
