"""Models and links: defaults, poses, frames, names, nested ones."""
import math
import random

import pytest
from reading import INERTIAL, VALID, codes, errors, link_of, model_of, sdf, tolerated, warnings

from my_simulations.description.flatten import flatten_model
from my_simulations.description.model import Inertial, Link, Model
from my_simulations.description.shapes import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Empty,
    Heightmap,
    ImageMap,
    Mesh,
    Plane,
    Polyline,
    Sphere,
    Surface,
    TerrainTexture,
)
from my_simulations.errors import Severity, errors_of
from my_simulations.formats.reading import parse_world, read_entity
from my_simulations.formats.sdf import model
from my_simulations.formats.sdf.model import DEEPEST
from my_simulations.geometry import quat_from_rpy
from my_simulations.resources.resolver import Resolver


def collision_of(inside):
    link, issues = link_of(f'<collision name="c">{inside}</collision>')
    return link.collisions[0], issues


def geometry_of(shape):
    return collision_of(f"<geometry>{shape}</geometry>")[0].geometry


def test_a_link_without_inertial_has_mass_1_and_unit_inertia():
    link, issues = link_of("")
    assert link.inertial == Inertial(1.0, ixx=1.0, iyy=1.0, izz=1.0)
    assert issues == []


def test_an_empty_inertial_has_the_same_defaults():
    assert link_of("<inertial/>")[0].inertial == Inertial()


def test_an_empty_model_has_the_defaults_of_the_format():
    model, issues = model_of("")
    assert model == Model("m") and issues == []


def test_the_switches_of_a_model_and_a_link_are_read():
    model, issues = model_of(
        "<static>1</static><self_collide>TRUE</self_collide>"
        "<allow_auto_disable>False</allow_auto_disable>"
        '<link name="l"><gravity>0</gravity><kinematic>1</kinematic><self_collide>0</self_collide>'
        "<velocity_decay><linear>0.1</linear><angular>0.2</angular></velocity_decay></link>")
    assert issues == []
    assert (model.static, model.self_collide, model.allow_auto_disable) == (True, True, False)
    link = model.links[0]
    assert (link.gravity, link.kinematic, link.self_collide) == (False, True, False)
    assert (link.linear_decay, link.angular_decay) == (0.1, 0.2)


def test_a_link_says_nothing_of_self_collision_where_the_file_does_not():
    assert link_of("")[0].self_collide is None


def test_every_shape_is_read():
    assert geometry_of("<box><size>1 2 3</size></box>") == Box((1, 2, 3))
    assert geometry_of("<sphere><radius>2</radius></sphere>") == Sphere(2)
    assert geometry_of("<cylinder><radius>2</radius><length>3</length></cylinder>") == Cylinder(
        2, 3)
    assert geometry_of("<plane><normal>0 1 0</normal><size>5 6</size></plane>") == Plane(
        (0, 1, 0), (5, 6))
    assert geometry_of("<empty/>") == Empty()
    assert geometry_of("<box/>") == Box()


def test_a_mesh_is_found_beside_the_file_and_keeps_its_part_and_scale():
    text = sdf('<model name="m"><link name="l"><collision name="c"><geometry><mesh>'
               "<uri>two_parts.obj</uri><scale>1 2 3</scale><submesh><name>high</name>"
               "<center>true</center></submesh></mesh></geometry></collision></link></model>")
    model, issues = read_entity(text, Resolver(resource_paths=[VALID]))
    mesh = model.links[0].collisions[0].geometry
    assert mesh == Mesh("two_parts.obj", f"{VALID}/two_parts.obj", (1, 2, 3), "high", True)
    assert issues == []


def test_a_missing_visual_mesh_is_a_warning_and_the_visual_stays_without_path():
    link, issues = link_of('<visual name="v"><geometry><mesh><uri>model://gone/a.dae</uri></mesh>'
                           "</geometry></visual>")
    assert link.visuals[0].geometry == Mesh("model://gone/a.dae")
    assert [(i.code, i.severity) for i in issues] == [("mesh-not-found", Severity.WARNING)]


