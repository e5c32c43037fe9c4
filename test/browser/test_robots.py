"""What robots see and how they are driven from the page, with ROS in between."""
from __future__ import annotations

import os

import pytest
from support import Node, wait_for

WORLD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "robot.world")


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    """A rover with a laser before a wall; the world runs."""
    running = Node(tmp_path_factory.mktemp("robots"), WORLD, "paused:=false")
    yield running
    running.close()


@pytest.fixture
def editor(node, visit):
    page = visit(node.url)
    yield page
    assert page.faults == []


def shown(editor):
    return editor.get("editor.topics.shown")


def heard(editor):
    """Nodes that hear the scan, as the master says."""
    listed = editor.get("editor.request('topics', {})")["topics"]
    return next(one["subscribers"] for one in listed if one["name"] == "/scan")


def forward(editor):
    return editor.model("rover")["pose"][0]


def test_a_selected_robot_shows_what_it_senses_and_costs_nothing_after(editor):
    assert heard(editor) == 0
    editor.row("rover").click()
    editor.until("editor.view.drawnTopics.includes('/scan')", "the laser's fan")
    editor.until("editor.view.drawnTopics.includes('/odom')", "the odometry's trail")
    assert heard(editor) == 1
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Escape")
    wait_for(lambda: shown(editor) == [], "nothing shown")
    wait_for(lambda: heard(editor) == 0, "nobody who hears the laser")
    editor.until("editor.view.drawnTopics.length === 0", "nothing drawn")


def test_the_fan_ends_at_the_wall(editor):
    editor.get("void editor.topics.listen('view', ({detail: {head, buffer, start}}) => {"
               " if (head.view.type === 'scan') window.ranges ="
               " [...new Float32Array(buffer, start, head.view.count)]; })")
    editor.row("rover").click()
    editor.until("window.ranges && Number.isFinite(window.ranges[45])", "a scan")
    x = forward(editor)
    assert editor.get("window.ranges[45]") == pytest.approx(2.0 - 0.1 - x, abs=0.02)


def test_arrow_keys_drive_the_selected_robot_until_they_are_released(node, editor):
    editor.row("rover").click()
    editor.page.locator("#view").focus()
    before = forward(editor)
    editor.page.keyboard.down("ArrowUp")
    wait_for(lambda: forward(editor) > before + 0.1, "the robot's way")
    editor.page.keyboard.up("ArrowUp")
    stands(editor)
    editor.page.keyboard.down("ArrowDown")
    there = forward(editor)
    wait_for(lambda: forward(editor) < there - 0.1, "the robot's way back")
    # The page is closed with the key held: the server stops the robot.
    other = editor.context.browser.new_context().new_page()
    editor.page.close()
    other.goto(node.url)
    wait_for(lambda: other.evaluate("Boolean(window.editor && editor.store.model('rover'))"),
             "another page")
    place = "editor.store.worldPose('rover')[0]"
    wait_for(lambda: still(lambda: other.evaluate(place), other), "the robot standing")
    other.close()


def stands(editor):
    wait_for(lambda: still(lambda: forward(editor), editor.page), "the robot standing")


def still(read, page):
    """Whether a coordinate stays where it is for half a second of wall time."""
    before = read()
    page.wait_for_timeout(500)
    return abs(read() - before) < 0.002


def test_a_model_without_wheels_is_said_to_be_undriven(editor):
    editor.get("editor.actions.edit({kind: 'insert', shape: 'box', name: 'crate', "
               "pose: [0, 3, 0.5, 0, 0, 0, 1]})")
    editor.until("Boolean(editor.store.model('crate'))", "the crate")
    editor.row("crate").click()
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("ArrowUp")
    editor.until("editor.store.issues.some(({message, severity}) => severity === 'note'"
                 " && message.includes('cannot be driven'))",
                 "a word about the crate")
    editor.get("editor.actions.undo()")


def test_the_topics_panel_shows_text_rates_and_tf_on_request(editor):
    editor.page.locator("#view").focus()
    editor.page.keyboard.press("Alt+t")
    panel = editor.page.locator("#topics")
    panel.get_by_label("Show /gazebo/performance_metrics").or_(
        panel.get_by_label("Show /clock")).first.wait_for()
    panel.get_by_label("Show /clock").check()
    window = editor.page.get_by_role("region", name="/clock")
    wait_for(lambda: "clock:" in (window.text_content() or ""), "the clock as text")
    wait_for(lambda: "Hz" in panel.get_by_role("listitem").filter(has_text="/clock").first
             .text_content(), "the clock's rate")
    editor.page.get_by_role("button", name="Close /clock").click()
    wait_for(lambda: shown(editor) == [], "the clock put away")
    panel.get_by_label("Show /tf", exact=True).check()
    editor.until("editor.view.drawnTopics.includes('/tf')", "frames of tf")
    assert editor.get("[...editor.topics.transforms.keys()]") == ["base"]
    panel.get_by_label("Show /tf", exact=True).uncheck()
    editor.page.keyboard.press("Alt+t")
    panel.wait_for(state="hidden")


