"""The interface of the sensing process: its requests and replies.

Sensors hang on links; a link is known by its row in the engine's ring. A request brings the poses
of all links (`at`, link rows as in the ring), so the same request gives the same bytes however late
it is worked on.

Sensor frames are Gazebo's: +x looks forward, y left, z up (SDF `<sensor><pose>`). Nothing heavy is
imported here: neither NumPy, Embree nor OpenGL.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Dict, List, Optional, Tuple, Union

from ..appearance.looks import Look
from ..description.actor import Actor
from ..description.light import Light
from ..description.model import Model
from ..description.shapes import Mesh
from ..description.surroundings import Road, Scene
from ..errors import SimulationError
from ..geometry import IDENTITY, Pose

if TYPE_CHECKING:
    import numpy as np

WORLD_ROW = -1
"""`Mount.row` of a sensor that stands still; its pose is in the world."""

PROBLEM = -1
"""Between the processes: the number of a message that is a sentence about what is left out."""

READY = -2
"""Between the processes: the number of the child's first message."""

NO_ROW = -1
"""Where a ray or a pixel meets nothing."""

COLLISIONS, VISUALS = "collisions", "visuals"
"""What rays see: Gazebo's `ray` sensors collisions, its `gpu_ray` sensors visuals."""

RGB, DEPTH, LABELS = "rgb", "depth", "labels"
"""What a camera can give; several of them in one request."""


class SensingError(SimulationError):
    """A request without an answer; the message is one sentence for the user."""


class SensingEndedError(SensingError):
    """The sensing process ended before it answered. The next request finds a new one."""


class SensingUnavailableError(SensingError):
    """What is needed is not installed, or the process ends again and again; says what to do."""


@dataclass(frozen=True)
class RayFan:
    """Rays from one point: SDF `<ray><scan>` and `<range>`.

    Angles in rad: yaw about z from +x towards y, elevation up from the x-y plane. `near` and `far`
    in metres: nothing nearer than `near` is seen, not even what is in the way (Gazebo behaviour:
    rays begin at the minimum range).

    Attributes:
        samples: rays in a row, samples x resolution of the file.
        rows: of different elevation.
    """

    samples: int
    min_angle: float = 0.0
    max_angle: float = 0.0
    rows: int = 1
    min_elevation: float = 0.0
    max_elevation: float = 0.0
    near: float = 0.0
    far: float = 10.0


@dataclass(frozen=True)
class RayBundle:
    """Any rays: `origins` (n, 3) in metres, unit `directions` (n, 3), both in the sensor frame."""

    origins: "np.ndarray"
    directions: "np.ndarray"
    near: float = 0.0
    far: float = 10.0


@dataclass(frozen=True)
class Distortion:
    """Brown's model on normalised image coordinates (SDF `<camera><distortion>`, as OpenCV).

    `center` as a share of width and height. `crop`: a barrel distortion is scaled so that no border
    stays empty (Gazebo's `border_crop`).
    """

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    center: Tuple[float, float] = (0.5, 0.5)
    crop: bool = False


@dataclass(frozen=True)
class WideLens:
    """A lens for wide angles: r = scale fun(theta / c2 + c3), see `description.sensor.Lens`.

    Attributes:
        scale: c1 times f.
        c2, c3: numbers of the mapping.
        fun: `tan`, `sin` or `id`.
        cutoff: rad; rays at greater angles are black.
        side: pixels along the sides of the pictures that the picture is made of.
    """

    scale: float
    c2: float
    c3: float
    fun: str
    cutoff: float
    side: int


@dataclass(frozen=True)
class CameraSpec:
    """A pinhole camera: square pixels, the optical axis through the middle of the picture.

    Focal length in pixels: width / (2 tan(hfov / 2)). The point (x, y, z) of the sensor frame falls
    on column (width - 1) / 2 - f y / x and row (height - 1) / 2 - f z / x, where integers are the
    centres of pixels.

    Attributes:
        width, height: pixels.
        hfov: rad, the whole angle.
        near, far: metres along +x; points outside this range are not drawn.
        samples: of a pixel, for smooth edges of RGB: 1 or 4; 0 for 4 where a graphics card draws,
            else 1.
        distortion: of RGB, depth and labels alike; None for an ideal lens.
        shadows: False leaves out those the world asks for.
        lens: None for a pinhole; a wide-angle camera may see 2 pi.
    """

    width: int = 320
    height: int = 240
    hfov: float = 1.047
    near: float = 0.1
    far: float = 100.0
    samples: int = 1
    distortion: Optional[Distortion] = None
    shadows: bool = True
    lens: Optional[WideLens] = None

    @property
    def focal_length(self) -> float:
        """In pixels; of a wide-angle lens in the middle of the picture."""
        from math import cos, tan

        if self.lens is not None:
            slope = {"tan": cos(self.lens.c3) ** -2, "sin": cos(self.lens.c3), "id": 1.0}
            return self.width / 2.0 * self.lens.scale * slope[self.lens.fun] / self.lens.c2

        return self.width / (2.0 * tan(self.hfov / 2.0))