@pytest.mark.parametrize("shape, expected", [
    ("<capsule><radius>0.2</radius><length>0.6</length></capsule>", Capsule(0.2, 0.6)),
    ("<capsule/>", Capsule(0.5, 1.0)),
    ("<ellipsoid><radii>1 2 3</radii></ellipsoid>", Ellipsoid((1, 2, 3))),
    ("<cone><radius>0.3</radius><length>2</length></cone>", Cone(0.3, 2.0)),
    ("<polyline><height>2</height><point>0 0</point><point>1 0</point><point>1 1</point>"
     "<point>0 0.00001</point></polyline>", Polyline([[(0, 0), (1, 0), (1, 1)]], 2.0)),
])
@pytest.mark.parametrize("owner", ["collision", "visual"])
def test_shapes_are_read_at_any_version(owner, shape, expected):
    for version in ("1.4", "1.7", "1.11"):
        link, issues = link_of(f'<{owner} name="c"><geometry>{shape}</geometry></{owner}>', version)
        items = link.collisions if owner == "collision" else link.visuals
        assert [item.geometry for item in items] == [expected] and errors(issues) == []


def test_further_polylines_are_holes():
    def loop(a, b):
        return "".join(f"<point>{x} {y}</point>" for x, y in ((a, a), (b, a), (b, b), (a, b)))

    link, issues = link_of(f'<collision name="c"><geometry><polyline>{loop(0, 3)}</polyline>'
                           f"<polyline>{loop(1, 2)}</polyline></geometry></collision>")
    assert [len(one) for one in link.collisions[0].geometry.loops] == [4, 4] and issues == []


def test_images_are_found_and_their_fields_read(tmp_path):
    image = tmp_path / "grey.png"
    image.write_bytes(b"")
    link, issues = link_of(
        f'<collision name="c"><geometry><heightmap><uri>{image}</uri><size>4 4 -1</size>'
        "<pos>1 2 3</pos><sampling>4</sampling><texture><size>2</size></texture></heightmap>"
        f'</geometry></collision><collision name="d"><geometry><image><uri>{image}</uri>'
        "<scale>0.1</scale><threshold>100</threshold><height>2</height><granularity>3</granularity>"
        "</image></geometry></collision>")
    terrain, plan = (c.geometry for c in link.collisions)
    assert terrain == Heightmap(str(image), str(image), (4, 4, -1), (1, 2, 3), 4,
                                [TerrainTexture(size=2.0)])
    assert plan == ImageMap(str(image), str(image), 0.1, 100, 2.0, 3)
    assert errors(issues) == []


@pytest.mark.parametrize("shape, code", [
    ("<heightmap/>", "image-not-found"),
    ("<image><uri>gone.png</uri></image>", "image-not-found"),
    ("<polyline/>", "bad-shape"),
    ("<polyline><point>0 0</point><point>1 1</point></polyline>", "bad-shape"),
    ("<capsule><radius>-1</radius></capsule>", "bad-shape"),
    ("<ellipsoid><radii>1 -1 1</radii></ellipsoid>", "bad-shape"),
    ("<cone><length>-1</length></cone>", "bad-shape"),
])
def test_a_shape_with_a_fault_is_left_out_and_kept(shape, code):
    link, issues = link_of(f'<collision name="c"><geometry>{shape}</geometry></collision>')
    assert link.collisions == [] and (tolerated(issues) or errors(issues)) == [code]
    assert link.extra[0].startswith('<collision name="c">')


def test_the_surface_is_read():
    collision, issues = collision_of(
        "<geometry><box/></geometry><max_contacts>4</max_contacts><laser_retro>7</laser_retro>"
        "<surface><bounce><restitution_coefficient>0.5</restitution_coefficient>"
        "<threshold>0.1</threshold></bounce><friction><ode><mu>0.3</mu><mu2>0.4</mu2>"
        "<fdir1>1 0 0</fdir1><slip1>0.1</slip1><slip2>0.2</slip2></ode>"
        "<torsional><coefficient>0.7</coefficient><patch_radius>0.05</patch_radius></torsional>"
        "</friction>"
        "<contact><collide_without_contact>true</collide_without_contact>"
        "<collide_bitmask>3</collide_bitmask><ode><kp>1e6</kp><kd>2</kd><max_vel>3</max_vel>"
        "<min_depth>0.001</min_depth></ode></contact></surface>")
    assert issues == [] and collision.extra == []
    assert (collision.max_contacts, collision.laser_retro) == (4, 7.0)
    assert collision.surface == Surface(
        mu=0.3, mu2=0.4, fdir1=(1, 0, 0), slip1=0.1, slip2=0.2, torsion=0.7, patch_radius=0.05,
        restitution=0.5, bounce_threshold=0.1, kp=1e6, kd=2, max_vel=3, min_depth=0.001,
        collide_without_contact=True, collide_bitmask=3)


