"""The world's lights as the shader wants them, and the views shadows are drawn from."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, List, Tuple

import numpy as np

from ...description.light import Light
from ...geometry import rotate
from ..api import CameraSpec
from .frustum import is_in_view
from .shaders import MOST_LIGHTS, MOST_SHADOWS

SHADOW_SIZE = 1024
_WIDEST = 20.0  # m round the middle that a directional light's shadows reach
_STEP = 5.0


@dataclass(frozen=True)
class ShadowView:
    """Where a shadow map is drawn from.

    Attributes:
        view: (4, 4) light (looking along -z) from world.
        clip: (4, 4) clip space from light.
        pixel: m a pixel, about.
    """

    view: np.ndarray
    clip: np.ndarray
    pixel: float


def chosen_lights(lights: List[Light], view: np.ndarray, spec: CameraSpec) -> List[Light]:
    """The lights that a picture is drawn under, MOST_LIGHTS at most; `view`: camera from world.

    Where there are more, directional ones come first, then those whose range the camera sees a
    part of, then near ones. (Gazebo's Ogre chooses by distance, too, for each object.)
    """
    if len(lights) <= MOST_LIGHTS:
        return lights
    places = np.array([light.pose.position for light in lights]) @ view[:3, :3].T + view[:3, 3]
    ranges = np.array([light.range for light in lights])
    local = np.array([is_local(light) for light in lights])
    order = np.lexsort((np.linalg.norm(places, axis=1) - ranges,
                        ~is_in_view(places, ranges, spec), local))
    # By type, so that one choice has few other programs than the next one.
    return sorted((lights[n] for n in sorted(order[:MOST_LIGHTS])), key=lambda one: one.type)


def is_local(light: Light) -> bool:
    """Whether a light has a place, and a range; others shine from afar."""
    return light.type in ("point", "spot")


def shadow_lights(lights: List[Light]) -> List[int]:
    """Which of the chosen lights cast shadows: the first directional and spot ones that shall."""
    wanted = [n for n, light in enumerate(lights) if light.cast_shadows and light.type != "point"]
    return wanted[:MOST_SHADOWS]


def light_kinds(lights: List[Light], shadows: List[int]) -> Tuple[Tuple[str, int], ...]:
    """Type of each light, and its shadow map or -1, as `shaders.LitKind` wants them."""
    return tuple((light.type if is_local(light) else "directional",
                  shadows.index(n) if n in shadows else -1)
                 for n, light in enumerate(lights))


def light_uniforms(lights: List[Light], view: np.ndarray) -> List[Tuple[str, Any]]:
    """Values of the shader's arrays for the chosen lights; `view` is camera from world."""
    at = np.zeros((MOST_LIGHTS, 4), np.float32)
    color = np.zeros((MOST_LIGHTS, 3), np.float32)
    way = np.zeros((MOST_LIGHTS, 3), np.float32)
    fade = np.zeros((MOST_LIGHTS, 4), np.float32)
    cone = np.full((MOST_LIGHTS, 3), -2.0, np.float32)
    for n, light in enumerate(lights):
        ahead = view[:3, :3] @ _direction(light)
        color[n] = light.diffuse[:3]
        way[n] = ahead
        if not is_local(light):
            at[n] = (*-ahead, 0.0)
        else:
            at[n] = (*(view @ np.array([*light.pose.position, 1.0]))[:3], 1.0)
        fade[n] = (light.constant, light.linear, light.quadratic, light.range)
        if light.type == "spot":
            outer = min(light.outer_angle or math.pi, math.pi * 0.98) / 2
            inner = min(light.inner_angle / 2, outer)
            cone[n] = (math.cos(inner), math.cos(outer), light.falloff or 1.0)
    return [("light_at", at), ("light_color", color), ("light_way", way), ("light_fade", fade),
            ("light_cone", cone)]


def _direction(light: Light) -> np.ndarray:
    way = np.array(rotate(light.pose.orientation, light.direction))
    unit: np.ndarray = way / (np.linalg.norm(way) or 1.0)
    return unit


def shadow_view(light: Light, low: np.ndarray, high: np.ndarray, eye: np.ndarray, ) -> ShadowView:
    """Where a light's map is drawn from.

    It depends on the casters' bounds (`low`, `high`) and, where these are wide, on which part of
    the world the camera is in; so a map can be kept while nothing moves.
    """
    ahead = _direction(light)
    back = -ahead
    side = np.cross([0.0, 0.0, 1.0] if abs(back[2]) < 0.9 else [0.0, 1.0, 0.0], back)
    side /= np.linalg.norm(side)
    turn = np.stack([side, np.cross(back, side), back])
    if light.type == "spot":
        view = _view(turn, np.array(light.pose.position))
        angle = min(light.outer_angle or 1.0, 2.8)
        clip = _perspective(angle, max(light.range, 0.2))
        return ShadowView(view, clip, 2 * math.tan(angle / 2) * light.range / 2 / SHADOW_SIZE)
    center, half = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    half = max(math.ceil(half * 2) / 2, 1.0)
    if half > _WIDEST:
        center, half = np.round(eye / _STEP) * _STEP, _WIDEST
    reach = half + 60.0
    clip = np.diag([1.0 / half, 1.0 / half, -1.0 / reach, 1.0])
    return ShadowView(_view(turn, center), clip, 2 * half / SHADOW_SIZE)


def _view(turn: np.ndarray, at: np.ndarray) -> np.ndarray:
    view = np.eye(4)
    view[:3, :3] = turn
    view[:3, 3] = -turn @ at
    return view


def _perspective(angle: float, far: float) -> np.ndarray:
    near = far / 500.0
    f = 1.0 / math.tan(angle / 2)
    return np.array([[f, 0, 0, 0], [0, f, 0, 0],
                     [0, 0, (far + near) / (near - far), 2 * far * near / (near - far)],
                     [0, 0, -1.0, 0]])
