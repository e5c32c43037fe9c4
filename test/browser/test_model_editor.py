"""The model editor by hand: a cart is built, saved, and its wheels turn in a fresh node."""
from __future__ import annotations

import os
import subprocess

import rospy
from gazebo_msgs.srv import ApplyJointEffort, GetJointProperties
from pytest import approx
from std_srvs.srv import Empty
from support import wait_for

WORLD = """<sdf version="1.7"><world name="default">
  <include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include>
  <include><uri>model://cart</uri><pose>0 0 0.1 0 0 0</pose></include>
</world></sdf>"""


def type_into(editor, target, path, *values):
    """Types numbers into a property's fields; each is taken before the next is typed."""
    fields = editor.page.locator(
        f'.properties .field[data-target="{target}"][data-path="{path}"] input')
    fields.first.wait_for()
    for field, value in zip(fields.all(), values):
        field.fill(str(value))
        field.press("Enter")
        done = editor.page.locator(f'.properties .field[data-target="{target}"]'
                                   f'[data-path="{path}"].pending')
        wait_for(lambda: done.count() == 0, f"{path} of {target}")


def add_link(editor, shape, point):
    """Takes a shape of the palette and clicks where it shall stand; returns the link's name."""
    before = editor.get("editor.store.history.undo.length")
    selected = editor.get("editor.store.selection[0] ?? ''")
    editor.button(f"Link: {shape}").click()
    x, y = editor.pixel(point)
    editor.page.mouse.move(x - 30, y - 20)
    editor.page.mouse.move(x, y, steps=4)
    editor.page.mouse.click(x, y)
    editor.until(f"editor.store.history.undo.length === {before + 1}", f"the {shape}")
    # The page selects it when its request is answered; its model may come later.
    return wait_for(lambda: editor.get(
        f"[editor.store.selection[0] ?? ''].find((name) => name.includes('::') && "
        f"name !== {selected!r} && editor.store.entity(name))"), "the selected link")


def build_cart(editor):
    editor.page.keyboard.press("Control+m")
    editor.page.get_by_role("region", name="Model editor").wait_for()
    body = add_link(editor, "box", (0.0, 0.0, 0.0))
    assert body == "untitled::link_0"
    for part in ("collision:collision", "visual:visual"):
        type_into(editor, f"{body}::{part}", "geometry.size", 0.6, 0.6, 0.3)
    wheels = []
    for side, y in (("right", -0.6), ("left", 0.6)):
        wheel = add_link(editor, "cylinder", (0.0, 4 * y, 0.0))
        for part in ("collision:collision", "visual:visual"):
            type_into(editor, f"{wheel}::{part}", "geometry.length", 0.2)
        type_into(editor, wheel, "pose", 0, y, 0.5, "90deg")
        wheels.append(wheel)
    for wheel, seen in zip(wheels, ((0.0, -0.7, 0.5), (0.0, 0.6, 0.97))):
        connect(editor, (0.1, -0.1, 0.65), seen)
        editor.until(f"editor.store.selection[0] === {wheel!r}", "the selected child")
    compute_inertia(editor)


def connect(editor, parent, child):
    joints = "editor.store.model('untitled').joints.length"
    before = editor.get(joints)
    editor.button("Connect").click()
    editor.click(parent)
    editor.page.get_by_text("Click the child link.").wait_for()
    editor.click(child)
    editor.until(f"{joints} === {before + 1}", "the joint")


def compute_inertia(editor):
    editor.button("Inertia of all links").click()
    editor.button("Compute").click()
    editor.until("editor.store.history.undo[0].startsWith('Compute inertia')", "the inertia")


def save_as(editor, name):
    editor.page.keyboard.press("Control+s")
    editor.page.get_by_label("Name", exact=True).last.fill(name)
    editor.page.locator(".dialog").get_by_role("button", name="Save", exact=True).click()
    wait_for(lambda: not editor.page.locator(".dialog").count(), "the end of saving")


