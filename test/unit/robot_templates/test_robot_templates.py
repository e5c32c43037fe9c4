"""Templates of robots: SDF without warnings, exact inertia, and values that are refused."""
from __future__ import annotations

import pytest

from my_simulations.description.validate import validate
from my_simulations.errors import CommandError
from my_simulations.formats.reading import read_entity
from my_simulations.resources.resolver import Resolver
from my_simulations.robot_templates import TEMPLATES, template_named

ALL_SENSORS = {"camera": True, "laser": True, "imu": True}


def model_of(name, /, **values):
    model, issues = read_entity(template_named(name).sdf(values), Resolver(), name)
    assert issues == []
    return model


def link(model, name):
    return next(one for one in model.links if one.name == name)


def plugins_of(model):
    return [*model.plugins, *(plugin for one in model.links for sensor in one.sensors
                              for plugin in sensor.plugins)]


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda one: one.name)
def test_a_template_is_valid_sdf_with_plugins(template):
    flags = {one.name: True for one in template.parameters if one.kind == "flag"}
    for given in ({}, flags):
        model = model_of(template.name, **given)
        assert validate(model) == []
        assert model.name == template.parameters[0].default
        assert plugins_of(model)


@pytest.mark.parametrize("template", TEMPLATES, ids=lambda one: one.name)
def test_the_ends_of_each_range_are_valid_or_refused_in_words(template):
    for parameter in template.parameters:
        if parameter.kind != "number":
            continue
        for value in (parameter.minimum, parameter.maximum):
            try:
                model = model_of(template.name, **{parameter.name: value})
            except CommandError as refused:
                assert "Body length" in str(refused)
            else:
                assert validate(model) == []


def test_inertia_is_that_of_solid_bodies():
    car = model_of("differential_drive", mass=6.0, length=0.5, width=0.4, body_height=0.1,
                   wheel_mass=0.5, wheel_radius=0.1, wheel_width=0.04)
    body = link(car, "base_link").inertial
    assert body.mass == 6.0
    assert (body.ixx, body.iyy, body.izz) == pytest.approx(
        (6 * (0.16 + 0.01) / 12, 6 * (0.25 + 0.01) / 12, 6 * (0.25 + 0.16) / 12), rel=1e-5)
    wheel = link(car, "left_wheel").inertial
    across = 0.5 * (3 * 0.01 + 0.0016) / 12
    assert (wheel.ixx, wheel.iyy, wheel.izz) == pytest.approx((across, across, 0.0025), rel=1e-5)


def test_sensors_names_and_topics_are_as_chosen():
    car = model_of("four_wheels", name="truck", namespace="/lab/truck/", command_topic="drive",
                   **ALL_SENSORS)
    assert car.name == "truck"
    assert {one.name for one in car.links} > {"camera_link", "laser_link", "imu_link"}
    for plugin in plugins_of(car):
        assert "<robotNamespace>/lab/truck</robotNamespace>" in plugin.xml
    assert any("<commandTopic>drive</commandTopic>" in plugin.xml for plugin in car.plugins)
    bare = model_of("differential_drive", camera=False)
    assert not any(one.sensors for one in bare.links)


@pytest.mark.parametrize("values, words", [
    ({"mass": -1.0}, "Body mass must be 0.1 to 2000 kg"),
    ({"mass": "heavy"}, "Body mass"),
    ({"mass": float("nan")}, "Body mass"),
    ({"camera": 1}, "Camera must be true or false"),
    ({"name": "a b"}, "Model name must start with a letter"),
    ({"name": ""}, "Model name"),
    ({"command_topic": "cmd vel"}, "Velocity topic"),
    ({"command_topic": "</commandTopic>"}, "Velocity topic"),
    ({"length": 0.1}, "Body length must be at least the diameter"),
    ({"color": "red"}, "unknown parameter 'color'"),
])
def test_values_that_are_not_allowed_are_refused(values, words):
    with pytest.raises(CommandError, match=words):
        template_named("differential_drive").sdf(values)


def test_an_unknown_template_is_refused():
    with pytest.raises(CommandError, match="unknown template 'boat'"):
        template_named("boat")
