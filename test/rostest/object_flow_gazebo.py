#!/usr/bin/env python3
"""The object tools with a server that offers Gazebo's services and none of our extensions."""
import os
import sys
import threading
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import object_flow_support as flow
import rospy
import support
from gazebo_msgs import srv


class Server:
    """Records what it is asked; a world is a list of names."""

    def __init__(self, node):
        self.models = ["ball"]
        self.calls = []
        self.refuse = ""
        self.go_on = threading.Event()
        self.go_on.set()
        for name, kind, handler in (
                ("get_world_properties", srv.GetWorldProperties, self.world),
                ("spawn_urdf_model", srv.SpawnModel, self.spawn_urdf),
                ("spawn_sdf_model", srv.SpawnModel, self.spawn_sdf),
                ("delete_model", srv.DeleteModel, self.delete)):
            rospy.Service(f"{node}/{name}", kind, handler)

    def world(self, _request):
        return srv.GetWorldPropertiesResponse(model_names=self.models, success=True)

    def spawn_urdf(self, request):
        return self.spawn("urdf", request)

    def spawn_sdf(self, request):
        return self.spawn("sdf", request)

    def spawn(self, kind, request):
        self.go_on.wait()
        self.calls.append((kind, request))
        if self.refuse:
            return srv.SpawnModelResponse(success=False, status_message=self.refuse)
        self.models.append(request.model_name)
        return srv.SpawnModelResponse(success=True, status_message="SpawnModel: done")

    def delete(self, request):
        self.calls.append(("delete", request))
        self.models.remove(request.model_name)
        return srv.DeleteModelResponse(success=True, status_message="DeleteModel: done")


class OtherServer(flow.ToolCase, unittest.TestCase):
    def setUp(self):
        self.node = f"/{self._testMethodName}"
        self.server = Server(self.node)

    def tearDown(self):
        self.server.go_on.set()

    def run_here(self, *words, status=0):
        return self.run_tool(*words, "--gazebo-namespace", self.node, status=status)

    def test_an_object_already_there_is_deleted_and_spawned_again(self):
        self.run_here("spawn_object.py", "ball")
        self.assertEqual([kind for kind, _ in self.server.calls], ["delete", "urdf"])
        request = self.server.calls[1][1]
        self.assertNotIn("my_simulations_replace", request.model_xml)
        self.assertEqual((request.model_name, request.robot_namespace, request.reference_frame),
                         ("ball", "", ""))
        at = request.initial_pose
        self.assertEqual((at.position.x, at.position.y, at.position.z), (1.0, 2.0, 3.0))
        self.assertEqual(at.orientation.w, 1.0)

    def test_an_sdf_object_goes_to_the_sdf_service(self):
        self.run_here("spawn_object.py", "barrel")
        self.assertEqual([kind for kind, _ in self.server.calls], ["sdf"])

    def test_a_refusal_fails_with_the_servers_words_and_the_rest_goes_on(self):
        self.server.refuse = "SpawnModel: not today"
        text = self.run_here("spawn_object.py", "barrel", "ball", status=1)
        self.assertEqual(text.count("SpawnModel: not today"), 2)

    def test_a_service_that_never_answers_ends_at_the_deadline_that_is_named(self):
        self.server.go_on.clear()
        # Long enough for the answers that do come.
        text = self.run_here("spawn_object.py", "barrel", "--timeout", "4", status=1)
        self.assertIn(f"service {self.node}/spawn_sdf_model did not respond within 4 s", text)


if __name__ == "__main__":
    support.run("object_flow_gazebo")