def test_a_cart_built_by_mouse_loads_without_a_warning_and_its_wheels_turn(launch, browser):
    node = launch("worlds/empty.world")
    editor = browser.open(node.url)
    build_cart(editor)
    model = editor.model("untitled")
    assert [(one["type"], one["parent"], one["child"]) for one in model["joints"]] == [
        ("revolute", "link_0", "link_1"), ("revolute", "link_0", "link_2")]
    assert model["links"][1]["inertial"]["ixx"] == approx((3 * 0.25 + 0.04) / 12, rel=1e-6)
    save_as(editor, "cart")
    editor.page.keyboard.press("Control+m")
    editor.page.get_by_role("region", name="Model editor").wait_for(state="detached")
    assert editor.faults == []
    editor.close()
    node.close()

    folder = os.path.join(node.home, ".gazebo", "models", "cart")
    assert sorted(os.listdir(folder)) == ["model.config", "model.sdf"]
    said = subprocess.run(["rosrun", "my_simulations", "check_model",
                           os.path.join(folder, "model.sdf")],
                          capture_output=True, text=True, timeout=60, check=True)
    assert "0 errors, 0 warnings" in said.stdout
    world = os.path.join(node.worlds, "cart.world")
    with open(world, "w", encoding="utf-8") as stream:
        stream.write(WORLD)
    fresh = launch(world)
    # Tests beside this one may have the port of the editor.
    assert not [line for line in fresh.said().lower().splitlines()
                if "warning" in line and "is in use" not in line]
    for wheel in ("link_1_joint", "link_2_joint"):
        assert fresh.ask("apply_joint_effort", ApplyJointEffort, effort=2.0,
                         joint_name=f"cart::{wheel}", duration=rospy.Duration(-1.0)).success
    fresh.ask("unpause_physics", Empty)
    for wheel in ("link_1_joint", "link_2_joint"):
        wait_for(lambda name=wheel: fresh.ask(
            "get_joint_properties", GetJointProperties,
            joint_name=f"cart::{name}").position[0] > 0.5, f"turns of {wheel}")


def test_the_palette_shows_its_headings_and_save_in_a_small_window(browser, node, editor):
    page = browser.open(node.url, size=(1280, 620))
    page.page.keyboard.press("Control+m")
    page.button("Link: box").click()
    page.click((1.0, 1.0, 0.0))
    page.until("editor.store.modelEditing?.name", "the model")
    cut = page.get("[...document.querySelectorAll('.model-palette h3')].filter((one) =>"
                   " one.scrollHeight > one.clientHeight).map((one) => one.textContent)")
    save = page.page.locator(".model-palette .primary").bounding_box()
    palette = page.page.locator(".model-palette").bounding_box()
    assert cut == []
    assert save["y"] + save["height"] <= palette["y"] + palette["height"]
    faults = page.faults
    page.close()
    assert faults == []


def test_the_palette_offers_only_links_until_there_is_one(editor):
    editor.page.keyboard.press("Control+m")
    palette = editor.page.get_by_role("region", name="Model editor")
    palette.get_by_text("it becomes the first link").wait_for()
    of_a_model = [palette.get_by_role("button", name=name, exact=True)
                  for name in ("Connect", "Schematic", "Plugins…", "Save", "Save As…")]
    of_a_model.append(palette.get_by_label("Model name"))
    assert not any(element.is_visible() for element in of_a_model)
    add_link(editor, "box", (0.0, 0.0, 0.0))
    for element in of_a_model:
        element.wait_for(state="visible")
    assert not palette.get_by_text("it becomes the first link").is_visible()


def test_a_link_is_moved_by_its_handles_and_back_by_undo(editor):
    editor.page.keyboard.press("Control+m")
    link = add_link(editor, "box", (0.0, 0.0, 0.0))
    add_link(editor, "sphere", (1.0, 2.5, 0.0))
    editor.click((0.3, -0.5, 0.5))
    editor.until(f"editor.store.selection[0] === {link!r}", "the clicked link")
    editor.page.keyboard.press("t")
    editor.drag((0.3, -0.5, 0.3), (1.3, -0.5, 0.3), keys=("x",))
    editor.until("editor.store.history.undo[0].startsWith('Move')", "the move")
    pose = "editor.store.model('untitled').links[0].pose"
    wait_for(lambda: editor.get(pose)[:3] == approx([1.0, 0.0, 0.5], abs=0.05), "its new place")
    assert editor.get("editor.store.model('untitled').links[1].pose")[1] == approx(2.5, abs=0.05)
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: editor.get(pose)[:3] == approx([0.0, 0.0, 0.5], abs=1e-6), "the way back")


