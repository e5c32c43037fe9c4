"""Camera pictures as JPEG, small enough for a page."""
from __future__ import annotations

import io
from typing import Any, Dict, Optional, Tuple

from ...formats.image.pixels import of_formats

_WIDEST = 640
_QUALITY = 80

_CHANNELS = {"rgb8": "RGB", "bgr8": "BGR", "rgba8": "RGBA", "bgra8": "BGRA", "mono8": "L",
             "8UC1": "L", "8UC3": "BGR", "8UC4": "BGRA"}
"""Encodings of 8 bits (sensor_msgs/image_encodings.h) and the order of their channels."""

_DEPTHS = {"16UC1": ("u2", 0.001), "mono16": ("u2", 1.0), "32FC1": ("f4", 1.0),
           "16SC1": ("i2", 1.0), "64FC1": ("f8", 1.0)}
"""Encodings of one wide channel, and the unit in m where they hold a depth (REP 118)."""

View = Tuple[Dict[str, Any], bytes]


def image(message: Any) -> View:
    """A sensor_msgs/Image. Raises ValueError for an encoding that cannot be shown."""
    encoding = message.encoding
    if encoding in _DEPTHS:
        return _depth(message, *_DEPTHS[encoding])
    order = "L" if encoding.startswith("bayer_") and encoding.endswith("8") \
        else _CHANNELS.get(encoding)
    if order is None:
        raise ValueError(f"images of encoding {encoding!r} cannot be shown")
    pixels = _rows(message, "u1", len(order))
    if order != "L":
        pixels = pixels[:, :, [order.index(name) for name in "RGB"]]
    else:
        pixels = pixels[:, :, 0]
    return _view(message, pixels)


def compressed_image(message: Any) -> View:
    """A sensor_msgs/CompressedImage in a format of browsers; Raises ValueError for others."""
    from PIL import Image

    data = bytes(message.data)
    try:
        with of_formats(io.BytesIO(data), ("JPEG", "PNG", "WEBP")) as opened:
            kind, (width, height) = str(opened.format).lower(), opened.size
    except (OSError, SyntaxError, EOFError, Image.DecompressionBombError) as fault:
        raise ValueError(f"images of format {message.format!r} cannot be shown") from fault
    return {"type": "image", "format": f"image/{kind}", "width": width, "height": height,
            "encoding": message.format}, data


def _rows(message: Any, kind: str, channels: int) -> Any:
    """Pixels (height, width, channels). Raises ValueError for sizes that do not fit each other."""
    import numpy as np

    item: Any = np.dtype((">" if message.is_bigendian else "<") + kind)
    row = message.width * channels * item.itemsize
    step = message.step or row
    # Without pixels a width may be anything, and what is made of it takes any memory.
    if not row or not message.height or step < row or len(message.data) != message.height * step:
        raise ValueError(f"{len(message.data)} bytes for {message.width} x {message.height} pixels"
                         f" in rows of {step} bytes")
    rows = np.frombuffer(message.data, "u1", message.height * step).reshape(message.height, step)
    pixels = np.ascontiguousarray(rows[:, :row]).view(item)
    return pixels.reshape(message.height, message.width, channels)


def _depth(message: Any, kind: str, unit: float) -> View:
    """Grey from black at the nearest to white at the farthest; black for unknown, as in rviz."""
    import numpy as np

    values = _rows(message, kind, 1)[:, :, 0].astype("f4") * np.float32(unit)
    known = np.isfinite(values) & (values > 0.0)
    near, far = ((float(values[known].min()), float(values[known].max())) if known.any()
                 else (0.0, 0.0))
    across = max(far - near, 1e-9)
    grey = np.where(known, (values - near) / across * 255.0, 0.0).clip(0, 255).astype("u1")
    return _view(message, grey, near, far)


def _view(message: Any, pixels: Any, near: Optional[float] = None,
          far: Optional[float] = None) -> View:
    import numpy as np
    from PIL import Image

    factor = -(-message.width // _WIDEST)
    drawn = Image.fromarray(np.ascontiguousarray(pixels))
    if factor > 1:
        drawn = drawn.reduce(factor)
    data = io.BytesIO()
    drawn.save(data, "JPEG", quality=_QUALITY)
    head = {"type": "image", "format": "image/jpeg", "width": message.width,
            "height": message.height, "encoding": message.encoding}
    if near is not None:
        head.update(near=near, far=far)
    return head, data.getvalue()
