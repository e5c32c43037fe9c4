"""Requests that cannot be carried out: a clear answer, nothing half done, and the node goes on."""
import socket
import struct
from urllib.parse import urlparse

import rosgraph
import rospy
import support
from gazebo_msgs.msg import ModelState
from gazebo_msgs.srv import GetModelState, SpawnModel
from support import box, pose, twist

NAN = float("nan")
SDF = '<sdf version="1.6">{}</sdf>'
MESH = ('<robot name="r"><link name="l"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0"'
        ' iyy="1" iyz="0" izz="1"/></inertial><collision><geometry><mesh filename="{}"/></geometry>'
        "</collision></link></robot>")


class BadRequests(support.GazeboCase):
    def setUp(self):
        self.gazebo.clear()
        self.gazebo.unpause_physics()

    def tearDown(self):
        """Whatever was asked for, the world still runs and takes models."""
        before = self.gazebo.sim_time()
        support.wait_for(lambda: self.gazebo.sim_time() > before, "a step")
        self.assertTrue(self.gazebo.spawn("afterwards").success)

    def refused(self, answer, *words):
        self.assertFalse(answer.success)
        self.assertNotIn("internal error", answer.status_message)
        for word in words:
            self.assertIn(word, answer.status_message)

    def spawn_refused(self, xml, *words, name="bad", kind="spawn_urdf_model"):
        """Refused with these words, running and paused, and no trace of the model."""
        for prepare in (self.gazebo.unpause_physics, self.gazebo.pause_physics):
            prepare()
            before = self.gazebo.names()
            self.refused(getattr(self.gazebo, kind)(name, xml, "", pose(), ""),
                         "SpawnModel: ", *words)
            self.assertEqual(self.gazebo.names(), before)
        self.gazebo.unpause_physics()

    def spawn_warned(self, xml, *words):
        """Spawned as Gazebo does, with a warning in the log that holds each of these words."""
        warned = [support.heard_on_rosout(word) for word in words]
        self.done(self.gazebo.spawn_urdf_model("odd", xml, "", pose(), ""))
        self.assertIn("odd", self.gazebo.names())
        for heard in warned:
            heard()

    def test_xml_that_is_cut_off(self):
        self.spawn_refused(box()[:150], "model_xml")

    def test_no_xml_at_all(self):
        self.spawn_refused("spawn me a box", "model_xml")
        self.spawn_refused("", "model_xml")

    def test_sdf_for_the_urdf_service(self):
        self.spawn_refused(support.static_box_sdf(), "entity format is invalid", "<sdf>")

    def test_a_root_that_is_neither(self):
        self.spawn_refused("<model name='x'/>", "<model>", kind="spawn_sdf_model")

    def test_sdf_without_a_model(self):
        for inside in ("", "<world name='default'/>"):
            self.spawn_refused(SDF.format(inside), " no ", kind="spawn_sdf_model")

    def test_an_include_of_an_unknown_model_lists_the_places(self):
        xml = SDF.format("<world name='default'><include><uri>model://no_such_thing</uri></include>"
                         "</world>")
        self.spawn_refused(xml, "model://no_such_thing", ".gazebo/models",
                           kind="spawn_sdf_model")

    def test_a_missing_mesh(self):
        self.spawn_warned(MESH.format("package://my_simulations/none.dae"), "none.dae")

    def test_a_mesh_of_an_unknown_package(self):
        self.spawn_warned(MESH.format("package://no_such_package/a.dae"), "no_such_package")

    def test_sizes_that_are_no_sizes(self):
        for size in ("-1 1 1", "1 -0.5 1"):
            self.spawn_warned(box().replace("0.2 0.2 0.2", size), f"above 0, found {size}")
            self.assertTrue(self.gazebo.delete_model("odd").success)

    def test_a_mass_of_zero(self):
        self.spawn_warned(box(mass=0.0), "has no mass")

    def test_an_inertia_that_is_not_positive_definite(self):
        self.spawn_warned(box().replace('ixx="0.00', 'ixx="-1.00'), "not positive definite")

    def test_an_empty_name(self):
        self.spawn_refused(box(), "empty", name="")

    def test_a_name_that_is_taken(self):
        self.assertTrue(self.gazebo.spawn("taken", where=pose(1.0)).success)
        self.spawn_refused(box(), "entity already exists", name="taken")
        self.assertAlmostEqual(self.gazebo.get_model_state("taken", "").pose.position.x, 1.0, 2)

    def test_an_unknown_reference_frame(self):
        answer = self.gazebo.spawn("bad", frame="nowhere")
        self.refused(answer, "SpawnModel: ", "nowhere")
        self.assertNotIn("bad", self.gazebo.names())

    def test_numbers_that_are_not_finite(self):
        for where in (pose(NAN), pose(0.0, float("inf")), pose(0.0, 0.0, 0.0, NAN)):
            self.refused(self.gazebo.spawn("bad", where=where), "NaN or infinity")
        self.assertTrue(self.gazebo.spawn("good", where=pose(1.0)).success)
        self.refused(self.gazebo.place("good", pose(NAN)), "SetModelState: ", "NaN or infinity")
        self.refused(self.gazebo.place("good", pose(), twist((0.0, NAN, 0.0))), "NaN or infinity")
        self.refused(self.gazebo.place_link("good::body", pose(NAN)), "NaN or infinity")
        self.assertAlmostEqual(self.gazebo.get_model_state("good", "").pose.position.x, 1.0, 2)
        physics = self.gazebo.get_physics_properties()
        self.refused(self.gazebo.set_physics_properties(NAN, 1000.0, physics.gravity,
                                                        physics.ode_config), "time_step")
        self.refused(self.gazebo.set_physics_properties(0.0, 1000.0, physics.gravity,
                                                        physics.ode_config), "time_step")
        self.assertEqual(self.gazebo.get_physics_properties().time_step, 0.001)

    def test_bad_messages_on_the_topics_are_told_in_the_log(self):
        self.assertTrue(self.gazebo.spawn("good", where=pose(1.0, 0.0, 0.1)).success)
        topic = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=10)
        support.wait_for(topic.get_num_connections, "a connection to the topic")
        told = support.heard_on_rosout("SetModelState (topic): pose.position")
        topic.publish(ModelState("good", pose(NAN), twist(), ""))
        told()
        self.assertAlmostEqual(self.gazebo.get_model_state("good", "").pose.position.x, 1.0, 2)
        told = support.heard_on_rosout("no_such_model")
        topic.publish(ModelState("no_such_model", pose(), twist(), ""))
        told()

    def test_unknown_names_are_answered_with_similar_ones(self):
        self.assertTrue(self.gazebo.spawn("coffee_cup").success)
        self.refused(self.gazebo.get_model_state("cofee_cup", ""),
                     "GetModelState: model does not exist", "coffee_cup")
        self.refused(self.gazebo.get_model_properties("cofee_cup"),
                     "GetModelProperties: model does not exist", "coffee_cup")
        self.refused(self.gazebo.delete_model("cofee_cup"), "DeleteModel: model does not exist")
        self.refused(self.gazebo.place("cofee_cup", pose()),
                     "SetModelState: model does not exist")

    def test_unknown_links(self):
        self.refused(self.gazebo.get_link_state("ground_plane::none", ""),
                     "GetLinkState: link not found, ")
        self.refused(self.gazebo.place_link("none", pose()), "SetLinkState: link does not exist")

    def test_unknown_frames(self):
        self.refused(self.gazebo.get_model_state("ground_plane", "none"),
                     "GetModelState: reference relative_entity_name not found, ")
        self.refused(self.gazebo.get_link_state("ground_plane::link", "none"),
                     "GetLinkState: reference reference_frame not found, ")
        self.refused(self.gazebo.place("ground_plane", pose(), frame="none"),
                     "SetModelState: specified reference frame entity does not exist")

    def test_bytes_that_are_no_request_are_answered(self):
        with self.connection() as raw:
            raw.sendall(struct.pack("<I", 12) + b"\xff" * 12)
            ok, length = struct.unpack("<BI", self.received(raw, 5))
            self.assertEqual(ok, 0)
            self.assertIn("malformed request", self.received(raw, length).decode())

    def test_a_client_that_says_nothing_keeps_nobody_out(self):
        with self.socket():
            state = rospy.ServiceProxy("/gazebo/get_model_state", GetModelState)
            self.assertTrue(state("ground_plane", "").success)

    def test_a_handshake_that_is_no_handshake(self):
        with self.socket() as raw:
            raw.sendall(b"GET / HTTP/1.0\r\n\r\n")

    def test_a_client_that_hangs_up_in_the_middle(self):
        with self.connection() as raw:
            raw.sendall(struct.pack("<I", 100) + b"half")

    def test_a_request_of_another_type_is_refused(self):
        wrong = rospy.ServiceProxy("/gazebo/delete_model", SpawnModel)
        with self.assertRaises(rospy.ServiceException):
            wrong("a", "b", "c", pose(), "d")

    def connection(self):
        """A service connection to spawn_urdf_model after its handshake."""
        raw = self.socket()
        fields = [b"callerid=/raw", b"service=/gazebo/spawn_urdf_model",
                  b"md5sum=" + SpawnModel._md5sum.encode(), b"persistent=1"]
        header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
        raw.sendall(struct.pack("<I", len(header)) + header)
        (length,) = struct.unpack("<I", self.received(raw, 4))
        self.received(raw, length)
        return raw

    @staticmethod
    def socket():
        """A connection to the node before any handshake."""
        uri = urlparse(rosgraph.Master("/raw").lookupService("/gazebo/spawn_urdf_model"))
        return socket.create_connection((uri.hostname, uri.port), timeout=support.SECONDS)

    @staticmethod
    def received(raw, count):
        data = b""
        while len(data) < count:
            more = raw.recv(count - len(data))
            assert more, "the server hung up without an answer"
            data += more
        return data
