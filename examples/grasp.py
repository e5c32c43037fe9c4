#!/usr/bin/env python3
"""Closes a gripper on a box by different forces, lifts it, and prints which forces hold.

A grip holds when the friction of both fingers carries the weight: 2 mu F > m g.

    python3 examples/grasp.py
"""
import my_simulations

MASS, MU, GRAVITY = 0.5, 0.5, 9.8
LIFT = 0.3      # m/s
FORCES = (2.0, 4.0, 6.0, 10.0, 20.0)  # N of each finger

BOX = f"""
<sdf version="1.7">
  <model name="box">
    <link name="link">
      <inertial>
        <mass>{MASS}</mass>
        <inertia><ixx>0.0005</ixx><iyy>0.0005</iyy><izz>0.0005</izz></inertia>
      </inertial>
      <collision name="collision">
        <geometry><box><size>0.08 0.08 0.08</size></box></geometry>
        <surface><friction><ode><mu>{MU}</mu><mu2>{MU}</mu2></ode></friction></surface>
      </collision>
    </link>
  </model>
</sdf>
"""

FINGER = """
    <link name="{side}">
      <pose>0 {y} 0 0 0 0</pose>
      <inertial>
        <mass>0.1</mass>
        <inertia><ixx>0.0001</ixx><iyy>0.0001</iyy><izz>0.0001</izz></inertia>
      </inertial>
      <collision name="collision">
        <geometry><box><size>0.04 0.01 0.06</size></box></geometry>
        <surface><friction><ode><mu>1</mu><mu2>1</mu2></ode></friction></surface>
      </collision>
    </link>
    <joint name="close_{side}" type="prismatic">
      <parent>palm</parent>
      <child>{side}</child>
      <axis><xyz>0 {inwards} 0</xyz><limit><lower>-0.01</lower><upper>0.05</upper></limit></axis>
    </joint>
"""

GRIPPER = """
<sdf version="1.7">
  <model name="gripper">
    <link name="palm">
      <pose>0 0 0.1 0 0 0</pose>
      <inertial>
        <mass>1</mass>
        <inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>
      </inertial>
    </link>
    <joint name="lift" type="prismatic">
      <parent>world</parent>
      <child>palm</child>
      <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>1</upper></limit></axis>
    </joint>
""" + FINGER.format(side="left", y=0.06, inwards=-1) + FINGER.format(
    side="right", y=-0.06, inwards=1) + """
  </model>
</sdf>
"""


def lifts(force):
    """Whether the box comes up with the gripper."""
    with my_simulations.open_world("worlds/empty.world") as world:
        world.spawn(BOX, pose=[0, 0, 0.04])
        world.spawn(GRIPPER, pose=[0, 0, 0.04])
        world.apply_effort("close_left", force)
        world.apply_effort("close_right", force)
        world.step(500)
        # The weight of palm and fingers, and enough for the box; slow by how long it acts.
        world.apply_effort("lift", (1.2 + MASS) * GRAVITY + 2.0, duration=0.5)
        world.step(500)
        return world.states().pose["box"][2] > 0.06


def main():
    """Print a table."""
    needed = MASS * GRAVITY / (2 * MU)
    print(f"{needed:.1f} N of each finger carry the box at rest")
    for force in FORCES:
        print(f"{force:5.1f} N: {'holds' if lifts(force) else 'slips'}")


if __name__ == "__main__":
    main()
