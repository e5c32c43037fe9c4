"""Reads the states of a few links and joint axes, for records of exact steps.

`StateReadout` reads all that may have moved; a record of one robot in a world of many bodies needs
a few rows. They are the same to the bit.
"""
from __future__ import annotations

import struct
from typing import Dict, List, Tuple

import pybullet

from ...geometry import Vec3, cross
from ..ring import LINK_WIDTH
from .bodies import Axis, Body, Part
from .link_states import Motion, motion
from .state_readout import StateReadout

_ROW = struct.Struct(f"={LINK_WIDTH}d")


class RowReader:
    """Rows of the ring's tables as they are now.

    Args:
        readout: its tables have the rows of bodies at rest.
        links: body and part by link row.
        axes: body and axis by joint row.
    """

    def __init__(self, readout: StateReadout, links: Dict[int, Tuple[Body, Part]],
                 axes: Dict[int, Tuple[Body, Axis]]) -> None:
        self._readout, self._links, self._axes = readout, links, axes

    def read_links(self, rows: Tuple[int, ...]) -> bytes:
        """The rows as raw doubles; zeros where there is no such link."""
        readout = self._readout
        found = b""
        for row in rows:
            body, part = self._links.get(row, (None, None))
            if body is not None and part is not None and readout.may_have_moved(body):
                now = motion(body.uid, part.index)
                total = sum(now.position) + sum(now.orientation) + sum(now.linear) + sum(
                    now.angular)
                if total - total == 0.0:
                    found += self._packed(row, now)
                    continue
                readout.update()   # which puts the body back
            found += readout.row(row)
        return found

    def _packed(self, row: int, now: Motion) -> bytes:
        """The row of a link by its centre of mass, as `StateReadout` computes it."""
        offset = self._readout.offset(row)
        if offset is None:
            return _ROW.pack(*now.position, *now.orientation, *now.linear, *now.angular)
        (px, py, pz), (rx, ry, rz, rw) = offset
        x, y, z, w = now.orientation
        u: Vec3 = (x, y, z)
        tx, ty, tz = cross(u, (px, py, pz))
        t: Vec3 = (2.0 * tx, 2.0 * ty, 2.0 * tz)
        ux, uy, uz = cross(u, t)
        lever: Vec3 = (px + w * t[0] + ux, py + w * t[1] + uy, pz + w * t[2] + uz)
        at, linear, angular = now.position, now.linear, now.angular
        vx, vy, vz = cross(angular, lever)
        cx, cy, cz = cross(u, (rx, ry, rz))
        return _ROW.pack(
            at[0] + lever[0], at[1] + lever[1], at[2] + lever[2],
            w * rx + rw * x + cx, w * ry + rw * y + cy, w * rz + rw * z + cz,
            w * rw - (x * rx + y * ry + z * rz),
            linear[0] + vx, linear[1] + vy, linear[2] + vz, *angular)

    def read_axes(self, rows: Tuple[int, ...]) -> List[float]:
        """Position and rate of joint axes, one after the other; zeros where there is none."""
        known = [self._axes[row] for row in rows if row in self._axes]
        if len(known) == len(rows):
            body = known[0][0]
            if self._readout.may_have_moved(body) and all(one is body for one, _ in known):
                states = pybullet.getJointStates(body.uid, [axis.index for _, axis in known])
                found = [value for state in states for value in state[:2]]
                total = sum(found)
                if total - total == 0.0:
                    return found
        self._readout.update()   # the robot is at rest, in several parts, or to be put back
        return [value for row in rows for value in self._readout.joints[row].tolist()]
