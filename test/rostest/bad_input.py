"""Every service, every kind of bad input: a reason soon, and the world as it was.

A row of `REFUSED` is a valid request of `VALID` with some fields made bad, and a word that the
reason must hold; a row of `FORGIVEN` is odd input that has a meaning.
"""
import os
import unittest
import xmlrpc.client

import rosgraph
import rospy
import support
from dynamic_reconfigure.msg import BoolParameter, DoubleParameter, IntParameter, StrParameter
from support import box, pose, static_box_sdf

from my_simulations.ros import interface
from my_simulations.ros.registration import class_of

NAN, INF, ABSURD = float("nan"), float("inf"), 1e300
SECONDS = 1.0
"""Processor time that an answer may cost the node; wall time would include other programs."""

ARM = ('<robot name="arm"><link name="world"/>'
       '<link name="fore"><inertial><mass value="1"/>'
       '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
       '<joint name="hinge" type="revolute"><origin xyz="0 5 1"/><parent link="world"/>'
       '<child link="fore"/><axis xyz="0 0 1"/>'
       '<limit lower="-1" upper="1" effort="5" velocity="9"/>'
       '</joint></robot>')
LIGHT = ('<sdf version="1.6"><light name="lamp" type="point"><pose>0 0 3 0 0 0</pose></light>'
         '</sdf>')

VALID = {
    "spawn_urdf_model": {"model_name": "new", "model_xml": box()},
    "spawn_sdf_model": {"model_name": "new", "model_xml": static_box_sdf()},
    "spawn_object": {"model_name": "new", "model_xml": box()},
    "delete_model": {"model_name": "box"},
    "delete_light": {"light_name": "lamp"},
    "get_model_properties": {"model_name": "box"},
    "get_model_state": {"model_name": "box"},
    "get_link_state": {"link_name": "box::body"},
    "get_link_properties": {"link_name": "box::body"},
    "get_joint_properties": {"joint_name": "arm::hinge"},
    "get_light_properties": {"light_name": "lamp"},
    "set_model_state": {"model_state.model_name": "box", "model_state.pose.position.x": 4.0},
    "set_link_state": {"link_state.link_name": "box::body", "link_state.pose.position.x": 4.0},
    "set_model_configuration": {"model_name": "arm", "joint_names": ["hinge"],
                                "joint_positions": [0.5]},
    "set_joint_properties": {"joint_name": "arm::hinge", "ode_joint_config.damping": [0.5]},
    "set_link_properties": {"link_name": "box::body", "mass": 2.0, "ixx": 1.0, "iyy": 1.0,
                            "izz": 1.0},
    "set_light_properties": {"light_name": "lamp", "attenuation_constant": 0.5},
    "set_physics_properties": {"time_step": 0.002, "max_update_rate": 500.0, "gravity.z": -5.0},
    "apply_body_wrench": {"body_name": "box::body", "wrench.force.x": 5.0,
                          "duration": rospy.Duration(1)},
    "apply_joint_effort": {"joint_name": "arm::hinge", "effort": 1.0,
                           "duration": rospy.Duration(1)},
    "step_world": {"steps": 1},
    "save_world": {"path": "somewhere.world"},
}


def numbers(service, fields, limit, word=None):
    """Rows that put NaN, infinities and an absurd number into each of some fields."""
    values = [NAN, INF, -INF] + ([limit] if limit else [])
    return [(service, {field: value}, word or field.split(".")[-1].split("[")[0][:3])
            for field in fields for value in values]


def axes(field, names="xyz"):
    return [f"{field}.{name}" for name in names]


