"""Mobile bases stand, drive and turn on slopes as rigid bodies on wheels do."""
from __future__ import annotations

import math
from typing import Dict, Iterator

import pytest
from coulomb_base import skid_steered_path
from laws import Laws
from mobile_bases import KINDS, OnSlope, angle_between
from under_use import Use, UsedLaws, used

SPEED, TURN = 0.3, 0.5   # m/s, rad/s
DEGREES = (5.0, 10.0, 15.0)
HEADINGS = {"up": 0.0, "down": math.pi, "along": math.pi / 2.0, "oblique": 0.5}

# Other bodies take most of the time at small steps.
USES = [Use(0.01, 100.0), Use(0.005, 20.0, company=False), Use(0.002, 50.0, company=False),
        Use(0.001, 100.0, company=False), Use(0.001, 0.0, False, False, False)]


def _runs(largest_steps: Dict[str, float]) -> Iterator[object]:
    """One slope and heading for each kind and use; all others are long runs.

    `largest_steps`: up to which a law holds, s, for kinds for which it does not at 10 ms.
    """
    for k, kind in enumerate(KINDS):
        for u, use in enumerate(USES):
            if use.step_size > largest_steps.get(kind, 0.01):
                continue
            for d, degrees in enumerate(DEGREES):
                for h, heading in enumerate(HEADINGS):
                    usual = d == (k + u) % 3 and h == (2 * k + u) % 4 and (
                        kind != "mecanum" or use.step_size > 0.001)
                    yield pytest.param(kind, degrees, HEADINGS[heading], use,
                                       id=f"{kind}-{degrees:g}deg-{heading}-{use}",
                                       marks=() if usual else pytest.mark.long)


@pytest.mark.parametrize("kind, degrees, heading, use", _runs({"mecanum": 0.002}))
def test_a_base_stands_and_drives_on_a_slope(laws: Laws, kind: str, degrees: float, heading: float,
                                             use: Use):
    law, checked = f"a {kind} base on slopes", UsedLaws(laws, use)
    with used(use, sunk=True) as lab:
        slope = OnSlope(lab, KINDS[kind](1.0), degrees, heading)
        slope.drive(0.0)
        lab.seconds(0.5)
        x, y, turned = slope.place()
        lab.seconds(1.0)
        now = slope.place()
        checked.at_most(f"{law}: creep in 1 s, m", math.dist(now[:2], (x, y)), 2e-3)
        checked.at_most(f"{law}: turn as it stands, degrees", angle_between(now[2], turned), 0.05)
        for speed in (SPEED, -SPEED):
            slope.drive(speed)
            lab.seconds(0.5)
            x, y, turned = slope.place()
            lab.seconds(1.0)
            now = slope.place()
            ahead = (now[0] - x) * math.cos(turned) + (now[1] - y) * math.sin(turned)
            aside = (now[1] - y) * math.cos(turned) - (now[0] - x) * math.sin(turned)
            checked.near(f"{law}: way by that of its wheels", ahead / speed, 1.0, rel=0.03)
            checked.at_most(f"{law}: way aside in 1 s, m", abs(aside), 0.01)
            checked.at_most(f"{law}: turn in 1 s, degrees", angle_between(now[2], turned), 0.05)


@pytest.mark.parametrize("kind, degrees, heading, use", _runs({"mecanum": 0.002, "skid": 0.002}))
def test_a_base_turns_on_a_slope(laws: Laws, kind: str, degrees: float, heading: float, use: Use):
    """In place, the car on a circle of 1 m; skid-steered wheels slip down the slope meanwhile."""
    law, checked, seconds = f"a {kind} base turns on slopes", UsedLaws(laws, use), 1.0
    ahead, turn = (SPEED, SPEED) if kind == "car" else (0.0, TURN)
    with used(use, sunk=True) as lab:
        slope = OnSlope(lab, KINDS[kind](1.0), degrees, heading)
        slope.drive(0.0)
        lab.seconds(0.5)
        slope.drive(ahead, turn)
        lab.seconds(0.5)
        x, y, begin = slope.place()
        lab.seconds(seconds)
        now = slope.place()
        turned = math.radians(angle_between(now[2], begin))
        if kind == "skid":
            way_x, way_y, expected = skid_steered_path(degrees, heading, 1.0, turn, 0.5, seconds)
        else:
            expected = turn * seconds
            chord = 2.0 * ahead / turn * math.sin(expected / 2.0)
            way_x, way_y = (chord * part(begin + expected / 2.0) for part in (math.cos, math.sin))
        checked.near(f"{law}: turn by Coulomb's law and kinematics", turned / expected, 1.0,
                     rel=0.03)
        checked.at_most(f"{law}: off its place after 1 s, m",
                        math.dist(now[:2], (x + way_x, y + way_y)), 0.01)
