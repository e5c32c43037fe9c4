"""What is seen: pixels of materials, terrains and copies read back; hints in small windows."""
from __future__ import annotations

import base64
import io
import math
import os

import numpy as np
import pytest
import trimesh
from PIL import Image
from support import SWIFTSHADER_FLAGS, Editor, Node, wait_for

from my_simulations.description.model import Link, Model
from my_simulations.description.shapes import Mesh, Visual
from my_simulations.description.surroundings import Scene
from my_simulations.geometry import Pose, quat_from_rpy
from my_simulations.sensing.api import RGB, Body, CameraSpec
from my_simulations.sensing.camera.renderer import Renderer
from my_simulations.sensing.poses import matrix

QUAD = """<source id="p"><float_array id="pa" count="12">-1 0 -1 1 0 -1 1 0 1 -1 0 1</float_array>
  <technique_common><accessor source="#pa" count="4" stride="3">
  <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
  </accessor></technique_common></source>
  <source id="n"><float_array id="na" count="6">0 -1 0 0 1 0</float_array>
  <technique_common><accessor source="#na" count="2" stride="3">
  <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
  </accessor></technique_common></source>
  <source id="t"><float_array id="ta" count="8">0 0 1 0 1 1 0 1</float_array>
  <technique_common><accessor source="#ta" count="4" stride="2">
  <param name="S" type="float"/><param name="T" type="float"/>
  </accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>"""
"""A square of 2 m that stands, and its two normals: the first looks at who takes the picture."""
FRONT = "0 0 0 1 0 1 2 0 2 0 0 0 2 0 2 3 0 3"
BACK = "2 1 2 1 1 1 0 1 0 3 1 3 2 1 2 0 1 0"


def collada(effects, sides):
    """A file with an effect for each side; corners are vertex, normal and picture coordinate."""
    names = range(len(effects))
    library = "".join(f"<effect id='e{n}'><profile_COMMON>{effects[n]}</profile_COMMON></effect>"
                      for n in names)
    materials = "".join(f"<material id='m{n}'><instance_effect url='#e{n}'/></material>"
                        for n in names)
    triangles = "".join(
        f"<triangles count='2' material='m{n}'><input semantic='VERTEX' source='#v' offset='0'/>"
        "<input semantic='NORMAL' source='#n' offset='1'/>"
        f"<input semantic='TEXCOORD' source='#t' offset='2'/><p>{sides[n]}</p></triangles>"
        for n in names)
    bound = "".join(f"<instance_material symbol='m{n}' target='#m{n}'/>" for n in names)
    return ("<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
            "version='1.4.1'><asset><unit meter='1'/><up_axis>Z_UP</up_axis></asset>"
            "<library_images><image id='i'><init_from>red.png</init_from></image></library_images>"
            f"<library_effects>{library}</library_effects>"
            f"<library_materials>{materials}</library_materials>"
            f"<library_geometries><geometry id='g'><mesh>{QUAD}{triangles}</mesh></geometry>"
            "</library_geometries><library_visual_scenes><visual_scene id='s'><node>"
            f"<instance_geometry url='#g'><bind_material><technique_common>{bound}"
            "</technique_common></bind_material></instance_geometry></node></visual_scene>"
            "</library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>")


def lambert(diffuse, more=""):
    return (f"<technique sid='common'><lambert><diffuse>{diffuse}</diffuse>{more}</lambert>"
            "</technique>")


def color(*parts):
    return f"<color>{' '.join(map(str, parts))} 1</color>"


RED, BLUE = lambert(color(0.8, 0, 0)), lambert(color(0, 0, 0.8))
SAMPLED = ("<newparam sid='f'><surface type='2D'><init_from>i</init_from></surface></newparam>"
           "<newparam sid='r'><sampler2D><source>f</source></sampler2D></newparam>")


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    running = Node(tmp_path_factory.mktemp("looks"), "worlds/empty.world")
    yield running
    running.close()


@pytest.fixture(scope="module")
def editor(node, browser):
    page = browser.open(node.url, scale=1)
    yield page
    faults = page.faults
    page.close()
    assert faults == []


