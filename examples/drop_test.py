#!/usr/bin/env python3
"""Drops each object of the list from half a metre and prints where it comes to rest.

    python3 examples/drop_test.py [NAME ...]
"""
import sys

import my_simulations

HEIGHT = 0.5   # m above its place in the list
SECONDS = 3.0


def drop(name):
    """Rise of the object after the fall in m, and its tilt: the z of its own z axis."""
    with my_simulations.open_world("worlds/empty.world", objects=[name]) as world:
        start = world.states().pose[name].copy()
        raised = start.copy()
        raised[2] += HEIGHT
        world.set_pose(name, raised)
        world.step(round(SECONDS / world.step_size))
        pose = world.states().pose[name]
        _, _, _, qx, qy, _, _ = pose
        return pose[2] - start[2], 1.0 - 2.0 * (qx * qx + qy * qy)


def main():
    """Drop what the command line names, else MY_OBJECT."""
    for name in sys.argv[1:] or ["MY_OBJECT"]:
        rise, upright = drop(name)
        print(f"{name}: {1000 * rise:+.1f} mm from its place, "
              + ("upright" if upright > 0.99 else "fallen over"))


if __name__ == "__main__":
    main()
