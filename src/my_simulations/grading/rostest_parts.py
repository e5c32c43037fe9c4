"""Divides a rostest into what the submission runs and what decides about it."""
from __future__ import annotations

from typing import Tuple

from lxml import etree

from ..errors import InputError, error

STARTED = "/my_simulations_grade/started"
"""Parameter that exists once the parameters of the first part are set."""

_SCOPES = ("group",)
_KEPT = ("arg", "env", "remap", "test")   # besides groups, of the second part


def split_rostest(path: str) -> Tuple[bytes, bytes]:
    """Return the two roslaunch files of a rostest.

    The first one has no tests, and sets the parameter `STARTED`. The second one has the tests of
    the file, with its arguments, groups, remappings and variables, and nothing else: tests in files
    that it includes do not count, because these may belong to the submission. Raises InputError:
    the file is no roslaunch file, or has no test.
    """
    try:
        started, tests = (etree.parse(path, etree.XMLParser(
            resolve_entities=False, remove_comments=True)).getroot() for _ in range(2))
    except (OSError, etree.XMLSyntaxError) as fault:
        raise InputError([error("xml-malformed", str(fault), file=path)]) from None
    for test in list(started.iter("test")):
        test.getparent().remove(test)
    etree.SubElement(started, "param", name=STARTED, type="int", value="1")
    _keep_tests(tests)
    if next(tests.iter("test"), None) is None:
        raise InputError([error("grade-value", "the rostest has no <test>", file=path)])
    return etree.tostring(started), etree.tostring(tests)


def _keep_tests(scope: "etree._Element") -> None:
    for child in list(scope):
        if child.tag in _SCOPES:
            _keep_tests(child)
        elif child.tag not in _KEPT:
            scope.remove(child)
