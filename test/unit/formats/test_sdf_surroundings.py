"""Populations, and what a world shows or tells without moving."""
import pytest
from lxml import etree
from reading import errors, warnings, world_of

from my_simulations.description.actor import Animation, Waypoint
from my_simulations.description.compare import differences
from my_simulations.description.surroundings import Atmosphere, Scene
from my_simulations.description.world import World
from my_simulations.formats.sdf.writer.entities import write_world
from my_simulations.geometry import Pose
from my_simulations.resources.resolver import Resolver

CAN = '<model name="can"><link name="l"/></model>'


def population(inside, name="p", pose="0 0 0 0 0 0"):
    return (f'<population name="{name}">{CAN}<pose>{pose}</pose>{inside}</population>')


def places(inside, **changes):
    world, issues = world_of(population(inside, **changes))
    assert errors(issues) == []
    return [model.pose.position for model in world.models]


BOX = "<box><size>4 2 1</size></box>"
CYLINDER = "<cylinder><radius>2</radius><length>3</length></cylinder>"


def kind(name, more=""):
    return f"<distribution><type>{name}</type>{more}</distribution>"


def test_clones_are_numbered_and_upright():
    world, issues = world_of(population("<model_count>3</model_count>" + BOX, pose="1 2 3 0 0 1"))
    assert [model.name for model in world.models] == ["can_clone_0", "can_clone_1", "can_clone_2"]
    assert all(model.pose.orientation == (0, 0, 0, 1) for model in world.models) and issues == []


@pytest.mark.parametrize("rule", ["random", "uniform"])
@pytest.mark.parametrize("region", [BOX, CYLINDER])
def test_models_stay_in_their_region_and_apart_and_repeat(rule, region):
    inside = f"<model_count>20</model_count>{region}{kind(rule)}"
    found = places(inside)
    assert len(set(found)) == 20 and found == places(inside)
    assert found != places(inside, name="other")
    for x, y, z in found:
        if region is BOX:
            assert abs(x) <= 2 and abs(y) <= 1 and abs(z) <= 0.5
        else:
            assert x * x + y * y <= 4 and 0 <= z <= 3


def test_a_uniform_population_is_more_even_than_a_random_one():
    def closest(points):
        return min(sum((a - b) ** 2 for a, b in zip(p, q))
                   for i, p in enumerate(points) for q in points[:i])

    inside = "<model_count>30</model_count><box><size>4 4 0</size></box>"
    assert closest(places(inside + kind("uniform"))) > 4 * closest(places(inside + kind("random")))


def test_a_grid_is_centred_with_columns_along_x():
    assert places(kind("grid", "<rows>2</rows><cols>3</cols><step>2 4 0</step>")) == [
        (-2, -2, 0), (0, -2, 0), (2, -2, 0), (-2, 2, 0), (0, 2, 0), (2, 2, 0)]


@pytest.mark.parametrize("axis, size", [(0, 4), (1, 2), (2, 1)])
def test_a_linear_population_steps_along_its_axis(axis, size):
    found = places(f"<model_count>4</model_count>{BOX}{kind('linear-' + 'xyz'[axis])}")
    assert [place[axis] for place in found] == [i * size / 4 - size / 2 for i in range(4)]
    assert all(place[k] == 0 for place in found for k in range(3) if k != axis)


@pytest.mark.parametrize("inside", [
    "<model_count>2</model_count>", "<model_count>100000000</model_count>" + BOX,
    BOX + kind("spiral"), CYLINDER + kind("linear-x"), "<box><size>1 -1 1</size></box>",
])
def test_a_population_that_says_not_enough_is_left_out(inside):
    world, issues = world_of(population(inside))
    assert world.models == [] and errors(issues) == ["population-unusable"]


def test_a_population_of_fewer_than_none_is_empty():
    assert places("<model_count>-5</model_count>" + BOX) == []


def test_the_defaults_are_those_of_the_format():
    world, _ = world_of("<gui/><scene/><wind/><atmosphere/>")
    assert (world.scene, world.atmosphere) == (Scene(), Atmosphere())
    assert world.gui_camera is None and world.magnetic_field == World().magnetic_field


def test_scene_view_and_weather_are_read():
    world, issues = world_of(
        "<scene><ambient>1 0 0</ambient><grid>0</grid><sky><time>12</time><clouds><speed>2</speed>"
        "</clouds></sky><fog><type>linear</type><end>9</end></fog></scene>"
        '<gui><camera name="c"><pose>1 2 3 0 0 0</pose><view_controller>fps</view_controller>'
        "<track_visual><name>box</name><min_dist>2</min_dist></track_visual></camera></gui>"
        "<wind><linear_velocity>1 2 3</linear_velocity></wind>"
        '<atmosphere type="adiabatic"><temperature>300</temperature></atmosphere>'
        "<magnetic_field>1 2 3</magnetic_field><spherical_coordinates><latitude_deg>48.5"
        "</latitude_deg></spherical_coordinates>", "1.7")
    assert errors(issues) == [] and warnings(issues) == []
    scene, camera = world.scene, world.gui_camera
    assert (scene.ambient, scene.grid, scene.sky.time, scene.sky.cloud_speed) == (
        (1, 0, 0, 1), False, 12, 2)
    assert (scene.fog.type, scene.fog.end) == ("linear", 9)
    assert (camera.name, camera.pose.position, camera.view_controller, camera.track,
            camera.track_min_dist) == ("c", (1, 2, 3), "fps", "box", 2)
    assert world.wind.linear_velocity == world.magnetic_field == (1, 2, 3)
    assert world.atmosphere.temperature == 300
    assert world.spherical_coordinates.latitude_deg == 48.5


