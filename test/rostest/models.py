"""Spawning, deleting, reading and moving models, in a running and in a paused world."""
import math

import rospy
import support
from gazebo_msgs.msg import LinkState, ModelState
from my_simulations_msgs.srv import SpawnObject
from support import numbers, pose, twist

PENDULUM = """<robot name="arm">
  <link name="base"><inertial><mass value="5"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="bob"><inertial><mass value="1"/><origin xyz="0 0 -1"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision name="bob_hull"><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="hinge" type="revolute"><parent link="base"/><child link="bob"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="10" velocity="10"/></joint></robot>"""


HIGH = 1000.0
"""Height in m from which a body falls for 14 s, however slow the test is."""
FREE_FALL = 4.9
"""Half of gravity, m/s^2."""


class Base:
    """The tests, for a world that runs and for one that is paused."""

    paused = False

    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()
        if self.paused:
            self.gazebo.pause_physics()

    def spawned(self, name, **more):
        answer = self.done(self.gazebo.spawn(name, **more))
        return answer

    def assert_near(self, found, wanted, delta=1e-6):
        self.assertEqual(len(found), len(wanted))
        for one, other in zip(found, wanted):
            self.assertAlmostEqual(one, other, delta=delta, msg=f"{found} is not {wanted}")

    def assert_fell(self, state, since):
        """A model has fallen from HIGH for no longer than since a moment of sim time."""
        seconds = self.gazebo.sim_time() - since + 0.001
        self.assertLessEqual(state.pose.position.z, HIGH + 1e-6)
        self.assertGreaterEqual(state.pose.position.z, HIGH - FREE_FALL * seconds ** 2 - 1e-6)

    def test_a_spawned_model_is_listed_last_when_the_answer_comes(self):
        for name in ("one", "two", "three"):
            answer = self.spawned(name)
            self.assertEqual(answer.status_message, "SpawnModel: Successfully spawned entity")
            self.assertEqual(self.gazebo.names()[-1], name)

    def test_a_deleted_model_is_not_listed_and_the_rest_keeps_its_order(self):
        for name in ("one", "two", "three"):
            self.spawned(name)
        answer = self.gazebo.delete_model("two")
        self.assertTrue(answer.success)
        self.assertEqual(answer.status_message, "DeleteModel: successfully deleted model")
        self.assertEqual(self.gazebo.names(), ["ground_plane", "one", "three"])
        self.spawned("two")
        self.assertEqual(self.gazebo.names()[-1], "two")

    def test_an_sdf_models_own_pose_is_composed_onto_the_requested_one(self):
        answer = self.gazebo.spawn_sdf_model(
            "block", support.static_box_sdf("1 0 0 0 0 0"), "", pose(0.0, 2.0, 0.5, math.pi / 2),
            "")
        self.assertTrue(answer.success, answer.status_message)
        state = self.gazebo.get_model_state("block", "world")
        half = math.sqrt(0.5)
        self.assert_near(numbers(state.pose), (0.0, 3.0, 0.5, 0.0, 0.0, half, half))
        self.assertTrue(self.gazebo.get_model_properties("block").is_static)

    def test_a_spawn_pose_is_in_the_frame_of_another_model(self):
        self.gazebo.spawn_sdf_model("block", support.static_box_sdf(), "",
                                    pose(1.0, 1.0, 0.5, math.pi / 2), "")
        for frame in ("block", "block::body"):
            self.assertTrue(self.gazebo.spawn_sdf_model(
                "placed", support.static_box_sdf("0 0 1 0 0 0"), "", pose(2.0), frame).success)
            state = self.gazebo.get_model_state("placed", "")
            self.assert_near(numbers(state.pose)[:3], (1.0, 3.0, 1.5))
            relative = self.gazebo.get_model_state("placed", frame)
            self.assert_near(numbers(relative.pose), (2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
            self.gazebo.delete_model("placed")

    def test_world_frames_have_four_names(self):
        self.spawned("one", where=pose(1.0, 2.0, 0.1))
        for literal in ("", "world", "map", "/map"):
            state = self.done(self.gazebo.get_model_state("one", literal))
            self.assertEqual(state.header.frame_id, literal)
            self.assert_near(numbers(state.pose)[:2], (1.0, 2.0), 1e-3)
        refused = self.gazebo.get_model_state("one", "/world")
        self.assertFalse(refused.success)
        self.assertIn("GetModelState: reference relative_entity_name not found,",
                      refused.status_message)

    def test_calls_are_counted_for_each_model(self):
        self.spawned("counted")
        first = self.gazebo.get_model_state("counted", "").header.seq
        self.gazebo.get_model_state("counted", "nowhere")
        self.gazebo.get_model_state("ground_plane", "")
        self.assertEqual(self.gazebo.get_model_state("counted", "").header.seq, first + 2)

    def test_stamps_are_sim_time(self):
        before = self.gazebo.sim_time()
        stamp = self.gazebo.get_model_state("ground_plane", "").header.stamp.to_sec()
        self.assertLessEqual(before, stamp + 1e-9)
        self.assertLessEqual(stamp, self.gazebo.sim_time() + 1e-9)

    def test_a_set_pose_shows_in_the_next_state(self):
        self.spawned("one")
        before = self.gazebo.sim_time()
        answer = self.gazebo.place("one", pose(3.0, -1.0, HIGH, 0.5))
        self.assertEqual(answer.status_message, "SetModelState: set model state done")
        state = self.gazebo.get_model_state("one", "")
        self.assert_near(numbers(state.pose)[:2] + numbers(state.pose)[3:],
                         (3.0, -1.0, 0.0, 0.0, math.sin(0.25), math.cos(0.25)))
        self.assert_fell(state, before)

    def test_a_pose_may_come_without_orientation(self):
        self.spawned("one")
        where = pose(1.0, 0.0, HIGH)
        where.orientation.w = 0.0
        self.assertTrue(self.gazebo.place("one", where).success)
        self.assert_near(numbers(self.gazebo.get_model_state("one", "").pose)[3:], (0, 0, 0, 1))

    def test_a_frame_turns_pose_and_twist(self):
        self.gazebo.spawn_sdf_model("block", support.static_box_sdf(), "",
                                    pose(1.0, 0.0, HIGH, math.pi / 2), "")
        self.spawned("one")
        before = self.gazebo.sim_time()
        self.gazebo.place("one", pose(1.0), twist((2.0, 0.0, 0.0), (0.0, 0.0, 1.0)), "block")
        state = self.gazebo.get_model_state("one", "")
        self.assert_fell(state, before)
        moved = 2.0 * (self.gazebo.sim_time() - before)
        self.assertAlmostEqual(state.pose.position.x, 1.0, delta=1e-3)
        self.assertAlmostEqual(state.pose.position.y, 1.0 + moved / 2, delta=moved / 2 + 1e-3)
        self.assert_near((state.twist.linear.x, state.twist.linear.y, state.twist.angular.z),
                         (0.0, 2.0, 1.0), 1e-3)
        relative = self.gazebo.get_model_state("one", "block")
        self.assert_near((relative.twist.linear.x, relative.twist.linear.y), (2.0, 0.0), 1e-3)

    def test_a_models_own_link_may_be_its_frame(self):
        self.gazebo.spawn_sdf_model("block", support.static_box_sdf(), "", pose(0.0, 0.0, 0.5), "")
        for _ in range(10):
            self.gazebo.place("block", pose(0.1), frame="block::body")
        self.assert_near(numbers(self.gazebo.get_model_state("block", "").pose)[:3],
                         (1.0, 0.0, 0.5))

    def test_links_are_found_by_scoped_and_by_plain_name(self):
        self.spawned("one", where=pose(1.0, 2.0, 0.1))
        for name in ("one::body", "body"):
            state = self.done(self.gazebo.get_link_state(name, "world"))
            self.assertEqual(state.link_state.link_name, name)
            self.assertEqual(state.link_state.reference_frame, "world")
            self.assert_near(numbers(state.link_state.pose)[:2], (1.0, 2.0), 1e-3)

    def test_a_plain_name_that_two_models_have_is_the_firsts_and_is_warned_about(self):
        link = f"twin_{type(self).__name__}"  # one that no other test case was warned about
        told = support.heard_on_rosout(f"have a link '{link}'")
        xml = support.box(link=link)
        self.spawned("one", xml=xml, where=pose(1.0, 2.0, 0.1))
        self.spawned("two", xml=xml, where=pose(3.0, 2.0, 0.1))
        for _ in range(3):
            state = self.done(self.gazebo.get_link_state(link, "world"))
            self.assert_near(numbers(state.link_state.pose)[:2], (1.0, 2.0), 1e-3)
        (line,) = told()
        self.assertIn("using that of 'one'", line.msg)

    def test_a_link_can_be_set(self):
        self.spawned("one")
        answer = self.gazebo.place_link("one::body", pose(0.0, 4.0, HIGH))
        self.assertEqual(answer.status_message, "SetLinkState: success")
        self.assert_near(numbers(self.gazebo.get_model_state("one", "").pose)[:2], (0.0, 4.0))

    def test_a_models_parts_are_listed_unscoped(self):
        self.spawned("arm", xml=PENDULUM, where=pose(0.0, 0.0, 3.0))
        found = self.gazebo.get_model_properties("arm")
        self.assertTrue(found.success)
        self.assertEqual(found.body_names, ["base", "bob"])
        self.assertEqual(found.canonical_body_name, "base")
        self.assertEqual(found.joint_names, ["hinge"])
        self.assertEqual(len(found.geom_names), 1)
        self.assertFalse(found.is_static)

    def test_a_model_can_be_replaced_in_one_step(self):
        self.spawned("one", where=pose(1.0, 0.0, 0.1))
        self.spawned("two")
        again = support.box(0.4, attributes='my_simulations_replace="true"')
        self.spawned("one", xml=again, where=pose(-2.0, 0.0, 0.2))
        self.assertEqual(sorted(self.gazebo.names()), ["ground_plane", "one", "two"])
        self.assertAlmostEqual(self.gazebo.get_model_state("one", "").pose.position.x, -2.0, 3)

    def test_an_object_can_be_replaced_in_one_step(self):
        spawn = rospy.ServiceProxy("/gazebo/spawn_object", SpawnObject)
        rospy.wait_for_service("/gazebo/spawn_object", support.SECONDS)
        self.spawned("one", where=pose(1.0, 0.0, 0.1))
        self.spawned("two")
        refused = spawn(model_name="one", model_xml=support.box(0.4))
        self.assertFalse(refused.success)
        self.assertIn("already exists", refused.status_message)
        faulty = spawn(model_name="one", model_xml="<robot name='x'><link name='l'/>"
                       "<link name='l'/></robot>", replace=True, file="/tmp/arm.urdf")
        self.assertFalse(faulty.success)
        self.assertIn("/tmp/arm.urdf:1", faulty.status_message)
        answer = spawn(model_name="one", model_xml=support.box(0.4), replace=True,
                       initial_pose=pose(-2.0, 0.0, 0.2))
        self.assertTrue(answer.success, answer.status_message)
        self.assertEqual(sorted(self.gazebo.names()), ["ground_plane", "one", "two"])
        self.assertAlmostEqual(self.gazebo.get_model_state("one", "").pose.position.x, -2.0, 3)

    def test_the_topics_do_what_the_services_do(self):
        self.spawned("one")
        models = rospy.Publisher("/gazebo/set_model_state", ModelState, queue_size=1)
        links = rospy.Publisher("/gazebo/set_link_state", LinkState, queue_size=1)
        support.wait_for(lambda: models.get_num_connections() and links.get_num_connections(),
                         "connections to the topics")
        models.publish(ModelState("one", pose(6.0, 0.0, 0.1), twist(), ""))
        support.wait_for(lambda: self.x("one") == 6.0, "the model at x = 6")
        links.publish(LinkState("one::body", pose(7.0, 0.0, 0.1), twist(), ""))
        support.wait_for(lambda: self.x("one") == 7.0, "the model at x = 7")

    def x(self, name):
        return round(self.gazebo.get_model_state(name, "").pose.position.x, 3)

    def test_physics_can_be_set_and_read_back(self):
        before = self.gazebo.get_physics_properties()
        changed = self.gazebo.get_physics_properties()
        changed.gravity.x, changed.gravity.z = 0.5, -1.6
        config = changed.ode_config
        config.sor_pgs_w, config.max_contacts, config.sor_pgs_rms_error_tol = 1.25, 7, 0.25
        config.auto_disable_bodies = True
        try:
            answer = self.gazebo.set_physics_properties(0.002, 500.0, changed.gravity, config)
            self.assertTrue(answer.success, answer.status_message)
            after = self.gazebo.get_physics_properties()
            self.assertEqual((after.time_step, after.max_update_rate), (0.002, 500.0))
            self.assertEqual(after.gravity, changed.gravity)
            self.assertEqual(after.ode_config, config)
            self.assertEqual(after.pause, self.paused)
        finally:
            self.gazebo.set_physics_properties(before.time_step, before.max_update_rate,
                                               before.gravity, before.ode_config)

    def test_reset_world_puts_models_back_and_keeps_the_time(self):
        self.spawned("one", where=pose(1.0, 0.0, 0.1))
        self.gazebo.place("one", pose(5.0, 0.0, 2.0), twist((1.0, 0.0, 0.0)))
        before = self.gazebo.sim_time()
        self.gazebo.reset_world()
        self.assertAlmostEqual(self.gazebo.get_model_state("one", "").pose.position.x, 1.0, 3)
        self.assertGreaterEqual(self.gazebo.sim_time(), before)

    def test_reset_simulation_sets_the_time_back_and_keeps_spawned_models(self):
        self.spawned("one", where=pose(1.0, 0.0, 0.1))
        self.gazebo.place("one", pose(5.0, 0.0, 2.0))
        before = self.gazebo.sim_time()
        self.gazebo.reset_simulation()
        self.assertLess(self.gazebo.sim_time(), before)
        self.assertIn("one", self.gazebo.names())
        self.assertAlmostEqual(self.gazebo.get_model_state("one", "").pose.position.x, 1.0, 3)
        self.assertEqual(self.gazebo.is_paused(), self.paused)


class Running(Base, support.GazeboCase):
    def test_a_dropped_box_comes_to_rest_on_the_ground(self):
        self.spawned("one", where=pose(0.0, 0.0, 1.0))
        support.wait_for(lambda: abs(self.gazebo.z("one") - 0.1) < 0.005, "the box on the ground")

    def test_pausing_stops_the_time_and_going_on_continues_it(self):
        self.gazebo.pause_physics()
        self.gazebo.pause_physics()
        stopped = self.gazebo.sim_time()
        self.assertEqual(self.gazebo.sim_time(), stopped)
        self.gazebo.unpause_physics()
        support.wait_for(lambda: self.gazebo.sim_time() > stopped, "a step")


class Paused(Base, support.GazeboCase):
    paused = True

    def test_nothing_moves_and_no_time_passes(self):
        self.spawned("one", where=pose(0.0, 0.0, 1.0))
        before = self.gazebo.sim_time()
        self.gazebo.place("one", pose(0.0, 0.0, 2.0), twist((0.0, 0.0, 1.0)))
        self.assertEqual(self.gazebo.z("one"), 2.0)
        self.assertEqual(self.gazebo.sim_time(), before)
