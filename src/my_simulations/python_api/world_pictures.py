"""Pictures of an open world, taken by the sensing process."""
from __future__ import annotations

import math
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from dataclasses import dataclass
from typing import TYPE_CHECKING, Dict, List, Optional, Sequence, Tuple

from ..errors import CommandError
from ..geometry import Pose, Vec3, compose, norm, quat_from_rpy, subtract
from ..sensing.api import DEPTH, LABELS, NO_ROW, RGB, CameraSpec, Mount, Pictures, SensingError
from ..simulator.scene_sensing import SceneSensing
from ..simulator.simulator import Simulator

if TYPE_CHECKING:
    import numpy as np

_OUTPUTS = (RGB, DEPTH, LABELS)
_LARGEST = 8192   # pixels of a side
_PATIENCE_S = 120.0  # the first picture of a heavy world loads its meshes and textures


@dataclass(frozen=True)
class Picture:
    """What a camera has seen; None for what was not asked for. The first row is the upper one.

    Attributes:
        time: sim time in s.
        rgb: uint8 (height, width, 3).
        depth: float32 (height, width), metres along the optical axis; inf where there is nothing.
        labels: int32 (height, width), the number of the link in `names` that is seen, -1 for none.
        names: the links, as `model::link`.
    """

    time: float
    rgb: "Optional[np.ndarray]"
    depth: "Optional[np.ndarray]"
    labels: "Optional[np.ndarray]"
    names: Tuple[str, ...]


class PictureRequest:
    """A picture that is being drawn; see `OpenWorld.request_picture`.

    Args:
        future: of the sensing process.
        ns: sim time of the picture.
        links: scoped names by row, at that time.
    """

    def __init__(self, future: "Future[Pictures]", ns: int, links: Dict[int, str]) -> None:
        self._future, self._ns, self._links = future, ns, links

    def result(self) -> Picture:
        """Wait for the picture. Raises CommandError if there is nothing to draw with."""
        try:
            found = self._future.result(_PATIENCE_S)
        except SensingError as fault:
            raise CommandError(f"no picture: {fault}") from fault
        except FutureTimeoutError as fault:
            raise CommandError(f"no picture within {_PATIENCE_S:g} s") from fault
        labels = None if found.labels is None else _number_rows(found.labels, list(self._links))
        return Picture(self._ns * 1e-9, found.rgb, found.depth, labels,
                       tuple(self._links.values()))


def camera_pose(position: Vec3, target: Vec3) -> Pose:
    """The pose of a camera (+x looks forward, +z up) that looks at a point, level.

    Raises CommandError: both points are one.
    """
    line = subtract(target, position)
    if norm(line) < 1e-12:
        raise CommandError("a camera cannot look at its own position")
    yaw = math.atan2(line[1], line[0])
    pitch = math.atan2(-line[2], math.hypot(line[0], line[1]))
    return Pose(position, quat_from_rpy(0.0, pitch, yaw))


def check_camera(camera: CameraSpec, outputs: Sequence[str]) -> None:
    """Check that a camera can take pictures and that the outputs exist. Raises CommandError."""
    if not (0 < camera.width <= _LARGEST and 0 < camera.height <= _LARGEST):
        raise CommandError(f"width and height must be between 1 and {_LARGEST} pixels, are"
                           f" {camera.width} and {camera.height}")
    if not 0.0 < camera.hfov < math.pi:
        raise CommandError(f"hfov must be between 0 and pi rad, is {camera.hfov}")
    if not 0.0 < camera.near < camera.far < math.inf:
        raise CommandError(f"0 < near < far is needed, near is {camera.near}, far {camera.far}")
    if isinstance(outputs, str):
        raise CommandError(f"outputs are a list such as ['rgb'], not {outputs!r}")
    unknown = [output for output in outputs if output not in _OUTPUTS]
    if unknown or not outputs:
        raise CommandError(f"outputs are {', '.join(_OUTPUTS)}; there is no"
                           f" '{unknown[0] if unknown else ''}'")


class Photographer:
    """Takes pictures; the process that draws is started by the first.

    Args:
        simulator: the world.
        scene: draws it.
    """

    def __init__(self, simulator: Simulator, scene: SceneSensing) -> None:
        self._simulator, self._scene = simulator, scene

    def close(self) -> None:
        """End the process that draws."""
        self._scene.close()

    def request(self, frame: str, pose: Pose, camera: CameraSpec, outputs: Sequence[str],
                ) -> PictureRequest:
        """Request a picture as of now.

        Args:
            frame: model or link that carries the camera; "" for the world.
            pose: of the camera in the frame: +x looks forward, y is left, z up.
            camera: what it is.
            outputs: of `sensing.api`.

        Raises:
            CommandError: no such frame, or a camera that cannot be.
        """
        check_camera(camera, outputs)
        row, offset = self._simulator.states.frame_mount(frame)
        mount = Mount(row, compose(offset, pose))
        ns = self._simulator.clock.sim_ns
        (future,) = self._scene.render([(mount, camera, tuple(outputs))], ns,
                                       self._simulator.feed.rows())
        return PictureRequest(future, ns, self._simulator.states.link_names())


def _number_rows(rows: "np.ndarray", links: "List[int]") -> "np.ndarray":
    """Replace rows of links by their places in `links`."""
    import numpy as np

    table = np.full(max([NO_ROW, *links, int(rows.max(initial=NO_ROW))]) + 2, -1, np.int32)
    table[links] = np.arange(len(links))
    return table[rows]  # NO_ROW is the last entry, which stays -1
