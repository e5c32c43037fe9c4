"""Colour cameras: libgazebo_ros_camera.so, and those called triggered, multi and both.

Parameters, defaults, topics and frames are those of gazebo_plugins with two differences
(see `camera_parameters`). Pictures are rendered while there are subscribers, and show the step of
their stamp. If rendering is slower than the rate, some are left out, and physics continues.
"""
from __future__ import annotations

from typing import Any, Callable, List, Type

from ..base import Plugin
from ..context import Context
from .camera_parameters import ImagerRate, topics_of
from .picture_stream import PictureStream, camera_sensor

_TRIGGERS = 100


class Camera(Plugin):
    """Image, compressed image and CameraInfo of a camera.

    Attributes:
        stream_type: makes the messages.
    """

    stream_type: Type[PictureStream] = PictureStream

    def load(self) -> None:
        context, p = self.enter_namespace(empty_means_model=True)
        sensor = camera_sensor(context, "camera")
        block = sensor.cameras[0]
        self._stream = self.stream_type(context, sensor, context.sensor_link, block,
                                        topics_of(context), p.number("hackBaseline", 0.0),
                                        p.flag("borderCrop", True))
        ImagerRate(context, [self._stream.topics.base], self.update, lambda: self._stream.wanted,
                   self._stream.publications)

    def update(self) -> None:
        """Take a picture, if a picture topic has a subscriber."""
        if self._stream.wanted:
            self.take()
        elif self._stream.info_wanted:
            self._stream.publish(None, self.context.now_ns)

    def take(self) -> bool:
        """Request a picture; return False if the previous one is late."""
        return self.context.photograph([self._stream.view()], self._seen)

    def _seen(self, pictures: List[Any], ns: int) -> None:
        self._stream.publish(pictures[0].rgb, ns)


class Trigger:
    """One picture, as soon as one can be drawn, for each message on a camera's trigger topic.

    `<update_rate>` does not delay it (gazebo_plugins). At this rate a picture that was lost is
    requested again.

    Args:
        context: of the plugin.
        stream: the camera's topics.
        turns: name under which its pictures take turns.
    """

    def __init__(self, context: Context, stream: PictureStream, turns: str = "") -> None:
        self._context, self._stream, self._turns = context, stream, turns
        self._triggers = 0
        self._warm = self._drawing = False
        topic = context.parameters.text("triggerTopicName") or "image_trigger"
        context.subscribe(stream.topics.named(topic), "std_msgs/Empty", self._receive, _TRIGGERS)

    def _receive(self, message: Any) -> None:
        self._triggers += 1
        self._schedule_picture()

    def reset(self) -> None:
        """Discard triggers that came before the reset."""
        self._triggers = 0
        self._drawing = False

    def update(self) -> None:
        """Take a picture if one is due; prepare the renderer for the first subscriber."""
        if not (self._warm or self._triggers) and self._stream.wanted:
            self._warm = self._drawn(self._warmed)
        elif self._triggers:
            self._take_due()

    def _schedule_picture(self) -> None:
        """Take the next triggered picture in this step, unless one is being drawn."""
        if self._triggers and not self._drawing:
            self._context.once(self._context.now_ns, self._take_due)

    def _take_due(self) -> None:
        if self._triggers and (not self._stream.wanted or self._drawn(self._seen)):
            self._triggers -= 1
            self._schedule_picture()

    def _drawn(self, call: Callable[[List[Any], int], None]) -> bool:
        self._drawing = True   # the pictures can come before the request returns
        taken = self._context.photograph([self._stream.view()], call, self._turns, queue=True)
        self._drawing = self._drawing and taken
        return taken

    def _seen(self, pictures: List[Any], ns: int) -> None:
        self._stream.publish(pictures[0].rgb, ns)
        self._warmed(pictures, ns)

    def _warmed(self, pictures: List[Any], ns: int) -> None:
        self._drawing = False
        self._schedule_picture()


class _Triggered(Plugin):
    """Base class of cameras with triggers."""

    _triggers: List[Trigger]

    def reset(self) -> None:
        """Discard triggers that came before the reset."""
        for trigger in self._triggers:
            trigger.reset()

    def update(self) -> None:
        for trigger in self._triggers:
            trigger.update()


class TriggeredCamera(_Triggered, Camera):
    """A camera that waits for triggers."""

    def load(self) -> None:
        super().load()
        self._triggers = [Trigger(self.context, self._stream)]


class MultiCamera(Plugin):
    """Several cameras with simultaneous pictures; a pair has `left` and `right` in its names."""

    def load(self) -> None:
        context, p = self.enter_namespace(empty_means_model=True)
        sensor = camera_sensor(context, "multicamera")
        self._streams = []
        for block in sensor.cameras:
            side = next((word for word in ("left", "right") if word in block.name), "")
            baseline = p.number("hackBaseline", 0.0) if side == "right" else 0.0
            self._streams.append(PictureStream(
                context, sensor, context.sensor_link, block,
                topics_of(context, f"/{side or block.name}"), baseline, p.flag("borderCrop", True)))
        ImagerRate(context, [stream.topics.base for stream in self._streams], self.update,
                   lambda: any(stream.wanted for stream in self._streams),
                   [one for stream in self._streams for one in stream.publications])

    def update(self) -> None:
        """Take pictures with the cameras that are listened to."""
        streams = [stream for stream in self._streams if stream.wanted]
        if not streams:
            for stream in self._streams:
                stream.publish(None, self.context.now_ns)
            return

        def seen(pictures: List[Any], ns: int) -> None:
            found = {id(stream): one.rgb for stream, one in zip(streams, pictures)}
            for stream in self._streams:
                stream.publish(found.get(id(stream)), ns)

        self.context.photograph([stream.view() for stream in streams], seen)


class TriggeredMultiCamera(_Triggered, MultiCamera):
    """Several cameras, each with a trigger topic of its own beside its pictures."""

    def load(self) -> None:
        super().load()
        self._triggers = [Trigger(self.context, stream, stream.topics.base)
                          for stream in self._streams]