UNKNOWN = [
    ("delete_model", "model_name", "does not exist"),
    ("delete_light", "light_name", "not found"),
    ("get_model_properties", "model_name", "does not exist"),
    ("get_model_state", "model_name", "does not exist"),
    ("get_link_state", "link_name", "not found"),
    ("get_link_properties", "link_name", "not found"),
    ("get_joint_properties", "joint_name", "not found"),
    ("get_light_properties", "light_name", "not found"),
    ("set_model_state", "model_state.model_name", "does not exist"),
    ("set_link_state", "link_state.link_name", "does not exist"),
    ("set_model_configuration", "model_name", "does not exist"),
    ("set_joint_properties", "joint_name", "not found"),
    ("set_link_properties", "link_name", "not found"),
    ("set_light_properties", "light_name", "not found"),
    ("apply_body_wrench", "body_name", "does not exist"),
    ("apply_joint_effort", "joint_name", "not found"),
]
FRAMES = [
    ("spawn_urdf_model", "reference_frame"), ("spawn_sdf_model", "reference_frame"),
    ("spawn_object", "reference_frame"),
    ("get_model_state", "relative_entity_name"), ("get_link_state", "reference_frame"),
    ("set_model_state", "model_state.reference_frame"),
    ("set_link_state", "link_state.reference_frame"),
    ("apply_body_wrench", "reference_frame"),
]
SPAWN = ("spawn_urdf_model", "spawn_sdf_model", "spawn_object")
ODE = ["sor_pgs_w", "contact_surface_layer", "contact_max_correcting_vel", "cfm", "erp"]

REFUSED = [
    *[(service, {field: name}, word) for service, field, word in UNKNOWN
      for name in ("", "nothing", "box::nothing", "nothing::body", "::", "x" * 100000)],
    *[(service, {field: name}, "frame") for service, field in FRAMES
      for name in ("nothing", "/world", "box::nothing", "::", " ")],

    *[(service, {"model_name": name}, word) for service in SPAWN
      for name, word in (("", "empty"), ("  ", "empty"), ("a::b", "::"),
                         ("box", "already exists"))],
    *[(service, {"model_xml": xml}, "") for service in SPAWN
      for xml in ("", "no xml", "<robot", "<robot/>", "<sdf/>", "<model/>", "<sdf version='1.6'/>",
                  "<!-- endless", "<robot name='r'><link name='l'/><link name='l'/></robot>")],
    *numbers("spawn_urdf_model", axes("initial_pose.position"), ABSURD, "initial_pose"),
    *numbers("spawn_urdf_model", axes("initial_pose.orientation", "xyzw"), None, "initial_pose"),
    *numbers("spawn_sdf_model", axes("initial_pose.position"), ABSURD, "initial_pose"),
    *numbers("spawn_object", axes("initial_pose.position"), ABSURD, "initial_pose"),
    ("spawn_sdf_model", {"model_xml": static_box_sdf("1e300 0 0 0 0 0")}, "beyond"),
    ("spawn_sdf_model", {"model_name": "lamp", "model_xml": LIGHT}, "already exists"),

    *numbers("set_model_state", axes("model_state.pose.position"), ABSURD, "position"),
    *numbers("set_model_state", axes("model_state.pose.orientation", "xyzw"), None, "orientation"),
    *numbers("set_model_state", axes("model_state.twist.linear"), ABSURD, "linear"),
    *numbers("set_model_state", axes("model_state.twist.angular"), ABSURD, "angular"),
    *numbers("set_link_state", axes("link_state.pose.position"), ABSURD, "position"),
    *numbers("set_link_state", axes("link_state.pose.orientation", "xyzw"), None, "orientation"),
    *numbers("set_link_state", axes("link_state.twist.linear"), ABSURD, "linear"),
    *numbers("set_link_state", axes("link_state.twist.angular"), ABSURD, "angular"),

    *[("set_model_configuration", {"joint_names": names, "joint_positions": positions},
       "different lengths")
      for names, positions in ((["hinge"], []), ([], [0.1]), (["hinge"], [0.1, 0.2]))],
    *[("set_model_configuration", {"joint_positions": [value]}, "hinge")
      for value in (NAN, INF, -INF, ABSURD)],

    *[("set_joint_properties", {f"ode_joint_config.{field}": values}, field)
      for field in ("damping", "hiStop", "loStop", "fmax", "vel")
      for values in ([NAN], [INF], [-INF], [ABSURD], [0.1, 0.1])],
    *[("set_joint_properties", {f"ode_joint_config.{field}": values}, field)
      for field in ("erp", "cfm", "stop_erp", "stop_cfm", "fudge_factor")
      for values in ([NAN], [INF], [0.1, 0.1])],
    ("set_joint_properties", {"ode_joint_config.damping": [-1.0]}, "damping"),
    ("set_joint_properties", {"ode_joint_config.fmax": [-1.0]}, "fmax"),
    ("set_joint_properties", {"ode_joint_config.loStop": [0.5], "ode_joint_config.hiStop": [0.1]},
     "loStop"),

    *numbers("set_link_properties", ["mass", "ixx", "ixy", "ixz", "iyy", "iyz", "izz"], ABSURD),
    *numbers("set_link_properties", axes("com.position"), ABSURD, "com"),
    *[("set_link_properties", {"mass": mass}, "mass") for mass in (0.0, -1.0)],
    *[("set_link_properties", changes, "inertia")
      for changes in ({"ixx": 0.0}, {"izz": -1.0}, {"ixy": 5.0})],

    *numbers("set_light_properties", [f"{colour}.{part}" for colour in ("diffuse", "specular")
                                      for part in "rgba"], 1e30, "must be between|finite"),
    *numbers("set_light_properties", [f"attenuation_{name}"
                                      for name in ("constant", "linear", "quadratic")], ABSURD),
    *numbers("set_light_properties", axes("direction"), ABSURD, "direction"),
    *numbers("set_light_properties", axes("pose.position"), ABSURD, "pose"),
    ("set_light_properties", {"diffuse.r": -1.0}, "diffuse"),
    ("set_light_properties", {"attenuation_linear": -1.0}, "attenuation_linear"),

    *numbers("set_physics_properties", ["time_step", "max_update_rate"], ABSURD),
    *numbers("set_physics_properties", axes("gravity"), ABSURD, "gravity"),
    *numbers("set_physics_properties", [f"ode_config.{name}" for name in ODE], ABSURD),
    *[("set_physics_properties", {"time_step": step}, "time_step") for step in (0.0, -0.001, 11.0)],
    *[("set_physics_properties", {f"ode_config.{name}": -1.0}, name) for name in ODE],
    *[("set_physics_properties", {f"ode_config.{name}": 4000000000}, name)
      for name in ("sor_pgs_precon_iters", "sor_pgs_iters", "max_contacts")],

    *numbers("apply_body_wrench", axes("wrench.force") + axes("wrench.torque"), ABSURD, "wrench"),
    *numbers("apply_body_wrench", axes("reference_point"), ABSURD, "reference_point"),
    *numbers("apply_joint_effort", ["effort"], ABSURD),

    *[("step_world", {"steps": steps}, "steps") for steps in (-1, -2 ** 63, 2 ** 63 - 1)],
    *[("save_world", {"path": path}, "") for path in
      ("", "/etc/passwd", "../../../../../etc/x.world", "x.txt", "a\0b.world", "/proc/x.world")],
]

