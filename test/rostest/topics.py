"""/clock, model_states and link_states."""
import time

import rospy
import support
from gazebo_msgs.msg import LinkStates, ModelStates
from rosgraph_msgs.msg import Clock
from support import Collected, numbers, pose, twist

from my_simulations.ros.topics.publish_pacing import BURST, CLOCK_MESSAGES_PER_SECOND

STEP_NS = 1000000


def times(clock):
    """What has come on /clock, in nanoseconds."""
    return [message.clock.to_nsec() for message in clock.all()]


def fallen(heard):
    """The times that are less than the one before."""
    return [b for a, b in zip(heard, heard[1:]) if b < a]


def longest_row(steps):
    """The most messages one after the other that each show the step after the one before."""
    longest = row = 0
    for before, after in zip(steps, steps[1:]):
        row = row + 1 if round(after - before) == 1 else 0
        longest = max(longest, row)
    return longest


class Topics(support.GazeboCase):
    def setUp(self):
        self.gazebo.unpause_physics()
        self.gazebo.clear()
        self.listeners = []

    def tearDown(self):
        for listener in self.listeners:
            listener.close()

    def listen(self, topic, message_class):
        self.listeners.append(Collected(topic, message_class))
        return self.listeners[-1]

    def set_rate(self, rate):
        physics = self.gazebo.get_physics_properties()
        self.assertTrue(self.gazebo.set_physics_properties(
            physics.time_step, rate, physics.gravity, physics.ode_config).success)

    def test_the_clock_shows_every_step_once_and_in_order(self):
        # Slowly: a node that got no processor for long leaves steps out, so as to catch up.
        self.set_rate(250.0)
        self.addCleanup(self.set_rate, 1000.0)
        clock = self.listen("/clock", Clock)
        support.wait_for(lambda: len(times(clock)) > 500, "500 steps")
        heard = times(clock)
        gaps = [b - a for a, b in zip(heard, heard[1:])]
        self.assertEqual(set(gaps), {STEP_NS})

    def test_faster_than_real_time_the_clock_is_thinned_and_never_goes_back(self):
        self.set_rate(0.0)
        began = time.monotonic()
        try:
            clock = self.listen("/clock", Clock)
            support.wait_for(lambda: len(times(clock)) > 1000, "1000 messages")
        finally:
            self.set_rate(1000.0)
        heard = times(clock)
        most = BURST + CLOCK_MESSAGES_PER_SECOND * (time.monotonic() - began)
        self.assertTrue(all(b > a for a, b in zip(heard, heard[1:])))
        self.assertLessEqual(len(heard), most)

    def test_the_clock_is_silent_while_paused_and_then_goes_on(self):
        clock = self.listen("/clock", Clock)
        support.wait_for(lambda: times(clock), "a clock")
        self.gazebo.pause_physics()
        stopped = round(self.gazebo.sim_time() * 1e9)
        support.wait_for(lambda: times(clock)[-1] == stopped, "the last step")
        clock.clear()
        self.gazebo.place("ground_plane", pose())
        self.assertEqual(times(clock), [])
        self.gazebo.unpause_physics()
        support.wait_for(lambda: times(clock), "a clock")
        self.assertEqual(times(clock)[0], stopped + STEP_NS)

    def test_a_reset_sets_the_clock_back_at_once(self):
        # Slowly: the first message after the reset may come late.
        self.set_rate(100.0)
        self.addCleanup(self.set_rate, 1000.0)
        clock = self.listen("/clock", Clock)
        support.wait_for(lambda: times(clock) and times(clock)[-1] > 50 * STEP_NS, "50 steps")
        self.gazebo.reset_simulation()
        support.wait_for(lambda: fallen(times(clock)), "a time that went back")
        self.assertLess(fallen(times(clock))[0], 50 * STEP_NS)
        support.wait_for(lambda: times(clock)[-1] > 100 * STEP_NS, "time going on")
        self.assertEqual(len(fallen(times(clock))), 1)

    def test_model_states_are_gazebos(self):
        self.assertTrue(self.gazebo.spawn("one", where=pose(1.0, 2.0, 0.1)).success)
        self.assertTrue(self.gazebo.spawn("two", where=pose(3.0, 4.0, 50.0)).success)
        self.gazebo.pause_physics()
        self.gazebo.place("two", pose(3.0, 4.0, 50.0, 0.5), twist((1.0, 2.0, 3.0), (0.0, 0.0, 4.0)))
        models = self.listen("/gazebo/model_states", ModelStates)
        links = self.listen("/gazebo/link_states", LinkStates)
        found = support.wait_for(lambda: [message for message in models.all() if len(
            message.twist) == 3 and message.twist[2].linear.y == 2.0], "model states")[-1]
        self.assertEqual(found.name, ["ground_plane", "one", "two"])
        for name, where, motion in zip(found.name, found.pose, found.twist):
            state = self.gazebo.get_model_state(name, "")
            self.assertEqual(numbers(where), numbers(state.pose))
            self.assertEqual(motion, state.twist)
        found = support.wait_for(lambda: [message for message in links.all() if len(
            message.twist) == 3 and message.twist[2].linear.y == 2.0], "link states")[-1]
        self.assertEqual(found.name, ["ground_plane::link", "one::body", "two::body"])
        self.assertEqual(len(found.pose), 3)
        self.assertEqual(found.twist[0].linear.x, 0.0)

    def test_states_come_at_every_step(self):
        # Slowly, so that the node can keep up on a busy machine, too: a row of steps without a gap
        # comes some time. The speed of the falling body identifies the step of a message.
        self.assertTrue(self.gazebo.spawn("one", where=pose(0.0, 0.0, 1000.0)).success)
        physics = self.gazebo.get_physics_properties()
        gained = -physics.gravity.z * physics.time_step
        self.set_rate(100.0)
        try:
            models = self.listen("/gazebo/model_states", ModelStates)
            support.wait_for(lambda: longest_row(
                [-message.twist[1].linear.z / gained for message in models.all()]) >= 100,
                "states of 100 steps in a row")
        finally:
            self.set_rate(1000.0)

    def test_a_listener_of_a_paused_world_hears_it_at_once_and_each_change_after(self):
        self.gazebo.pause_physics()
        models = self.listen("/gazebo/model_states", ModelStates)
        support.wait_for(models.all, "the first message")
        self.gazebo.spawn("one", where=pose(1.0, 0.0, 1.0))
        support.wait_for(lambda: models.all()[-1].name == ["ground_plane", "one"], "the spawn")
        self.gazebo.place("one", pose(2.0, 0.0, 1.0))
        support.wait_for(lambda: models.all()[-1].pose[1].position.x == 2.0, "the move")
        self.gazebo.delete_model("one")
        support.wait_for(lambda: models.all()[-1].name == ["ground_plane"], "the delete")
        self.assertLess(len(models.all()), 12)

    def test_a_deleted_model_leaves_and_a_new_one_comes_last(self):
        models = self.listen("/gazebo/model_states", ModelStates)
        for name in ("one", "two"):
            self.gazebo.spawn(name, where=pose(1.0, 0.0, 1.0))
        self.gazebo.delete_model("one")
        self.gazebo.spawn("one", where=pose(3.0, 0.0, 1.0))
        support.wait_for(lambda: models.all() and models.all()[-1].name
                         == ["ground_plane", "two", "one"], "the new order")

    def test_wait_for_message_works_on_every_topic(self):
        for topic, message_class in (("/clock", Clock), ("/gazebo/model_states", ModelStates),
                                     ("/gazebo/link_states", LinkStates)):
            for _ in range(3):
                rospy.wait_for_message(topic, message_class, timeout=support.SECONDS)
