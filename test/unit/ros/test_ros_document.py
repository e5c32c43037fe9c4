import pytest

from my_simulations.description.model import Link, Model, PluginSpec
from my_simulations.errors import CommandError
from my_simulations.ros.services.spawn_request import asks_to_replace, checked_name, named, root_of


@pytest.mark.parametrize("text, root", [
    ("<robot name='a'/>", "robot"),
    ("<?xml version='1.0' encoding='ISO-8859-1'?>\n<!-- a > b -->\n<sdf version='1.6'><x></sdf>",
     "sdf"),
    ("<robot><never closed", "robot"),
    ("", ""),
    ("no xml at all", ""),
    ("<!-- never closed", ""),
])
def test_the_root_is_found_without_reading_on(text, root):
    assert root_of(text)[0] == root


@pytest.mark.parametrize("value, asked", [("true", True), ("1", True), ("false", False)])
def test_replacement_is_asked_for_by_a_root_attribute(value, asked):
    _, attributes = root_of(f"<robot my_simulations_replace='{value}'/>")
    assert asks_to_replace(attributes) is asked
    assert not asks_to_replace(root_of("<robot/>")[1])


@pytest.mark.parametrize("name", ["", "  ", "a::b"])
def test_names_no_model_can_have_are_refused(name):
    with pytest.raises(CommandError, match="model_name"):
        checked_name(name)


def plugin_model():
    return Model(
        name="own",
        plugins=[PluginSpec("a", "liba.so", "<plugin name='a' filename='liba.so'/>"),
                 PluginSpec("b", "libb.so", "<plugin name='b' filename='libb.so'>"
                            "<robotNamespace>mine</robotNamespace></plugin>")],
        links=[Link("l", extra=["<sensor name='s'><plugin name='c' filename='c.so'/></sensor>"])],
        models=[Model("inner", plugins=[PluginSpec("d", "d.so", "<plugin name='d'/>")])])


def test_the_namespace_goes_into_every_plugin_that_lacks_one():
    model = named(plugin_model(), "given", "/ns")
    assert model.name == "given"
    assert "<robotNamespace>/ns</robotNamespace>" in model.plugins[0].xml
    assert "mine" in model.plugins[1].xml and "/ns" not in model.plugins[1].xml
    assert "<robotNamespace>/ns</robotNamespace></plugin>" in model.links[0].extra[0]
    assert "/ns" in model.models[0].plugins[0].xml


def test_an_empty_namespace_leaves_the_plugins_alone():
    before = plugin_model()
    assert named(plugin_model(), "given", "").plugins == before.plugins


def test_a_plugin_with_an_undeclared_prefix_is_left_as_it_is():
    odd = "<plugin name='p'><controller:x/></plugin>"
    model = named(Model("own", plugins=[PluginSpec("p", "p.so", odd)]), "given", "/ns")
    assert model.plugins[0].xml == odd