def test_what_is_discarded_is_gone_and_time_goes_on(editor):
    editor.get("editor.actions.play()")
    editor.until("!editor.store.stats.paused", "running physics")
    editor.page.keyboard.press("Control+m")
    add_link(editor, "capsule", (0.0, 0.0, 0.0))
    editor.page.keyboard.press("Space")  # plays nothing here
    editor.frame()
    assert editor.get("editor.store.stats.paused")
    editor.page.keyboard.press("Control+m")
    editor.button("Discard Changes").click()
    editor.until("!editor.store.model('untitled') && !editor.store.modelEditing", "the end")
    editor.until("!editor.store.stats.paused", "running physics again")


def test_a_model_of_the_world_is_edited_and_keeps_its_name(editor):
    name = editor.place("Box", (0.0, 0.0, 0.0))
    editor.row(name).click(button="right")
    editor.page.get_by_role("menuitem", name="Edit Model").click()
    editor.page.get_by_role("region", name="Model editor").wait_for()
    assert add_link(editor, "cone", (0.0, -2.0, 0.0)) == f"{name}::link_0"
    editor.button("Exit model editor").click()
    editor.button("Keep in World").click()
    editor.until("!editor.store.modelEditing", "the end")
    wait_for(lambda: [link["name"] for link in editor.model(name)["links"]] == ["link", "link_0"],
             "both links")


def test_one_size_changes_collision_visual_and_inertia_in_one_step(editor):
    editor.page.keyboard.press("Control+m")
    link = add_link(editor, "box", (0.0, 0.0, 0.0))
    before = editor.model("untitled")["links"][0]
    depth = editor.get("editor.store.history.depth")
    editor.button("Size…").click()
    dialog = editor.page.get_by_role("dialog", name=f"Size of {link}")
    for name, value in (("x", "0.6"), ("y", "0.4"), ("z", "0.2")):
        dialog.get_by_label(f"Size {name}", exact=True).fill(value)
    dialog.get_by_role("button", name="OK").click()
    dialog.wait_for(state="detached")
    editor.until(f"editor.store.history.depth === {depth + 1}", "one step")
    # The history may come before the model does.
    editor.until("editor.store.model('untitled')?.links[0].visuals[0].geometry.size[0] === 0.6",
                 "the new size")
    after = editor.model("untitled")["links"][0]
    for part in ("collisions", "visuals"):
        assert [one["geometry"]["size"] for one in after[part]] == [[0.6, 0.4, 0.2]]
    assert after["inertial"]["mass"] == approx(1.0)
    assert after["inertial"]["ixx"] == approx((0.4 ** 2 + 0.2 ** 2) / 12)
    editor.get("editor.request('undo')")
    editor.until(f"editor.store.history.depth === {depth}", "the undone step")
    wait_for(lambda: (editor.model("untitled") or {}).get("links", [None])[0] == before,
             "the former link")


