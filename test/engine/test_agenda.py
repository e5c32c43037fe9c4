"""Which bodies are checked in which step."""
from __future__ import annotations

from my_simulations.engine.bullet.agenda import FAR, Agenda


def test_bodies_are_taken_in_their_step_by_number():
    agenda: Agenda[int] = Agenda()
    for uid, step in ((3, 5), (1, 5), (2, 7)):
        agenda.plan(uid, step)
    assert agenda.next == 5
    assert agenda.take(4) == []
    assert agenda.take(5) == [1, 3]
    assert agenda.next == 7
    assert agenda.take(9) == [2]
    assert agenda.next == FAR


def test_a_new_plan_replaces_the_one_before():
    agenda: Agenda[int] = Agenda()
    for step in (5, 2, 8, 5, 8):
        agenda.plan(1, step)
    assert agenda.at(1) == agenda.next == 8
    assert agenda.take(7) == []
    assert agenda.take(8) == [1]
    assert agenda.take(9) == []
    assert agenda.at(1) == FAR


def test_a_body_that_is_planned_again_after_its_check_is_checked_once_more_only():
    agenda: Agenda[int] = Agenda()
    for step in (5, 7, 5):
        agenda.plan(1, step)
    assert agenda.take(5) == [1]
    agenda.plan(1, 7)
    assert agenda.take(7) == [1]
    assert agenda.next == FAR


def test_a_removed_link_is_not_checked():
    agenda: Agenda[tuple] = Agenda()
    agenda.plan((1, -1), 3)
    agenda.plan((1, 0), 3)
    agenda.pop((1, -1))
    agenda.pop((7, 0))
    assert agenda.take(3) == [(1, 0)]
