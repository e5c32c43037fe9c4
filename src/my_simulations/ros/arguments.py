"""Command line parser that suggests similar options for unknown ones."""
from __future__ import annotations

import argparse
import difflib
import re
from typing import Any, List

from ..program_end import ArgumentParser

_NEGATIVE = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?(,.*)?$")
"""A negative number, or a list that begins with one; argparse itself knows -0.5, not -1e-3."""


class Parser(ArgumentParser):
    """An argument parser that takes every spelling of negative numbers for values.

    It suggests options and choices much like an unknown one.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._negative_number_matcher = _NEGATIVE

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse; print usage, error and suggestion, and exit with status 2 for unknown options."""
        found, unknown = self.parse_known_args(args, namespace)
        self._refuse(unknown)
        return found

    def parse_intermixed_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As `parse_args`, with options between arguments."""
        found, unknown = self.parse_known_intermixed_args(args, namespace)
        self._refuse(unknown)
        return found

    def _refuse(self, unknown: List[str]) -> None:
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}{self._suggestion(unknown)}")

    def _suggestion(self, unknown: List[str]) -> str:
        known: List[str] = [option for action in self._actions
                            if action.help is not argparse.SUPPRESS
                            for option in action.option_strings]
        near = [difflib.get_close_matches(word.split("=")[0], known, 1)
                for word in unknown if word.startswith("-")]
        found = [options[0] for options in near if options]
        return f"; did you mean {' and '.join(found)}?" if found else ""


def is_remapping(word: str) -> bool:
    """Whether a word is a ROS remapping `name:=value`, which rospy handles."""
    return ":=" in word and not word.startswith("-")


def parse_number(text: str) -> float:
    """A number, for argparse; it may be infinite or NaN."""
    try:
        return float(text)
    except ValueError:
        comma = "; use a decimal point" if "," in text else ""
        raise argparse.ArgumentTypeError(f"{text!r} is not a number{comma}") from None


def parse_seconds(text: str) -> float:
    """A positive finite number of seconds, for argparse."""
    value = parse_number(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a positive number of seconds, is {text}")
    return value
