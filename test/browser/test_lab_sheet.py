"""The lab sheet's second half, as a person does it: a world built by hand, saved, loaded again."""
from __future__ import annotations

import math
import os
from xml.etree import ElementTree

from gazebo_msgs.srv import GetModelState, GetWorldProperties, SpawnModel
from pytest import approx
from support import wait_for, yaw_of

HALF_UP = 0.5
WHOLE = 1e-6


def on_ground(x, y):
    return (x, y, 0.0)


def at_centre(model):
    return tuple(model["pose"][:3])


def off_the_handles(centre):
    """A point of a unit box's face towards -y, left of the arrows and below them."""
    return (centre[0] - 0.25, centre[1] - 0.5, centre[2] - 0.2)


def test_a_world_built_by_mouse_is_the_same_in_a_fresh_node(editor, node, launch, browser):
    insert_the_three_shapes(editor)
    move_the_box_to_whole_metres(editor)
    turn_the_box_by_45_degrees(editor)
    scale_the_cylinder(editor)
    delete_the_sphere_and_bring_it_back(editor)
    path = save_as(editor, node, "built_by_hand")
    built = {name: editor.model(name) for name in editor.names()}

    fresh = launch(path)
    assert set(fresh.ask("get_world_properties", GetWorldProperties).model_names) == set(built)
    for name, model in built.items():
        state = fresh.ask("get_model_state", GetModelState, model_name=name)
        assert state.success, name
        position, turn = state.pose.position, state.pose.orientation
        assert [position.x, position.y, position.z] == approx(model["pose"][:3], abs=1e-5), name
        assert [turn.x, turn.y, turn.z, turn.w] == approx(model["pose"][3:], abs=1e-5), name
    again = browser.open(fresh.url)
    for name, model in built.items():
        loaded = again.model(name)["links"][0]
        for part in ("collisions", "visuals"):
            assert [one["geometry"] for one in loaded[part]] == \
                [one["geometry"] for one in model["links"][0][part]], name
        assert loaded["inertial"] == model["links"][0]["inertial"], name
    assert again.faults == []
    again.close()


def insert_the_three_shapes(editor):
    for tool, place in (("Box", (-0.4, -1.6)), ("Sphere", (1.7, 0.4)), ("Cylinder", (-1.0, 1.5))):
        name = editor.place(tool, on_ground(*place))
        assert name == f"unit_{tool.lower()}"
        x, y, z = editor.model(name)["pose"][:3]
        assert (x, y) == approx(place, abs=0.02)
        assert z == approx(HALF_UP)
    editor.until("editor.store.mode === 'select'", "the mode of before")


def move_the_box_to_whole_metres(editor):
    box = at_centre(editor.model("unit_box"))
    editor.click(box)
    editor.until("editor.store.selection.join() === 'unit_box'", "the selection of the box")
    editor.page.keyboard.press("t")
    # Taken by the body it goes along the ground; Ctrl draws it to whole metres near by.
    grip = off_the_handles(box)
    editor.drag(grip, (grip[0] + 1.3, grip[1] - 0.5, grip[2]), keys=["Control"])
    # Poses come while the box is dragged already; the history comes with the release.
    in_history(editor, "translate")
    wait_for(lambda: editor.model("unit_box")["pose"][:3] == approx((1.0, -2.0, HALF_UP),
                                                                   abs=WHOLE), "whole metres")


def in_history(editor, verb):
    wait_for(lambda: editor.get("editor.store.history.undo[0]").lower().startswith(verb),
             f"{verb} in the history")


def turn_the_box_by_45_degrees(editor):
    box = at_centre(editor.model("unit_box"))
    editor.page.keyboard.press("r")
    grip = off_the_handles(box)
    editor.drag(grip, (grip[0] + 0.9, grip[1] + 0.2, grip[2]), keys=["z", "Control"])
    in_history(editor, "rotate")
    turned = wait_for(lambda: abs(yaw_of(editor.model("unit_box")["pose"])) > 1.0 and
                      yaw_of(editor.model("unit_box")["pose"]), "the turn")
    assert turned / 45.0 == approx(round(turned / 45.0), abs=1e-4)
    assert at_centre(editor.model("unit_box")) == approx(box, abs=WHOLE)


def scale_the_cylinder(editor):
    cylinder = editor.model("unit_cylinder")
    centre = at_centre(cylinder)
    editor.page.keyboard.press("Escape")
    editor.click(centre)
    editor.page.keyboard.press("s")
    grip = (centre[0] - 0.3, centre[1] - 0.4, centre[2] - 0.2)
    editor.drag(grip, (grip[0], grip[1], grip[2] + 0.5), keys=["z"])
    before = cylinder["links"][0]["collisions"][0]["geometry"]
    in_history(editor, "scale")
    wait_for(lambda: geometry(editor, "unit_cylinder")["length"] > 1.05, "the longer cylinder")
    after = geometry(editor, "unit_cylinder")
    assert after["radius"] == approx(before["radius"])
    visual = editor.model("unit_cylinder")["links"][0]["visuals"][0]["geometry"]
    assert visual["length"] == approx(after["length"])


def geometry(editor, name):
    return editor.model(name)["links"][0]["collisions"][0]["geometry"]