def write_model(node, name, geometry, files):
    """A model of the user's own, whose picture the library draws."""
    folder = os.path.join(node.home, ".gazebo", "models", name)
    os.makedirs(folder)
    texts = {"model.config": f"<?xml version='1.0'?><model><name>{name}</name><version>1</version>"
                             "<sdf version='1.6'>model.sdf</sdf></model>",
             "model.sdf": f"<?xml version='1.0'?><sdf version='1.6'><model name='{name}'>"
                          "<static>true</static><link name='link'><visual name='v'><geometry>"
                          f"{geometry}</geometry></visual></link></model></sdf>"}
    for file, content in {**texts, **files}.items():
        data = content if isinstance(content, bytes) else content.encode()
        with open(os.path.join(folder, file), "wb") as stream:
            stream.write(data)


def write_mesh(node, name, effects, sides):
    write_model(node, name, f"<mesh><uri>model://{name}/mesh.dae</uri></mesh>",
                {"mesh.dae": collada(effects, sides), "red.png": png((4, 4), (200, 0, 0))})


def png(size, fill):
    return encoded(Image.new("RGB", size, fill))


def encoded(image):
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return stream.getvalue()


def picture(editor, name):
    """What the library shows of a model, seen from (3, -4, 2.6)."""
    data = editor.get(f"""(async () => {{
      const shown = await editor.view.thumbnail('model://{name}');
      const blob = await (await fetch(shown)).blob();
      return new Promise((done) => {{
        const reader = new FileReader();
        reader.onload = () => done(reader.result);
        reader.readAsDataURL(blob);
      }});
    }})()""")
    return Image.open(io.BytesIO(base64.b64decode(data.split(",")[1]))).convert("RGB")


def seen_by_camera(node, name, file="mesh.dae"):
    """What a camera sensor sees of a mesh of a model from there, under full ambient light."""
    path = os.path.join(node.home, ".gazebo", "models", name, file)
    renderer = Renderer(pytest.fail)
    renderer.set_lights([], Scene(ambient=(1.0, 1.0, 1.0, 1.0)))
    renderer.add(Body(name, Model(name, links=[Link("link", visuals=[
        Visual("v", Mesh(file, path))])]), 0, {}))
    eye = Pose((3.0, -4.0, 2.6), quat_from_rpy(0.0, math.atan2(2.6, 5.0), math.atan2(4.0, -3.0)))
    still = np.array([[0.0, 0, 0, 0, 0, 0, 1]])
    return Image.fromarray(renderer.render(CameraSpec(320, 240), matrix(eye), still, (RGB,),
                                           0).rgb)


def middle(image):
    """The pixels about the middle, where the square is."""
    width, height = image.size
    box = (width // 2 - 15, height // 2 - 15, width // 2 + 15, height // 2 + 15)
    return list(image.crop(box).getdata())


def assert_red(node, editor, name, file="mesh.dae", least=90, most_blue=60):
    """The library and a camera show a mesh of a model in red."""
    for image in (picture(editor, name), seen_by_camera(node, name, file)):
        assert all(red > least and green < 60 and blue < most_blue
                   for red, green, blue in middle(image))


def test_a_collada_material_that_old_files_call_wholly_transparent_is_drawn(node, editor):
    unseen = lambert(color(0.8, 0, 0), "<transparent>" + color(1, 1, 1) +
                     "</transparent><transparency><float>0</float></transparency>")
    write_mesh(node, "unseen", [unseen], [FRONT])
    assert_red(node, editor, "unseen")


def test_of_two_faces_at_one_place_the_one_seen_from_its_front_is_drawn(node, editor):
    write_mesh(node, "two_faced", [RED, BLUE], [FRONT, BACK])
    assert_red(node, editor, "two_faced")


def wall(name, size, place, paint):
    shape = f"<geometry><box><size>{size}</size></box></geometry>"
    return (f"<link name='{name}'><pose>{place} 0 0 0</pose><visual name='v'>{shape}<material>"
            f"<ambient>{paint}</ambient><diffuse>{paint}</diffuse></material></visual></link>")


def test_faces_of_two_materials_at_one_place_have_no_stripes(editor):
    # The end of one wall is in the plane of the other one's face.
    sdf = ("<sdf version='1.6'><model name='tee'><static>true</static>" +
           wall("along", "4 0.6 2.5", "0 0 1.25", "1 0 0 1") +
           wall("across", "0.6 3.3 2.5", "0 1.35 1.25", "0 0 1 1") + "</model></sdf>")
    editor.get(f"editor.request('edit', {{op: {{kind: 'insert', sdf: {sdf!r}}}}})")
    editor.until("editor.store.model('tee')", "the walls")
    x, y = editor.pixel((0.0, -0.3, 1.0))
    data = editor.settled_picture({"x": x - 12, "y": y - 40, "width": 24, "height": 80})
    pixels = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).reshape(-1, 3)
    red, blue = (int((pixels[:, part] > 90).sum()) for part in (0, 2))
    editor.get("editor.request('edit', {op: {kind: 'delete', names: ['tee']}})")
    assert red + blue == len(pixels)
    assert min(red, blue) <= 0.01 * len(pixels)


