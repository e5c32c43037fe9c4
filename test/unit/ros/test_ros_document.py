import pytest

from my_simulations.description.model import Link, Model, PluginSpec
from my_simulations.errors import CommandError
from my_simulations.formats.reading import parse_document
from my_simulations.resources.resolver import Resolver
from my_simulations.ros.services.model_services import (
    SpawnOptions,
    check_name,
    options_of_attributes,
    with_name,
)


@pytest.mark.parametrize("text, root", [
    ("<robot name='a'/>", "robot"),
    ("<?xml version='1.0'?>\n<!-- a > b --><sdf version='1.6'><model name='m'/></sdf>", "sdf"),
])
def test_the_root_is_known_before_the_entity_is_read(text, root):
    assert parse_document(text, Resolver()).root_tag == root


@pytest.mark.parametrize("value, asked", [("true", True), ("1", True), ("false", False)])
def test_replacement_is_asked_for_by_a_deprecated_root_attribute(value, asked):
    assert options_of_attributes({"my_simulations_replace": value}).replace is asked
    assert options_of_attributes({}) == SpawnOptions()


@pytest.mark.parametrize("value, pid", [("41", 41), ("", 0), ("many", 0), ("9" * 30, 0)])
def test_the_launch_of_a_deprecated_root_attribute_is_a_process_id(value, pid):
    assert options_of_attributes({"my_simulations_launch": value}).launch_pid == pid


def test_attributes_that_were_taken_cause_no_warning():
    text = "<robot name='a' my_simulations_replace='1' odd='2'><link name='l'/></robot>"
    document = parse_document(text, Resolver())
    assert document.take_attributes(("my_simulations_replace", "my_simulations_file")) == {
        "my_simulations_replace": "1"}
    _, issues = document.read_entity()
    assert [issue.message for issue in issues if issue.code == "unknown-attribute"] == [
        "attribute odd is unknown in <robot>; it is kept without effect"]


def test_a_document_that_gets_another_name_has_it_in_every_issue():
    document = parse_document("<robot name='a'><link name='l'/><odd></robot>", Resolver())
    document.set_file("arm.urdf")
    _, issues = document.read_entity()
    assert len(issues) > 1 and {issue.file for issue in issues} == {"arm.urdf"}


@pytest.mark.parametrize("name", ["", "  ", "a::b"])
def test_names_no_model_can_have_are_refused(name):
    with pytest.raises(CommandError, match="model_name"):
        check_name(name)


def plugin_model():
    return Model(
        name="own",
        plugins=[PluginSpec("a", "liba.so", "<plugin name='a' filename='liba.so'/>"),
                 PluginSpec("b", "libb.so", "<plugin name='b' filename='libb.so'>"
                            "<robotNamespace>mine</robotNamespace></plugin>")],
        links=[Link("l", extra=["<sensor name='s'><plugin name='c' filename='c.so'/></sensor>"])],
        models=[Model("inner", plugins=[PluginSpec("d", "d.so", "<plugin name='d'/>")])])


def test_the_namespace_goes_into_every_plugin_that_lacks_one():
    model = with_name(plugin_model(), "given", "/ns")
    assert model.name == "given"
    assert "<robotNamespace>/ns</robotNamespace>" in model.plugins[0].xml
    assert "mine" in model.plugins[1].xml and "/ns" not in model.plugins[1].xml
    assert "<robotNamespace>/ns</robotNamespace></plugin>" in model.links[0].extra[0]
    assert "/ns" in model.models[0].plugins[0].xml


def test_an_empty_namespace_leaves_the_plugins_alone():
    before = plugin_model()
    assert with_name(plugin_model(), "given", "").plugins == before.plugins


def test_a_plugin_with_an_undeclared_prefix_is_left_as_it_is():
    odd = "<plugin name='p'><controller:x/></plugin>"
    model = with_name(Model("own", plugins=[PluginSpec("p", "p.so", odd)]), "given", "/ns")
    assert model.plugins[0].xml == odd