def test_any_number_of_a_topic_is_plotted(editor):
    editor.page.keyboard.press("Control+p")
    search = editor.page.get_by_label("Find a variable")
    search.fill("odom")
    editor.page.get_by_role("option", name="/odom", exact=True).click()
    search.fill("odom.pose.pose.position.x")
    editor.page.get_by_role("option", name="/odom.pose.pose.position.x").click()
    search.fill("/scan.ranges[45]")
    editor.page.get_by_role("option", name="/scan.ranges[45]").press("Enter")
    wait_for(lambda: heard(editor) == 1, "one node that hears the scan")
    editor.get("window.plotted = {}; void editor.store.listen('watch', ({detail: {topic, value}})"
               " => { if (Number.isFinite(value)) window.plotted[topic] = value; })")
    x = forward(editor)
    editor.until("'plot:/odom.pose.pose.position.x' in plotted", "the odometry")
    editor.until(f"Math.abs(plotted['plot:/scan.ranges[45]'] - {1.9 - x}) < 0.1", "the middle beam")
    for variable in ("/odom.pose.pose.position.x", "/scan.ranges[45]"):
        editor.button(f"Remove {variable}").click()
    wait_for(lambda: heard(editor) == 0, "nobody who hears the scan")
    editor.button("Close plots").click()


def test_parameters_of_a_sensor_are_set_in_fields(editor):
    editor.row("rover").click()
    editor.page.keyboard.press("ArrowRight")
    row = editor.page.get_by_role("treeitem", name="base::laser", exact=True)
    row.get_by_text("running").wait_for()
    row.click()
    properties = editor.page.get_by_role("region", name="Properties")
    far = properties.locator(".section", has_text="Ray range").get_by_role("textbox", name="max")
    before = far.input_value()
    far.fill("4.5")
    far.press("Enter")
    editor.until("editor.store.model('rover').links.flatMap(({sensors}) => sensors).some("
                 "({parameters}) => parameters.some(({path, value}) => path === 'ray/range/max'"
                 " && value === 4.5))", "the new range")
    defaults = properties.locator(".section", has_text="parameters with default values")
    namespace = defaults.get_by_role("textbox", name="robotNamespace")
    namespace.fill("lab")
    namespace.press("Enter")
    editor.until("editor.store.model('rover').links.flatMap(({sensors}) => sensors).some("
                 "({parameters}) => parameters.some(({path, value}) =>"
                 " path === 'plugin:laser/robotNamespace' && value === 'lab'))", "the new element")
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Control+z")
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: far.input_value() == before, "the value of before")


def test_parameters_of_a_plugin_are_set_in_fields_and_the_plugin_starts_again(editor):
    editor.row("rover").click()
    editor.page.keyboard.press("ArrowRight")
    editor.row("drive").click()
    width = editor.field("wheelSeparation")
    assert width.input_value() == "0.3"
    width.fill("0.36")
    width.press("Enter")
    editor.until("editor.store.model('rover').plugins[0].xml.includes("
                 "'<wheelSeparation>0.36</wheelSeparation>')", "the new parameter")
    wait_for(lambda: any(one["name"] == "/cmd_vel" and one["subscribers"]
                         for one in editor.get("editor.request('topics', {})")["topics"]),
             "the plugin that listens again")
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Control+z")
    wait_for(lambda: editor.field("wheelSeparation").input_value() == "0.3", "the value of before")


def test_a_parameter_that_the_file_leaves_out_has_its_default_and_can_be_set(editor):
    editor.row("rover").click()
    editor.page.keyboard.press("ArrowRight")
    editor.row("drive").click()
    wait_for(lambda: editor.field("wheelAcceleration").input_value() == "0", "the default")
    source = editor.page.get_by_role("combobox", name="odometrySource", exact=True)
    assert source.input_value() == "world"
    assert editor.page.get_by_role("checkbox", name="publishOdomTF", exact=True).is_checked()
    editor.field("wheelAcceleration").fill("1.5")
    editor.field("wheelAcceleration").press("Enter")
    editor.until("editor.store.model('rover').plugins[0].xml.includes("
                 "'<wheelAcceleration>1.5</wheelAcceleration>')", "the new element")
    editor.until("editor.store.pluginStates.some(({name, state}) =>"
                 " name === 'drive' && state === 'running')", "the plugin that runs again")
    wait_for(lambda: editor.field("wheelAcceleration").input_value() == "1.5", "the new value")
    editor.page.keyboard.press("Escape")
    editor.page.keyboard.press("Control+z")
    editor.until("!editor.store.model('rover').plugins[0].xml.includes('wheelAcceleration')",
                 "the file as before")
    wait_for(lambda: editor.field("wheelAcceleration").input_value() == "0", "the default again")
