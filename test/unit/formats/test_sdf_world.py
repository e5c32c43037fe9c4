"""Worlds: physics, lights, includes, order, what is kept."""
import os

import pytest
from reading import INERTIAL, codes, errors, sdf, tolerated, warnings, world_of

from my_simulations.description.light import Light
from my_simulations.description.surroundings import Gui, Scene
from my_simulations.description.world import Physics
from my_simulations.formats.reading import parse_world, read_entity, read_world
from my_simulations.resources.resolver import Resolver

BOX = '<link name="l"><collision name="c"><geometry><box/></geometry></collision></link>'


@pytest.fixture
def resolver(tmp_path):
    def put(name, text, file="model.sdf", config=None):
        folder = tmp_path / name
        folder.mkdir(exist_ok=True)
        (folder / file).write_text(text)
        if config:
            (folder / "model.config").write_text(config)

    put("crate", sdf(f'<model name="crate"><pose>9 9 9 0 0 0</pose>{BOX}</model>'))
    put("lamp", sdf('<light name="lamp" type="directional"><pose>0 0 5 0 0 0</pose></light>'))
    put("versions", sdf('<model name="old"/>', "1.3"), "old.sdf",
        "<model><name>v</name><sdf version='1.3'>old.sdf</sdf><sdf version='1.6'>new.sdf</sdf>"
        "<sdf version='2.0'>future.sdf</sdf></model>")
    put("versions", sdf('<model name="new"/>'), "new.sdf")
    put("versions", sdf('<model name="future"/>'), "future.sdf")
    put("robot", '<robot name="bot"><link name="l"><inertial><mass value="1"/><inertia ixx="1"'
        ' ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>', "model.urdf",
        "<model><name>r</name><sdf>model.urdf</sdf></model>")
    put("broken", sdf('<model name="broken"><link name="l"><inertial><mass>0</mass></inertial>'
                      "</link></model>"))
    put("cut", "<sdf version='1.6'><model")
    put("actor", sdf('<actor name="man"/>'))
    return Resolver([str(tmp_path)])


def include(uri, inside=""):
    return f"<include><uri>{uri}</uri>{inside}</include>"


def test_an_empty_world_has_the_defaults_of_the_format():
    world, issues = world_of("")
    assert (world.name, world.gravity, world.physics) == ("w", (0, 0, -9.8), Physics())
    assert issues == []


@pytest.mark.parametrize("written, shown, told", [
    ("w", "w", ""), ("Wörld 世界", "Wörld 世界", ""),
    ("a&#10;error: b", "a error: b", "U+000A at position 2"),
    ("a&#x202E;b", "a b", "U+202E at position 2")])
def test_the_name_of_a_world_has_blanks_for_characters_that_are_not_shown(written, shown, told):
    world, issues = parse_world(sdf(f'<world name="{written}"/>'), Resolver())
    assert world.name == shown
    assert tolerated(issues) == (["name-characters"] if told else [])
    assert all(told in issue.message and issue.line == 1 for issue in issues)


def test_the_shipped_empty_world_gives_a_plane_and_a_light():
    resolver = Resolver.from_environment()
    loaded = read_world(resolver.resolve("worlds/empty.world"), resolver)
    world, issues = loaded.world, loaded.issues
    assert errors(issues) == []
    assert [model.name for model in world.models] == ["ground_plane"]
    assert world.models[0].static
    assert type(world.models[0].links[0].collisions[0].geometry).__name__ == "Plane"
    assert [light.type for light in world.lights] == ["directional"]