def test_an_empty_friction_and_default_texts_leave_the_defaults():
    collision, issues = collision_of(
        "<geometry><box/></geometry><laser_retro>__default__</laser_retro>"
        "<surface><friction><ode/></friction><contact><ode><kp></kp></ode></contact></surface>")
    assert issues == []
    assert (collision.surface, collision.laser_retro) == (Surface(), 0.0)


def test_what_is_known_but_not_simulated_is_kept_with_its_place_and_without_a_warning():
    collision, issues = collision_of(
        "<geometry><box/></geometry><surface><friction><torsional><ode><slip>2</slip></ode>"
        "</torsional></friction></surface>")
    assert issues == []
    assert collision.extra == ["<surface><friction><torsional><ode><slip>2</slip></ode>"
                               "</torsional></friction></surface>"]


def test_a_sensor_is_kept_whole():
    xml = '<sensor name="s" type="rfid"><update_rate>30</update_rate></sensor>'
    link, issues = link_of(xml)
    assert link.extra == [xml] and errors(issues) == [] and warnings(issues) == []
    assert codes(issues) == ["not-simulated"]


def test_an_unknown_element_is_kept_with_a_warning_and_a_guess():
    link, issues = link_of("<colision/>")
    (issue,) = issues
    assert (issue.code, issue.severity) == ("unknown-element", Severity.WARNING)
    assert "collision" in issue.hint and link.extra == ["<colision/>"]
    assert issue.xpath == "/sdf/model/link/colision"


def test_materials_keep_colours_and_scripts():
    link, issues = link_of(
        '<visual name="v"><geometry><box/></geometry><transparency>0.5</transparency>'
        "<cast_shadows>0</cast_shadows><material><double_sided>1</double_sided>"
        "<ambient>1 0 0</ambient>"
        "<diffuse>0 1 0 0.5</diffuse><script><uri>model://a/scripts</uri><uri>model://a/t</uri>"
        "<name>A/B</name></script><shader type='pixel'/></material></visual>")
    visual = link.visuals[0]
    assert warnings(issues) == ["material-script-not-found"] * 2
    assert (visual.transparency, visual.cast_shadows) == (0.5, False)
    assert visual.material.ambient == (1, 0, 0, 1) and visual.material.double_sided
    assert visual.material.diffuse == (0, 1, 0, 0.5)
    assert visual.material.specular is None
    assert visual.material.script_uris == ["model://a/scripts", "model://a/t"]
    assert visual.material.script_name == "A/B"
    assert visual.extra == ['<material><shader type="pixel"/></material>']


def test_repeated_collision_and_visual_names_get_a_suffix_with_a_warning():
    one = '<{0} name="x"><geometry><box/></geometry></{0}>'
    link, issues = link_of((one * 3).format("collision") + (one * 2).format("visual"))
    assert [c.name for c in link.collisions] == ["x", "x_1", "x_2"]
    assert [v.name for v in link.visuals] == ["x", "x_1"]
    assert warnings(issues) == ["name-changed"] * 3


def test_a_pose_may_be_spread_over_lines():
    link, _ = link_of("<pose>\n  1\t2\n3 0 0\n +1e-1 </pose>")
    assert link.pose.position == (1, 2, 3)
    assert link.pose.orientation == pytest.approx(quat_from_rpy(0, 0, 0.1))


def test_poses_are_taken_relative_to_links_joints_frames_and_nested_models():
    model, issues = model_of(
        '<link name="a"><pose>1 0 0 0 0 1.5707963267948966</pose></link>'
        '<link name="b"><pose relative_to="a">1 0 0 0 0 0</pose></link>'
        '<link name="c"><pose relative_to="f">0 0 1 0 0 0</pose></link>'
        '<link name="d"><pose relative_to="n">0 0 1 0 0 0</pose></link>'
        '<link name="e"><pose relative_to="j">0 0 1 0 0 0</pose></link>'
        '<frame name="f" attached_to="b"><pose>0 0 1 0 0 0</pose></frame>'
        '<model name="n"><pose relative_to="f">0 0 1 0 0 0</pose><link name="l"/></model>'
        '<joint name="j" type="fixed"><parent>a</parent><child>b</child>'
        "<pose>0 0 5 0 0 0</pose></joint>", "1.7")
    assert errors(issues) == []
    at = {link.name: link.pose.position for link in model.links}
    assert at["b"] == pytest.approx((1, 1, 0))
    assert at["c"] == pytest.approx((1, 1, 2))
    assert at["d"] == pytest.approx((1, 1, 3))
    assert at["e"] == pytest.approx((1, 1, 6))
    assert model.models[0].pose.position == pytest.approx((1, 1, 2))


