"""Faults of launch files, as the output of roslaunch names them."""
from __future__ import annotations

import pytest

from my_simulations.grading.launch_checks import LaunchFault, last_line, launch_fault

FILE = "while processing /s/a/go.launch:\n"
OTHER = "while processing /s/b.launch:\n"
TRACEBACK = "\x1b[31mThe traceback for the exception was written to the log file\x1b[0m\n"


@pytest.mark.parametrize("text, fault", [
    ("RLException: " + 300 * FILE + "Invalid roslaunch XML syntax: maximum recursion depth exceeded"
     " while calling a Python object", LaunchFault(
         "a/go.launch includes itself, directly or by another file", "a/go.launch")),
    ("RLException: " + FILE + OTHER + "Invalid roslaunch XML syntax: mismatched tag: line 3,"
     " column 2", LaunchFault("Invalid roslaunch XML syntax: mismatched tag: line 3, column 2",
                              "b.launch", 3)),
    ("RLException: Invalid roslaunch XML syntax: mismatched tag: line 29, column 4", LaunchFault(
        "Invalid roslaunch XML syntax: mismatched tag: line 29, column 4", "", 29)),
    ("RLException: Invalid <arg> tag: 'line 2'", LaunchFault("Invalid <arg> tag: 'line 2'")),
    ("\x1b[31mERROR: cannot launch node of type [a/b]: a\nROS path", LaunchFault(
        "ERROR: cannot launch node of type [a/b]: a")),
    ("\x1b]2;x\x07\x1b[31mResource not found: nothing\nROS path", LaunchFault(
        "Resource not found: nothing")),
    ("started core service", None)])
def test_the_first_fault_is_found_with_file_and_line(text, fault):
    assert launch_fault((f"Done\n\x1b[31m{text}\x1b[0m\n" + TRACEBACK).encode(), "/s") == fault


def test_the_last_line_is_one_that_says_something():
    assert last_line(("first\n\n" + TRACEBACK).encode()) == "first"
    assert last_line(TRACEBACK.encode()) == "no output"