FORGIVEN = [
    ("set_model_state", {"model_state.model_name": "box", "model_state.pose.position.x": 2.0,
                         "model_state.pose.position.z": 0.1}),          # a quaternion of zeros
    ("set_link_state", {"link_state.link_name": "box::body", "link_state.pose.position.x": 2.0,
                        "link_state.pose.position.z": 0.1}),
    ("set_model_state", {"model_state.model_name": "box", "model_state.pose.position.x": 2.0,
                         "model_state.pose.position.z": 0.1,
                         "model_state.pose.orientation.w": ABSURD}),    # normalised
    ("set_model_configuration", {"model_name": "arm", "joint_names": ["none"],
                                 "joint_positions": [0.1]}),            # named in the message
    ("set_model_configuration", {"model_name": "arm"}),
    ("set_joint_properties", {"joint_name": "hinge"}),
    ("apply_body_wrench", {"body_name": "box::body", "wrench.force.x": 5.0}),   # no duration
    ("apply_joint_effort", {"joint_name": "hinge", "effort": 5.0}),
    ("clear_body_wrenches", {"body_name": "nothing"}),
    ("clear_joint_forces", {"joint_name": "nothing"}),
    ("step_world", {"steps": 0}),
]

PARAMETERS = [
    ("doubles", DoubleParameter("time_step", NAN), "time_step"),
    ("doubles", DoubleParameter("gravity_z", INF), "gravity_z"),
    ("doubles", DoubleParameter("time_step", 0.0), "time_step"),
    ("doubles", DoubleParameter("nothing", 1.0), "nothing"),
    ("ints", IntParameter("time_step", 1), "time_step"),
    ("bools", BoolParameter("nothing", True), "nothing"),
    ("strs", StrParameter("gravity_z", "-9.8"), "gravity_z"),
]


