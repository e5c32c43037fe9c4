"""The table of services and topics, and what it promises."""
from __future__ import annotations

import ast
import pathlib
import sys

import pytest

from my_simulations.ros import interface
from my_simulations.ros.interface import BY_ROSPY, PUBLISHES, SERVES, SUBSCRIBES, TABLE

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
ROS = REPOSITORY / "src" / "my_simulations" / "ros"
sys.path.insert(0, str(REPOSITORY / "tools" / "generate"))

from interface_table import PAGE, with_interface

GAZEBOS = """
    spawn_urdf_model spawn_sdf_model delete_model delete_light get_model_properties get_model_state
    get_world_properties get_joint_properties get_link_properties get_link_state
    get_light_properties pause_physics unpause_physics reset_simulation reset_world
    set_model_state set_link_state set_model_configuration set_joint_properties
    set_link_properties set_light_properties set_physics_properties get_physics_properties
    apply_body_wrench apply_joint_effort clear_body_wrenches clear_joint_forces
    set_parameters get_loggers set_logger_level""".split()
"""The services of gazebo_ros."""


def names(direction, **settings):
    return [row.name for row in interface.offered_rows(**settings) if row.direction is direction]


def test_without_extensions_the_services_are_gazebos():
    assert sorted(names(SERVES, extensions=False)) == sorted(GAZEBOS)


def test_what_newer_versions_of_gazebo_have_is_not_called_an_extension():
    (line,) = (line for line in interface.interface_tables().splitlines()
               if "`performance_metrics`" in line)
    assert "since Gazebo 11.2" in line and "extension" not in line
    assert "performance_metrics" not in names(PUBLISHES, extensions=False)


def test_without_extensions_the_topics_are_gazebos():
    assert names(PUBLISHES, extensions=False) == [
        "/clock", "model_states", "link_states", "parameter_descriptions", "parameter_updates",
        "/rosout"]
    assert names(SUBSCRIBES, extensions=False) == ["set_model_state", "set_link_state"]


def test_without_a_network_there_is_a_clock_and_what_every_node_has():
    assert [row.name for row in interface.offered_rows(network=False)] == [
        "/clock", "/rosout", "get_loggers", "set_logger_level"]


def test_names_are_unique_by_direction():
    found = [(row.name, row.direction) for row in TABLE]
    assert len(found) == len(set(found))


def test_names_move_with_the_node():
    assert interface.row_of("model_states", PUBLISHES).under("/a/b") == "/a/b/model_states"
    assert interface.row_of("/clock", PUBLISHES).under("/a/b") == "/clock"
    with pytest.raises(KeyError):
        interface.row_of("model_states", SERVES)


def test_every_handler_of_the_table_is_a_method_and_every_service_has_a_title():
    methods = {node.name for path in ROS.rglob("*.py")
               for made in ast.parse(path.read_text()).body if isinstance(made, ast.ClassDef)
               for node in made.body if isinstance(node, ast.FunctionDef)}
    for row in TABLE:
        if row.handler == BY_ROSPY or row.direction is PUBLISHES:
            continue
        assert row.handler.split(".")[1] in methods, row
        assert row.title or row.direction is SUBSCRIBES, row


def test_the_page_has_the_present_table():
    page = PAGE.read_text(encoding="utf-8")
    assert with_interface(page) == page, "run tools/generate/interface_table.py"
