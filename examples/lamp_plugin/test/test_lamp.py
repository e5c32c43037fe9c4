"""The plugin alone, and with physics in a Python program; neither needs ROS."""
import unittest
from pathlib import Path

from lamp_plugin.lamp import Lamp

import my_simulations
from my_simulations.plugins.testing import FakeContext

LAMP = str(Path(__file__).resolve().parents[1] / "urdf" / "lamp.urdf")


class LampTest(unittest.TestCase):
    def test_its_motor_turns_at_the_rate_that_is_asked_for(self):
        context = FakeContext("<plugin><rate>2</rate></plugin>", joints=("lamp_joint",))
        Lamp(context).load()
        context.advance(0.02)
        self.assertEqual(context.joints["lamp_joint"].motor, (2.0, 2.0))
        context.deliver("lamp_rate", data=0.5)
        context.advance(0.02)
        self.assertEqual(context.joints["lamp_joint"].motor, (0.5, 2.0))

    def test_it_turns_to_both_sides(self):
        with my_simulations.open_world(plugins={"liblamp.so": "lamp_plugin.lamp:Lamp"}) as world:
            world.spawn(LAMP, name="lamp")
            angles = world.topics["lamp"]
            world.step(3000)
            seen = [message.data for message in angles.take()]
            self.assertEqual(world.issues, [])
        self.assertTrue(max(seen) > 0.5 and min(seen) < -0.5)
        self.assertLess(max(map(abs, seen)), 0.6)
