"""Parameters of camera plugins, and the sensor_msgs/CameraInfo that they define.

Parameters and defaults are those of gazebo_plugins' GazeboRosCameraUtils, with two differences:
the principal point is the middle of the picture, (width - 1) / 2, with pixel centres at integers
as in ROS (in gazebo_plugins it is one pixel off); and if the plugin has no distortion, CameraInfo
contains the sensor's `<distortion>`.
"""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Callable, List, Mapping, Sequence, Tuple

from ...description.sensor import Camera
from ...description.sensor import Camera as CameraBlock
from ...sensing.api import CameraSpec, Distortion, WideLens
from ..context import Context, PluginError, Publication
from ..frames import add_tf_prefix
from ..parameters import lowest_rate
from ..reconfigure import Option, Reconfigure, Value

USUAL_RATE = 30.0
"""Hz, of a camera that names no rate."""

_NARROWEST, _WIDEST = 0.1, 3.13     # rad
_NEAR, _DEPTH, _FARTHEST = 0.01, 100.0, 1e4   # m

_COEFFICIENTS = ("K1", "K2", "T1", "T2", "K3")  # in the order of `CameraInfo.D`


@dataclass(frozen=True)
class CameraTopics:
    """Names of topics, relative to the plugin's namespace or absolute; the frame of the picture."""

    base: str
    image: str
    info: str
    frame: str

    def named(self, name: str) -> str:
        return name if name.startswith("/") or not self.base else f"{self.base}/{name}"


def topics_of(context: Context, suffix: str = "") -> CameraTopics:
    """Return the topics of the element; `suffix` (`/left`) is appended to the camera's name."""
    p = context.parameters
    return CameraTopics(p.text("cameraName").strip("/") + suffix,
                        p.text("imageTopicName") or "image_raw",
                        p.text("cameraInfoTopicName") or "camera_info",
                        add_tf_prefix(context, p.text("frameName")))


def rate_of(context: Context) -> float:
    """Hz: the lower one of the sensor's `<update_rate>` and the plugin's `<updateRate>`."""
    return lowest_rate(context.parameters.number("updateRate", 0.0),
                       context.sensor.update_rate if context.sensor is not None else 0.0,
                       default=USUAL_RATE)


_LOOK_HZ = 10.0   # how often a slow camera checks for subscribers
_RATE = Option("imager_rate", 2.0, 1.0, 50.0, "pictures a second of sim time (Hz)")


class ImagerRate:
    """Calls at the rate of a camera, which dynamic_reconfigure can change.

    Args:
        context: of the plugin.
        names: of the cameras; "" is a camera without dynamic_reconfigure (gazebo_plugins).
        call: takes a picture.
        wanted: returns whether the camera has subscribers.
        topics: all topics of the camera, `CameraInfo` too.
    """

    def __init__(self, context: Context, names: Sequence[str], call: Callable[[], None],
                 wanted: Callable[[], bool], topics: Sequence[Publication]) -> None:
        self._context, self._call, self._wanted = context, call, wanted
        self._topics = topics
        rate = rate_of(context)
        self._timer = context.observe(rate, call, topics, world=True)
        self._listened = False
        if rate < _LOOK_HZ:
            context.every(_LOOK_HZ, self._check_subscribers)
        self._offers = [Reconfigure(context, name, (_RATE,), {_RATE.name: rate}, self._change)
                        for name in names if name]

    def _check_subscribers(self) -> None:
        """Take a picture at once for a first subscriber, as in Gazebo."""
        before, self._listened = self._listened, self._wanted()
        if self._listened and not before and not self._context.is_stepped_manually:
            self._call()

    def _change(self, values: Mapping[str, Value]) -> None:
        self._timer.end()
        self._timer = self._context.observe(float(values[_RATE.name]), self._call, self._topics,
                                            world=True)
        for offer in self._offers:
            offer.publish(values)


def spec_of(context: Context, block: CameraBlock, crop: bool = False) -> CameraSpec:
    """Return the camera to render for a `<camera>`; invalid numbers are replaced and reported.

    In SDF 1.7 angles are at least 0.1 rad, and Gazebo's renderer allows no near clip plane at 0.
    Without a fisheye lens the field of view is below pi.
    """
    lens = (block.k1, block.k2, block.k3, block.p1, block.p2)
    hfov, near, far = block.horizontal_fov, block.near, block.far
    is_wide = context.sensor is not None and context.sensor.type == WIDE_ANGLE
    if not 0.0 < hfov < math.pi and not is_wide:
        hfov = _WIDEST if hfov >= math.pi else _NARROWEST
        context.warn(f"<horizontal_fov> {block.horizontal_fov:g} of camera {block.name!r} is none:"
                     f" {hfov:g} rad is drawn")
    if not 0.0 < near < math.inf:
        near = _NEAR
    if not near < far < math.inf:
        far = _FARTHEST if far > near else near + _DEPTH
    if (near, far) != (block.near, block.far):
        context.warn(f"<clip> from {block.near:g} to {block.far:g} m of camera {block.name!r} holds"
                     f" nothing: it is drawn from {near:g} to {far:g} m")
    return CameraSpec(
        max(1, block.width), max(1, block.height), hfov, near, far,
        1 if block.anti_aliasing <= 1 else 0,
        Distortion(*lens, center=block.distortion_center, crop=crop) if any(lens) and not is_wide
        else None, lens=wide_lens_of(block, hfov) if is_wide else None)


