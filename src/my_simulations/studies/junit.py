"""Reads the results of tests in JUnit's XML, as rostest and rosunit write them."""
from __future__ import annotations

import glob
import os
from dataclasses import dataclass
from typing import List

from lxml import etree

_OWN = "rostest-"  # rostest's file about whether the tests ran; those of rosunit are of the tests
_LONGEST = 500     # characters of a failure


@dataclass(frozen=True)
class TestResults:
    """The results of the tests of a scenario.

    Attributes:
        tests: how many ran, skipped ones included.
        failures: how many failed or ended by an exception.
        first: the first of those: its name and what it said; "" for none.
        junit: all results as one document.
    """

    tests: int
    failures: int
    first: str
    junit: bytes


def results_below(folder: str) -> TestResults:
    """The results in all XML files below a folder.

    A file that is cut off counts as an error. What rostest says about a test that wrote results
    counts only if it failed.
    """
    tests = failures = 0
    first = ""
    suites = etree.Element("testsuites")
    paths = sorted(glob.glob(os.path.join(glob.escape(folder), "**", "*.xml"), recursive=True),
                   key=lambda path: (os.path.basename(path).startswith(_OWN), path))
    for path in paths:
        try:
            root = etree.parse(path, etree.XMLParser(resolve_entities=False, huge_tree=True)
                               ).getroot()
        except etree.XMLSyntaxError as fault:
            tests, failures = tests + 1, failures + 1
            first = first or f"{os.path.basename(path)} is no whole XML document: {fault.msg}"
            continue
        own = os.path.basename(path).startswith(_OWN)
        for case in root.iter("testcase"):
            faults: List[etree._Element] = [child for child in case
                                            if child.tag in ("failure", "error")]
            if own and not faults:
                continue
            tests += 1
            failures += bool(faults)
            if faults and not first:
                first = _name_and_message(case, faults[0], own)
        suites.extend([root] if root.tag == "testsuite" else list(root))
    return TestResults(tests, failures, first, etree.tostring(
        suites, encoding="UTF-8", xml_declaration=True))


def _name_and_message(case: "etree._Element", fault: "etree._Element", own: bool) -> str:
    """Return the name of a test and its message; in rosunit's text a traceback follows."""
    name = ".".join(part for part in (case.get("classname"), case.get("name")) if part)
    if own:  # of a <test> whose program wrote no results: rostest puts "test" before its name
        name = (case.get("name") or "")[len("test"):]
    said = fault.get("message") or next(
        (line for line in (fault.text or "").splitlines() if line.strip()), "failed")
    said = " ".join(said.split()).replace("False is not true : ", "")
    return f"{name}: {said}"[:_LONGEST]
