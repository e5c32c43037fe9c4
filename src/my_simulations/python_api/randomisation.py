"""Draws friction, mass, gravity, light, colours, textures and sensor noise of a world."""
from __future__ import annotations

import zlib
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Optional, Tuple

import numpy as np

from ..description.light import Light
from ..description.model import Inertial, Link, Model
from ..description.sensor import Noise
from ..description.shapes import Collision, Color, Material, Visual
from ..description.world import World
from ..errors import CommandError
from .plain_values import limit_of, number_of
from .world_choice import WorldChoice

Range = Tuple[float, float]
"""The least and the greatest value; each value between them is as likely."""

_SAME = (1.0, 1.0)
_WHITE = (1.0, 1.0, 1.0, 1.0)   # with it, a texture has its own colours


@dataclass(frozen=True)
class Randomisation:
    """What differs from one episode to the next. The defaults leave everything as in the files.

    Each model has one factor of friction, mass and noise for all its links. Raises CommandError for
    a range or an amount that is not possible.

    Attributes:
        friction: factor of the coefficients of friction.
        mass: factor of the masses and moments of inertia; static models have none.
        gravity: factor of gravity.
        light: factor of the brightness of each light.
        colour: the most by which red, green and blue of each visual change, 0 to 1.
        textures: URIs or paths of images; each visual gets one of them.
        sensor_noise: factor of all standard deviations of the sensors' noise.
        models: names of the models that change; () for all.

    A world that lacks one of the models or textures cannot be opened: CommandError.
    """

    friction: Range = _SAME
    mass: Range = _SAME
    gravity: Range = _SAME
    light: Range = _SAME
    colour: float = 0.0
    textures: Tuple[str, ...] = ()
    sensor_noise: Range = _SAME
    models: Tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("friction", "mass", "gravity", "light", "sensor_noise"):
            _check_range(name, getattr(self, name))
        if not 0.0 <= number_of(self.colour, "colour") <= 1.0:
            raise CommandError(f"colour must be between 0 and 1, is {self.colour!r}")
        for name in ("textures", "models"):
            values = getattr(self, name)
            if isinstance(values, str) or not all(isinstance(value, str) for value in values):
                raise CommandError(f"{name} is a list of names, not {values!r}")

    def apply(self, choice: WorldChoice, random: np.random.Generator) -> WorldChoice:
        """Return a choice whose world and models are drawn; equal generators draw the same."""
        seed = int(random.integers(2 ** 32))

        def alter_model(model: Model) -> Model:
            return self._model(choice.alter_model(model), seed)

        def alter(world: World) -> World:
            return self._world(choice.alter(world), seed)

        return replace(choice, alter=alter, alter_model=alter_model,
                       expected_models=(*choice.expected_models, *self.models),
                       expected_files=(*choice.expected_files, *self.textures))

    def _world(self, world: World, seed: int) -> World:
        random = np.random.default_rng([seed, 0])
        factor = random.uniform(*self.gravity)
        x, y, z = (factor * value for value in world.gravity)
        return replace(world, gravity=(x, y, z),
                       lights=[_brighter(light, random.uniform(*self.light))
                               for light in world.lights],
                       models=[self._model(model, seed) for model in world.models])

    def _model(self, model: Model, seed: int) -> Model:
        if self.models and model.name not in self.models:
            return model
        random = np.random.default_rng([seed, 1, zlib.crc32(model.name.encode())])
        factors = _Factors(random.uniform(*self.friction), random.uniform(*self.mass),
                           random.uniform(*self.sensor_noise))
        return self._randomise(model, factors, random)

    def _randomise(self, model: Model, factors: _Factors, random: np.random.Generator) -> Model:
        return replace(
            model, links=[self._link(link, factors, random) for link in model.links],
            joints=[replace(joint, sensors=_noisier(joint.sensors, factors.noise))
                    for joint in model.joints],
            models=[self._randomise(inner, factors, random) for inner in model.models])

    def _link(self, link: Link, factors: _Factors, random: np.random.Generator) -> Link:
        return replace(
            link, inertial=_heavier(link.inertial, factors.mass),
            collisions=[_rougher(one, factors.friction) for one in link.collisions],
            visuals=[self._visual(one, random) for one in link.visuals],
            sensors=_noisier(link.sensors, factors.noise))

    def _visual(self, visual: Visual, random: np.random.Generator) -> Visual:
        shift = random.uniform(-self.colour, self.colour, 3) if self.colour else None
        texture = str(random.choice(self.textures)) if self.textures else ""
        if shift is None and not texture:
            return visual
        before = visual.material or Material()
        material = before
        if texture:
            before = material = replace(before, texture=texture, ambient=_WHITE, diffuse=_WHITE,
                                        script_uris=[], script_name="")
        if shift is not None:
            material = replace(material, ambient=_shift_colour(before.ambient, shift),
                               diffuse=_shift_colour(before.diffuse, shift),
                               script_uris=[], script_name="")
        return replace(visual, material=material)


@dataclass(frozen=True)
class _Factors:
    """Factors that a model has."""

    friction: float
    mass: float
    noise: float


def _check_range(name: str, values: Range) -> None:
    try:
        least, greatest = values
    except (TypeError, ValueError):
        raise CommandError(f"{name} is a range (least, greatest), not {values!r}") from None
    if number_of(least, name) > number_of(greatest, name):
        raise CommandError(f"the least value of {name} comes first: {values!r}")
    if name != "gravity":
        limit_of(least, name)


def _heavier(old: Inertial, factor: float) -> Inertial:
    return Inertial(old.mass * factor, old.pose, old.ixx * factor, old.ixy * factor,
                    old.ixz * factor, old.iyy * factor, old.iyz * factor, old.izz * factor)


def _rougher(collision: Collision, factor: float) -> Collision:
    surface = collision.surface
    return replace(collision, surface=replace(surface, mu=surface.mu * factor,
                                              mu2=surface.mu2 * factor))


def _brighter(light: Light, factor: float) -> Light:
    red, green, blue = (min(1.0, factor * value) for value in light.diffuse[:3])
    return replace(light, diffuse=(red, green, blue, light.diffuse[3]))


def _shift_colour(colour: Optional[Color], shift: np.ndarray) -> Color:
    old = colour or (0.7, 0.7, 0.7, 1.0)
    red, green, blue = np.clip(np.array(old[:3]) + shift, 0.0, 1.0).tolist()
    return (red, green, blue, old[3])


def _noisier(value: Any, factor: float) -> Any:
    """Return sensors, or parts of them, with other standard deviations of all their noise."""
    if isinstance(value, Noise):
        return replace(value, stddev=value.stddev * factor, bias_stddev=value.bias_stddev * factor,
                       dynamic_bias_stddev=value.dynamic_bias_stddev * factor)
    if isinstance(value, list):
        return [_noisier(one, factor) for one in value]
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{one.name: _noisier(getattr(value, one.name), factor)
                                 for one in fields(value) if one.init})
    return value
