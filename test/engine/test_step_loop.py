"""Who is called around which step."""
from __future__ import annotations

from types import SimpleNamespace

from my_simulations.engine.bullet.body_events import BodyEvent
from my_simulations.engine.bullet.step_helper import FAR, StepHelper, StepLoop

MOVING = SimpleNamespace(uid=1, moves=True)


class Helper(StepHelper):
    """Acts in the steps it is told, and does something in them."""

    def __init__(self, name, calls, steps, act=lambda step: None):
        self.name, self.calls, self.steps, self.act = name, calls, set(steps), act

    def due(self, step):
        return min((one for one in self.steps if one >= step), default=FAR)

    def before(self, step, dt, gravity):
        self.calls.append(f"{self.name}{step}<")
        self.act(step)

    def after(self, step, dt, gravity):
        self.calls.append(f"{self.name}{step}>")


def run(helpers, calls, first, count):
    loop = StepLoop(helpers, lambda: calls.append("."))
    loop.add(MOVING)
    return loop, lambda: loop.run(first, count, 0.001, (0.0, 0.0, -9.8))


def test_helpers_act_in_their_order_around_the_steps_that_are_theirs():
    calls = []
    _, go = run([Helper("a", calls, (2, 3)), Helper("b", calls, (3,))], calls, 0, 5)
    go()
    assert calls == [".", ".", "a2<", ".", "a2>", "a3<", "b3<", ".", "a3>", "b3>", "."]


def test_one_who_acts_in_each_step_lets_the_others_have_theirs():
    calls = []
    _, go = run([Helper("a", calls, range(9)), Helper("b", calls, (2,))], calls, 0, 4)
    go()
    assert [one for one in calls if one.startswith("b")] == ["b2<", "b2>"]
    assert [one for one in calls if one.startswith("a")] == [
        f"a{step}{side}" for step in range(4) for side in "<>"]


def test_whoever_is_due_since_a_body_was_touched_acts_in_the_same_step():
    calls = []
    first, last = Helper("a", calls, ()), Helper("c", calls, ())

    def touch(step):
        if step == 1:
            first.steps.add(1)
            last.steps.add(1)
            loop.handle_event(BodyEvent.ACTIVATED, None)

    loop, go = run([first, Helper("b", calls, range(9), touch), last], calls, 0, 3)
    go()
    # The first one's turn before the step was over; after it, all have theirs.
    assert calls == ["b0<", ".", "b0>", "b1<", "c1<", ".", "a1>", "b1>", "c1>", "b2<", ".", "b2>"]


def test_steps_are_the_same_however_many_are_made_in_one_go():
    found = []
    for parts in ((6,), (1, 2, 3), (1,) * 6):
        calls, step = [], 0
        helpers = [Helper("a", calls, (0, 1, 4)), Helper("b", calls, (1, 5))]
        for part in parts:
            run(helpers, calls, step, part)[1]()
            step += part
        found.append(calls)
    assert found[0] == found[1] == found[2]


def test_what_was_known_is_kept_from_one_run_to_the_next_until_a_command_changes_it():
    calls = []
    late = Helper("a", calls, ())
    loop, _ = run([late], calls, 0, 0)
    for step in range(3):
        if step == 1:
            late.steps.add(1)
            late.steps.add(2)
            loop.invalidate_due_steps()
        loop.run(step, 1, 0.001, (0.0, 0.0, -9.8))
    assert calls == [".", "a1<", ".", "a1>", "a2<", ".", "a2>"]


def test_bullet_makes_no_steps_where_nothing_can_move():
    calls = []
    loop, _ = run([Helper("a", calls, (2,))], calls, 0, 0)
    loop.forget(MOVING)
    loop.run(0, 5, 0.001, (0.0, 0.0, -9.8))
    assert calls == ["a2<", ".", "a2>"]


def test_a_helper_is_called_only_for_what_it_defines():
    class After(StepHelper):
        def due(self, step):
            return step

        def after(self, step, dt, gravity):
            calls.append(f"after{step}")

    calls = []
    _, go = run([StepHelper(), After()], calls, 0, 2)
    go()
    assert calls == [".", "after0", ".", "after1"]
