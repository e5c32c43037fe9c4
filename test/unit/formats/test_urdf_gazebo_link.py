"""SDF `<link>`s in `<gazebo>` of URDF: links that belong to the robot, outside of its tree."""
import pytest
from reading import URDF_INERTIAL, errors, robot_joint, robot_link, robot_of, tolerated

ARM = (robot_link("base", URDF_INERTIAL) + robot_link("tip", URDF_INERTIAL)
       + robot_joint("turn", "base", "tip", "continuous", xyz="0 0 2"))
ROD = """<link name="rod"><pose{}>1 0 0 0 0 0</pose><gravity>false</gravity><inertial><mass>3</mass>
<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
"""


def rod_in(frame):
    return ROD.format(f' relative_to="{frame}"')


def test_a_link_of_sdf_is_a_link_of_the_robot():
    robot, issues = robot_of(ARM + f"<gazebo>{ROD.format('')}</gazebo>")
    assert issues == [] and [link.name for link in robot.links] == ["base", "tip", "rod"]
    rod = robot.links[2]
    assert rod.pose.position == (1, 0, 0) and rod.inertial.mass == 3 and not rod.gravity
    assert [collision.geometry.radius for collision in rod.collisions] == [0.1]


def test_its_pose_may_be_relative_to_a_link_of_the_tree():
    robot, issues = robot_of(ARM + f"<gazebo>{rod_in('tip')}</gazebo>")
    assert issues == [] and robot.links[2].pose.position == (1, 0, 2)
    robot, issues = robot_of(ARM + f"<gazebo>{rod_in('t')}</gazebo>")
    assert tolerated(issues) == ["frame-unknown"] and errors(issues) == []
    assert robot.links[2].pose.position == (1, 0, 0)


def test_joints_of_sdf_connect_it_to_the_tree():
    loop = ('<gazebo><joint name="{}" type="revolute"><parent>{}</parent><child>rod</child>'
            "<axis><xyz>0 1 0</xyz></axis></joint></gazebo>")
    robot, issues = robot_of(ARM + loop.format("first", "base") + f"<gazebo>{ROD.format('')}"
                             "</gazebo>" + loop.format("second", "tip"))
    assert issues == []
    assert [(one.name, one.parent, one.child) for one in robot.joints] == [
        ("turn", "base", "tip"), ("first", "base", "rod"), ("second", "tip", "rod")]
    assert all(one.pose.position == pytest.approx((0, 0, 0)) for one in robot.joints)


def test_a_second_link_of_one_name_is_kept_under_another():
    robot, issues = robot_of(ARM + f"<gazebo>{ROD.format('').replace('rod', 'tip')}</gazebo>")
    assert tolerated(issues) == ["name-repeated"] and errors(issues) == []
    assert [link.name for link in robot.links] == ["base", "tip", "tip_1"]


def test_a_fault_in_it_is_told_at_its_own_line():
    lines = ROD.format("").replace("<mass>3", "<mass>-3")
    _, issues = robot_of(f"{ARM}<gazebo>\n{lines}</gazebo>")
    assert [issue.code for issue in issues] == ["mass-not-positive"]
    assert issues[0].line == ARM.count("\n") + 2
