"""The plugin of a conveyor belt, in a world without physics."""
from __future__ import annotations

from types import SimpleNamespace

import pytest

from my_simulations.description.model import Joint, JointAxis
from my_simulations.plugins.context import PluginError
from my_simulations.plugins.moving_surface import MovingSurface
from my_simulations.plugins.testing import FakeContext, Message
from my_simulations.plugins.world.conveyor_belt import ConveyorBelt, power_of


def belt(inside=""):
    context = FakeContext(f"<plugin><robot_namespace>/cell</robot_namespace>{inside}</plugin>",
                          joints=["belt_joint"])
    context.joints["belt_joint"].spec = Joint("belt_joint", "prismatic", "world", "belt",
                                              axis=JointAxis(lower=0.0, upper=1.0))
    return context, context.load(ConveyorBelt)


def set_power(context, **request):
    response = Message()
    context.services["cell/conveyor/control"](Message(**request), response)
    return response.success


def speed(context):
    return context.joints["belt_joint"].motor[0]


def test_the_power_is_a_share_of_the_fastest_speed():
    context, plugin = belt("<power>25</power>")
    assert speed(context) == pytest.approx(0.05)
    assert set_power(context, power=50.0) and speed(context) == pytest.approx(0.1)
    plugin.reset()
    assert speed(context) == pytest.approx(0.05)


def test_a_belt_never_reaches_its_limit():
    context, _ = belt("<power>100</power><max_velocity>2</max_velocity>")
    positions = []
    for _ in range(300):
        context.advance(0.01)
        positions.append(context.joints["belt_joint"].position)
    assert 0.8 < max(positions) < 1.0
    assert context.joints["belt_joint"].set_count >= 3


@pytest.mark.parametrize("lower, upper", [(0.0, 1.0), (-1.0, 1.0), (-2.0, -1.0)])
@pytest.mark.parametrize("velocity", [2.0, -2.0])
def test_a_surface_never_reaches_the_limits_in_either_direction(lower, upper, velocity):
    context = FakeContext("<plugin/>", joints=["belt"])
    joint = context.joints["belt"]
    joint.spec = Joint("belt", "prismatic", "world", "belt",
                       axis=JointAxis(lower=lower, upper=upper))
    joint.position = 0.5 * (lower + upper)
    MovingSurface(context, "belt").set_velocity(velocity)
    for _ in range(300):
        context.advance(0.01)
        assert lower <= joint.position <= upper
    assert joint.set_count >= 3 and joint.motor[0] == velocity


def test_a_surface_that_stops_stays():
    context = FakeContext("<plugin/>", joints=["belt"])
    surface = MovingSurface(context, "belt")
    surface.set_velocity(1.0)
    context.advance(0.1)
    surface.set_velocity(0.0)
    before = context.joints["belt"].position
    context.advance(1.0)
    assert context.joints["belt"].position == before > 0.0


def test_a_power_beyond_its_range_is_refused():
    context, _ = belt()
    assert not set_power(context, power=101.0) and speed(context) == 0.0
    assert any("0 to 100" in text for text in context.log_messages)
    with pytest.raises(PluginError, match="<power> must be 0 to 100"):
        belt("<power>-1</power>")


def test_the_power_can_be_that_of_a_state():
    assert power_of(SimpleNamespace(power=30.0)) == 30.0
    assert power_of(SimpleNamespace(state=SimpleNamespace(power=30.0))) == 30.0