def test_what_glows_has_the_colors_of_its_picture(node, editor):
    glowing = SAMPLED + lambert("<texture texture='r' texcoord='UV'/>",
                                f"<emission>{color(1, 1, 1)}</emission>")
    write_mesh(node, "glowing", [glowing], [FRONT])
    assert_red(node, editor, "glowing", least=150)


def test_a_picture_for_the_glow_is_that_of_the_material(node, editor):
    # Gazebo's rule: a material has one picture, that of another colour without one of the diffuse.
    pictured = SAMPLED + lambert(color(1, 1, 1), "<emission><texture texture='r' texcoord='UV'/>"
                                                 "</emission>")
    write_mesh(node, "pictured", [pictured], [FRONT])
    assert_red(node, editor, "pictured")


def upright_square():
    return trimesh.Trimesh([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]],
                           [[0, 1, 2], [0, 2, 3]], process=False)


@pytest.mark.parametrize("looks", [
    {"baseColorTexture": Image.new("RGB", (4, 4), (200, 0, 0)), "metallicFactor": 1.0},
    {"baseColorFactor": [200, 0, 0, 255]}], ids=["picture", "color"])
def test_a_gltf_mesh_has_its_colors(node, editor, looks, request):
    name = f"gltf_{request.node.callspec.id}"
    square = upright_square()
    square.visual = trimesh.visual.TextureVisuals(
        [[0, 0], [1, 0], [1, 1], [0, 1]], trimesh.visual.material.PBRMaterial(**looks))
    write_model(node, name, f"<mesh><uri>model://{name}/mesh.glb</uri></mesh>",
                {"mesh.glb": square.export(file_type="glb")})
    assert_red(node, editor, name, "mesh.glb")


@pytest.mark.parametrize("kind", ["vertices", "faces"])
def test_a_ply_mesh_has_its_colors(node, editor, kind):
    square = upright_square()
    given = {"vertices": "vertex_colors", "faces": "face_colors"}[kind]
    setattr(square.visual, given, [200, 40, 20, 255])
    name = f"ply_{kind}"
    write_model(node, name, f"<mesh><uri>model://{name}/mesh.ply</uri></mesh>",
                {"mesh.ply": square.export(file_type="ply")})
    assert_red(node, editor, name, "mesh.ply", most_blue=45)


