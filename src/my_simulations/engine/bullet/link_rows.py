"""Rows of the link table from states of centres of mass.

PyBullet gives the pose of the centre of mass, along the principal axes, and its velocity. A row
shows the link frame: with its offset (p, r) in the frame of the centre of mass, which is at x with
the rotation R, the link frame is at x + R p and moves at v + w x R p.
"""
from __future__ import annotations

import struct
from typing import Optional, Tuple

from ...geometry import Pose, Quat, Vec3
from ..ring import LINK_WIDTH

ROW = struct.Struct(f"={LINK_WIDTH}d")
"""Position, quaternion, linear and angular velocity; see `ring.LINK_WIDTH`."""

PlaceRow = Tuple[float, float, float, float, float, float, float]
"""The first seven numbers of a row."""


def place_row(position: Vec3, orientation: Quat, offset: Pose) -> Tuple[PlaceRow, Vec3]:
    """Return the pose of a link frame, and its position relative to the centre of mass, m.

    Both along the axes of the world; `offset` is the link frame in the frame of the centre of mass.
    """
    (x, y, z), (qx, qy, qz, qw) = position, orientation
    (px, py, pz), (rx, ry, rz, rw) = offset
    tx, ty, tz = (2.0 * (qy * pz - qz * py), 2.0 * (qz * px - qx * pz), 2.0 * (qx * py - qy * px))
    lx = px + qw * tx + (qy * tz - qz * ty)
    ly = py + qw * ty + (qz * tx - qx * tz)
    lz = pz + qw * tz + (qx * ty - qy * tx)
    return (x + lx, y + ly, z + lz,
            qw * rx + rw * qx + (qy * rz - qz * ry),
            qw * ry + rw * qy + (qz * rx - qx * rz),
            qw * rz + rw * qz + (qx * ry - qy * rx),
            qw * rw - (qx * rx + qy * ry + qz * rz)), (lx, ly, lz)


def link_row(position: Vec3, orientation: Quat, linear: Vec3, angular: Vec3,
             offset: Optional[Pose]) -> Tuple[float, ...]:
    """Return the row of a link frame, 13 numbers, whose centre of mass has this state.

    `offset` None: the link frame is that of the centre of mass.
    """
    if offset is None:
        return (*position, *orientation, *linear, *angular)
    place, (lx, ly, lz) = place_row(position, orientation, offset)
    (vx, vy, vz), (wx, wy, wz) = linear, angular
    return (*place, vx + (wy * lz - wz * ly), vy + (wz * lx - wx * lz),
            vz + (wx * ly - wy * lx), wx, wy, wz)