def delete_the_sphere_and_bring_it_back(editor):
    pose = editor.model("unit_sphere")["pose"]
    editor.page.keyboard.press("Escape")
    editor.click(at_centre(editor.model("unit_sphere")), button="right")
    editor.page.get_by_role("menuitem", name="Delete").click()
    wait_for(lambda: "unit_sphere" not in editor.names(), "the sphere's end")
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: "unit_sphere" in editor.names(), "the sphere's return")
    assert editor.model("unit_sphere")["pose"] == approx(pose, abs=1e-6)


def save_as(editor, node, name):
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    dialog.get_by_role("button", name="my_simulations/worlds").click()
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == node.worlds, "the folder")
    dialog.get_by_role("textbox", name="File name").fill(name)
    dialog.get_by_role("button", name="Save", exact=True).click()
    path = os.path.join(node.worlds, f"{name}.world")
    wait_for(lambda: os.path.isfile(path), "the file")
    editor.until("!editor.store.history.dirty", "the end of what is unsaved")
    return path


ROBOT = """<robot name="robo" my_simulations_launch="{launch}"><link name="base"><inertial>
<mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>"""


def test_a_robot_of_the_launch_file_is_saved_only_when_its_box_is_ticked(editor, node):
    # As spawn_model does that the launch file starts.
    assert node.ask("spawn_urdf_model", SpawnModel, model_name="robo",
                    model_xml=ROBOT.format(launch=node.process.pid)).success
    wait_for(lambda: "robo" in editor.names(), "the robot in the page")
    editor.place("Box", on_ground(-0.4, -1.6))
    assert save_with(editor, node, launched=False) == ["ground_plane", "unit_box"]
    assert save_with(editor, node, launched=True) == ["ground_plane", "robo", "unit_box"]
    # What was chosen stays chosen.
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    wait_for(lambda: dialog.get_by_role("checkbox", name="Include robo").is_checked(), "the tick")
    assert not dialog.get_by_role("checkbox", name="Include sim time").is_checked()


def save_with(editor, node, launched):
    """The models in a file that Save As has written, in the folder where it begins."""
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == node.typed, "the folder")
    choice = dialog.get_by_role(
        "checkbox", name="Include robo, which the launch file spawns at each start")
    choice.wait_for(state="visible")
    assert not choice.is_checked()
    choice.set_checked(launched)
    name = f"with_{launched}.world"
    dialog.get_by_role("textbox", name="File name").fill(name)
    dialog.get_by_role("button", name="Save", exact=True).click()
    path = os.path.join(node.typed, name)
    wait_for(lambda: os.path.isfile(path), "the file")
    dialog.wait_for(state="detached")
    world = ElementTree.parse(path).getroot().find("world")
    return [model.get("name") for model in world.findall("model")]


def test_a_typed_name_with_its_ending_is_saved_where_the_command_was_typed(editor, node):
    box = editor.place("Box", on_ground(-0.4, -1.6))
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == node.typed, "the folder")
    editor.page.keyboard.type("my_world.sdf")
    editor.page.keyboard.press("Enter")
    path = os.path.join(node.typed, "my_world.sdf")
    wait_for(lambda: os.path.isfile(path), "the file")
    dialog.wait_for(state="detached")
    assert box in [model.get("name") for model in ElementTree.parse(path).iter("model")]


def test_a_long_list_of_folders_does_not_cover_the_choices_below_it(editor, node):
    for number in range(40):
        os.makedirs(os.path.join(node.typed, f"folder_{number}"))
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    dialog.get_by_role("option", name="folder_39").wait_for(state="attached")
    files = dialog.get_by_role("listbox", name="Files").bounding_box()
    choice = dialog.get_by_role("checkbox").first.bounding_box()
    assert files["height"] > 200.0 and files["y"] + files["height"] <= choice["y"]
    editor.page.keyboard.press("Escape")


def test_a_world_is_saved_in_a_new_folder(editor, node):
    editor.place("Box", on_ground(-0.4, -1.6))
    editor.page.keyboard.press("Control+Shift+s")
    dialog = editor.page.get_by_role("dialog", name="Save World As")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == node.typed, "the folder")
    dialog.get_by_role("button", name="New Folder").click()
    asked = editor.page.get_by_role("dialog", name="New Folder")
    asked.get_by_role("textbox", name="Folder name").fill("week_1")
    editor.page.keyboard.press("Enter")
    asked.wait_for(state="detached")
    folder = os.path.join(node.typed, "week_1")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == folder, "the new folder")
    dialog.get_by_role("textbox", name="File name").fill("room.world")
    dialog.get_by_role("button", name="Save", exact=True).click()
    wait_for(lambda: os.path.isfile(os.path.join(folder, "room.world")), "the file")
    dialog.wait_for(state="detached")
    editor.page.keyboard.press("Control+Shift+s")
    wait_for(lambda: dialog.get_by_label("Folder").text_content() == folder, "the world's folder")
    dialog.get_by_role("option", name="..", exact=True).click()
    dialog.get_by_role("option", name="week_1", exact=True).click()
    dialog.get_by_role("option", name="room.world").wait_for()
    editor.page.keyboard.press("Escape")


def test_the_middle_of_the_drawn_view_is_where_a_person_points(editor):
    """The tests' own idea of the camera is the page's: a click on the ground lands there."""
    for place in ((-3.0, 2.0), (2.0, 1.0), (0.0, 0.0)):
        name = editor.place("Box", on_ground(*place))
        x, y = editor.model(name)["pose"][:2]
        assert math.hypot(x - place[0], y - place[1]) < 0.02