def request_of(service, fields):
    kind = class_of(interface.row_of(service, interface.SERVES))
    request = kind._request_class()
    for path, value in fields.items():
        where = request
        *parents, last = path.split(".")
        for parent in parents:
            where = getattr(where, parent)
        setattr(where, last, value)
    return request


class BadInput(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.gazebo = support.Gazebo()
        uri = rosgraph.Master("/bad_input").lookupNode("/gazebo")
        cls.pid = xmlrpc.client.ServerProxy(uri).getPid("/bad_input")[2]
        cls.gazebo.clear()
        for name, kind, xml, where in (("box", "urdf", box(), pose(2.0, 0.0, 0.1)),
                                       ("arm", "urdf", ARM, pose()),
                                       ("lamp", "sdf", LIGHT, pose())):
            answer = getattr(cls.gazebo, f"spawn_{kind}_model")(name, xml, "", where, "")
            assert answer.success, answer.status_message
        support.wait_for(lambda: abs(cls.gazebo.z("box") - 0.1) < 1e-3, "a box at rest")

    @classmethod
    def processor_seconds(cls):
        """What the node, without its engine, has used."""
        with open(f"/proc/{cls.pid}/stat", encoding="utf-8") as stat:
            used = stat.read().rpartition(")")[2].split()[11:13]
        return sum(map(int, used)) / os.sysconf("SC_CLK_TCK")

    def world(self):
        """Return the world as the services report it, rounded to the jitter of a resting box."""
        gazebo = self.gazebo
        physics = gazebo.get_physics_properties()
        states = [round(number, 3) + 0.0 for name in ("box", "arm")
                  for number in support.numbers(gazebo.get_model_state(name, "").pose)]
        return (gazebo.names(), states, str(physics), str(gazebo.get_link_properties("box::body")),
                str(gazebo.get_light_properties("lamp")),
                str(gazebo.get_joint_properties("hinge").damping),
                round(gazebo.get_joint_properties("hinge").position[0], 3) + 0.0)

    def check(self, service, fields, judge):
        before, since = self.world(), self.gazebo.sim_time()
        began = self.processor_seconds()
        answer = getattr(self.gazebo, service)(request_of(service, fields))
        self.assertLess(self.processor_seconds() - began, SECONDS)
        judge(answer)
        self.assertEqual(self.world(), before)
        support.wait_for(lambda: self.gazebo.sim_time() > since, "a step")

    def test_numbers_and_names_for_dynamic_reconfigure(self):
        for field, element, word in PARAMETERS:
            request = request_of("set_parameters", {})
            getattr(request.config, field).append(element)
            before = self.world()
            with self.assertRaises(rospy.ServiceException, msg=word) as raised:
                self.gazebo.set_parameters(request)
            self.assertIn(word, str(raised.exception))
            self.assertEqual(self.world(), before)


def refusal(service, changes, word):
    def judge(case, answer):
        case.assertFalse(answer.success)
        case.assertNotIn("internal error", answer.status_message)
        case.assertTrue(any(part in answer.status_message for part in word.split("|")),
                        answer.status_message)
        case.assertGreater(len(answer.status_message), len(word))

    def test(case):
        case.check(service, {**VALID[service], **changes}, lambda answer: judge(case, answer))

    return test


def acceptance(service, fields):
    def judge(case, answer):
        case.assertTrue(getattr(answer, "success", True), answer)

    return lambda case: case.check(service, fields, lambda answer: judge(case, answer))


def told(changes):
    return "_".join(f"{path.split('.')[-1]}_{str(value)[:20]}" for path, value in changes.items())


for number, (of, bad, reason) in enumerate(REFUSED):
    setattr(BadInput, f"test_{number:03}_{of}_refuses_{told(bad)}", refusal(of, bad, reason))
for number, (of, odd) in enumerate(FORGIVEN):
    setattr(BadInput, f"test_odd_{number:02}_{of}", acceptance(of, odd))
