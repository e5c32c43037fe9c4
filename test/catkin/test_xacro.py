"""xacro as ROS Noetic has it, in a shell that sourced the workspace."""
from __future__ import annotations

import os
import shutil
import subprocess
import sys

import pytest
from lxml import etree

XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def _run(*words, **variables):
    return subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=300, env={**os.environ, **variables})


@pytest.fixture
def package(tmp_path):
    """A package `arm` on the package path; what its `robot.xacro` holds is given to `xacro`."""
    folder = tmp_path / "somewhere" / "arm"
    (folder / "config").mkdir(parents=True)
    (folder / "package.xml").write_text(
        "<package format='2'><name>arm</name><version>0.0.1</version><description>arm"
        "</description><maintainer email='a@b.invalid'>a</maintainer><license>none</license>"
        "<buildtool_depend>catkin</buildtool_depend><depend>xacro</depend></package>")
    return folder


@pytest.fixture
def expanded(package):
    def expand(content, *words, **variables):
        file = package / "robot.xacro"
        file.write_text(f'<robot name="r" {XMLNS}>{content}</robot>')
        done = _run("xacro", str(file), *words, **{**_path_with(package), **variables})
        assert done.returncode == 0, done.stderr
        return etree.fromstring(done.stdout.encode()), done.stderr
    return expand


def _path_with(package):
    return {"ROS_PACKAGE_PATH": f"{package.parent}:{os.environ['ROS_PACKAGE_PATH']}"}


def _refused(package, content, *words):
    file = package / "robot.xacro"
    file.write_text(f'<robot name="r" {XMLNS}>{content}</robot>')
    done = _run("xacro", str(file), *words, **_path_with(package))
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    return done.stderr


def test_yaml_with_units_is_read_from_a_found_package(expanded, package):
    # The way in which the descriptions of Universal Robots and Franka read their limits.
    (package / "config" / "limits.yaml").write_text(
        "joints:\n  elbow: {max: !degrees 90, names: [a, b]}\n")
    root, notes = expanded("""
      <xacro:arg name="limits" default="$(find arm)/config/limits.yaml"/>
      <xacro:property name="file" value="$(arg limits)"/>
      <xacro:property name="all" value="${xacro.load_yaml(file)['joints']}"/>
      <link name="${all.elbow.names[1]}" max="${all.elbow.max}" n="${len(all)}"/>""")
    assert dict(root[0].attrib) == {"name": "b", "max": "1.5707963267948966", "n": "1"}
    assert notes == ""


def test_an_absent_file_is_named_without_a_traceback(tmp_path):
    done = _run("xacro", str(tmp_path / "absent.urdf.xacro"))
    assert done.returncode == 2
    assert "Traceback" not in done.stderr and "absent.urdf.xacro" in done.stderr


def test_functions_without_their_name_space_still_work_and_say_so(expanded, package):
    (package / "config" / "limits.yaml").write_text("top: 3\n")
    root, notes = expanded('<link top="${load_yaml(\'config/limits.yaml\')[\'top\']}"/>')
    assert root[0].get("top") == "3"
    assert "xacro.load_yaml()" in notes


def test_substitution_arguments_are_those_of_roslaunch(expanded, package):
    root, _ = expanded("""
      <xacro:arg name="side" default="left"/>
      <link find="$(find arm)/config" arg="$(arg side)" env="$(env SEEN)" more="x $(arg side) y"
            optenv="$(optenv UNSEEN a b)" eval="$(eval 2 * 3 if side == 'left' else 0)"
            anon="$(anon cam)" python="${xacro.arg('side')}" inside="${'$(find arm)'}"/>""",
        SEEN="seen")
    found = dict(root[0].attrib)
    assert found.pop("anon").startswith("cam_")
    assert found == {"find": str(package / "config"), "arg": "left", "env": "seen",
                     "more": "x left y", "optenv": "a b", "eval": "6", "python": "left",
                     "inside": str(package)}


def test_arguments_of_the_command_line_win_over_defaults(expanded):
    root, _ = expanded('<xacro:arg name="a" default="1"/><link a="$(arg a)"/>', "a:=2")
    assert root[0].get("a") == "2"


def test_a_missing_package_and_argument_are_named(package):
    assert "resource not found: nowhere" in _refused(package, '<link a="$(find nowhere)/x"/>')
    assert "Undefined substitution argument nothing" in _refused(package, '<a b="$(arg nothing)"/>')


def test_names_without_the_prefix_are_plain_elements(expanded):
    root, notes = expanded('<xacro:macro name="m"><link name="a"/></xacro:macro>'
                           '<m/><property name="p" value="1"/><xacro:m/>')
    assert [child.tag for child in root] == ["m", "property", "link"]
    assert "robot.xacro: <property> without the prefix xacro: has no effect" in notes


