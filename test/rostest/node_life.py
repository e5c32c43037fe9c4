#!/usr/bin/env python3
"""How the programs start, refuse to start, and end."""
import contextlib
import os
import signal
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import rosgraph
import rospy
import support
from free_ports import silent_uri
from support import Program, executable, is_alive, wait_for

from my_simulations.editor.logs.state_log import LogReader
from my_simulations.ros import interface

WORLD = '<sdf version="1.5"><world name="default">{}</world></sdf>'


CONCAVE = """<model name="concave"><link name="l"><collision name="c"><geometry>
<mesh><uri>notch.obj</uri></mesh></geometry></collision></link></model>"""

# The same in the air, askew, above the ground.
FALLING = (CONCAVE.replace("<link", "<pose>0 0 1 0.4 0.3 0.2</pose><link", 1)
           + "<include><uri>model://ground_plane</uri></include>")

# An L of one piece: not convex.
NOTCH = "".join(f"v {x} {y} {z}\n" for z in (0, 1) for x, y in
                ((0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3))) + "".join(
    f"f {a} {b} {c}\n" for n in range(2, 6) for a, b, c in
    ((1, n + 1, n), (7, n + 6, n + 7))) + "".join(
    f"f {n} {n % 6 + 1} {n % 6 + 7}\nf {n} {n % 6 + 7} {n + 6}\n" for n in range(1, 7))

# In front of PyBullet, and itself only where meshes are divided.
SLEEPING_VHACD = """import sys, time
if sys.argv[0].endswith("worker.py"):
    def vhacd(*_, **__):
        time.sleep(600)
else:
    sys.path.remove({!r})
    del sys.modules["pybullet"]
    import pybullet
"""

# The first to import a module interrupts its process group.
INTERRUPTING = """import os, signal, sys
class Finder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == {!r} and sys.argv[0].endswith(("gzserver", "gazebo")):
            os.killpg(os.getpgid(0), signal.SIGINT)
sys.meta_path.insert(0, Finder)
"""

# A node whose registration thread does not look by itself whether the node has ended.
PATIENT = """import sys, threading, time, traceback, rospy
from rospy.impl.registration import RegManager
from my_simulations.ros.prompt_end import end_promptly

class Patient(threading.Condition):
    def wait(self, timeout=None):
        return super().wait()

def prepare(self, handler, usual=RegManager.__init__):
    usual(self, handler)
    self.cond = Patient()
    managers.append(self)

managers, RegManager.__init__ = [], prepare
rospy.init_node("patient", disable_rostime=True)
end_promptly()
while not managers[0].cond._waiters:
    time.sleep(0.01)
threads = list(rospy.core._shutdown_threads)
rospy.signal_shutdown("done")
print(len(threads), "threads,", sum(thread.is_alive() for thread in threads), "alive")

def serves():
    return any(frame.f_code.co_name == "serve_forever" for top in sys._current_frames().values()
               for frame, _ in traceback.walk_stack(top))

deadline = time.monotonic() + 60.0
while serves() and time.monotonic() < deadline:
    time.sleep(0.01)
print("the server", "still polls" if serves() else "has ended")
"""


def children_of(pid):
    """Process ids of what a process has started."""
    found = []
    for thread in os.listdir(f"/proc/{pid}/task"):
        # Threads come and go.
        with contextlib.suppress(FileNotFoundError, ProcessLookupError), open(
                f"/proc/{pid}/task/{thread}/children", encoding="ascii") as file:
            found += [int(word) for word in file.read().split()]
    return found


