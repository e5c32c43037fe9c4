"""What all cameras publish of a colour picture: image, compressed image and CameraInfo."""
from __future__ import annotations

from typing import Any, List, Optional

from ...description.sensor import Camera as CameraBlock
from ...description.sensor import Sensor
from ...geometry import Pose, compose
from ...sensing.api import RGB
from ...sensing.noise import noisy_picture
from ..context import Context, PluginError, Publication, View
from .camera_parameters import Calibration, CameraTopics, spec_of
from .image_messages import (
    ENCODINGS,
    LazyValue,
    encode_picture,
    header,
    make_compressed_image,
    make_image,
)

_QUALITY = 80  # of jpeg, as compressed_image_transport


def camera_sensor(context: Context, kinds: str) -> Sensor:
    """Return the plugin's sensor. Raises PluginError if it has no camera."""
    if context.sensor is None or not context.sensor.cameras:
        raise PluginError(f"it must be in a <sensor> of type {kinds} with a <camera>")
    return context.sensor


def place_of(sensor: Sensor, block: CameraBlock) -> Pose:
    """Where a camera of a sensor is on its link."""
    return compose(sensor.pose, block.pose)


class PictureStream:
    """Topics of one camera of a sensor.

    Args:
        context: of the plugin.
        sensor, link: the sensor, and the name of its link.
        block: the camera.
        topics: names and frame.
        baseline: of a stereo pair, m; for `CameraInfo.P`.
        crop: no empty borders where the lens has a barrel distortion.
        calibrated: offer `set_camera_info`.

    Attributes:
        encoding: of its pictures; "" if the format of the sensor decides.
    """

    encoding = ""

    def __init__(self, context: Context, sensor: Sensor, link: str, block: CameraBlock,
                 topics: CameraTopics, baseline: float = 0.0, crop: bool = True,
                 calibrated: bool = True) -> None:
        self._context, self.topics = context, topics
        self.spec = spec_of(context, block, crop)
        self.calibration = Calibration(context, block, self.spec, baseline)
        self._link, self._pose = link, place_of(sensor, block)
        self._who = "::".join((context.model, link, sensor.name, block.name))
        self._noise = block.noise
        self._encoding = self.encoding or ENCODINGS.get(block.format, "")
        if not self._encoding:
            context.warn(f"there is no image format {block.format!r}; bgr8 is published")
            self._encoding = "bgr8"
        name = topics.named(topics.image)
        self._image = context.publish(name, "sensor_msgs/Image", 2, latch=True)
        self._compressed = context.publish(f"{name}/compressed", "sensor_msgs/CompressedImage", 2,
                                           latch=True)
        self._info = context.publish(topics.named(topics.info), "sensor_msgs/CameraInfo", 2)
        self._form = str(context.search_parameter(f"{name}/compressed/format", "jpeg"))
        self._quality = int(context.search_parameter(f"{name}/compressed/jpeg_quality", _QUALITY))
        if calibrated:
            context.serve(topics.named("set_camera_info"), "sensor_msgs/SetCameraInfo",
                          self.calibration.replace)

    @property
    def wanted(self) -> bool:
        return self._image.wanted or self._compressed.wanted

    @property
    def info_wanted(self) -> bool:
        return self._info.wanted

    @property
    def publications(self) -> List[Publication]:
        return [self._image, self._compressed, self._info]

    def view(self, *outputs: str) -> View:
        """Return the view to render; colours are the default output."""
        return View(self._link, self._pose, self.spec, outputs or (RGB,))

    def publish(self, rgb: Optional[Any], ns: int) -> None:
        """Publish a picture and CameraInfo on the topics that have subscribers."""
        context = self._context
        head = header(context, ns, self.topics.frame)
        if self._info.wanted:
            self._info.publish(self.calibration.message(head))
        if rgb is None or not self.wanted:
            return
        encoding = self._encoding
        noisy = LazyValue(lambda: self._picture(rgb, ns))
        if self._image.wanted:
            self._image.publish_later(
                lambda: make_image(context, head, encode_picture(noisy.get(), encoding), encoding))
        if self._compressed.wanted:
            self._compressed.publish_later(lambda: make_compressed_image(
                context, head, noisy.get(), encoding, self._form, self._quality))

    def _picture(self, rgb: Any, ns: int) -> Any:
        """The picture with its noise; another thread calls this.

        The sim time counts the samples: a picture that is left out shifts no other's noise.
        """
        return noisy_picture(rgb, self._noise, self._context.seed, self._who, ns)
