"""A rostest is divided into what the submission runs and what decides about it."""
from __future__ import annotations

import pytest
from lxml import etree

from my_simulations.errors import InputError
from my_simulations.grading.launch_checks import STARTED, split_rostest

ROSTEST = """<launch>
  <!-- a comment -->
  <arg name="submission"/>
  <include file="$(arg submission)/go.launch"/>
  <param name="a" command="whoami"/>
  <node name="n" pkg="p" type="t"/>
  <group ns="lab" if="$(arg submission)">
    <remap from="x" to="y"/>
    <node name="m" pkg="p" type="t"/>
    <test test-name="one" pkg="p" type="t"><param name="b" value="2"/></test>
  </group>
  <test test-name="two" pkg="p" type="t"/>
</launch>
"""


def tags(document):
    return [element.tag for element in etree.fromstring(document).iter()][1:]


def test_nodes_and_tests_are_in_separate_files(tmp_path):
    (tmp_path / "lab.test").write_text(ROSTEST)
    started, tests = split_rostest(str(tmp_path / "lab.test"))
    assert tags(started) == ["arg", "include", "param", "node", "group", "remap", "node", "param"]
    assert etree.fromstring(started)[-1].get("name") == STARTED
    assert tags(tests) == ["arg", "group", "remap", "test", "param", "test"]


@pytest.mark.parametrize("text", ["<launch><node name='n' pkg='p' type='t'/></launch>",
                                  "<launch>", ""])
def test_a_file_without_tests_is_refused(tmp_path, text):
    (tmp_path / "lab.test").write_text(text)
    with pytest.raises(InputError):
        split_rostest(str(tmp_path / "lab.test"))