class NodeLife(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        cls.server = executable("gazebo_ros", "gzserver")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def world(self, text, name="a world.world"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def is_registered(self, node):
        return any(node in nodes for _, nodes in
                   rosgraph.Master("/node_life").getSystemState()[2])

    def ends_well(self, number):
        """A second server, under a name of its own, ended by a signal, with all it started."""
        world = self.world(WORLD.format(""))
        with Program([self.server, world, "__name:=second"]) as program:
            pid = wait_for(lambda: rospy.get_param("/second/my_simulations/engine_pid", 0),
                           "the second server")
            self.assertTrue(is_alive(pid))
            program.process.send_signal(number)
            self.assertEqual(program.ended(), 0, program.text)
            wait_for(lambda: not is_alive(pid), "the end of its engine")
            self.assertFalse(self.is_registered("/second"))
        rospy.delete_param("/second")

    def test_an_interrupt_ends_it_with_its_engine(self):
        self.ends_well(signal.SIGINT)

    def test_a_termination_ends_it_with_its_engine(self):
        self.ends_well(signal.SIGTERM)

    def assert_logs(self, number):
        """A second server's state log is whole when a signal has ended it."""
        world = self.world(WORLD.format(""))
        self.addCleanup(lambda: rospy.delete_param("/second"))
        with Program([self.server, "-r", "--record_path", self.folder, world,
                      "__name:=second"]) as program:
            gazebo = support.Gazebo("/second", persistent=False)
            wait_for(lambda: gazebo.sim_time() > 0.2, "some steps")
            gazebo.pause_physics()
            last = gazebo.sim_time()
            program.process.send_signal(number)
            self.assertEqual(program.ended(), 0, program.text)
        log = LogReader(os.path.join(self.folder, "state.log"))
        self.addCleanup(log.close)
        self.assertEqual(log.begin, 0.0)
        self.assertAlmostEqual(log.end, last, 9)

    def test_the_end_waits_for_no_thread_that_looks_now_and_then(self):
        with Program([sys.executable, "-c", PATIENT]) as program:
            self.assertEqual(program.ended(), 0, program.text)
            self.assertIn("1 threads, 0 alive", program.text)
            self.assertIn("the server has ended", program.text)

    def test_a_state_log_is_whole_after_an_interrupt(self):
        self.assert_logs(signal.SIGINT)

    def test_a_state_log_is_whole_after_a_termination(self):
        self.assert_logs(signal.SIGTERM)

    def test_a_server_that_cannot_write_its_log_says_so_and_runs(self):
        file = self.world("in the way", "taken")
        self.addCleanup(lambda: rospy.delete_param("/second"))
        with Program([self.server, "-r", "--record_path", os.path.join(file, "logs"),
                      self.world(WORLD.format("")), "__name:=second"]) as program:
            gazebo = support.Gazebo("/second", persistent=False)
            wait_for(lambda: gazebo.sim_time() > 0.0, "a step")
            wait_for(lambda: "cannot record a state log" in program.text, "the reason")
            self.assertEqual(program.text.count("Not a directory"), 1)

    @staticmethod
    def two(found):
        return found if len(found) == 2 else None

    def test_an_interrupt_while_meshes_are_divided_ends_it_with_all_it_started(self):
        fake = self.world(SLEEPING_VHACD.format(self.folder), "pybullet.py")
        self.world(NOTCH, "notch.obj")
        world = self.world(WORLD.format(CONCAVE))
        paths = os.pathsep.join([os.path.dirname(fake), os.environ.get("PYTHONPATH", "")])
        with Program([self.server, world, "__name:=second"], PYTHONPATH=paths,
                     XDG_CACHE_HOME=self.folder) as program:
            wait_for(lambda: "dividing mesh 1 of 1 (concave::l)" in program.text, "the work")
            started = wait_for(lambda: self.two(children_of(program.process.pid)),
                               "engine and work")
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)
            self.assertNotIn("Traceback", program.text)
            wait_for(lambda: not any(map(is_alive, started)), "the end of what it started")
            self.assertFalse(self.is_registered("/second"))

    def test_a_first_start_and_one_with_known_parts_give_equal_bits(self):
        self.world(NOTCH, "notch.obj")
        world = self.world(WORLD.format(FALLING))
        ends = []
        for is_known in (False, True):
            with Program([self.server, "-u", world, "__name:=second"],
                         XDG_CACHE_HOME=self.folder) as program:
                gazebo = support.Gazebo("/second", persistent=False)
                self.assertTrue(gazebo.step_world(1500).success)
                state = gazebo.get_model_state("concave", "")
                self.assertTrue(state.success)
                ends.append(support.numbers(state.pose))
                self.assertEqual("dividing mesh 1 of 1" in program.text, not is_known)
            rospy.delete_param("/second")
        self.assertLess(ends[0][2], 1.0)
        self.assertEqual(ends[0], ends[1])

    def test_a_control_c_during_the_imports_prints_no_traceback(self):
        for program in ("gzserver", "gazebo"):
            for moment in ("my_simulations.cli", "rosgraph_msgs", "my_simulations.formats"):
                with self.subTest(program=program, moment=moment):
                    self.assert_ends_quietly(executable("gazebo_ros", program), moment)

    def assert_ends_quietly(self, server, moment):
        """The whole group is interrupted, as in a terminal, when a module is first imported."""
        self.world(INTERRUPTING.format(moment), "sitecustomize.py")
        paths = os.pathsep.join([self.folder, os.environ.get("PYTHONPATH", "")])
        with Program([server, self.world(WORLD.format("")), "__name:=second"],
                     start_new_session=True, PYTHONPATH=paths) as program:
            self.assertIn(program.ended(), (0, -signal.SIGINT), program.text)
            self.assertNotIn("KeyboardInterrupt", program.text)
            self.assertNotIn("Traceback", program.text)

    def test_an_engine_does_not_outlive_a_killed_server(self):
        with Program([self.server, self.world(WORLD.format("")), "__name:=second"]) as program:
            pid = wait_for(lambda: rospy.get_param("/second/my_simulations/engine_pid", 0),
                           "the second server")
            program.process.kill()
            wait_for(lambda: not is_alive(pid), "the end of its engine")
        rospy.delete_param("/second")

    def test_a_second_node_of_the_name_is_refused_and_the_first_goes_on(self):
        with Program([self.server, "__name:=gazebo"]) as program:
            self.assertEqual(program.ended(), 1)
            self.assertIn("a node /gazebo is already running", program.text)
        before = self.gazebo.sim_time()
        wait_for(lambda: self.gazebo.sim_time() > before, "a step of the first node")

    def test_a_world_with_blanks_in_its_path_is_found_and_names_the_node(self):
        with Program([self.server, "-u", self.world(WORLD.format("")), "__name:=second"]):
            gazebo = support.Gazebo("/second")
            self.assertTrue(gazebo.is_paused())
            self.assertEqual(gazebo.sim_time(), 0.0)
            self.assertEqual(rospy.get_param("/second/world_base_name"), "a world")
        rospy.delete_param("/second")

    def assert_refused(self, *words, argument):
        """No node comes up; the reason is on standard error and on /rosout."""
        told = support.heard_on_rosout(words[0], node="/second")
        with Program([self.server, argument, "__name:=second"]) as program:
            told()
            self.assertEqual(program.ended(), 1)
            for word in words:
                self.assertIn(word, program.text)

    def test_the_empty_world_replaces_a_missing_file_and_a_folder_as_in_gazebo(self):
        for missing in (os.path.join(self.folder, "none.world"), self.folder):
            with Program([self.server, missing, "__name:=second"]) as server:
                self.assertEqual(support.Gazebo("/second").names(), ["ground_plane"])
                self.assertEqual(rospy.get_param("/second/world_base_name"), "empty")
                wait_for(lambda: missing in server.text, "the path that is missing")
            rospy.delete_param("/second")

    def test_a_world_file_that_is_cut_off_is_refused_with_its_line(self):
        path = self.world('<sdf version="1.5">\n<world name="w">\n<model name="m">\n<link')
        self.assert_refused(f"{path}:4", argument=path)

    def test_a_file_without_a_world_is_refused(self):
        path = self.world('<sdf version="1.5"></sdf>')
        self.assert_refused("no <world>", path, argument=path)

    def test_an_unknown_model_is_told_and_the_rest_of_the_world_loads(self):
        path = self.world(WORLD.format(
            "<include><uri>model://no_such_model</uri></include>"
            "<include><uri>model://ground_plane</uri></include>"))
        with Program([self.server, path, "__name:=second"]) as server:
            wait_for(lambda: "model://no_such_model" in server.text, "a word about the model")
            self.assertEqual(support.Gazebo("/second").names(), ["ground_plane"])
        rospy.delete_param("/second")

    def test_without_a_master_it_says_so_and_can_be_ended(self):
        uri = silent_uri()
        with Program([self.server], ROS_MASTER_URI=uri) as program:
            wait_for(lambda: uri in program.text, "a word about the master")
            wait_for(lambda: "roscore" in program.text, "what to do about it")
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)

    def test_a_bad_world_is_told_without_a_master_too(self):
        path = self.world('<sdf version="1.5"></sdf>')
        with Program([self.server, path], ROS_MASTER_URI=silent_uri()) as program:
            self.assertEqual(program.ended(), 1)
            self.assertIn(path, program.text)

    def test_a_new_master_is_told_everything_again(self):
        uri = silent_uri()
        start = ["rosmaster", "--core", "-p", uri.rpartition(":")[2]]
        graph = rosgraph.Master("/node_life", master_uri=uri)

        def mine():
            """Topics and services of the server, and its parameters."""
            state = [{name for name, nodes in kind if "/gazebo" in nodes}
                     for kind in graph.getSystemState()]
            return state, sorted(graph.getParam("/gazebo")["my_simulations"]), graph.getParam(
                "/use_sim_time")

        offered = {row.under("/gazebo") for row in interface.TABLE}
        parameters = {"/gazebo/time_step", "/gazebo/my_simulations/engine_pid"}

        def is_complete():
            """Whether the server has registered all and set its last parameter."""
            with contextlib.suppress(OSError, KeyError, rosgraph.MasterException):
                return offered <= set().union(*mine()[0]) and parameters <= set(
                    graph.getParamNames())

        def is_whole():
            with contextlib.suppress(OSError, KeyError, rosgraph.MasterException):
                return mine() == before

        with Program(start) as first, Program(
                [self.server, "-u", self.world(WORLD.format(""))], ROS_MASTER_URI=uri) as server:
            wait_for(is_complete, "the whole server")
            before = mine()
            service = graph.lookupService("/gazebo/get_world_properties")
            first.process.kill()
            first.process.wait()
            wait_for(lambda: "does not respond" in server.text, "a word about the loss")
            with Program(start):
                wait_for(is_whole, "everything on the new master")
                wait_for(lambda: "registered the node" in server.text, "a word about it")
                self.assertEqual(graph.lookupService("/gazebo/get_world_properties"), service)
                wait_for(lambda: self.has_param(graph, "/gazebo/time_step"), "the settings")
                server.interrupt()
                self.assertEqual(server.ended(), 0, server.text)
                wait_for(lambda: not self.is_there(graph, "/gazebo/pause_physics"), "its end")
            loss = server.text.partition("registered the node")[0]
            self.assertEqual(loss.count("does not respond"), 1)

    @staticmethod
    def is_there(graph, service):
        with contextlib.suppress(OSError, KeyError, rosgraph.MasterException):
            return bool(graph.lookupService(service))

    @staticmethod
    def has_param(graph, name):
        with contextlib.suppress(OSError, KeyError, rosgraph.MasterException):
            return graph.hasParam(name)

    def test_unknown_options_are_refused_with_the_usage(self):
        with Program([self.server, "--no-such-option"]) as program:
            self.assertEqual(program.ended(), 2)
            self.assertIn("usage: gzserver", program.text)

    def test_the_client_says_where_the_editor_is_and_ends_with_the_server(self):
        client = executable("gazebo_ros", "gzclient")
        with Program([self.server, "-u", self.world(WORLD.format(""))],
                     ROS_NAMESPACE="/shown") as server:
            self.assertEqual(support.Gazebo("/shown/gazebo").names(), [])
            with Program([client, "--verbose", "__name:=gazebo_gui", "__log:=x.log"],
                         ROS_NAMESPACE="/shown") as program:
                wait_for(lambda: "http://127.0.0.1:" in program.text, "the address")
                server.interrupt()
                self.assertEqual(program.ended(), 0, program.text)
        rospy.delete_param("/shown")

    def test_gazebo_is_server_and_editor_in_one(self):
        both = executable("gazebo_ros", "gazebo")
        with Program([both, "-u", self.world(WORLD.format("")), "__name:=second"]) as program:
            self.assertEqual(support.Gazebo("/second").names(), [])
            wait_for(lambda: "http://127.0.0.1:" in program.text, "the address")
            program.interrupt()
            self.assertEqual(program.ended(), 0)
        rospy.delete_param("/second")

    def test_a_node_can_live_in_a_namespace(self):
        world = self.world(WORLD.format(""))
        with Program([self.server, "-u", world], ROS_NAMESPACE="/deep/down"):
            self.assertEqual(support.Gazebo("/deep/down/gazebo").names(), [])
        rospy.delete_param("/deep")


if __name__ == "__main__":
    support.run("node_life")
