"""Issues that a file repeats are logged once."""
from __future__ import annotations

import pytest

from my_simulations.errors import error, group_repeated, warning


def unknown(line, joint, file="a.urdf", name="K"):
    return warning("unknown", f"attribute {name} is unknown", file=file, line=line,
                   xpath=f"/robot/joint[{joint}]", hint="remove it")


def test_issues_that_differ_in_their_place_become_the_first_with_the_lines_of_the_others():
    found = group_repeated([unknown(9, 3), unknown(3, 1), unknown(5, 2), unknown(7, 1, name="D")])
    assert [str(issue) for issue in found] == [
        "a.urdf:9: warning: attribute K is unknown; also in lines 3, 5 [/robot/joint[3]] (remove"
        " it)", "a.urdf:7: warning: attribute D is unknown [/robot/joint[1]] (remove it)"]


def test_many_lines_are_counted():
    (found,) = group_repeated([unknown(line, line) for line in range(1, 11)])
    assert found.message.endswith("also in lines 2, 3, 4, 5, 6 and 4 more")


def test_issues_of_other_files_severities_and_places_without_lines_stay():
    issues = [unknown(1, 1), unknown(1, 1, file="b.urdf"), unknown(0, 2), unknown(0, 3),
              error("unknown", "attribute K is unknown", file="a.urdf", line=4)]
    kept = group_repeated([*issues[1:], unknown(0, 3)])
    assert kept == issues[1:]
    assert group_repeated([]) == []


@pytest.mark.parametrize("code", ["inertia-zero", "inertia-not-positive", "inertia-impossible"])
def test_inertia_that_links_lack_is_reported_once_for_each_model(code):
    def zero(line, link, model="/sdf/world/model[1]"):
        return warning(code, f"the inertia of link {link!r} is zero", file="a.world",
                       line=line, xpath=f"{model}/link[{line}]/inertial")

    found = group_repeated([zero(1, "a"), zero(2, "b"), zero(3, "c"),
                            zero(4, "a", "/sdf/world/model[2]"), zero(5, "b", "/robot"),
                            zero(6, "c", "/robot")])
    assert [issue.message for issue in found] == [
        "the inertia of link 'a' is zero; also in lines 2, 3", "the inertia of link 'a' is zero",
        "the inertia of link 'b' is zero; also in line 6"]
