#!/usr/bin/env python3
"""Slides a box over floors of different friction and compares with v^2 / (2 mu g).

    python3 examples/parameter_sweep.py
"""
import my_simulations

SPEED = 2.0    # m/s
GRAVITY = 9.8  # m/s^2, as in the empty world
FRICTIONS = (0.2, 0.4, 0.6, 0.8)

BOX = """
<sdf version="1.7">
  <model name="box">
    <link name="link">
      <inertial>
        <mass>1</mass>
        <inertia><ixx>0.0067</ixx><iyy>0.0067</iyy><izz>0.0067</izz></inertia>
      </inertial>
      <collision name="collision">
        <geometry><box><size>0.2 0.2 0.2</size></box></geometry>
        <surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>
      </collision>
    </link>
  </model>
</sdf>
"""


def distance(world, mu):
    """How far the box slides in m."""
    world.spawn(BOX.format(mu=mu))
    world.set_pose("box", [0, 0, 0.1], twist=[SPEED, 0, 0, 0, 0, 0])
    while abs(world.states().twist["box"][0]) > 1e-3:
        world.step(50)
    travelled = world.states().pose["box"][0]
    world.remove("box")
    return travelled


def main():
    """Print a table."""
    print("  mu  simulated  expected")
    with my_simulations.open_world("worlds/empty.world") as world:
        for mu in FRICTIONS:
            expected = SPEED ** 2 / (2 * mu * GRAVITY)
            print(f"{mu:4.1f} {distance(world, mu):8.3f} m {expected:7.3f} m")


if __name__ == "__main__":
    main()
