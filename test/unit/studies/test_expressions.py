"""The language of measurements."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.studies.expressions import ExpressionError, Signal, parse

TIME = np.array([0.0, 1.0, 2.0, 3.0])
Z, X = Signal("pose", ("box",), "z"), Signal("pose", ("box",), "x")
TOUCH = Signal("contact", ("a", "robo::arm"))
SAMPLES = {
    Signal("time"): TIME, Z: np.array([4.0, 2.0, -1.0, 1.0]), X: np.array([0.0, 1.0, 2.0, 3.0]),
    TOUCH: np.array([False, False, True, True]),
    Signal("vary", ("mass",)): np.array([5.0, 5.0, 5.0, 5.0]),
    Signal("speed", ("my box",)): np.array([1.0, 1.0, 1.0, 2.0]),
    Signal("joint", ("robo::arm",), "rate"): np.array([0.0, 0.0, 0.0, 0.25]),
}


def value(text):
    return parse(text).value(SAMPLES)


@pytest.mark.parametrize(("text", "expected"), [
    ("1 + 2 * 3", 7.0), ("(1 + 2) * 3", 9.0), ("8 / 4 / 2", 1.0), ("2 - 3 - 4", -5.0),
    ("-2 ^ 2", -4.0), ("2 ^ -1", 0.5), ("--2", 2.0), (".5e1", 5.0),
    ("final(pose.box.z)", 1.0), ("initial(pose.box.z)", 4.0), ("max(pose.box.z)", 4.0),
    ("min(pose.box.z)", -1.0), ("mean(pose.box.z)", 1.5), ("rms(pose.box.x)", math.sqrt(3.5)),
    ("max(abs(pose.box.z - 3))", 4.0), ("max(pose.box.z) - min(pose.box.z)", 5.0),
    ("max(final(pose.box.z), 3)", 3.0), ("min(2, 3)", 2.0),
    ("hypot(final(pose.box.x), 4)", 5.0), ("atan2(0, -1)", math.pi), ("sqrt(16)", 4.0),
    ("vary.mass * 2", 10.0), ("max(speed.'my box')", 2.0), ("final(joint.robo::arm.rate)", 0.25),
    ("final(time)", 3.0), ("first(pose.box.z < 0)", 2.0),
    ("duration(contact(a, robo::arm))", 2.0), ("final(pose.box.x*pose.box.z)", 3.0)])
def test_a_number_is_computed(text, expected):
    found = value(text)
    assert type(found) is float and found == pytest.approx(expected)


@pytest.mark.parametrize(("text", "expected"), [
    ("contact(a, robo::arm)", True), ("all(contact(a, robo::arm))", False),
    ("final(contact(a, robo::arm))", True), ("initial(contact(a, robo::arm))", False),
    ("any(pose.box.z > 3.5)", True), ("final(pose.box.z) >= 1", True),
    ("not final(pose.box.z) >= 1", False), ("not not 1 < 2", True),
    ("1 < 2 and 3 < 2 or 2 == 2", True), ("1 != 1", False), ("pose.box.z < -3", False)])
def test_a_condition_is_decided(text, expected):
    found = value(text)
    assert type(found) is bool and found is expected


@pytest.mark.parametrize(("text", "measured"), [
    ("final(pose.box.z) > 2", ["final(pose.box.z) is 1"]),
    ("all( pose.box.z  < 3 ) and not 5 > max(speed.'my box')",
     ["pose.box.z is -1 to 4", "max(speed.'my box') is 2"]),
    ("vary.mass * 0.33333 > 2", ["vary.mass * 0.33333 is 1.67"]),
    ("speed.'my box' < 9", ["speed.'my box' is 1 to 2"]),
    ("pose.box.x * 1e-12 == 1 or 1 / final(pose.box.x) < 1",
     ["pose.box.x * 1e-12 is 0", "1 / final(pose.box.x) is 0.333"]),
    ("contact(a, robo::arm)", [])])
def test_a_condition_shows_what_it_has_compared(text, measured):
    assert parse(text).measured(SAMPLES) == measured


def test_what_is_not_defined_is_nan():
    assert math.isnan(value("0 / 0")) and math.isnan(value("sqrt(-1)"))
    assert math.isnan(value("first(pose.box.z > 100)"))


def test_only_what_looks_between_start_and_end_is_sampled():
    assert not parse("final(pose.box.z) - initial(pose.box.z)").sampled
    assert parse("max(pose.box.z)").sampled and parse("contact(a, b)").sampled
    assert parse("final(pose.box.z)").signals == {Z, Signal("time")}


@pytest.mark.parametrize(("text", "said"), [
    ("pose.box.z", "final"), ("pose.box.q", "one of x, y, z"), ("final(3)", "each sample"),
    ("max(contact(a, b))", "takes a number"), ("any(pose.box.z)", "takes a condition"),
    ("1 + (2 < 3)", "takes a number"), ("1 and 2", "takes a condition"), ("", "a value at the end"),
    ("(1", r"'\)' at the end"), ("1 2", "an operator or the end at column 3"),
    ("open(1)", "a function: "), ("__import__('os')", "a function: "), ("eval", "one of pose"),
    ("final(pose.box.z", r"'\)'"), ("contact(a)", "','"), ("1 @ 2", "unexpected '@' at column 3"),
    ("atan2(1)", "2 values, not 1"), ("joint.j", r"'\.'"), ("(" * 60, "nested"),
    ("1 +" * 700 + "1", "characters"), ("1 < 2 < 3", "an operator or the end")])
def test_what_is_not_in_the_language_is_refused(text, said):
    with pytest.raises(ExpressionError, match=said):
        parse(text)
