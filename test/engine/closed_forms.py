"""What the laws of motion give, by formula or by an integrator of high order."""
from __future__ import annotations

import cmath
import math
from typing import Tuple


def pendulum(angle: float, rate: float, inertia: float, torque: float, damping: float,
             seconds: float, step: float = 1e-4) -> Tuple[float, float]:
    """Angle below the horizontal and rate after `seconds`: I a'' = torque cos a - damping a'.

    Runge-Kutta 4.
    """
    def slope(a: float, w: float) -> Tuple[float, float]:
        return w, (torque * math.cos(a) - damping * w) / inertia

    for _ in range(round(seconds / step)):
        a1, w1 = slope(angle, rate)
        a2, w2 = slope(angle + step / 2 * a1, rate + step / 2 * w1)
        a3, w3 = slope(angle + step / 2 * a2, rate + step / 2 * w2)
        a4, w4 = slope(angle + step * a3, rate + step * w3)
        angle += step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        rate += step / 6 * (w1 + 2 * w2 + 2 * w3 + w4)
    return angle, rate


def pendulum_period(amplitude: float, inertia: float, torque: float) -> float:
    """4 K(sin(amplitude / 2)) / sqrt(torque / inertia), by the arithmetic-geometric mean."""
    a, b = 1.0, math.cos(amplitude / 2)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return 2 * math.pi / (a * math.sqrt(torque / inertia))


def oscillator(seconds: float, inertia: float, stiffness: float, damping: float,
               force: float) -> Tuple[float, float]:
    """Position and rate of I q'' = force - k q - d q' after `seconds`, from rest at 0."""
    if stiffness == 0.0 and damping == 0.0:
        return force / inertia * seconds ** 2 / 2, force / inertia * seconds
    if stiffness == 0.0:
        final, decay = force / damping, math.exp(-damping * seconds / inertia)
        return final * (seconds - inertia / damping * (1 - decay)), final * (1 - decay)
    root = cmath.sqrt(damping ** 2 - 4 * inertia * stiffness)
    fast, slow = (-damping - root) / (2 * inertia), (-damping + root) / (2 * inertia)
    if abs(fast - slow) < 1e-12 * abs(fast):
        fast *= 1 + 1e-6  # nearly critical: the formula needs two roots
    rest = force / stiffness
    grow = [cmath.exp(r * seconds) for r in (fast, slow)]
    position = rest * (1 - (slow * grow[0] - fast * grow[1]) / (slow - fast))
    rate = -rest * fast * slow * (grow[0] - grow[1]) / (slow - fast)
    return position.real, rate.real