def test_roads_and_actors_are_read_and_kept():
    road = '<road name="r"><width>3</width><point>0 0 0</point><point>1 0 0</point></road>'
    actor = (
        '<actor name="man"><pose>1 0 0 0 0 0</pose><skin><filename>walk.dae</filename></skin>'
        '<animation name="walk"><filename>walk.dae</filename><interpolate_x>true</interpolate_x>'
        "</animation><script><loop>false</loop><delay_start>2</delay_start>"
        '<trajectory id="1" type="run"/><trajectory id="0" type="walk"><waypoint><time>4</time>'
        "<pose>1 2 0 0 0 0</pose></waypoint></trajectory></script></actor>")
    world, issues = world_of(road + actor)
    assert errors(issues) == [] and warnings(issues) == []
    assert (world.roads[0].width, world.roads[0].points) == (3, [(0, 0, 0), (1, 0, 0)])
    man = world.actors[0]
    assert (man.skin, man.loop, man.delay_start, man.auto_start) == ("walk.dae", False, 2, True)
    assert man.animations == [Animation("walk", "walk.dae", 1.0, True)]
    assert [one.type for one in man.trajectories] == ["walk", "run"]
    assert man.trajectories[0].waypoints == [Waypoint(4, Pose((1, 2, 0)))]
    written = etree.fromstring(write_world(world)).find("world")
    assert shape_of(written.find("road")) == shape_of(etree.fromstring(road))
    found = shape_of(written.find("actor"))
    assert found[:2] == ("actor", {"name": "man"})
    assert sorted(found[3], key=str) == sorted(shape_of(etree.fromstring(actor.replace(
        '<trajectory id="1" type="run"/>', "").replace(
        "</script>", '<trajectory id="1" type="run"/></script>')))[3], key=str)


def shape_of(element):
    """Tag, attributes, text and children of an element, for comparisons."""
    return (element.tag, dict(element.attrib), (element.text or "").strip(),
            [shape_of(child) for child in element])


def test_unknown_elements_of_surroundings_and_actors_survive_saving():
    """No field holds them, so that only `extra` can."""
    kept = {
        "scene/mood": "grim", "scene/sky/material": "stars", "scene/sky/clouds/shape": "round",
        "scene/fog/smell": "salt", "gui/skin": "dark", "gui/camera/lens": "wide",
        "wind/gusts": "1", "atmosphere/haze": "2", "spherical_coordinates/datum": "3",
        "road/lanes": "2", "road/material/shininess": "4", "actor/mood": "glad",
        "actor/animation/speed": "5", "actor/script/trajectory/pace": "6",
        "actor/script/trajectory/waypoint/pause": "7",
    }
    root = etree.Element("world", name="w")
    for path, text in kept.items():
        at = root
        for tag in path.split("/"):
            there = at.find(tag)
            at = etree.SubElement(at, tag) if there is None else there
        at.text = text
    root.find("gui").append(etree.fromstring('<plugin name="p" filename="libp.so"/>'))
    root.find("gui").set("fullscreen", "true")
    inside = "".join(etree.tostring(child, encoding="unicode") for child in root)
    world, issues = world_of(inside, "1.7")
    assert errors(issues) == [] and world.extra == []
    written = etree.fromstring(write_world(world)).find("world")
    assert {path: written.findtext(path) for path in kept} == kept
    assert written.find("gui").get("fullscreen") == "true"
    assert written.find("gui/plugin").get("filename") == "libp.so"
    copy, _ = world_of("".join(etree.tostring(child, encoding="unicode") for child in written),
                       "1.7")
    assert differences(world, copy) == []


def test_an_included_actor_is_saved_as_the_include_that_brings_it(tmp_path):
    folder = tmp_path / "walker"
    folder.mkdir()
    (folder / "model.sdf").write_text(
        '<sdf version="1.6"><actor name="walker"><skin><filename>walk.dae</filename></skin></actor>'
        "</sdf>")
    include = "<include><uri>model://walker</uri><name>man</name></include>"
    world, _ = world_of(include, resolver=Resolver([str(tmp_path)]))
    assert [actor.name for actor in world.actors] == ["man"] and world.extra == []
    written = etree.fromstring(write_world(world)).find("world")
    assert written.find("actor") is None
    assert shape_of(written.find("include")) == shape_of(etree.fromstring(include))


def test_what_does_nothing_is_said_once_for_each_kind():
    sensor = '<sensor name="{}" type="{}"/>'
    world, issues = world_of(
        '<model name="m"><link name="l">' + "".join(
            sensor.format(n, t) for n, t in enumerate(("sonar", "sonar", "rfid")))
        + '</link></model><road name="r"/><road name="s"/>')
    assert [issue.message.split(">")[0] for issue in issues] == ["<road", "<sensor sonar",
                                                                 "<sensor rfid"]
    assert all(issue.code == "not-simulated" and issue.line for issue in issues)


@pytest.mark.parametrize("tag, value", [("scene", "<grid>0</grid>"),
                                        ("atmosphere", "<pressure>1</pressure>"),
                                        ("spherical_coordinates", "<elevation>1</elevation>")])
def test_the_first_of_repeated_surroundings_is_used(tag, value):
    other = value.replace("0", "1") if "0" in value else value.replace("1", "2")
    world, issues = world_of(f"<{tag}>{value}</{tag}><{tag}>{other}</{tag}>")
    alone, _ = world_of(f"<{tag}>{value}</{tag}>")
    assert getattr(world, tag) == getattr(alone, tag)
    assert [issue.code for issue in issues] == ["element-repeated"]