def test_the_physics_settings_are_read():
    world, issues = world_of(
        '<physics name="p" type="bullet"><max_step_size>0.01</max_step_size>'
        "<real_time_factor>2</real_time_factor><real_time_update_rate>0</real_time_update_rate>"
        "<max_contacts>7</max_contacts><ode><solver><type>quick</type><iters>10</iters>"
        "<precon_iters>3</precon_iters><sor>1.1</sor></solver><constraints><cfm>0.1</cfm>"
        "<erp>0.3</erp><contact_max_correcting_vel>5</contact_max_correcting_vel>"
        "<contact_surface_layer>0.01</contact_surface_layer></constraints></ode></physics>")
    physics = world.physics
    assert issues == []
    assert (physics.name, physics.type) == ("p", "bullet")
    assert (physics.max_step_size, physics.real_time_factor) == (0.01, 2)
    assert physics.real_time_update_rate == 0
    ode = physics.ode
    assert (ode.iters, ode.precon_iters, ode.sor, ode.max_contacts) == (10, 3, 1.1, 7)
    assert (ode.cfm, ode.erp, ode.contact_max_correcting_vel) == (0.1, 0.3, 5)
    assert ode.contact_surface_layer == 0.01
    assert world.extra == ["<physics><ode><solver><type>quick</type></solver></ode></physics>"]


def test_the_default_preset_is_used_else_the_first():
    one = '<physics name="{0}"{1}><max_step_size>{2}</max_step_size></physics>'
    both = one.format("a", "", 0.01) + one.format("b", ' default="true"', 0.02)
    world, _ = world_of(both)
    assert (world.physics.name, world.physics.max_step_size) == ("b", 0.02)
    assert 'name="a"' in world.extra[0]
    world, _ = world_of(both.replace(' default="true"', ""))
    assert world.physics.name == "a"


def test_lights_are_read():
    world, issues = world_of(
        '<light name="s" type="spot"><pose>1 2 3 0 0 0</pose><cast_shadows>1</cast_shadows>'
        "<diffuse>.5 .5 .5 1</diffuse><specular>.2 .2 .2 1</specular><attenuation>"
        "<range>20</range><constant>.5</constant><linear>.01</linear><quadratic>.001</quadratic>"
        "</attenuation><direction>0 1 -1</direction><spot><inner_angle>.1</inner_angle>"
        "<outer_angle>.5</outer_angle><falloff>2</falloff></spot></light>")
    (light,) = world.lights
    assert issues == []
    assert light.pose.position == (1, 2, 3)
    assert light == Light("s", "spot", light.pose, True, (.5, .5, .5, 1), (.2, .2, .2, 1), 20, .5,
                          .01, .001, (0, 1, -1), .1, .5, 2)


def test_the_pose_of_an_include_replaces_the_models_own(resolver):
    world, issues = world_of(
        include("model://crate") + include("model://crate", "<name>c2</name>"
                                           "<pose>1 2 3 0 0 0</pose>"), resolver=resolver)
    assert issues == []
    assert [(m.name, m.pose.position) for m in world.models] == [
        ("crate", (9, 9, 9)), ("c2", (1, 2, 3))]
    assert world.models[0].uri == "model://crate"


def test_an_include_may_make_a_model_static_and_bring_plugins(resolver):
    world, _ = world_of(include("model://crate", "<static>true</static>"
                                '<plugin name="p" filename="f"/>'), resolver=resolver)
    assert world.models[0].static
    assert [plugin.name for plugin in world.models[0].plugins] == ["p"]


def test_lights_and_robots_are_included_too(resolver):
    world, issues = world_of(
        include("model://lamp", "<pose>1 1 1 0 0 0</pose><name>lamp2</name>")
        + include("model://robot", "<pose>0 0 2 0 0 0</pose>"), resolver=resolver)
    assert errors(issues) == []
    assert [(light.name, light.pose.position) for light in world.lights] == [("lamp2", (1, 1, 1))]
    assert [(m.name, m.pose.position) for m in world.models] == [("bot", (0, 0, 2))]


def test_the_highest_known_version_of_a_model_is_taken(resolver):
    world, _ = world_of(include("model://versions"), resolver=resolver)
    assert world.models[0].name == "new"


def test_faults_of_an_included_file_name_that_file(resolver, tmp_path):
    world, issues = world_of(include("model://broken") + include("model://cut")
                             + include("model://crate"), resolver=resolver)
    assert [model.name for model in world.models] == ["crate"]
    files = {(issue.code, os.path.basename(os.path.dirname(issue.file))) for issue in issues}
    assert files == {("mass-not-positive", "broken"), ("xml-truncated", "cut")}


