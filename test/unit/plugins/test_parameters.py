"""What plugins read from their elements, and what is known of it after."""
from __future__ import annotations

import math

from my_simulations.geometry import quat_from_rpy
from my_simulations.plugins.drive.diff_drive import DiffDrive
from my_simulations.plugins.parameters import Parameters
from my_simulations.plugins.plugin_state import PluginParameter
from my_simulations.plugins.testing import FakeContext


def test_what_was_read_is_declared_in_this_order_with_type_and_default():
    parameters = Parameters("<plugin><rate>5</rate></plugin>")
    assert parameters.declared() == ()
    parameters.number("rate", 100.0)
    parameters.positive("width", 0.34)
    parameters.integer("count", 3)
    parameters.flag("on", True)
    parameters.text("topic", "scan")
    parameters.vector("axis", (0.0, 0.5, 1.0))
    parameters.turn("turn", quat_from_rpy(0.0, 0.0, math.pi / 2.0))
    parameters.pose("origin")
    parameters.choice("source", {"encoder": True, "world": False}, False)
    assert parameters.declared() == (
        PluginParameter("rate", "number", "100"), PluginParameter("width", "number", "0.34"),
        PluginParameter("count", "integer", "3"), PluginParameter("on", "flag", "true"),
        PluginParameter("topic", "text", "scan"), PluginParameter("axis", "text", "0 0.5 1"),
        PluginParameter("turn", "text", "0 0 1.57079632679"),
        PluginParameter("origin", "text", "0 0 0 0 0 0"),
        PluginParameter("source", "choice", "world", ("encoder", "world")))


def test_the_first_default_that_says_something_stays():
    parameters = Parameters("")
    parameters.text("noise")
    parameters.number("noise", 0.1)
    parameters.number("noise", 0.2)
    assert parameters.declared() == (PluginParameter("noise", "number", "0.1"),)


def test_a_drive_declares_what_its_element_leaves_out():
    context = FakeContext("<plugin/>", joints=("left_joint", "right_joint"))
    DiffDrive(context).load()
    declared = {one.name: one for one in context.parameters.declared()}
    assert declared["wheelSeparation"] == PluginParameter("wheelSeparation", "number", "0.34")
    assert declared["odometrySource"].choices == ("encoder", "world")
    assert declared["commandTopic"].default == "cmd_vel"


def test_a_warning_of_a_wrong_value_names_the_default_as_files_write_it():
    warnings = []
    parameters = Parameters("<plugin><source>Source</source><origin>1</origin></plugin>",
                            warnings.append)
    assert parameters.choice("source", {"encoder": True, "world": False}, False) is False
    parameters.pose("origin")
    assert [text.rpartition("; ")[2] for text in warnings] == [
        "world is used", "0 0 0 0 0 0 is used"]
