"""What wheels slip, and what joints transmit, by the names and rows of a running world."""
from __future__ import annotations

from dataclasses import replace

import pytest
from kinematic_backend import KinematicBackend
from running_simulator import running

from my_simulations.description.model import Inertial, Joint, JointAxis, Link, Model
from my_simulations.description.world import World
from my_simulations.engine.commands import JointWrench
from my_simulations.engine.drive_commands import WheelSlip
from my_simulations.errors import CommandError
from my_simulations.simulator.simulator import Simulator


def cart(name: str = "cart") -> Model:
    return Model(name, links=[Link("base", inertial=Inertial()), Link("arm", inertial=Inertial()),
                              Link("wheel", inertial=Inertial())],
                 joints=[Joint("axle", "revolute", "base", "wheel", axis=JointAxis()),
                         Joint("mount", "fixed", "base", "arm")])


@pytest.fixture
def case():
    backends = []

    def backend() -> KinematicBackend:
        backends.append(KinematicBackend())
        return backends[-1]

    with running(World(models=[cart("other"), cart()]), backend) as made:
        yield made, backends


def _slip(simulator: Simulator) -> WheelSlip:
    entity = simulator.models.inventory()[1][-1]
    wheel = entity.first_link_row + entity.link_names.index("wheel")
    return WheelSlip(wheel, entity.axis_row("axle", 0), 0.1, 20.0, 0.5, 1.0)


def test_wheels_slip_on_in_a_new_engine_until_a_reset(case):
    simulator, backends = case
    slip = _slip(simulator)
    simulator.drives.set_wheel_slips([slip])
    assert backends[-1].wheel_slips == {slip.row: slip}
    simulator._session.supervisor.engine.kill()
    simulator.clock.advance(1)
    assert len(backends) == 2 and backends[-1].wheel_slips == {slip.row: slip}
    simulator.resets.reset_simulation()
    assert simulator.drives.settings.commands() == []


def test_wheels_slip_on_after_an_edit_and_no_more_after_the_model_has_gone(case):
    simulator, backends = case
    slip = _slip(simulator)
    simulator.drives.set_wheel_slips([slip])
    model = simulator.models.get("cart")
    simulator.models.edit("cart", replace(model, links=[
        *model.links[:2], Link("more", inertial=Inertial()), *model.links[2:]]))
    now = _slip(simulator)
    assert now.row != slip.row and backends[-1].wheel_slips[now.row] == now
    simulator.models.delete("cart")
    assert simulator.drives.settings.commands() == []


def test_wrenches_are_asked_for_by_name_fixed_joints_too(case):
    simulator, backends = case
    wrench = JointWrench((1, 2, 3), (4, 5, 6))
    number = simulator.models.inventory()[1][-1].model_id
    backends[-1].joint_wrenches[number, "mount"] = wrench
    assert simulator.joints.wrenches(["cart::axle", "cart::mount"]) == [None, wrench]
    with pytest.raises(CommandError, match="nowhere"):
        simulator.joints.wrenches(["cart::nowhere"])
