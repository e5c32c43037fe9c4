"""What is looked at when commands wake bodies."""
from __future__ import annotations

from types import SimpleNamespace

from my_simulations.engine.bullet.wake_up import WakeUp


def test_a_body_with_many_commands_is_woken_once(monkeypatch):
    bodies = {uid: SimpleNamespace(uid=uid, sleeps=False, moves=uid != 3) for uid in range(4)}
    looked, touched = [], []
    near = {0: {0, 1, 3}, 1: {0, 1, 2, 3}, 2: {1, 2}}

    def moving_near(self, body, seen):
        looked.append(body.uid)
        return [bodies[uid] for uid in near[body.uid] - seen if bodies[uid].moves]

    monkeypatch.setattr(WakeUp, "_moving_near", moving_near)
    WakeUp(bodies, lambda body: touched.append(body.uid)).around([bodies[0]] * 8 + [bodies[1]])
    assert sorted(looked) == [0, 1, 2]
    assert sorted(touched) == [0, 1, 2]
