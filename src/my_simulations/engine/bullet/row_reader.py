"""Read the states of a few links and joint axes, for records of exact steps.

`StateReadout` reads all bodies that may have moved. A record of one robot in a world of many bodies
needs a few rows only. The values of both are identical.
"""
from __future__ import annotations

from typing import Dict, List, Tuple

import pybullet

from .bodies import Axis, Body, Part
from .link_rows import ROW, link_row
from .link_states import motion
from .state_readout import StateReadout


class RowReader:
    """Reads the present values of rows of the ring's tables.

    Args:
        readout: its tables have the last finite states, and rows without a link.
        links: body and part by link row.
        axes: body and axis by joint row.
    """

    def __init__(self, readout: StateReadout, links: Dict[int, Tuple[Body, Part]],
                 axes: Dict[int, Tuple[Body, Axis]]) -> None:
        self._readout, self._links, self._axes = readout, links, axes

    def read_links(self, rows: Tuple[int, ...]) -> bytes:
        """Return link rows as raw doubles; zeros for rows without a link."""
        readout = self._readout
        found = b""
        for row in rows:
            body, part = self._links.get(row, (None, None))
            if body is not None and part is not None:
                now = motion(body.uid, part.index)
                total = sum(now.position) + sum(now.orientation) + sum(now.linear) + sum(
                    now.angular)
                if total - total == 0.0:   # finite
                    found += ROW.pack(*link_row(*now, readout.offset(row)))
                    continue
                readout.update()   # puts a body with an infinite state back
            found += readout.row(row)
        return found

    def read_axes(self, rows: Tuple[int, ...]) -> List[float]:
        """Return position and rate of each joint axis in turn; zeros for rows without an axis."""
        known = [self._axes[row] for row in rows if row in self._axes]
        if len(known) == len(rows):
            body = known[0][0]
            if all(one is body for one, _ in known):
                states = pybullet.getJointStates(body.uid, [axis.index for _, axis in known])
                found = [value for state in states for value in state[:2]]
                total = sum(found)
                if total - total == 0.0:
                    return found
        self._readout.update()   # the robot is in several parts, or to be put back
        return [value for row in rows for value in self._readout.joints[row].tolist()]
