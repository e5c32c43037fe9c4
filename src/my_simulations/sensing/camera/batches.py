"""Instances of the same triangles and surface, drawn together."""
from __future__ import annotations

from typing import Any, Dict, Hashable, List, Tuple, Union

import numpy as np

from ..surfaces import Piece, Surface
from .shaders import MOST_LAYERS
from .sky import srgb_to_linear

INSTANCE: Any = np.dtype([("rows", "<f4", (3, 4)), ("link", "<i4"), ("diffuse", "<f4", 4),
                          ("specular", "<f4", 3), ("emissive", "<f4", 3)])
"""What a program reads for each instance: view from shape, link row and colours of the surface.

Colours are here and no uniforms: Mesa takes five times as long to draw after a uniform has changed.
"""


class Batch:
    """One mesh on the graphics card, and where it is to be seen.

    Attributes:
        owners: name of the model of each instance.
        instance: of INSTANCE, with the colours of its surface; shape ().
        uniforms: of its surface.
        rows: link row of each; local: (n, 4, 4) link from shape.
        shape: another number for another shape.
        ahead: z in the view frame of what was uploaded, on average; of clear surfaces only.
    """

    def __init__(self, context: Any, programs: Dict[Hashable, Any], piece: Piece,
                 shadows: bool) -> None:
        self.surface: Surface = piece.surface
        self.instance = _instance(piece.surface)
        self.uniforms = _uniforms(piece.surface)
        self.casts_shadow = shadows and not piece.surface.clear
        self.center, self.radius = _bounds(piece.rows)
        self.shape = 0
        self.ahead = 0.0
        self.owners: List[str] = []
        self.rows = np.zeros(0, dtype=np.int64)
        self.local = np.zeros((0, 4, 4))
        self.count = 0
        self._context = context
        self._programs = programs
        self._vertices = context.buffer(piece.rows.tobytes())
        self._index = context.buffer(piece.triangles.tobytes())
        self._instances: Any = None
        self._arrays: Dict[Hashable, Any] = {}

    def add(self, owner: str, row: int, local: np.ndarray) -> None:
        """Add an instance: a visual of `owner`, with the row of its pose, and its (4, 4) matrix."""
        self.owners.append(owner)
        self.rows = np.append(self.rows, row)
        self.local = np.concatenate([self.local, local[None]])

    def remove(self, owner: str) -> None:
        kept = np.array([one != owner for one in self.owners], dtype=bool)
        self.owners = [one for one in self.owners if one != owner]
        self.rows, self.local = self.rows[kept], self.local[kept]

    def reshape(self, rows: np.ndarray) -> None:
        """Replace positions and normals of the vertices; `rows` as in `Piece`."""
        self.center, self.radius = _bounds(rows)
        self.shape += 1
        self._vertices.write(rows.tobytes())

    def upload(self, instances: np.ndarray) -> None:
        """Set where it is to be drawn: (n,) of INSTANCE."""
        self.count = len(instances)
        if not self.count:
            return
        if self._instances is None or self._instances.size < instances.nbytes:
            self._release_arrays()
            self._instances = self._context.buffer(reserve=instances.nbytes * 2, dynamic=True)
        self._instances.write(instances.tobytes())

    def draw(self, program: Hashable, culled: bool = True) -> None:
        """Draw what was uploaded; with `culled` only faces that are seen from their front.

        The back faces of a double-sided surface are drawn, too.
        """
        if culled and not self.surface.double_sided:
            self._context.enable(self._context.CULL_FACE)
        else:
            self._context.disable(self._context.CULL_FACE)
        if program not in self._arrays:
            made = self._programs[program]
            self._arrays[program] = self._context.vertex_array(
                made, [(self._vertices, *_inputs(made, ("at", "normal", "uv"), (3, 3, 2), "f")),
                       (self._instances, *_inputs(
                           made, ("row0", "row1", "row2", "link", "diffuse", "specular",
                                  "emissive"), (4, 4, 4, 1, 4, 3, 3), "/i"))], self._index)
        self._arrays[program].render(instances=self.count)

    def _release_arrays(self) -> None:
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()
        if self._instances is not None:
            self._instances.release()

    def release(self) -> None:
        """Give the memory back."""
        self._release_arrays()
        self._vertices.release()
        self._index.release()


def _bounds(rows: np.ndarray) -> Tuple[np.ndarray, float]:
    """Centre and radius of a ball about all vertices."""
    places: np.ndarray = rows[:, :3].astype(np.float64)
    center: np.ndarray = (places.min(axis=0) + places.max(axis=0)) / 2
    return center, float(np.linalg.norm(places - center, axis=1).max())


def _uniforms(surface: Surface) -> Dict[str, Union[float, bytes, Tuple[float, ...]]]:
    """What programs of surfaces with pictures read; bytes of float32 for arrays."""
    return {"repeats": surface.repeats, "alpha_test": surface.alpha_test,
            **({"layer_form": _layer_forms(surface)} if surface.layers else {})}


def _instance(surface: Surface) -> np.ndarray:
    found = np.zeros((), dtype=INSTANCE)
    found["diffuse"] = (*(srgb_to_linear(surface.diffuse) * surface.brightness), surface.opacity)
    found["specular"] = srgb_to_linear(surface.specular)
    found["emissive"] = srgb_to_linear(surface.emissive)
    return found


def _layer_forms(surface: Surface) -> bytes:
    """Of each layer of a terrain what `shaders` says of `layer_form`."""
    return np.array([(1.0 / layer.size, surface.base + layer.min_height, 1.0 / layer.fade_dist)
                     for layer in surface.layers[:MOST_LAYERS]], dtype=np.float32).tobytes()


def _inputs(program: Any, names: Tuple[str, ...], widths: Tuple[int, ...], kind: str,
            ) -> Tuple[str, ...]:
    """moderngl's buffer format; what a program does not use (its compiler drops it) is skipped."""
    words, used = [], []
    for name, width in zip(names, widths):
        if name in program:
            words.append("1i" if name == "link" else f"{width}f")
            used.append(name)
        else:
            words.append(f"{width * 4}x")
    form = " ".join(words) + ("/i" if kind == "/i" else "")
    return (form, *used)