def test_a_large_mesh_is_drawn_with_fewer_triangles_without_a_graphics_card(node, editor):
    ball = trimesh.creation.icosphere(7, 1.0)
    write_model(node, "large", "<mesh><uri>model://large/mesh.stl</uri></mesh>",
                {"mesh.stl": ball.export(file_type="stl")})
    editor.get("editor.request('edit', {op: {kind: 'insert', uri: 'model://large', name: 'large',"
               " pose: [0, 0, 1, 0, 0, 0, 1]}})")
    editor.until("editor.view.meshTriangles > 0 && editor.view.waiting === 0", "the mesh")
    assert len(ball.faces) > 300000
    assert any("stl_worker" in worker.url for worker in editor.page.workers), "the page goes on"
    assert 10000 < editor.get("editor.view.meshTriangles") < 120000
    bounds = editor.get("(({min, max}) => [...min, ...max])(editor.view.bounds('large'))")
    assert bounds == pytest.approx([-1.0, -1.0, 0.0, 1.0, 1.0, 2.0], abs=0.03)
    simplified = editor.page.get_by_role("menuitemcheckbox", name="Simplified Meshes")
    for shown, faces in (("true", len(ball.faces)), ("false", None)):
        editor.page.get_by_role("menuitem", name="View", exact=True).click()
        assert simplified.get_attribute("aria-checked") == shown
        simplified.click()
        editor.until("editor.view.meshTriangles > 0 && editor.view.waiting === 0", "the mesh")
        triangles = editor.get("editor.view.meshTriangles")
        assert triangles == faces if faces else triangles < 120000
    editor.get("editor.actions.edit({kind: 'delete', names: ['large']})")
    editor.until("!editor.store.model('large')", "the mesh is gone")


def test_the_picture_of_a_terrain_shows_all_of_it(node, editor):
    slope = Image.linear_gradient("L").resize((129, 129))
    write_model(node, "terrain", "<heightmap><uri>model://terrain/slope.png</uri>"
                "<size>1000 1000 100</size></heightmap>", {"slope.png": encoded(slope)})
    image = picture(editor, "terrain")
    background = image.getpixel((2, 2))
    columns = [x for x in range(image.width)
               if any(image.getpixel((x, y)) != background for y in range(image.height))]
    assert columns[-1] - columns[0] > 0.7 * image.width


TERRAIN_SIZE = 32.0
"""m of a terrain along a side; its west is 0 m high, its east 4 m."""


def write_terrain(node, name, inside, files):
    """A terrain that rises from west to east, seen by the library from (3, -4, 2.6)."""
    slope = Image.linear_gradient("L").rotate(90).resize((33, 33))
    write_model(node, name, f"<heightmap><uri>model://{name}/slope.png</uri>"
                f"<size>{TERRAIN_SIZE} {TERRAIN_SIZE} 4</size>{inside}</heightmap>",
                {"slope.png": encoded(slope), **files})


def texture(name, file, size=10):
    return f"<texture><diffuse>model://{name}/{file}</diffuse><size>{size}</size></texture>"


def on_terrain(image, x, y):
    """The pixel of the library's picture in which a point of the terrain is seen, about."""
    wide, high = image.size
    # The middle of the terrain is in the middle of the picture; both diagonals are seen aslant.
    across, deep = 0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y
    return image.getpixel((round(wide / 2 + 0.42 * wide * across / TERRAIN_SIZE),
                           round(high / 2 - 0.20 * high * deep / TERRAIN_SIZE)))


def test_the_textures_of_a_terrain_are_blended_by_height(node, editor):
    write_terrain(node, "blended", texture("blended", "red.png") + texture("blended", "blue.png")
                  + "<blend><min_height>1.5</min_height><fade_dist>1</fade_dist></blend>",
                  {"red.png": png((4, 4), (220, 0, 0)), "blue.png": png((4, 4), (0, 0, 220))})
    image = picture(editor, "blended")
    low, high, between = (on_terrain(image, x, 0) for x in (-12, 12, 0))
    assert low[0] > 3 * low[2] and high[2] > 3 * high[0], (low, high)
    assert min(between[0], between[2]) > 40, between


def test_a_texture_is_repeated_by_its_size_and_upright(node, editor):
    halves = Image.new("RGB", (8, 8), (220, 0, 0))
    halves.paste((0, 0, 220), (4, 0, 8, 8))
    write_terrain(node, "tiled", texture("tiled", "halves.png", 16),
                  {"halves.png": encoded(halves)})
    image = picture(editor, "tiled")
    seen = ["red" if on_terrain(image, x, 0)[0] > on_terrain(image, x, 0)[2] else "blue"
            for x in (-12, -4, 4, 12)]
    assert seen == ["red", "blue", "red", "blue"]