class Calibration:
    """Makes sensor_msgs/CameraInfo; another one can be set (`set_camera_info`)."""

    def __init__(self, context: Context, block: CameraBlock, spec: CameraSpec,
                 baseline: float) -> None:
        p = context.parameters
        self._context = context
        self.width, self.height = spec.width, spec.height
        focal = p.number("focalLength", 0.0)
        drawn = spec.focal_length / _crop_share(spec)
        if focal and abs(focal - drawn) > 1e-3 * drawn:
            context.warn(f"<focalLength> {focal:g} px is not what the sensor's width and field of"
                         f" view give: {drawn:.3f} px, which is what is drawn")
        focal = focal or drawn
        center = (p.number("Cx", 0.0) or (spec.width - 1) / 2,
                  p.number("Cy", 0.0) or (spec.height - 1) / 2)
        self._distortion = _coefficients(context, block)
        self._k = [focal, 0.0, center[0], 0.0, focal, center[1], 0.0, 0.0, 1.0]
        self._p = [focal, 0.0, p.number("CxPrime", 0.0) or center[0], -focal * baseline,
                   0.0, focal, center[1], 0.0, 0.0, 0.0, 1.0, 0.0]
        self._given: Any = None

    def message(self, header: Any) -> Any:
        """The message that belongs to a picture."""
        message = self._context.message("sensor_msgs/CameraInfo")
        if self._given is not None:
            for name in ("height", "width", "distortion_model", "D", "K", "R", "P", "binning_x",
                         "binning_y", "roi"):
                setattr(message, name, getattr(self._given, name))
        else:
            message.height, message.width = self.height, self.width
            message.distortion_model, message.D = "plumb_bob", self._distortion
            message.K, message.P = self._k, self._p
            message.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
        message.header = header
        return message

    def replace(self, request: Any, response: Any) -> None:
        """Answer `set_camera_info`: change the published CameraInfo, but not the rendering."""
        given = request.camera_info
        response.success = (given.width, given.height) in ((self.width, self.height), (0, 0))
        if response.success:
            self._given = given
            response.status_message = "stored until the model is deleted"
        else:
            response.status_message = (f"the camera has {self.width}x{self.height} pixels, not "
                                       f"{given.width}x{given.height}")


def _coefficients(context: Context, block: CameraBlock) -> List[float]:
    """D: what the plugin says, else what the sensor's lens does."""
    p = context.parameters
    names = [f"distortion{name}" for name in _COEFFICIENTS]
    if p.flag("autoDistortion", False) or not any(name in p for name in names):
        return [block.k1, block.k2, block.p1, block.p2, block.k3]
    return [p.number(name, 0.0) for name in names]


def _crop_share(spec: CameraSpec) -> float:
    """By how much a barrel distortion without empty borders lengthens the focal length."""
    if spec.distortion is None or not spec.distortion.crop:
        return 1.0
    from ...sensing.camera.distortion import crop_share

    return crop_share(spec)


WIDE_ANGLE = "wideanglecamera"
"""The type of its sensor."""

_TYPES: Mapping[str, Tuple[float, float, str]] = {
    "gnomonical": (1.0, 1.0, "tan"), "stereographic": (2.0, 2.0, "tan"),
    "equidistant": (1.0, 1.0, "id"), "equisolid_angle": (2.0, 2.0, "sin"),
    "orthographic": (1.0, 1.0, "sin")}
"""c1, c2 and fun; c3 is 0 and f is 1."""

_FUNCTIONS: Mapping[str, Callable[[float], float]] = {
    "tan": math.tan, "sin": math.sin, "id": float}


def wide_lens_of(block: Camera, hfov: float) -> WideLens:
    """Return the lens of a camera whose horizontal field of view is `hfov`, rad.

    Raises PluginError: its `<lens>` is unknown, or does not see that field of view.
    """
    lens = block.lens
    c1, c2, c3, f, fun = lens.c1, lens.c2, lens.c3, lens.f, lens.fun
    if lens.type != "custom":
        if lens.type not in _TYPES:
            raise PluginError(f"<lens><type> of camera {block.name!r} is {lens.type!r}; there are"
                              f" {', '.join((*_TYPES, 'custom'))}")
        (c1, c2, fun), c3, f = _TYPES[lens.type], 0.0, 1.0
    if fun not in _FUNCTIONS:
        raise PluginError(f"<lens><custom_function><fun> of camera {block.name!r} is {fun!r};"
                          f" there are {', '.join(_FUNCTIONS)}")
    scale = c1 * f
    if lens.scale_to_hfov and c2 > 0.0:
        edge = hfov / 2.0 / c2 + c3
        within = fun == "id" or 0.0 < edge < math.pi / 2.0
        scale = 1.0 / _FUNCTIONS[fun](edge) if within and edge > 0.0 else 0.0
    if not (c2 > 0.0 and 0.0 < scale < math.inf):
        raise PluginError(f"the <lens> of camera {block.name!r} does not see a field of view of"
                          f" {hfov:g} rad")
    return WideLens(scale, c2, c3, fun, min(lens.cutoff_angle, math.pi), lens.env_texture_size)