@dataclass(frozen=True)
class Mount:
    """Where a sensor is: `pose` in the frame of the link of `row`, or in the world."""

    row: int = WORLD_ROW
    pose: Pose = IDENTITY


@dataclass(frozen=True)
class CastRays:
    """Ask for ranges. Answered with `RayReturns`.

    `ns`: sim time of the state, where actors are taken from.
    """

    mount: Mount
    rays: Union[RayFan, RayBundle]
    sees: str = COLLISIONS
    at: bytes = b""
    ns: int = 0


@dataclass(frozen=True)
class CastBatch:
    """Ask for the ranges of several sensors in one state, `at`, instead of in their own.

    Answered with a list: `RayReturns` or a `SensingError` for each.
    """

    casts: Tuple[CastRays, ...]
    at: bytes = b""


@dataclass(frozen=True)
class RenderCamera:
    """Ask for pictures of one moment. Answered with `Pictures`.

    `ns`: sim time of the state, where actors are taken from.
    """

    mount: Mount
    camera: CameraSpec
    outputs: Tuple[str, ...] = (RGB,)
    at: bytes = b""
    ns: int = 0


@dataclass(frozen=True)
class RayReturns:
    """What rays have met, in the order of the fan: row by row from `min_elevation` on, in each from
    `min_angle` on. The arrays are the caller's own.

    Attributes:
        ranges: float64 (n,), metres from the sensor's origin (a bundle: from each ray's); inf where
            nothing is met up to `far`. Not clipped, without noise.
        retro: float32 (n,), `laser_retro` of what is met, 0 for nothing.
        link_rows: int32 (n,), the link that is met, NO_ROW for nothing.
    """

    ranges: "np.ndarray"
    retro: "np.ndarray"
    link_rows: "np.ndarray"

    def __reduce__(self) -> "Tuple[object, ...]":
        """Between the processes, plain bytes: arrays of their own take six times as long."""
        return _returns, (bytearray(self.ranges), bytearray(self.retro), bytearray(self.link_rows))


def _returns(ranges: bytearray, retro: bytearray, link_rows: bytearray) -> RayReturns:
    import numpy as np

    return RayReturns(np.frombuffer(ranges, np.float64), np.frombuffer(retro, np.float32),
                      np.frombuffer(link_rows, np.int32))


@dataclass(frozen=True)
class Pictures:
    """What a camera has seen; None for what was not asked for. The first row is the upper one.

    Attributes:
        rgb: uint8 (height, width, 3).
        depth: float32 (height, width), metres along +x; inf where there is nothing up to `far`.
        labels: int32 (height, width), link rows, NO_ROW for nothing.
    """

    rgb: "Optional[np.ndarray]" = None
    depth: "Optional[np.ndarray]" = None
    labels: "Optional[np.ndarray]" = None


@dataclass(frozen=True)
class Body:
    """A model to look at; link n has row `first_link_row + n`.

    Attributes:
        name: of the model; a body of the same name is replaced.
        model: flattened, mesh paths resolved.
        looks: what each visual looks like, by (link index, visual index); without one: the mesh's
            own materials, or white. `scene.body` makes it.
    """

    name: str
    model: Model
    first_link_row: int
    looks: Dict[Tuple[int, int], Look] = field(default_factory=dict)


@dataclass(frozen=True)
class PaintedRoad:
    """A road, and what it looks like."""

    road: Road
    look: Look


@dataclass(frozen=True)
class Figure:
    """An actor, and the files that it is made of.

    Attributes:
        actor: where it goes.
        skin: its surface.
        animations: paths of the files of the actor's animations; "" for the skin's own.
    """

    actor: Actor
    skin: Mesh
    animations: Tuple[str, ...] = ()


@dataclass(frozen=True)
class SetScenery:
    """These are the roads and actors now: what belongs to no model, and cameras and rays see."""

    roads: Tuple[PaintedRoad, ...] = ()
    figures: Tuple[Figure, ...] = ()


@dataclass(frozen=True)
class LoadScene:
    """Everything there is to see; replaces what there was."""

    bodies: List[Body] = field(default_factory=list)
    lights: List[Light] = field(default_factory=list)
    scene: Scene = field(default_factory=Scene)
    scenery: SetScenery = SetScenery()


@dataclass(frozen=True)
class AddBody:
    """A model has come, or has changed."""

    body: Body


@dataclass(frozen=True)
class RemoveBody:
    """A model has gone."""

    name: str


@dataclass(frozen=True)
class SetLights:
    """These are the lights and the surroundings now."""

    lights: List[Light] = field(default_factory=list)
    scene: Scene = field(default_factory=Scene)


Change = Union[LoadScene, AddBody, RemoveBody, SetLights, SetScenery]
Request = Union[CastRays, CastBatch, RenderCamera]
