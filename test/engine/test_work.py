"""What Python does for a command does not grow with the bodies that are there."""
from __future__ import annotations

import pytest
from conftest import ball, box, ground
from work_count import lines_run

from my_simulations.engine.commands import LoadModel, RemoveModel
from my_simulations.geometry import Pose

FEW, MANY = 20, 220


@pytest.mark.parametrize("make", [box, ball])
def test_a_body_that_comes_or_goes_costs_no_look_at_the_others(lab, make):
    lab.load(ground(1.0))
    lab.steps(1)
    came, gone, numbers = {}, {}, []
    for n in range(MANY):
        numbers.append(n + 2)
        load = LoadModel(n + 2, make(f"b{n}"), Pose((3.0 * n, 0.0, 0.5)), n + 1, 0, {})
        came[n + 1] = lines_run(lambda load=load: lab.apply(load))
        lab.backend.read()
    while numbers:
        model = numbers.pop(len(numbers) // 2)
        gone[len(numbers) + 1] = lines_run(lambda model=model: lab.apply(RemoveModel(model)))
    assert abs(came[MANY] - came[FEW]) < 20 and came[FEW] > 500
    assert abs(gone[MANY] - gone[FEW]) < 20 and gone[FEW] > 100


def test_a_body_that_is_read_out_after_a_command_is_the_only_one(lab):
    lab.load(ground(1.0))
    read = {}
    for n in range(MANY):
        lab.apply(LoadModel(n + 2, box(f"b{n}"), Pose((3.0 * n, 0.0, 0.5)), n + 1, 0, {}))
        read[n + 1] = lines_run(lab.backend.read)
    assert read[MANY] - read[FEW] < 20
