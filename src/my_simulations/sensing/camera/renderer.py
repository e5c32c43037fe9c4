"""Pictures of the scene: colours with light and shadow, depth, and which link is where."""
from __future__ import annotations

import math
from typing import Any, Callable, Dict, Hashable, Iterator, List, Optional, Tuple

import numpy as np

from ...description.light import Light
from ...description.picture_size import picture_size_of
from ...description.shapes import is_mesh_without_file
from ...description.surroundings import Scene
from ...errors import InputError
from ..api import DEPTH, LABELS, NO_ROW, RGB, Body, CameraSpec, Pictures, SetScenery
from ..poses import inverse, matrices, matrix
from ..scenery import Scenery
from ..surfaces import pieces_of
from . import distortion, shaders
from .batches import Batch
from .context import Targets, draws_with_a_card, load_gl_finish, new_context
from .frustum import check, projection
from .instance_table import InstanceTable, SeenInstances
from .kept_pictures import Drawn, PictureCache
from .lamps import (
    SHADOW_SIZE,
    ShadowView,
    chosen_lights,
    shadow_lights,
    shadow_view,
)
from .lit_surfaces import Lighting, LitSurfaces
from .sky import sky_uniforms
from .uploaded_textures import Textures
from .wide_lens import LensMap

_VIEW_FROM_SENSOR = np.array([[0.0, -1, 0, 0], [0, 0, 1, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])


class Renderer:
    """One scene and one context; all calls from the thread that made it.

    `report_problem` is told of meshes and textures that cannot be read.

    Raises:
        SensingUnavailableError: there is no OpenGL.
    """

    def __init__(self, trouble: Callable[[str], None]) -> None:
        self._trouble = trouble
        self._context = new_context()
        self._context.front_face = "cw"  # `projection` turns pictures upside down
        self._finish = load_gl_finish()
        self._smooth = 4 if draws_with_a_card(self._context) else 1
        program = self._context.program
        self._programs: Dict[Hashable, Any] = {
            "range": program(*shaders.plain_programs("range", cut=False)),
            "shadow": program(*shaders.plain_programs("shadow", cut=False)),
            "sky": program(shaders.SKY_VERTEX, shaders.SKY_FRAGMENT)}
        corners = np.array([-1, -1, 3, -1, -1, 3], dtype=np.float32)
        self._sky = self._context.vertex_array(
            self._programs["sky"], [(self._context.buffer(corners.tobytes()), "2f", "at")])
        self._batches: Dict[Tuple[str, int], Batch] = {}
        self._scenery = Scenery()
        self._scenic: List[Batch] = []
        self._instances: Optional[InstanceTable] = None   # of all batches
        self._textures = Textures(self._context, lambda text: self._trouble(text))
        self._lights: List[Light] = []
        self._scene = Scene()
        self._targets = Targets(self._context)
        self._maps = [self._context.depth_texture((SHADOW_SIZE, SHADOW_SIZE))
                      for _ in range(shaders.MOST_SHADOWS)]
        for one in self._maps:
            one.compare_func = "<="
            one.repeat_x = one.repeat_y = False
        self._lit = LitSurfaces(self._context, self._programs, self._textures, self._maps)
        self._map_targets = [self._context.framebuffer(depth_attachment=one) for one in self._maps]
        self._map_keys: List[Any] = [None] * len(self._maps)
        self._kept = PictureCache()
        self._wide: Dict[CameraSpec, LensMap] = {}
        self._lenses: Dict[CameraSpec, Tuple[np.ndarray, np.ndarray]] = {}

    def _forget(self) -> None:
        """What is seen changes: kept pictures, shadow maps and the table are not valid any more."""
        self._kept.forget()
        self._map_keys = [None] * len(self._maps)
        self._instances = None

    def add(self, body: Body) -> None:
        self._forget()
        for n, link in enumerate(body.model.links):
            for m, visual in enumerate(link.visuals):
                if visual.transparency >= 1.0:
                    continue
                local, look = matrix(visual.pose), body.looks.get((n, m))
                size = picture_size_of(visual)
                key = repr((visual.geometry, look, visual.transparency, visual.cast_shadows,
                            size and (size, visual.pose)))
                if (key, 0) not in self._batches and not self._prepare(
                        key, visual, look, f"{body.name}::{link.name}"):
                    continue
                for part in range(len(self._batches)):
                    batch = self._batches.get((key, part))
                    if batch is None:
                        break
                    batch.add(body.name, body.first_link_row + n, local)

    def _prepare(self, key: str, visual: Any, look: Any, link: str) -> bool:
        if is_mesh_without_file(visual.geometry):
            return False
        try:
            pieces = pieces_of(visual, look)
        except InputError as fault:
            self._trouble(f"cameras do not see the visual {visual.name!r} of {link!r}: {fault}")
            return False
        for part, piece in enumerate(piece for piece in pieces if len(piece.triangles)):
            self._textures.renew(piece.surface)
            self._batches[key, part] = Batch(self._context, self._programs, piece,
                                             visual.cast_shadows)
        return bool(pieces)

    def remove(self, name: str) -> None:
        """A model has gone; what only it was made of is forgotten, too."""
        self._forget()
        for key, batch in list(self._batches.items()):
            if name in batch.owners:
                batch.remove(name)
                if not batch.owners:
                    batch.release()
                    del self._batches[key]

    def set_lights(self, lights: List[Light], scene: Scene) -> None:
        self._forget()
        self._lights, self._scene = lights, scene

    def set_scenery(self, scenery: SetScenery) -> None:
        """Roads and actors."""
        if scenery == self._scenery.told:
            return
        self._forget()
        for batch in self._scenic:
            batch.release()
        self._scenery = Scenery(scenery, self._trouble)
        self._scenic = [Batch(self._context, self._programs, part.piece, part.casts_shadow)
                        for part in self._scenery.parts]
        for batch, part in zip(self._scenic, self._scenery.parts):
            self._textures.renew(part.piece.surface)
            batch.add("", part.row, np.eye(4))

    def render(self, spec: CameraSpec, frame: np.ndarray, poses: np.ndarray,
               outputs: Tuple[str, ...], ns: int = 0) -> Pictures:
        """Pictures from a sensor at `frame` (world from sensor), links at `poses`, at `ns`.

        Raises SensingError for a camera with impossible numbers.
        """
        check(spec, self._targets.most)
        placed = self._scenery.append_poses(poses, ns)
        drawn = self._kept.get((spec, outputs, frame.tobytes()),
                               (placed.tobytes(), self._scenery.forms(ns)),
                               lambda: self._seen(spec, frame, placed, outputs, ns))
        return Pictures(*drawn)

    def _seen(self, spec: CameraSpec, frame: np.ndarray, poses: np.ndarray,
              outputs: Tuple[str, ...], ns: int) -> Drawn:
        if spec.lens is None:
            return self._drawn(spec, frame, poses, outputs, ns)
        if spec not in self._wide:
            self._wide[spec] = LensMap(spec, spec.lens)
        wide = self._wide[spec]
        check(wide.spec, self._targets.most)
        return wide.compose_picture([self._drawn(wide.spec, frame @ side.frame, poses, outputs, ns)
                                     for side in wide.sides])

    def _all(self) -> Iterator[Batch]:
        yield from self._batches.values()
        yield from self._scenic

    def _drawn(self, spec: CameraSpec, frame: np.ndarray, poses: np.ndarray,
               outputs: Tuple[str, ...], ns: int) -> Drawn:
        for part, rows in self._scenery.take_reshaped_parts(ns):
            self._scenic[part].reshape(rows)
            self._instances = None
        view = _VIEW_FROM_SENSOR @ inverse(frame)
        links = matrices(poses)
        rgb = depth = labels = None
        clip = projection(spec)
        if RGB in outputs:
            lights = chosen_lights(self._lights, view, spec)
            shadows = self._shadows(spec, lights, links, frame[:3, 3])
            self._upload_instances(view, links, spec)
            rgb = self._draw_rgb(spec, view, self._lit.lighting(
                view, clip, lights, shadows, self._scene))
        if DEPTH in outputs or LABELS in outputs:
            if RGB not in outputs:
                self._upload_instances(view, links, spec)
            depth, labels = self._draw_ranges(spec, clip)
        if spec.distortion is not None:
            rgb, depth, labels = self._distort(spec, rgb, depth, labels)
        return (rgb, depth if DEPTH in outputs else None, labels if LABELS in outputs else None)

    def _upload_instances(self, view: np.ndarray, links: np.ndarray, spec: Optional[CameraSpec],
                          casters: bool = False) -> None:
        """Upload to each batch the poses of its instances that the camera can see.

        Transparent ones are sorted, the farthest first; `casters`: only those that cast shadows.
        """
        for batch, instances, centers in self._instances_in_view(view, links, spec, casters):
            if batch.surface.clear and len(instances):
                ahead = centers[:, 2]
                batch.ahead = float(ahead.mean())
                instances = instances[np.argsort(ahead, kind="stable")]
            batch.upload(instances)

    def _instances_in_view(self, view: np.ndarray, links: np.ndarray, spec: Optional[CameraSpec],
                           casters: bool) -> Iterator[SeenInstances]:
        if self._instances is None:
            self._instances = InstanceTable(self._all())
        return self._instances.seen(view, links, len(links) - self._scenery.count, spec, casters)

    # Colours.

    def _draw_rgb(self, spec: CameraSpec, view: np.ndarray, lighting: Lighting) -> np.ndarray:
        context = self._context
        samples = spec.samples or self._smooth
        target = self._targets.get("rgb", spec.width, spec.height, samples)
        target.use()
        background = self._scene.background[:3]
        target.clear(*background, 1.0, depth=1.0)
        context.enable_only(context.DEPTH_TEST)
        seen = [batch for batch in self._all() if batch.count]
        self._lit.draw_opaque([batch for batch in seen if not batch.surface.clear], lighting)
        if self._scene.sky is not None:
            self._draw_sky(spec, view)
        clear = [batch for batch in seen if batch.surface.clear]
        if clear:
            clear.sort(key=lambda one: one.ahead)  # farther surfaces show through nearer ones
            self._draw_clear(clear, target, lighting)
        if samples > 1:
            whole = self._targets.get("rgb", spec.width, spec.height, 1)
            context.copy_framebuffer(whole, target)
            target = whole
        self._finish()
        made = np.frombuffer(target.read(components=3, alignment=1), dtype=np.uint8)
        return made.reshape(spec.height, spec.width, 3)

    def _draw_clear(self, batches: List[Batch], target: Any, lighting: Lighting) -> None:
        context = self._context
        context.enable_only(context.DEPTH_TEST | context.BLEND)
        context.blend_func = context.SRC_ALPHA, context.ONE_MINUS_SRC_ALPHA
        target.depth_mask = False
        for batch in batches:
            self._lit.draw(batch, self._lit.kind_of(batch.surface, lighting), lighting)
        target.depth_mask = True

    def _draw_sky(self, spec: CameraSpec, view: np.ndarray) -> None:
        program = self._programs["sky"]
        half = math.tan(spec.hfov / 2)
        program["slope"] = (half, half * spec.height / spec.width)
        _set(program, "world_from_view", view[:3, :3])  # its transpose, column by column
        if self._scene.sky is not None:
            for name, value in sky_uniforms(self._scene.sky).items():
                program[name] = value
        self._context.depth_func = "<="
        self._sky.render(vertices=3)
        self._context.depth_func = "<"

    # Shadows.

    def _shadows(self, spec: CameraSpec, lights: List[Light], links: np.ndarray, eye: np.ndarray,
                 ) -> List[Tuple[int, ShadowView]]:
        """The maps that lights need, drawn again only where something has moved."""
        if not (spec.shadows and self._scene.shadows):
            return []
        wanted = shadow_lights(lights)
        if not wanted:
            return []
        low, high, places = self._casters(links)
        found = []
        for n, index in enumerate(wanted):
            light = lights[index]
            one = shadow_view(light, low, high, eye)
            key = (light, one.view.tobytes(), one.clip.tobytes(), places)
            if key != self._map_keys[n]:
                self._map_keys[n] = key
                self._draw_map(n, one, links)
            found.append((index, one))
        return found

    def _casters(self, links: np.ndarray) -> Tuple[np.ndarray, np.ndarray, bytes]:
        low, high, places = np.full(3, np.inf), np.full(3, -np.inf), []
        for n, (batch, instances, centers) in enumerate(
                self._instances_in_view(np.eye(4), links, None, casters=True)):
            if not batch.casts_shadow:
                continue
            places.append(repr((n, batch.radius, batch.shape)).encode() + instances.tobytes())
            if batch.radius > 1000.0 or not len(instances):  # a ground casts on nothing
                continue
            low = np.minimum(low, centers.min(axis=0) - batch.radius)
            high = np.maximum(high, centers.max(axis=0) + batch.radius)
        if not np.isfinite(low).all():
            low, high = np.zeros(3), np.ones(3)
        return np.floor(low), np.ceil(high), b"".join(places)

    def _draw_map(self, n: int, one: ShadowView, links: np.ndarray) -> None:
        context, target = self._context, self._map_targets[n]
        self._upload_instances(one.view, links, None, casters=True)
        target.use()
        target.clear(depth=1.0)
        context.enable_only(context.DEPTH_TEST)
        for batch in self._all():
            if batch.count and batch.casts_shadow:
                self._draw_plain(batch, "shadow", one.clip)

    # Depth and labels.

    def _draw_ranges(self, spec: CameraSpec, clip: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        context = self._context
        target = self._targets.get("range", spec.width, spec.height, 1)
        target.use()
        target.clear(depth=1.0)
        depth, labels = target.color_attachments
        context.enable_only(context.DEPTH_TEST)
        for batch in self._all():
            if batch.count:
                self._draw_plain(batch, "range", clip)
        self._finish()
        away = np.frombuffer(depth.read(alignment=4), np.float32).reshape(spec.height, spec.width)
        link = np.frombuffer(labels.read(alignment=4), np.int32).reshape(spec.height, spec.width)
        empty = away <= 0.0
        return (np.where(empty, np.float32(np.inf), away),
                np.where(empty, np.int32(NO_ROW), link))

    def _draw_plain(self, batch: Batch, name: str, clip: np.ndarray) -> None:
        """Draw without light: `name` is shadow or range; holes of pictures are left out."""
        texture = self._textures.cutting(batch.surface)
        if texture is not None:
            name, plain = f"{name} cut", name
            if name not in self._programs:
                self._programs[name] = self._context.program(
                    *shaders.plain_programs(plain, cut=True))
            texture.use(location=0)
            for uniform in ("alpha_test", "repeats"):
                self._programs[name][uniform] = batch.uniforms[uniform]
        _set(self._programs[name], "clip", clip.T)
        # Light falls on whatever is in its way, from either side.
        batch.draw(name, culled=not name.startswith("shadow"))

    def _distort(self, spec: CameraSpec, rgb: Optional[np.ndarray], depth: Optional[np.ndarray],
                 labels: Optional[np.ndarray]) -> Tuple[Optional[np.ndarray], ...]:
        if spec not in self._lenses:
            self._lenses[spec] = distortion.source_pixels(spec)
        column, row = self._lenses[spec]
        return (None if rgb is None else distortion.sample_bilinear(rgb, column, row),
                None if depth is None else distortion.sample_nearest(depth, column, row, np.inf),
                None if labels is None else distortion.sample_nearest(labels, column, row, NO_ROW))


def _set(program: Any, name: str, values: np.ndarray) -> None:
    if name in program:
        program[name].write(np.ascontiguousarray(values, dtype=np.float32).tobytes())
