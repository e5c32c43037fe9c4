"""What the tests of the readers share."""
from __future__ import annotations

import os

from my_simulations.errors import InputError, Severity
from my_simulations.formats.reading import parse_world, read_entity
from my_simulations.resources.resolver import Resolver

DATA = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                     "..", "..", "data"))
VALID = os.path.join(DATA, "valid")
INVALID = os.path.join(DATA, "invalid")

INERTIAL = ("<inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>"
            "</inertial>")
URDF_INERTIAL = ('<inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0"'
                 ' izz="0.1"/></inertial>')


def sdf(inside, version="1.6"):
    return f'<sdf version="{version}">{inside}</sdf>'


def model_of(inside, version="1.6", resolver=None):
    """A model named `m` with the given content, read; and the issues."""
    return read_entity(sdf(f'<model name="m">{inside}</model>', version), resolver or Resolver())


def link_of(inside, version="1.6"):
    model, issues = model_of(f'<link name="l">{inside}</link>', version)
    return model.links[0], issues


def robot_of(inside, resolver=None):
    """A robot named `r`, read; and the issues."""
    return read_entity(f'<robot name="r">{inside}</robot>', resolver or Resolver())


def world_of(inside, version="1.6", resolver=None):
    """A world, read; and the issues."""
    return parse_world(sdf(f'<world name="w">{inside}</world>', version),
                       resolver or Resolver())


def codes(issues, severity=None):
    return [i.code for i in issues if severity is None or i.severity is severity]


def errors(issues):
    return codes(issues, Severity.ERROR)


def warnings(issues):
    return codes(issues, Severity.WARNING)


def tolerated(issues):
    """Codes of what was read as Gazebo reads it."""
    return [issue.code for issue in issues if issue.tolerated]


def refusal(function, *arguments):
    """The `InputError` that a call raises."""
    try:
        function(*arguments)
    except InputError as fault:
        return fault
    raise AssertionError("nothing was raised")


def robot_link(name, inside=URDF_INERTIAL):
    return f'<link name="{name}">{inside}</link>'


def robot_joint(name, parent, child, kind="fixed", inside="", xyz="0 0 0", rpy="0 0 0"):
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/>{inside}</joint>')
