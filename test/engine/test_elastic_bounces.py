"""Bounces keep the energy that their restitution leaves, whatever the step size."""
from __future__ import annotations

import math

import numpy as np
import pytest
from conftest import Lab, ball, box, ground
from laws import Laws
from test_contact import _as_built

from my_simulations.description.shapes import Surface

G = 9.8
DROP = 5.0   # m
BOUNCES = 9
BARS = {0.001: 0.001, 0.002: 0.001, 0.005: 0.001, 0.01: 0.003}   # by the step size in s


def _bouncing(restitution: float) -> Surface:
    return Surface(restitution=restitution, bounce_threshold=0.0)


def _tops(heights: "np.ndarray") -> "np.ndarray":
    """The highest points between bounces, m."""
    inner = heights[1:-1]
    return inner[(inner >= heights[:-2]) & (inner > heights[2:])]


def _heights(lab: Lab, numbers, duration: float) -> "np.ndarray":
    """(steps, bodies), m, of the lowest points of balls with a radius of 0.5 m."""
    found = []
    for _ in range(round(duration / lab.settings.step_size)):
        lab.steps(1)
        found.append([lab.pose(number).position[2] - 0.5 for number in numbers])
    return np.array(found)


@pytest.mark.parametrize("kind", ["rigid", "articulated"])
@pytest.mark.parametrize("step", BARS)
def test_nine_elastic_bounces_keep_the_height(lab: Lab, laws: Laws, step: float, kind: str):
    lab.configure(step_size=step)
    lab.load(ground(surface=_bouncing(1.0)))
    drops = [DROP + 0.0137 * n for n in range(4)]
    balls = [lab.load(_as_built(ball(f"b{n}", surface=_bouncing(1.0)), kind),
                      (3.0 * n, 0, 0.5 + drop)) for n, drop in enumerate(drops)]
    for n in range(4):   # others stand and lie beside them, and one falls
        lab.load(box(f"box{n}"), (3.0 * n, 4.0 + n % 2, 0.5 + n % 2 * 3.0))
    heights = _heights(lab, balls, math.sqrt(8 * DROP / G) * (BOUNCES + 0.2))
    for drop, track in zip(drops, heights.T):
        tops = _tops(track)
        assert len(tops) == BOUNCES
        for top in tops:
            laws.near(f"nine elastic bounces of {kind} balls from 5 m, steps of {step} s: top, m",
                      float(top), drop, rel=BARS[step])


@pytest.mark.parametrize("step", BARS)
def test_bounces_rise_to_the_square_of_the_restitution(lab: Lab, laws: Laws, step: float):
    lab.configure(step_size=step)
    lab.load(ground(surface=_bouncing(1.0)))
    balls = [lab.load(ball(f"b{n}", surface=_bouncing(0.8)), (3.0 * n, 0, 3.5 + 0.0137 * n))
             for n in range(4)]
    heights = _heights(lab, balls, math.sqrt(2 * 3.0 / G) * (1 + 2 * 0.8 + 2 * 0.64 + 0.5))
    for n, track in enumerate(heights.T):
        first, second = _tops(track)[:2]
        drop = 3.0 + 0.0137 * n
        # A sampled top may be up to G (step / 2)^2 / 2 too low.
        laws.near(f"bounces with restitution 0.8, steps of {step} s: top, m",
                  [float(first), float(second)], [0.64 * drop, 0.4096 * drop], rel=5 * BARS[step])


@pytest.mark.parametrize("step", BARS)
def test_elastic_balls_that_meet_in_the_air_keep_their_energy(lab: Lab, laws: Laws, step: float):
    lab.configure(step_size=step, gravity=(0.0, 0.0, 0.0))
    left, right = (lab.load(ball(name, surface=_bouncing(1.0)), (x, 0, 3.0))
                   for name, x in (("left", -1.5), ("right", 1.5)))
    lab.push(left, (5.0, 0, 0))
    lab.seconds(1.0)
    speeds = [lab.twist(one).linear[0] for one in (left, right)]
    laws.near(f"elastic balls that meet, steps of {step} s: speeds, m/s", speeds, [0.0, 5.0],
              abs=0.01)