def test_the_pose_of_a_collision_may_be_given_in_another_frame():
    model, issues = model_of(
        '<link name="a"><pose>1 0 0 0 0 0</pose></link>'
        '<link name="b"><pose>3 0 0 0 0 0</pose><collision name="c">'
        '<pose relative_to="a">0 0 1 0 0 0</pose><geometry><box/></geometry></collision></link>',
        "1.7")
    assert errors(issues) == []
    assert model.links[1].collisions[0].pose.position == pytest.approx((-2, 0, 1))


def test_a_joint_pose_is_in_the_child_link_whatever_it_was_given_in():
    links = ('<link name="a"><pose>1 0 0 0 0 0</pose></link>'
             '<link name="b"><pose>3 0 0 0 0 0</pose></link>')
    joint = ('<joint name="j" type="fixed"><parent>a</parent><child>b</child>'
             "<pose{}>0 0 1 0 0 0</pose></joint>")
    plain, _ = model_of(links + joint.format(""), "1.7")
    given, _ = model_of(links + joint.format(' relative_to="a"'), "1.7")
    assert plain.joints[0].pose.position == (0, 0, 1)
    assert given.joints[0].pose.position == pytest.approx((-2, 0, 1))


def test_nested_models_have_scoped_links_that_joints_may_name():
    model, issues = model_of(
        '<link name="a"/><model name="n"><pose>0 0 1 0 0 0</pose><link name="b">'
        f"<pose>1 0 0 0 0 0</pose>{INERTIAL}</link></model>"
        '<joint name="j" type="fixed"><parent>a</parent><child>n::b</child></joint>')
    assert errors(issues) == []
    flat = flatten_model(model)
    assert [link.name for link in flat.links] == ["a", "n::b"]
    assert flat.links[1].pose.position == (1, 0, 1)


def test_a_static_model_may_have_any_inertia():
    model, issues = model_of(
        '<static>true</static><link name="l"><inertial><mass>0</mass><inertia><ixx>0</ixx>'
        "<iyy>0</iyy><izz>0</izz></inertia></inertial></link>"
        '<model name="n"><link name="l"><inertial><mass>0</mass></inertial></link></model>')
    assert errors(issues) == [] and len(model.models) == 1


@pytest.mark.parametrize("shape", [
    "<box><size>1 1 0</size></box>", "<box><size>0 0 0</size></box>",
    "<sphere><radius>0</radius></sphere>",
    "<cylinder><radius>0</radius><length>1</length></cylinder>",
    "<capsule><radius>0</radius></capsule>", "<ellipsoid><radii>1 0 1</radii></ellipsoid>",
])
@pytest.mark.parametrize("static", ["", "<static>true</static>"])
def test_a_collision_of_zero_size_touches_nothing_and_is_left_out_with_a_warning(shape, static):
    model, issues = model_of(
        f'{static}<link name="l"><collision name="c"><geometry>{shape}</geometry></collision>'
        "</link>")
    assert model.links[0].collisions == []
    assert model.links[0].extra[0].startswith('<collision name="c">')
    assert [(i.code, i.severity) for i in issues] == [("bad-shape", Severity.WARNING)]


@pytest.mark.parametrize("moments, expected", [
    ((1, 0, 0), (1, 0.5, 0.5)), ((0, 2, 0), (1, 2, 1)), ((0.5, 0.5, 0), (0.5, 0.5, 0.0005)),
    ((3, 0, 1), (3, 2, 1)),
])
def test_moments_of_zero_beside_others_become_what_a_body_may_have(moments, expected):
    xx, yy, zz = moments
    model, issues = model_of(
        f'<link name="l"><inertial><mass>2</mass><inertia><ixx>{xx}</ixx><iyy>{yy}</iyy>'
        f"<izz>{zz}</izz></inertia></inertial></link>")
    inertial = model.links[0].inertial
    assert (inertial.ixx, inertial.iyy, inertial.izz) == pytest.approx(expected)
    assert inertial.mass == 2
    assert [(i.code, i.severity) for i in issues] == [("inertia-zero", Severity.WARNING)]


def test_zeros_beside_products_of_inertia_give_one_about_each_axis():
    model, issues = model_of(
        '<link name="l"><inertial><inertia><ixx>1</ixx><iyy>1</iyy><izz>0</izz><ixy>0.1</ixy>'
        "</inertia></inertial></link>")
    assert tolerated(issues) == ["inertia-not-positive"]
    assert model.links[0].inertial == Inertial()


