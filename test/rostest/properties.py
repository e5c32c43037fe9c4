"""Properties of lights, links, joints and physics: set values are read back and take effect."""
import math

import rospy
import support
from dynamic_reconfigure.client import Client
from gazebo_msgs.msg import PerformanceMetrics
from geometry_msgs.msg import Vector3
from support import Collected, box, pose, srv

from my_simulations.ros.services.physics_parameters import PARAMETERS

LAMP = ('<sdf version="1.6"><!-- a lamp --><light name="any" type="point"><pose>0 0 1 0 0 0</pose>'
        '<diffuse>0.5 0.5 0.5 1</diffuse><attenuation><constant>0.3</constant></attenuation>'
        '</light></sdf>')

LIMB = ('<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        '</inertial>')
ARM = ('<robot name="arm"><link name="world"/>'
       + "".join(f'<link name="{link}">{LIMB}</link>' for link in ("upper", "lower", "slide"))
       + '<joint name="shoulder" type="revolute"><origin xyz="0 5 2"/><parent link="world"/>'
         '<child link="upper"/><axis xyz="0 0 1"/><dynamics damping="0.7"/>'
         '<limit lower="-1" upper="2" effort="50" velocity="9"/></joint>'
         '<joint name="wrist" type="continuous"><parent link="upper"/><child link="lower"/>'
         '<axis xyz="0 0 1"/></joint>'
         '<joint name="rail" type="prismatic"><parent link="lower"/><child link="slide"/>'
         '<axis xyz="1 0 0"/><limit lower="0" upper="1" effort="50" velocity="9"/></joint>'
         '</robot>')


class Properties(support.GazeboCase):
    def setUp(self):
        self.gazebo.clear()
        self.gazebo.pause_physics()

    def near(self, found, wanted, delta=1e-6):
        self.assertEqual(len(found), len(wanted))
        for one, other in zip(found, wanted):
            self.assertAlmostEqual(one, other, delta=delta)

    # -- lights

    def light(self, name="lamp"):
        found = self.done(self.gazebo.get_light_properties(name))
        return (round(found.diffuse.r, 4), found.attenuation_constant, found.attenuation_linear,
                found.attenuation_quadratic)

    def test_lights_come_change_and_go(self):
        self.done(self.gazebo.spawn_sdf_model("lamp", LAMP, "", pose(1.0), ""))
        self.assertEqual(self.light(), (0.5, 0.3, 1.0, 0.0))
        self.assertNotIn("lamp", self.gazebo.names())
        request = srv.SetLightPropertiesRequest(light_name="lamp")
        request.diffuse.r, request.diffuse.a = 0.25, 1.0
        self.done(self.gazebo.set_light_properties(request))
        self.assertEqual(self.light(), (0.25, 0.3, 1.0, 0.0))
        request = srv.SetLightPropertiesRequest(light_name="lamp", attenuation_linear=0.75)
        self.done(self.gazebo.set_light_properties(request))
        self.assertEqual(self.light(), (0.25, 0.0, 0.75, 0.0))
        self.done(self.gazebo.delete_light("lamp"))
        self.assertFalse(self.gazebo.get_light_properties("lamp").success)

    def test_the_sun_of_the_empty_world_is_a_light(self):
        self.assertEqual(self.light("sun"), (0.8, 0.9, 0.01, 0.001))

    # -- links

    def test_mass_and_inertia_reach_the_engine(self):
        self.done(self.gazebo.spawn("a", box(mass=1.0), pose(0.0, 0.0, 9.0)))
        self.done(self.gazebo.set_link_properties(srv.SetLinkPropertiesRequest(
            link_name="a::body", mass=4.0, ixx=0.5, iyy=0.5, izz=0.5, gravity_mode=False)))
        found = self.done(self.gazebo.get_link_properties("body"))
        self.assertEqual((found.mass, found.ixx, found.gravity_mode), (4.0, 0.5, False))
        request = srv.ApplyBodyWrenchRequest(body_name="a::body",
                                             duration=rospy.Duration(0, 10 ** 7))
        request.wrench.force.x, request.wrench.torque.z = 400.0, 5.0
        self.done(self.gazebo.apply_body_wrench(request))
        self.done(self.gazebo.step_world(20))
        twist = self.gazebo.get_model_state("a", "").twist
        self.near([twist.linear.x, twist.linear.z, twist.angular.z], [1.0, 0.0, 0.1])

    def test_gravity_and_the_centre_of_mass_reach_the_engine(self):
        self.done(self.gazebo.spawn("a", box(mass=1.0), pose(0.0, 0.0, 9.0)))
        request = srv.SetLinkPropertiesRequest(link_name="a::body", mass=1.0, ixx=1.0, iyy=1.0,
                                               izz=1.0, gravity_mode=True)
        request.com.position.x = 0.25
        self.done(self.gazebo.set_link_properties(request))
        self.assertEqual(self.gazebo.get_link_properties("a::body").com.position.x, 0.25)
        push = srv.ApplyBodyWrenchRequest(body_name="a::body", reference_frame="a::body",
                                          duration=rospy.Duration(0, 10 ** 6))
        push.wrench.force.y = 100.0
        self.done(self.gazebo.apply_body_wrench(push))
        self.done(self.gazebo.step_world(1))
        twist = self.gazebo.get_model_state("a", "").twist
        self.near([twist.linear.z, twist.angular.z], [-0.0098, -0.25 * 100.0 * 0.001])

    # -- joints

    def test_joints_tell_their_kind_damping_and_position(self):
        self.done(self.gazebo.spawn("arm", ARM))
        kinds = srv.GetJointPropertiesResponse
        for name, kind, damping in (("shoulder", kinds.REVOLUTE, 0.7),
                                    ("arm::wrist", kinds.CONTINUOUS, 0.0),
                                    ("arm::rail", kinds.PRISMATIC, 0.0)):
            found = self.done(self.gazebo.get_joint_properties(name))
            self.assertEqual((found.type, list(found.damping), len(found.position),
                              len(found.rate)), (kind, [damping], 1, 1))

    def test_a_configuration_puts_joints_within_their_limits(self):
        self.done(self.gazebo.spawn("arm", ARM))
        answer = self.done(self.gazebo.set_model_configuration(
            "arm", "", ["shoulder", "arm::wrist", "rail", "tail", "shoulder"],
            [0.1, -3.0, 7.0, 1.0, 0.5]))
        self.assertIn("tail", answer.status_message)
        positions = [self.gazebo.get_joint_properties(name).position[0]
                     for name in ("shoulder", "wrist", "rail")]
        self.near(positions, [0.5, -3.0, 1.0])
        slide = self.gazebo.get_link_state("arm::slide", "arm::lower").link_state.pose.position
        self.near([slide.x, slide.y], [1.0, 0.0])

    def test_damping_and_stops_of_a_joint_act(self):
        self.done(self.gazebo.spawn("arm", ARM))
        request = srv.SetJointPropertiesRequest(joint_name="arm::rail")
        config = request.ode_joint_config
        config.hiStop, config.loStop, config.damping = [0.2], [0.0], [0.5]
        config.fudge_factor = [1.0]
        answer = self.done(self.gazebo.set_joint_properties(request))
        self.assertIn("not supported by Bullet: fudge_factor", answer.status_message)
        self.assertEqual(list(self.gazebo.get_joint_properties("rail").damping), [0.5])
        self.done(self.gazebo.apply_joint_effort("arm::rail", 40.0, rospy.Time(),
                                                 rospy.Duration(-1)))
        self.done(self.gazebo.step_world(2000))
        self.near(self.gazebo.get_joint_properties("rail").position, [0.2], 0.01)
        self.gazebo.clear_joint_forces("rail")

    def test_a_joint_without_axis_has_no_position(self):
        fixed = ARM.replace('name="wrist" type="continuous"', 'name="wrist" type="fixed"')
        keep = '<gazebo reference="wrist"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
        self.done(self.gazebo.spawn("arm", fixed.replace("</robot>", keep + "</robot>")))
        found = self.done(self.gazebo.get_joint_properties("wrist"))
        self.assertEqual(found.type, srv.GetJointPropertiesResponse.FIXED)
        self.assertTrue(math.isnan(found.position[0]))
        self.assertEqual(list(found.rate), [0.0])

    # -- dynamic_reconfigure

    def test_dynamic_reconfigure_changes_and_hears_of_changes(self):
        heard = []
        client = Client("/gazebo", timeout=support.SECONDS, config_callback=heard.append)
        described = {row["name"]: row for row in client.get_parameter_descriptions()}
        self.assertEqual(sorted(described), sorted(parameter.name for parameter in PARAMETERS))
        self.assertEqual((described["gravity_z"]["default"], described["gravity_z"]["min"],
                          described["gravity_z"]["max"]), (-9.8, -100.0, 100.0))
        support.wait_for(lambda: heard, "the first update")
        self.assertEqual(heard[-1]["gravity_z"], -9.8)
        answer = client.update_configuration({"gravity_z": -1.5, "sor_pgs_iters": 20000})
        self.assertEqual((answer["gravity_z"], answer["sor_pgs_iters"]), (-1.5, 10000))
        physics = self.gazebo.get_physics_properties()
        self.assertEqual((physics.gravity.z, physics.ode_config.sor_pgs_iters), (-1.5, 10000))
        support.wait_for(lambda: heard[-1]["gravity_z"] == -1.5, "the update")
        physics.ode_config.sor_pgs_iters = 50
        self.done(self.gazebo.set_physics_properties(0.001, 1000.0, Vector3(0.0, 0.0, -9.8),
                                                     physics.ode_config))
        support.wait_for(lambda: heard[-1]["gravity_z"] == -9.8, "the change by the service")
        support.wait_for(lambda: rospy.get_param("/gazebo/gravity_z", None) == -9.8,
                         "the parameter")
        client.close()

    # -- metrics

    def test_metrics_tell_how_fast_the_world_runs_and_are_silent_while_paused(self):
        metrics = Collected("/gazebo/performance_metrics", PerformanceMetrics)
        support.wait_for(metrics.sources, "a connection")

        def stepped():
            # Each time: the node may begin to measure after the first steps.
            self.done(self.gazebo.step_world(10))
            return metrics.all()

        support.wait_for(stepped, "a message for steps on request")
        metrics.clear()
        self.gazebo.unpause_physics()
        heard = support.wait_for(lambda: metrics.all()[3:], "four messages")
        self.assertEqual(list(heard[-1].sensors), [])
        self.assertGreater(heard[-1].real_time_factor, 0.0)
        self.assertGreater(heard[-1].header.stamp.to_sec(), 0.0)
        metrics.close()