def test_macro_parameters_have_defaults_from_outside_and_blocks(expanded):
    root, _ = expanded("""
      <xacro:property name="side" value="left"/>
      <xacro:macro name="m" params="side:=^ size:=^|5 *origin **rest">
        <link side="${side}" size="${size}"><xacro:insert_block name="origin"/>
        <xacro:insert_block name="rest"/></link>
      </xacro:macro>
      <xacro:m><origin/><rest><a/><b/></rest></xacro:m>""")
    assert dict(root[0].attrib) == {"side": "left", "size": "5"}
    assert [child.tag for child in root[0]] == ["origin", "a", "b"]


def test_properties_of_outer_scopes_and_conditions(expanded):
    root, _ = expanded("""
      <xacro:macro name="m"><xacro:property name="out" value="1" scope="parent"/>
        <xacro:property name="all" value="2" scope="global"/></xacro:macro>
      <xacro:m/><xacro:if value="${out == 1 and all == 2}"><link name="both"/></xacro:if>
      <xacro:unless value="false"><link name="unless"/></xacro:unless>""")
    assert [link.get("name") for link in root] == ["both", "unless"]


def test_options_of_older_releases_are_taken(expanded):
    for option in ("--inorder", "-i", "--xacro-ns"):
        root, _ = expanded('<link name="a"/>', option)
        assert root[0].get("name") == "a"


def test_deps_lists_the_included_files(package):
    (package / "inside.xacro").write_text(f"<robot {XMLNS}/>")
    (package / "robot.xacro").write_text(
        f'<robot name="r" {XMLNS}><xacro:include filename="$(find arm)/inside.xacro"/></robot>')
    done = _run("xacro", "--deps", str(package / "robot.xacro"), **_path_with(package))
    assert done.stdout.strip() == str(package / "inside.xacro")


@pytest.mark.parametrize("python", [sys.executable, "/usr/bin/python3"])
def test_scripts_import_xacro_and_get_the_same(package, python):
    if shutil.which(python) is None:
        python = sys.executable
    (package / "robot.xacro").write_text(
        f'<robot name="r" {XMLNS}><link a="$(find arm)" b="$(arg b)"/></robot>')
    code = ("import xacro, sys; from xacro import process_file; import xacro.cli\n"
            "made = process_file(sys.argv[1], mappings={'b': '2'})\n"
            "print(xacro.process_file is process_file, made.documentElement.tagName,"
            " made.toprettyxml())")
    done = _run(python, "-c", code, str(package / "robot.xacro"), **_path_with(package))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("True robot ")
    assert f'a="{package}" b="2"' in done.stdout


def test_import_says_what_to_do_where_no_xacro_is_installed():
    done = _run(sys.executable, "-S", "-c", "import xacro", MY_SIMULATIONS_PYTHON="")
    assert "devel/setup.bash" in done.stderr


CMAKE = """cmake_minimum_required(VERSION 3.0.2)
project(arm)
find_package(catkin REQUIRED COMPONENTS xacro)
catkin_package()
xacro_add_files(robots/arm.urdf.xacro REMAP side:=left INSTALL DESTINATION robots)
xacro_add_xacro_file(robots/arm.urdf.xacro other.urdf REMAP side:=right)
add_custom_target(other ALL DEPENDS ${XACRO_OUTPUT_FILE})
"""


def test_packages_expand_xacro_files_at_build_time(package, tmp_path):
    (package / "CMakeLists.txt").write_text(CMAKE)
    (package / "robots").mkdir()
    (package / "robots" / "arm.urdf.xacro").write_text(
        f'<robot name="r" {XMLNS}><xacro:arg name="side" default=""/>'
        '<xacro:include filename="inside.xacro"/><link name="$(arg side)"/></robot>')
    inside = package / "robots" / "inside.xacro"
    build, installed = tmp_path / "build", tmp_path / "install"

    def made(name):
        inside.write_text(f'<robot {XMLNS}><link name="{name}"/></robot>')
        for words in (["cmake", "-S", str(package), "-B", str(build),
                       f"-DCMAKE_INSTALL_PREFIX={installed}",
                       f"-DPYTHON_EXECUTABLE={sys.executable}"], ["cmake", "--build", str(build)],
                      ["cmake", "--install", str(build)]):
            done = _run(*words)
            assert done.returncode == 0, done.stdout + done.stderr
        return [[link.get("name") for link in etree.parse(str(path)).getroot()] for path in (
            build / "devel/share/arm/robots/arm.urdf", installed / "share/arm/robots/arm.urdf",
            build / "other.urdf")]

    assert made("first") == [["first", "left"]] * 2 + [["first", "right"]]
    assert made("second") == [["second", "left"]] * 2 + [["second", "right"]]