JOINTS_OF_UNTITLED = "editor.store.model('untitled').joints"
DRIVE = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
<leftJoint>link_1_joint</leftJoint><rightJoint>link_1_joint</rightJoint></plugin>"""


def with_covered_sphere(editor):
    """A model of a box and a sphere in it, in the model editor."""
    editor.page.keyboard.press("Control+m")
    editor.page.get_by_role("region", name="Model editor").wait_for()
    add_link(editor, "box", (0.0, 0.0, 0.0))
    editor.get("editor.request('edit', {op: {kind: 'add_link', model: 'untitled', "
               "shape: 'sphere', pose: [0, 0, 0.5, 0, 0, 0, 1]}})")
    editor.until("editor.store.model('untitled').links.length === 2", "the sphere")
    editor.rest()


def joint_ends(editor):
    editor.until(f"{JOINTS_OF_UNTITLED}.length === 1", "the joint")
    ends = editor.get(f"{JOINTS_OF_UNTITLED}.map(({{parent, child}}) => [parent, child])[0]")
    editor.get("editor.request('undo')")
    editor.until(f"{JOINTS_OF_UNTITLED}.length === 0", "no joint")
    return ends


def test_links_are_connected_in_the_view_the_tree_and_the_list(editor):
    with_covered_sphere(editor)
    front = (0.1, -0.1, 0.6)
    editor.button("Connect").click()
    editor.click(front)
    editor.page.get_by_text("Click the child link.").wait_for()
    editor.click(front)
    assert joint_ends(editor) == ["link_0", "link_1"]

    editor.page.keyboard.press("Escape")
    editor.get("editor.store.select(['untitled::link_1'])")
    editor.row("link_1").wait_for()
    editor.button("Connect").click()
    editor.row("link_1").click()
    editor.page.get_by_text("Parent: link_1.").wait_for()
    editor.row("link_0").click()
    assert joint_ends(editor) == ["link_1", "link_0"]

    editor.button("Connect").click()
    editor.page.get_by_role("combobox", name="Parent link").select_option("link_1")
    editor.page.get_by_role("combobox", name="Child link").select_option("link_0")
    assert joint_ends(editor) == ["link_1", "link_0"]


def test_a_plugin_that_lacks_its_joint_is_reported_and_starts_with_the_joint(launch, browser):
    node = launch("worlds/empty.world")
    editor = browser.open(node.url)
    with_covered_sphere(editor)
    editor.button("Plugins…").click()
    editor.page.get_by_role("textbox", name="Plugins").fill(DRIVE)
    editor.page.get_by_role("dialog").get_by_role("button", name="OK").click()
    editor.until("editor.store.issues.some(({code}) => code === 'plugin-failed')",
                 "the fault in Messages")
    editor.get("editor.store.select(['untitled'])")
    editor.row("untitled").get_by_text("plugin failed").wait_for()
    editor.page.get_by_role("treeitem", name="untitled", exact=True).press("ArrowRight")
    editor.row("drive").get_by_text("failed").wait_for()
    editor.row("drive").click()
    properties = editor.page.get_by_role("region", name="Properties")
    properties.get_by_text("link_1_joint").first.wait_for()
    editor.button("Connect").click()
    editor.page.get_by_role("combobox", name="Parent link").select_option("link_0")
    editor.page.get_by_role("combobox", name="Child link").select_option("link_1")
    editor.until(f"{JOINTS_OF_UNTITLED}.length === 1", "the joint")
    editor.page.keyboard.press("Alt+t")
    wait_for(lambda: "/odom" in editor.get("document.body.innerText"),
             "the topic of the plugin")
    editor.row("drive").get_by_text("running").wait_for()
    assert editor.faults == []
    editor.close()


def test_the_schematic_shows_links_and_joints_and_selects_and_connects_them(editor):
    with_covered_sphere(editor)
    editor.page.keyboard.press("Control+e")
    schematic = editor.page.get_by_role("region", name="Schematic")
    schematic.get_by_role("button", name="Link link_0").click()
    editor.until("editor.store.selection.join() === 'untitled::link_0'", "the selected link")
    editor.button("Connect").click()
    schematic.get_by_role("button", name="Link link_0").click()
    schematic.get_by_role("button", name="Link link_1").press("Enter")
    schematic.get_by_role("button", name="revolute").click()
    editor.page.get_by_role("dialog").get_by_role("button", name="Cancel").click()
    assert joint_ends(editor) == ["link_0", "link_1"]
    editor.page.keyboard.press("Control+e")
    schematic.wait_for(state="hidden")


LETTER = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 10" onload="window.ran = true">
<g transform="translate(1 1)"><path d="M0 0h16v8h-16z M2 2v4h4v-4z"/></g>
<script>window.ran = true</script>
</svg>"""


def test_the_outline_of_an_svg_drawing_becomes_a_link(editor):
    editor.page.keyboard.press("Control+m")
    editor.button("SVG…").click()
    dialog = editor.page.get_by_role("dialog", name="Add SVG")
    dialog.get_by_label("SVG file").set_input_files(
        {"name": "letter.svg", "mimeType": "image/svg+xml", "buffer": LETTER.encode()})
    dialog.get_by_text("2 outlines, 8 corners").wait_for()
    dialog.get_by_label("Width").fill("0.8")
    dialog.get_by_label("Height").fill("0.2")
    dialog.get_by_role("button", name="Add").click()
    dialog.wait_for(state="detached")
    editor.until("editor.store.model('untitled')", "the model")
    link = editor.model("untitled")["links"][0]
    assert {part: link[part][0]["geometry"]["type"] for part in ("visuals", "collisions")} == {
        "visuals": "polyline", "collisions": "polyline"}
    assert link["inertial"]["mass"] == approx(1.0)
    # The hole of 0.2 m is to the left of the middle.
    assert link["inertial"]["pose"][:3] == approx([0.04 * 0.2 / 0.28, 0.0, 0.1])
    editor.until("editor.view.bounds('untitled')", "its picture")
    bounds = editor.get("(({min, max}) => [...min, ...max])(editor.view.bounds('untitled'))")
    assert bounds == approx([-0.4, -0.2, 0.0, 0.4, 0.2, 0.2], abs=1e-3)
    assert editor.get("window.ran") is None
