#!/usr/bin/env python3
"""The world editor of a live node: it and the ROS interface show one world."""
import asyncio
import os
import signal
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(HERE, os.pardir, "unit", "support"))

import aiohttp
import rospkg
import rospy
import support
from editor_case import Browser
from free_ports import silent_uri
from support import Program, executable, wait_for

from my_simulations.editor.transport import address_file

WORLD = '<sdf version="1.7"><world name="default">{}</world></sdf>'
BALL = ("<sdf version='1.7'><model name='ball'><link name='link'><collision name='c'><geometry>"
        "<sphere><radius>0.5</radius></sphere></geometry></collision></link></model></sdf>")


def browse(url, scenario):
    """Run a coroutine with a browser that has the world."""
    async def run():
        async with aiohttp.ClientSession() as session:
            return await scenario(await Browser.open(session, url))

    return asyncio.run(run())


async def position(gazebo, name):
    """Where ROS says that a model is."""
    loop = asyncio.get_running_loop()
    state = await loop.run_in_executor(None, lambda: gazebo.get_model_state(model_name=name))
    point = state.pose.position
    return (round(point.x, 3), round(point.y, 3), round(point.z, 3))


class EditorNode(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.started = time.time()
        cls.gazebo = support.Gazebo(persistent=False)
        cls.public = wait_for(lambda: rospy.get_param("/gazebo/my_simulations/editor_url", ""),
                              "the editor")
        cls.url = address_file.with_token(cls.public)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def opened(self, node):
        """The whole address of the editor of a node with this test's folder as its cache."""
        url = support.Gazebo(node, persistent=False).open_editor().url
        return address_file.with_token(url, os.path.join(self.folder, "my_simulations"))

    def world(self, text=""):
        path = os.path.join(self.folder, "a.world")
        with open(path, "w", encoding="utf-8") as file:
            file.write(WORLD.format(text))
        return path

    def test_an_insert_and_a_move_are_seen_by_ros_when_they_are_answered(self):
        async def edit(browser):
            name = (await browser.edit("insert", shape="box", pose=[4, 0, 0.5, 0, 0, 0, 1]))["name"]
            self.assertIn(name, self.gazebo.names())
            await browser.edit("move", poses={name: [5, 1, 0.5, 0, 0, 0, 1]})
            self.assertEqual((await position(self.gazebo, name))[:2], (5.0, 1.0))
            await browser.ask("undo")
            self.assertEqual((await position(self.gazebo, name))[:2], (4.0, 0.0))
            await browser.ask("undo")
            self.assertNotIn(name, self.gazebo.names())

        browse(self.url, edit)

    def test_what_ros_does_is_seen_by_the_page(self):
        async def watch(browser):
            loop = asyncio.get_running_loop()
            await loop.run_in_executor(None, lambda: self.gazebo.spawn_sdf_model(
                model_name="ball", model_xml=BALL))
            await browser.until(lambda: browser.model("ball"))
            await browser.until(lambda: browser.link_pose("ball"))
            await loop.run_in_executor(None, lambda: self.gazebo.delete_model(model_name="ball"))
            await browser.until(lambda: not browser.model("ball"))

        browse(self.url, watch)

    def test_a_dragged_body_hangs_in_the_air_until_it_is_put_down(self):
        async def drag(browser):
            name = (await browser.edit("insert", shape="sphere"))["name"]
            high = [8, 0, 5, 0, 0, 0, 1]
            await browser.notify("drag", names=[name], poses=[high])
            await browser.until(lambda: (browser.link_pose(name) or [0, 0, 0])[2] > 4.9)
            await browser.ask("watch", topics=["plot:sim_time"])
            await browser.until(lambda: browser.last("watch"))
            start = browser.last("watch")["value"]
            await browser.until(lambda: browser.last("watch")["value"] > start + 0.5)
            self.assertEqual(await position(self.gazebo, name), (8.0, 0.0, 5.0))
            await browser.edit("move", poses={name: high})
            await browser.until(lambda: browser.link_pose(name)[2] < 4.5)
            await browser.edit("delete", names=[name])

        browse(self.url, drag)

    def test_contacts_name_the_links_that_touch(self):
        async def touch(browser):
            name = (await browser.edit("insert", shape="box", pose=[0, 9, 0.5, 0, 0, 0, 1]))["name"]
            await browser.ask("watch", topics=["contacts"])
            await browser.until(lambda: browser.last("watch") and any(
                f"{name}::link" in (one["a"], one["b"])
                for one in browser.last("watch")["contacts"]))
            await browser.edit("delete", names=[name])

        browse(self.url, touch)

    def test_the_service_tells_the_same_address(self):
        self.assertEqual(self.gazebo.open_editor().url, self.public)

    def test_what_others_can_read_holds_no_token(self):
        token = self.url.partition("?token=")[2]
        self.assertGreaterEqual(len(token), 20)
        master = rospy.get_master()
        self.assertNotIn(token, str(master.getParam("/")[2]))
        answer = self.gazebo.open_editor()
        self.assertNotIn(token, answer.url + answer.status_message)
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/cmdline", "rb") as stream:
                    self.assertNotIn(token.encode(), stream.read(), pid)
            except OSError:
                continue
        logs = [path for path in map(str, Path(rospkg.get_log_dir()).rglob("*.log"))
                if os.path.getmtime(path) > self.started]
        self.assertTrue(logs)
        for path in logs:
            with open(path, "rb") as stream:
                self.assertNotIn(token.encode(), stream.read(), path)

    def test_without_a_wish_for_it_nothing_of_the_editor_is_loaded(self):
        server = executable("gazebo_ros", "gzserver")
        with Program([server, self.world(), "__name:=plain"]) as program:
            gazebo = support.Gazebo("/plain", persistent=False)
            self.assertEqual(gazebo.names(), [])
            maps = f"/proc/{program.process.pid}/maps"
            with open(maps, encoding="utf-8") as file:
                self.assertNotIn("aiohttp", file.read())
            self.assertFalse(rospy.has_param("/plain/my_simulations/editor_url"))
            url = gazebo.open_editor().url
            self.assertEqual(rospy.get_param("/plain/my_simulations/editor_url"), url)
            with open(maps, encoding="utf-8") as file:
                self.assertIn("aiohttp", file.read())
            program.interrupt()
            self.assertEqual(program.ended(), 0)
        rospy.delete_param("/plain")

    def test_edits_outlive_a_node_that_is_killed(self):
        server = executable("gazebo_ros", "gzserver")
        world = self.world()
        cache = os.path.join(self.folder, "my_simulations", "autosave")

        def entries():
            return [name for name in os.listdir(cache) if name.endswith(".json")] \
                if os.path.isdir(cache) else []

        async def edit(browser):
            await browser.edit("insert", shape="cylinder")

        async def restore(browser):
            await browser.until(lambda: browser.last("autosave"))
            await browser.ask("autosave", action="restore")
            await browser.until(lambda: browser.model("unit_cylinder"))

        with Program([server, world, "__name:=doomed"], XDG_CACHE_HOME=self.folder) as program:
            browse(self.opened("/doomed"), edit)
            wait_for(entries, "the autosave")
            program.process.send_signal(signal.SIGKILL)
            program.process.wait()
        with Program([server, world, "__name:=doomed"], XDG_CACHE_HOME=self.folder) as program:
            browse(self.opened("/doomed"), restore)
            program.interrupt()
            self.assertEqual(program.ended(), 0)
        rospy.delete_param("/doomed")

    def test_gazebo_runs_a_world_and_its_editor_without_ros(self):
        program = Program([executable("gazebo_ros", "gazebo"), self.world()],
                          ROS_MASTER_URI=silent_uri())
        with program:
            url = wait_for(lambda: program.text.partition("editor is at ")[2].partition("\n")[0],
                           "the address").strip()

            async def edit(browser):
                await browser.edit("insert", shape="box", pose=[0, 0, 5, 0, 0, 0, 1])
                await browser.until(lambda: (browser.link_pose("unit_box") or [0, 0, 9])[2] < 4.5)

            browse(url, edit)
            program.interrupt()
            self.assertEqual(program.ended(), 0, program.text)


if __name__ == "__main__":
    support.run("editor_node")
