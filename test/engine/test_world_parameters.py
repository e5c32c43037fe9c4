"""How requests for world-wide parameters of Bullet combine, and when they are set."""
from __future__ import annotations

import pytest

from my_simulations.engine.bullet import world_parameters
from my_simulations.engine.bullet.world_parameters import Accuracy, WorldParameters
from my_simulations.engine.commands import PhysicsSettings


@pytest.fixture
def calls(monkeypatch):
    found = []
    monkeypatch.setattr(world_parameters.pybullet, "setPhysicsEngineParameter",
                        lambda **values: found.append(values))
    monkeypatch.setattr(world_parameters.pybullet, "setGravity", lambda *_: None)
    return found


@pytest.fixture
def parameters(calls):
    made = WorldParameters()
    made.configure(PhysicsSettings(iterations=50))
    calls.clear()
    return made


def test_all_parameters_are_set_after_a_reset():
    found = []
    made = WorldParameters()
    made.request_accuracy(Accuracy(4, 1e-15))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world_parameters.pybullet, "setPhysicsEngineParameter",
                      lambda **values: found.append(values))
        patch.setattr(world_parameters.pybullet, "setGravity", lambda *_: None)
        for _ in range(2):
            found.clear()
            made.configure(PhysicsSettings(iterations=50))
            values = {name: value for call in found for name, value in call.items()}
            assert values["numSolverIterations"] == 200
            assert values["contactBreakingThreshold"] == world_parameters.USUAL_SPACING


def test_what_has_not_changed_is_not_set_again(parameters, calls):
    parameters.apply()
    parameters.request_accuracy(Accuracy())
    parameters.split_impulses(False)
    parameters.apply()
    assert calls == []


@pytest.mark.parametrize("order", [(0.2, 5e-4), (5e-4, 0.2)])
def test_the_widest_spacing_of_a_step_counts_for_that_step_alone(parameters, calls, order):
    for spacing in order:
        parameters.request_spacing(spacing)
    for _ in range(3):
        parameters.apply()
    assert calls == [{"contactBreakingThreshold": 0.2},
                     {"contactBreakingThreshold": world_parameters.USUAL_SPACING}]


def test_a_spacing_requested_in_each_step_is_set_once(parameters, calls):
    for _ in range(3):
        parameters.request_spacing(5e-4)
        parameters.apply()
    assert calls == [{"contactBreakingThreshold": 5e-4}]
    parameters.restore_spacing()
    parameters.request_spacing(5e-4)
    parameters.apply()
    assert calls[1:] == [{"contactBreakingThreshold": world_parameters.USUAL_SPACING},
                         {"contactBreakingThreshold": 5e-4}]


def test_the_most_exact_request_counts_and_that_of_a_step_ends_with_it(parameters, calls):
    parameters.request_accuracy(Accuracy(4, 1e-11))
    parameters.request_step_accuracy(Accuracy(10, 1e-9))
    parameters.apply()
    parameters.apply()
    assert calls == [{"numSolverIterations": 500, "solverResidualThreshold": 1e-11},
                     {"numSolverIterations": 200}]


@pytest.mark.parametrize("step_size, iterations", [(5e-4, 50), (1e-3, 50), (5e-3, 250)])
def test_longer_steps_take_more_iterations(parameters, calls, step_size, iterations):
    parameters.configure(PhysicsSettings(iterations=50, step_size=step_size))
    values = {name: value for call in calls for name, value in call.items()}
    assert values["numSolverIterations"] == iterations
