"""The few calls of Embree 4 that are needed, through ctypes.

The library is the one that the `embreex` wheel carries: Debian's is Embree 3, and the wheel's
Python module has no instances. Source of names and numbers: Embree's API documentation.
"""
from __future__ import annotations

import ctypes
import ctypes.util
import glob
import importlib.util
import os
from typing import Any, Optional, Tuple

from ..api import SensingError, SensingUnavailableError

TRIANGLES, SPHERES, INSTANCES = 0, 50, 122
INDEX, VERTEX, TRANSFORM = 0, 1, 23
UINT, UINT3, FLOAT3, FLOAT4 = 0x5001, 0x5003, 0x9003, 0x9004
MATRIX = 0x9234
"""RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR; the number beside it, 0x9134, is row major's."""
DYNAMIC, ROBUST = 1 << 0, 1 << 2
MEDIUM_QUALITY = 1
NOTHING = 0xFFFFFFFF
"""RTC_INVALID_GEOMETRY_ID."""

PACKET = 16
"""Rays a call."""
# A packet's fields, `PACKET` words each: RTCRay16 then RTCHit16 (one level of instances). BODY is a
# place in the array of instances.
(ORIGIN, NEAR, DIRECTION, TIME, FAR, MASK, _ID, _FLAGS, NORMAL, _U, _V, _PRIMITIVE, GEOMETRY,
 _ARRAY, BODY) = (0, 3, 4, 7, 8, 9, 10, 11, 12, 15, 16, 17, 18, 19, 20)
FIELDS = 21

_POINTER, _UINT, _INT, _SIZE = ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_size_t
_CALLS = {
    "rtcNewDevice": (_POINTER, [ctypes.c_char_p]),
    "rtcReleaseDevice": (None, [_POINTER]),
    "rtcGetDeviceError": (_INT, [_POINTER]),
    "rtcNewScene": (_POINTER, [_POINTER]),
    "rtcReleaseScene": (None, [_POINTER]),
    "rtcSetSceneFlags": (None, [_POINTER, _INT]),
    "rtcSetSceneBuildQuality": (None, [_POINTER, _INT]),
    "rtcCommitScene": (None, [_POINTER]),
    "rtcNewGeometry": (_POINTER, [_POINTER, _INT]),
    "rtcReleaseGeometry": (None, [_POINTER]),
    "rtcSetNewGeometryBuffer": (_POINTER, [_POINTER, _INT, _UINT, _INT, _SIZE, _SIZE]),
    "rtcCommitGeometry": (None, [_POINTER]),
    "rtcAttachGeometry": (_UINT, [_POINTER, _POINTER]),
    "rtcDetachGeometry": (None, [_POINTER, _UINT]),
    "rtcSetGeometryInstancedScenes": (None, [_POINTER, _POINTER, _SIZE]),
    "rtcSetSharedGeometryBuffer": (None, [_POINTER, _INT, _UINT, _INT, _POINTER, _SIZE, _SIZE,
                                          _SIZE]),
    "rtcUpdateGeometryBuffer": (None, [_POINTER, _INT, _UINT]),
    "rtcIntersect16": (None, [_POINTER, _POINTER, _POINTER, _POINTER]),
}


class Embree:
    """A device. Not thread safe.

    Raises:
        SensingUnavailableError: there is no library; says what to install.
    """

    def __init__(self) -> None:
        path = library_path()
        if path is None:
            raise SensingUnavailableError(
                "lasers need Embree 4.3: on x86-64 'pip install embreex'; on other processors the "
                "system's library (Debian 13: apt-get install libembree4-4)")
        try:
            # Calls are short: to let other threads run meanwhile costs more than the calls.
            library, building = ctypes.PyDLL(path), ctypes.CDLL(path)
        except OSError as fault:
            raise SensingUnavailableError(f"lasers need Embree, which cannot be loaded: {fault}"
                                          ) from None
        for name, (result, arguments) in _CALLS.items():
            call = getattr(building if name == "rtcCommitScene" else library, name)
            call.restype, call.argtypes = result, arguments
            setattr(self, name, call)
        # One thread: the trees are small, and the physics needs the other cores.
        self.device = self.rtcNewDevice(b"threads=1,set_affinity=0")
        if not self.device:
            raise SensingUnavailableError("Embree does not run on this processor")

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)

    def check(self) -> None:
        """Raise SensingError when a call has failed."""
        code = self.rtcGetDeviceError(self.device)
        if code:
            raise SensingError(f"Embree failed with code {code}")

    def scene(self, dynamic: bool) -> int:
        """An empty scene; rays do not slip through its edges."""
        made: int = self.rtcNewScene(self.device)
        self.rtcSetSceneFlags(made, ROBUST | (DYNAMIC if dynamic else 0))
        self.rtcSetSceneBuildQuality(made, MEDIUM_QUALITY)  # no slower to make than the low one
        return made

    def reshape(self, geometry: int, buffer: int, vertices: Any) -> None:
        """Give a geometry other vertices, float32 (n, 3); `buffer`: the address of the old ones."""
        ctypes.memmove(buffer, vertices.ctypes.data, vertices.nbytes)
        self.rtcUpdateGeometryBuffer(geometry, VERTEX, 0)
        self.rtcCommitGeometry(geometry)

    def attach(self, scene: int, kind: int, buffers: "Tuple[Tuple[int, int, Any], ...]",
               ) -> Tuple[int, int]:
        """Add a geometry; `buffers` are (kind, format, contiguous array of rows).

        Returns:
            The geometry and the address of its last buffer, as long as the scene has it.
        """
        geometry, to = self.rtcNewGeometry(self.device, kind), 0
        for use, form, rows in buffers:
            to = self.rtcSetNewGeometryBuffer(geometry, use, 0, form, rows.strides[0], len(rows))
            if not to:
                self.check()
            ctypes.memmove(to, rows.ctypes.data, rows.nbytes)
        self.rtcCommitGeometry(geometry)
        self.rtcAttachGeometry(scene, geometry)
        self.rtcReleaseGeometry(geometry)
        return geometry, to


def library_path() -> Optional[str]:
    """The wheel's library, found without importing its module, else the system's; None for none."""
    return _library_of_wheel() or ctypes.util.find_library("embree4")


def _library_of_wheel() -> Optional[str]:
    spec = importlib.util.find_spec("embreex")
    if spec is None or not spec.submodule_search_locations:
        return None
    package = spec.submodule_search_locations[0]
    for folder in (os.path.join(os.path.dirname(package), "embreex.libs"), package):
        found = sorted(glob.glob(os.path.join(folder, "libembree4*")))
        if found:
            return found[0]
    return None