def test_a_broken_model_included_twice_is_left_out_twice_and_reported_once(resolver):
    world, issues = world_of(
        include("model://broken") + include("model://broken", "<name>again</name>"),
        resolver=resolver)
    assert world.models == [] and codes(issues) == ["mass-not-positive"]


def test_an_actor_is_left_out_with_a_warning(resolver):
    world, issues = world_of(include("model://actor"), resolver=resolver)
    assert world.models == [] and warnings(issues) == ["actor-unsupported"]


def test_a_model_may_include_another_under_its_own_name(resolver):
    world, issues = world_of(
        '<model name="pile"><link name="base"/><include><uri>model://crate</uri><name>top</name>'
        "<pose>0 0 1 0 0 0</pose></include></model>", resolver=resolver)
    assert issues == []
    inner = world.models[0].models[0]
    assert (inner.name, inner.pose.position, inner.links[0].name) == ("top", (0, 0, 1), "l")


def test_a_spawned_document_may_be_a_world_with_an_include(resolver):
    model, issues = read_entity(
        sdf("<world name='default'>" + include("model://crate", "<name>mine</name>") + "</world>"),
        resolver)
    assert (model.name, issues) == ("mine", [])


def test_the_second_model_of_one_name_is_left_out_with_a_warning():
    world, issues = world_of(f'<model name="a">{BOX}</model><model name="a"/>'
                             '<light name="a" type="point"/><light name="a" type="spot"/>')
    assert len(world.models) == 1 and world.models[0].links
    assert [light.type for light in world.lights] == ["point"]
    assert codes(issues) == ["name-repeated", "name-repeated"]


def test_models_keep_the_order_of_the_file_includes_among_them(resolver):
    world, _ = world_of('<model name="a"/>' + include("model://crate") + '<model name="z"/>',
                        resolver=resolver)
    assert [model.name for model in world.models] == ["a", "crate", "z"]


def test_a_pose_in_a_world_may_be_relative_to_another_model():
    world, issues = world_of(
        '<model name="b"><pose relative_to="a">1 0 0 0 0 0</pose></model>'
        '<model name="a"><pose>5 0 0 0 0 0</pose></model>'
        '<model name="c"><pose relative_to="gone">1 0 0 0 0 0</pose></model>', "1.7")
    assert [(m.name, m.pose.position[0]) for m in world.models] == [("b", 6), ("a", 5), ("c", 1)]
    assert tolerated(issues) == ["frame-unknown"]


def test_what_is_not_simulated_is_kept_without_a_warning():
    kept = ["<scene><shadows>0</shadows></scene>", '<gui fullscreen="0"/>',
            '<state world_name="w"/>', '<actor name="man"/>']
    world, issues = world_of("".join(kept) + '<plugin name="p" filename="f"/>')
    assert world.extra == [] and errors(issues) == [] and warnings(issues) == []
    assert world.scene == Scene(shadows=False) and world.gui == Gui()
    assert [actor.name for actor in world.actors] == ["man"] and world.state.world_name == "w"
    assert codes(issues) == ["not-simulated"]  # the actor
    assert [plugin.name for plugin in world.plugins] == ["p"]


def test_plugins_of_the_client_are_told_once_for_each_library():
    plugin = '<plugin name="{}" filename="lib{}.so"/>'
    world, issues = world_of("<gui>" + plugin.format("p", "one") + plugin.format("q", "two")
                             + plugin.format("r", "one") + "</gui>")
    assert sorted(issue.message.split()[1] for issue in issues) == ["libone.so>", "libtwo.so>"]


def test_only_the_first_of_several_worlds_is_read():
    world, issues = parse_world(sdf("<world name='a'/><world name='b'/>"), Resolver())
    assert world.name == "a" and warnings(issues) == ["world-many"]


def test_names_with_spaces_are_legal():
    world, issues = world_of(f'<model name="a crate"><link name="its body">{INERTIAL}</link>'
                             "</model>")
    assert world.models[0].links[0].name == "its body" and issues == []