def test_the_view_says_when_its_sky_is_not_that_of_cameras(editor):
    switch = editor.page.locator(".look-switch")

    def corner():
        clip = editor.page.locator("#view").bounding_box()
        image = Image.open(io.BytesIO(editor.settled_picture(clip))).convert("RGB")
        return image.getpixel((image.width // 3, 4))

    assert switch.inner_text() == "Editor colors"
    assert switch.get_attribute("aria-pressed") == "false"
    red, _, blue = corner()
    assert blue > red + 2
    switch.click()
    editor.until("document.querySelector('.look-switch').textContent === 'Camera colors'",
                 "what the switch says")
    assert max(corner()) - min(corner()) < 6
    switch.click()   # the page and its world serve other tests


def test_the_view_the_properties_and_the_file_have_the_same_color_of_a_box(editor):
    name = editor.place("Box", (0.0, 0.0, 0.0))
    editor.page.keyboard.press("Escape")
    clip = editor.page.locator("#view").bounding_box()
    image = Image.open(io.BytesIO(editor.settled_picture(clip))).convert("RGB")
    red, _, blue = image.getpixel((image.width // 2, image.height // 2))
    assert red > blue + 30
    material = editor.model(name)["links"][0]["visuals"][0]["material"]
    assert material["diffuse"] == pytest.approx([0.93, 0.62, 0.33, 1.0])
    editor.row(name).click()
    field = editor.page.locator(".properties input[type=color]").first
    assert field.input_value() == "#ed9e54"
    editor.get(f"editor.actions.edit({{kind: 'delete', names: ['{name}']}})")
    editor.until(f"!editor.store.model('{name}')", "the box is gone")


def test_a_terrain_whose_texture_is_missing_is_grey(node, editor):
    write_terrain(node, "bare", texture("bare", "gone.png"), {})
    red, green, blue = on_terrain(picture(editor, "bare"), 0, 0)
    assert min(red, green, blue) > 80 and max(red, green, blue) - min(red, green, blue) < 40


def test_the_bumps_of_a_terrain_turn_its_light(node, editor):
    for name, towards in (("bumps_east", (255, 128, 128)), ("bumps_west", (0, 128, 128))):
        write_terrain(node, name, texture(name, "white.png").replace(
            "<size>", f"<normal>model://{name}/bumps.png</normal><size>"),
            {"white.png": png((4, 4), (255, 255, 255)), "bumps.png": png((4, 4), towards)})
    east, west = (sum(on_terrain(picture(editor, name), 0, 0))
                  for name in ("bumps_east", "bumps_west"))
    assert east > west + 30  # the library's sun stands in the south-east


PLACES = [(x, y) for y in (-1.5, 0.0, 1.5) for x in (-1.5, 0.0, 1.5)]


def test_each_of_many_copies_is_seen_where_it_is(editor):
    editor.get("editor.store.setOverlay('grid', false)")
    for number, (x, y) in enumerate(PLACES):
        editor.get(f"editor.actions.edit({{kind: 'insert', shape: 'box', name: 'box_{number}', "
                   f"pose: [{x}, {y}, 0.5, 0, 0, 0, 1]}})")
    wait_for(lambda: boxes_seen(editor, PLACES), "nine boxes")
    editor.get("editor.actions.move({box_0: [3, -1.5, 0.5, 0, 0, 0.3826834, 0.9238795]})")
    editor.get("editor.actions.edit({kind: 'delete', names: ['box_6']})")
    gone = [PLACES[0], PLACES[6]]
    left = [place for place in PLACES if place not in gone]
    wait_for(lambda: boxes_seen(editor, [*left, (3, -1.5)]) and
             not any(boxes_seen(editor, [place]) for place in gone),
             "eight boxes, one of them elsewhere")


FLOOR = """<sdf version="1.6"><model name="floor"><static>true</static><link name="link"><visual
 name="v"><geometry><box><size>3 3 0.01</size></box></geometry></visual></link></model></sdf>"""


def test_a_thin_floor_is_as_bright_in_coarse_pictures_as_in_full_ones(editor):
    editor.get(f"editor.actions.edit({{kind: 'insert', name: 'floor', sdf: {FLOOR!r},"
               " pose: [0, 0, 0.005, 0, 0, 0, 1]})")
    editor.until("Boolean(editor.store.model('floor'))", "the floor")
    editor.rest()

    def brightness():
        x, y = editor.pixel((0.5, 0.5, 0.01))
        clip = {"x": x - 8, "y": y - 8, "width": 16, "height": 16}
        image = Image.open(io.BytesIO(editor.page.screenshot(clip=clip))).convert("L")
        return float(np.asarray(image, dtype=float).mean())

    full, width = brightness(), editor.get("document.querySelector('.view-canvas').width")
    editor.get("(() => { window.timeout = setTimeout; window.setTimeout = () => 0; })()")
    editor.get("editor.view.redraw()")
    editor.until(f"document.querySelector('.view-canvas').width < {width}", "a coarse picture")
    editor.frame()
    coarse = brightness()
    editor.get("(() => { window.setTimeout = timeout; editor.view.redraw(); })()")
    editor.rest()
    assert abs(coarse - full) < 12


def boxes_seen(editor, places):
    """Whether the tops of boxes of 1 m, which are orange, are seen at all of these places."""
    image = Image.open(io.BytesIO(editor.page.screenshot())).convert("RGB")
    for place in places:
        red, _, blue = image.getpixel(tuple(round(part) for part in editor.pixel((*place, 1.0))))
        if red < blue + 40:
            return False
    return True


HINTS = """(() => {
  const line = document.querySelector('.hint-line').getBoundingClientRect();
  const words = document.querySelector('.hint-line .hints').getBoundingClientRect();
  const shown = [...document.querySelectorAll('.hint-line .hints span')].map((one) =>
    ({text: one.textContent, box: one.getBoundingClientRect()})).filter(({box}) =>
    box.top < words.bottom - 1);
  return {inside: line.left >= 0 && line.right <= innerWidth, shown: shown.map(({text}) => text),
    cut: shown.filter(({box}) => box.right > words.right + 1).map(({text}) => text)};
})()"""


@pytest.mark.parametrize("size, touch", [((800, 600), False), ((400, 720), True)], ids=str)
def test_hints_fit_a_small_window_and_can_be_closed(node, browser, size, touch):
    editor = browser.open(node.url, size=size, has_touch=touch, is_mobile=touch)
    hints = editor.get(HINTS)
    assert hints["inside"] and hints["cut"] == [] and len(hints["shown"]) >= 3, hints
    assert ("one finger turn" in hints["shown"]) is touch
    editor.button("Close the hints").click()
    editor.until("document.querySelector('.hint-line') === null", "no hints")
    faults = editor.faults
    editor.close()
    assert faults == []


def test_swiftshader_draws_what_mesa_draws(node, editor, browser):
    editor.get("editor.actions.edit({kind: 'insert', shape: 'sphere', name: 'ball',"
               " pose: [0, 0, 0.5, 0, 0, 0, 1]})")
    chromium = browser.launch(*SWIFTSHADER_FLAGS)
    pages = [editor, Editor(chromium, node.url, scale=1)]
    shown = []
    for page in pages:
        page.until("Boolean(editor.store.model('ball') && editor.view.pixelOf('ball'))", "the ball")
        x, y = page.get("editor.view.pixelOf('ball')")
        clip = {"x": x - 100, "y": y - 100, "width": 200, "height": 200}
        shown.append(np.asarray(Image.open(io.BytesIO(page.settled_picture(clip))).convert("RGB"),
                                dtype=float))
    assert "SwiftShader" in pages[1].get(RENDERER) and "SwiftShader" not in editor.get(RENDERER)
    assert pages[1].faults == []
    chromium.close()
    assert shown[0].std() > 10.0, "a ball and its shadow"
    assert np.abs(shown[0] - shown[1]).mean() < 2.0


RENDERER = """(() => {
  const context = document.createElement('canvas').getContext('webgl2');
  const named = context.getExtension('WEBGL_debug_renderer_info');
  return context.getParameter(named.UNMASKED_RENDERER_WEBGL);
})()"""
