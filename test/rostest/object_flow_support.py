"""The object tools as programs, for rostests."""
from __future__ import annotations

import os

import rospkg
import rospy
import support


def package_file(inside):
    return os.path.join(rospkg.RosPack().get_path(support.PACKAGE), *inside.split("/"))


def tool(name, *words, **environment):
    """A script of this package, started as rosrun would; use it in a `with`."""
    return support.Program([support.executable(support.PACKAGE, name), *words], **environment)


def wait_for_list():
    """Wait until the launch file's list is loaded; from then on only the test changes it."""
    support.wait_for(lambda: rospy.get_param("/my_simulations/object_list", None), "the list")


def entry(model="my_simulations/objects/MY_OBJECT.urdf", position=(0, 0, 0),
          orientation=(0, 0, 0), **more):
    """An object of a list in the current format."""
    return {"model": model, "position": list(position), "orientation": list(orientation), **more}


class ToolCase:
    """For test cases whose class has `gazebo`: runs tools and looks where models are."""

    def run_tool(self, *words, status=0, **environment):
        """The tool's output; its exit status must be `status`."""
        with tool(*words, **environment) as program:
            self.assertEqual(program.ended(), status, program.text)
        return program.text

    def assert_at(self, name, x, y, z, delta=0.01):
        """The model stands at a place of the world."""
        state = self.gazebo.get_model_state(name, "")
        self.assertTrue(state.success, state.status_message)
        found = state.pose.position
        for one, other in zip((found.x, found.y, found.z), (x, y, z)):
            self.assertAlmostEqual(one, other, delta=delta, msg=f"{name} at {found}")


class RobotWorldCase(ToolCase):
    """Tools in a world with a robot; each test begins with the list of the empty world."""

    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        support.wait_for(lambda: "robo" in cls.gazebo.names(), "the robot")
        wait_for_list()

    def setUp(self):
        self.gazebo.clear(keep=("ground_plane", "robo"))
        self.run_tool("upload_objects.py", "--world", "empty_world")
