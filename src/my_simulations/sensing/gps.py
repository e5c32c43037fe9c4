"""A satellite receiver (Gazebo Classic 11, `GpsSensor` and `SphericalCoordinates`).

The world is a tangent plane at its origin on the WGS 84 ellipsoid: places go to earth-centred
coordinates and from there to latitude, longitude and height.
"""
from __future__ import annotations

import math
from typing import NamedTuple, Tuple

from ..description.surroundings import SphericalCoordinates
from ..geometry import Vec3

_A, _B = 6378137.0, 6356752.314245  # WGS 84, m
_E2 = 1.0 - (_B / _A) ** 2


class GpsFix(NamedTuple):
    """Degrees and m above the ellipsoid; velocity m/s towards east, north and up."""

    latitude_deg: float
    longitude_deg: float
    altitude: float
    velocity: Vec3


def measure(position: Vec3, velocity: Vec3, origin: SphericalCoordinates) -> GpsFix:
    """A fix for a place and a velocity in the world.

    Gazebo's signs: with heading 0 the world's +x points west and its +y south; a world whose +x
    points east says `heading_deg` 180. See `east_north`.
    """
    east, north = east_north(position[0], position[1], origin.heading_deg)
    x, y, z = _earth_from_plane((east, north, position[2]), origin)
    latitude, longitude, altitude = geodetic(x, y, z)
    east, north = east_north(velocity[0], velocity[1], origin.heading_deg)
    return GpsFix(math.degrees(latitude), math.degrees(longitude), altitude,
                  (east, north, velocity[2]))


def east_north(x: float, y: float, heading_deg: float) -> Tuple[float, float]:
    """World axes to east and north, as Gazebo Classic turns them (its transform LOCAL)."""
    c, s = math.cos(math.radians(heading_deg)), math.sin(math.radians(heading_deg))
    return -x * c - y * s, x * s - y * c


def earth_centred(latitude: float, longitude: float, altitude: float) -> Vec3:
    """Radians and m to earth-centred, earth-fixed metres."""
    around = _A / math.sqrt(1.0 - _E2 * math.sin(latitude) ** 2)
    across = (around + altitude) * math.cos(latitude)
    return (across * math.cos(longitude), across * math.sin(longitude),
            ((1.0 - _E2) * around + altitude) * math.sin(latitude))


def _earth_from_plane(place: Vec3, origin: SphericalCoordinates) -> Vec3:
    lat, lon = math.radians(origin.latitude_deg), math.radians(origin.longitude_deg)
    e, n, u = place
    x, y, z = earth_centred(lat, lon, origin.elevation)
    sin_lat, cos_lat, sin_lon, cos_lon = math.sin(lat), math.cos(lat), math.sin(lon), math.cos(lon)
    return (x - sin_lon * e - cos_lon * sin_lat * n + cos_lon * cos_lat * u,
            y + cos_lon * e - sin_lon * sin_lat * n + sin_lon * cos_lat * u,
            z + cos_lat * n + sin_lat * u)


def geodetic(x: float, y: float, z: float) -> Vec3:
    """Earth-centred metres to latitude, longitude (rad) and height (m), by Bowring's formula."""
    p = math.hypot(x, y)
    theta = math.atan2(z * _A, p * _B)
    latitude = math.atan2(z + (_A ** 2 / _B ** 2 - 1.0) * _B * math.sin(theta) ** 3,
                          p - _E2 * _A * math.cos(theta) ** 3)
    around = _A / math.sqrt(1.0 - _E2 * math.sin(latitude) ** 2)
    # The form that holds at the poles, too.
    altitude = (p * math.cos(latitude) + z * math.sin(latitude)
                - _A * _A / around)
    return latitude, math.atan2(y, x), altitude
