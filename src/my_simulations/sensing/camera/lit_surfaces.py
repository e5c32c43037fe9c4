"""Draws surfaces with lights, shadows and fog, by a program for each kind of surface."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Hashable, List, Sequence, Set, Tuple

import numpy as np

from ...description.light import Light
from ...description.surroundings import Scene
from ..poses import inverse
from ..surfaces import Surface
from . import shaders
from .batches import Batch
from .lamps import ShadowView, light_kinds, light_uniforms
from .sky import fog_law, srgb_to_linear
from .uploaded_textures import Textures


@dataclass
class Lighting:
    """What all surfaces of one picture share; `told`: the programs that know it."""

    fog: str
    kinds: Tuple[Tuple[str, int], ...]
    values: Dict[str, np.ndarray]
    told: Set[shaders.LitKind] = field(default_factory=set)


class LitSurfaces:
    """Draws batches as cameras see them.

    Args:
        context: the OpenGL context.
        programs: by name; those of kinds of surfaces are added by kind.
        textures: of surfaces.
        maps: the shadow maps.
    """

    def __init__(self, context: Any, programs: Dict[Hashable, Any], textures: Textures,
                 maps: Sequence[Any]) -> None:
        self._context = context
        self._programs = programs
        self._textures = textures
        self._maps = maps

    def lighting(self, view: np.ndarray, clip: np.ndarray, lights: List[Light],
                 shadows: List[Tuple[int, ShadowView]], scene: Scene) -> Lighting:
        """What is the same for all surfaces of a picture.

        Args:
            view: 4x4, view from world.
            clip: 4x4, clip from view.
            lights: at most as many as a program counts with.
            shadows: which of the lights have the first shadow maps, and how these look.
            scene: ambient light and fog.
        """
        fog, kind = scene.fog, ""
        maps = np.zeros((shaders.MOST_SHADOWS, 4, 4), np.float32)
        pixels = np.zeros(shaders.MOST_SHADOWS, np.float32)
        for n, (_, one) in enumerate(shadows):
            maps[n] = (one.clip @ one.view @ inverse(view)).T
            pixels[n] = one.pixel
        values = {"clip": clip.T, "ambient": np.array(scene.ambient[:3]), "up": view[:3, 2],
                  "shadow_from_view": maps, "shadow_pixel": pixels,
                  **dict(light_uniforms(lights, view))}
        if fog is not None and fog.type != "none":
            kind, density = fog_law(fog)
            values["fog_color"] = srgb_to_linear(fog.color)
            values["fog"] = np.array([fog.start, fog.end, density])
        for n, texture in enumerate(self._maps):
            texture.use(location=1 + n)
        return Lighting(kind, light_kinds(lights, [n for n, _ in shadows]), {
            name: np.ascontiguousarray(value, dtype=np.float32) for name, value in values.items()})

    def kind_of(self, surface: Surface, lighting: Lighting) -> shaders.LitKind:
        """The kind of program that draws a surface."""
        return shaders.LitKind(
            self._textures.of(surface) is not None, surface.lit,
            surface.lit and max(surface.specular[:3]) > 0.0,
            self._textures.cutting(surface) is not None, surface.blended,
            lighting.fog, lighting.kinds if surface.lit else (),
            tuple(bool(bumps) for _, bumps in self._layers(surface)))

    def _layers(self, surface: Surface) -> List[Tuple[Any, Any]]:
        """Picture and normal map of each layer of a terrain."""
        return [(self._textures.of_layer(layer), n < shaders.MOST_BUMPS
                 and self._textures.bumps_of(layer))
                for n, layer in enumerate(surface.layers[:shaders.MOST_LAYERS])]

    def draw_opaque(self, batches: Sequence[Batch], lighting: Lighting) -> None:
        """Draw batches that hide what is behind them.

        Program by program, because a change takes Mesa three times as long as a small batch. Small
        ones first: walls and grounds are mostly behind them, and need not be lit there.
        """
        kinds: Dict[shaders.LitKind, List[Batch]] = {}
        for batch in sorted(batches, key=lambda one: one.radius):
            kinds.setdefault(self.kind_of(batch.surface, lighting), []).append(batch)
        for kind, alike in sorted(kinds.items(), key=lambda item: item[1][-1].radius):
            for batch in alike:
                self.draw(batch, kind, lighting)

    def draw(self, batch: Batch, kind: shaders.LitKind, lighting: Lighting) -> None:
        """Draw a batch, whose surface is of a kind."""
        texture = self._textures.of(batch.surface)
        program = self._program(kind, lighting)
        for uniform, values in batch.uniforms.items():
            member = program.get(uniform, None)   # `in` looks at all members, one after the other
            if member is not None and isinstance(values, bytes):
                _write(member, values)
            elif member is not None:
                member.value = values
        if texture is not None:
            texture.use(location=0)
        for n, (map_of_layer, bumps) in enumerate(self._layers(batch.surface)):
            map_of_layer.use(location=shaders.FIRST_LAYER + n)
            if bumps:
                bumps.use(location=shaders.FIRST_BUMPS + n)
        batch.draw(kind)

    def _program(self, kind: shaders.LitKind, lighting: Lighting) -> Any:
        """The program for surfaces of a kind, with what a picture sets set."""
        if kind not in self._programs:
            made = self._programs[kind] = self._context.program(
                shaders.LIT_VERTEX, shaders.lit_fragment(kind))
            for unit, sampler in enumerate((
                    "picture", "shadow0", "shadow1",
                    *(f"layer{n}" for n in range(shaders.MOST_LAYERS)),
                    *(f"bumps{n}" for n in range(shaders.MOST_BUMPS)))):
                if sampler in made:
                    made[sampler] = unit
        program = self._programs[kind]
        if kind not in lighting.told:
            lighting.told.add(kind)
            for uniform, values in lighting.values.items():
                member = program.get(uniform, None)
                if member is not None:
                    _write(member, values.tobytes())
        return program


def _write(member: Any, values: bytes) -> None:
    """Set a uniform of float32; of an array the compiler keeps as much as is used."""
    member.write(values[:member.array_length * member.dimension * 4])