def test_plugins_are_kept_as_written():
    xml = '<plugin name="p" filename="libp.so"><a b="1">2</a></plugin>'
    model, issues = model_of('<link name="l"/>' + xml)
    assert issues == []  # the plugin loader reports unsupported plugins
    assert [(p.name, p.filename, p.xml) for p in model.plugins] == [("p", "libp.so", xml)]


def test_a_document_without_model_name_gets_one_with_a_warning():
    model, issues = read_entity(sdf('<model><link name="l"/></model>'), Resolver())
    assert model.name == "unnamed" and codes(issues) == ["name-missing"]


def test_the_first_entity_of_a_document_is_taken():
    light, _ = read_entity(sdf('<light name="lamp" type="spot"/><model name="m"/>'), Resolver())
    assert (light.name, light.type) == ("lamp", "spot")
    model, _ = read_entity(sdf('<world name="w"><gravity>0 0 0</gravity><model name="m"/></world>'),
                           Resolver())
    assert model.name == "m"


@pytest.mark.parametrize("seed", range(20))
def test_the_numbers_of_a_random_model_survive_reading(seed):
    rng = random.Random(seed)

    def some(count, low=-10.0, high=10.0):
        return [rng.uniform(low, high) for _ in range(count)]

    pose, size, mu = some(6), some(3, 1e-3, 5), some(2, 0, 2)
    mass, moments = rng.uniform(1e-3, 1e3), [m + 3 for m in some(3, 0, 1)]
    lower, upper = sorted(some(2))
    text = " ".join(map(repr, pose))
    model, issues = model_of(
        f'<pose>{text}</pose><link name="a"><inertial><mass>{mass!r}</mass><inertia>'
        + "".join(f"<{n}>{v!r}</{n}>" for n, v in zip(("ixx", "iyy", "izz"), moments))
        + f'</inertia></inertial><collision name="c"><geometry><box><size>'
        f'{" ".join(map(repr, size))}</size></box></geometry><surface><friction><ode>'
        f"<mu>{mu[0]!r}</mu><mu2>{mu[1]!r}</mu2></ode></friction></surface></collision></link>"
        f'<link name="b"/><joint name="j" type="prismatic"><parent>a</parent><child>b</child>'
        f"<axis><xyz>0 0 -3</xyz><limit><lower>{lower!r}</lower><upper>{upper!r}</upper></limit>"
        "</axis></joint>")
    assert issues == []
    link, axis = model.links[0], model.joints[0].axis
    assert model.pose.position == tuple(pose[:3])
    assert model.pose.orientation == quat_from_rpy(*pose[3:])
    assert (link.inertial.ixx, link.inertial.iyy, link.inertial.izz) == tuple(moments)
    assert link.inertial.mass == mass
    assert link.collisions[0].geometry == Box(tuple(size))
    assert (link.collisions[0].surface.mu, link.collisions[0].surface.mu2) == tuple(mu)
    assert (axis.lower, axis.upper) == (lower, upper)
    assert axis.xyz == (0.0, 0.0, -1.0)
    assert math.isclose(sum(c * c for c in link.pose.orientation), 1.0)
    assert isinstance(link, Link)


def nested_models(count):
    text = "".join(f'<model name="m{n}"><link name="l"/>' for n in range(count))
    return sdf(f'<world name="w">\n{text}{"</model>" * count}'
               '<model name="after"><link name="l"/></model></world>')


@pytest.mark.parametrize("count, kept", [(DEEPEST, DEEPEST), (DEEPEST + 1, DEEPEST),
                                         (220, DEEPEST)])
def test_models_inside_models_are_read_up_to_a_depth(count, kept):
    world, issues = parse_world(nested_models(count), Resolver())
    assert [model.name for model in world.models] == ["m0", "after"]
    assert len(flatten_model(world.models[0]).links) == kept
    assert [issue.code for issue in errors_of(issues)] == ["models-too-deep"] * (count > kept)
    assert all(issue.line == 2 for issue in errors_of(issues))


def test_a_fault_of_a_nested_model_is_told_once_however_deep_it_lies(monkeypatch):
    text = nested_models(20).replace('<link name="l"/></model>', '<link name="l"><inertial><mass>-1'
                                     '</mass></inertial></link></model>', 1)
    asked = []
    original = model.find_own_faults
    monkeypatch.setattr(model, "find_own_faults",
                        lambda model, static: asked.append(model) or original(model, static))
    _, issues = parse_world(text, Resolver())
    assert len(errors_of(issues)) == 1
    assert len(asked) == 21  # each model once: 200 models would be 20 000 else
