"""Reads a class file: YAML, every fault with its line and key."""
from __future__ import annotations

import os
import re
from typing import Any, List, Mapping, Optional, Sequence, Tuple

from ..errors import Issue
from ..studies.value_reader import ValueReader, describe_value, read_document
from .class_plan import ClassLimits, ClassPlan, Student
from .containers import PROGRAMS

_KEYS = ("class", "students", "folder", "host", "port", "launch", "args", "limits",
         "idle_minutes", "submission", "image", "containers")
_LIMITS = ("memory_mb", "processors", "processes", "file_mb", "home_mb")
_NAME = re.compile(r"[a-z][a-z0-9_-]{0,31}\Z")
_MOST_STUDENTS = 500
_FIRST_PORT = 11400
_LONGEST_MINUTES = 100000.0


def read_class(file: str) -> Tuple[ClassPlan, List[Issue]]:
    """Read a class file; relative paths in it start at its folder.

    Returns:
        The class, and warnings.

    Raises:
        InputError: the file has faults; all of them are named.
    """
    return read_document(file, _ClassReader, _ClassReader.plan)


class _ClassReader(ValueReader):
    document = "class file"

    def fault(self, path: Sequence[str], message: str, hint: str = "",
              code: str = "class-value") -> None:
        """Note a fault of a class file; codes of studies become those of classes."""
        super().fault(path, message, hint, code.replace("study-", "class-"))

    def plan(self, tree: Any, file: str) -> Optional[ClassPlan]:
        """The class; None if it is not a mapping at all."""
        if not isinstance(tree, Mapping):
            self.fault((), f"a class must be a mapping, is {describe_value(tree)}")
            return None
        top = self.mapping(tree, (), _KEYS)
        if "students" not in top:
            self.fault((), "a class needs 'students': a number or a list of names",
                       code="class-key")
            return None
        name = self.text(top.get("class", os.path.splitext(os.path.basename(file))[0]),
                         ("class",))
        port = self.integer(top.get("port", _FIRST_PORT), ("port",), 1024, 65000)
        folder = self.text(top.get("folder", name), ("folder",))
        return ClassPlan(
            name, file, os.path.join(os.path.dirname(file), os.path.expanduser(folder)),
            self.text(top.get("host", "127.0.0.1"), ("host",)), port,
            self._students(top.get("students"), port), self._launch(top.get("launch")),
            self._arguments(top.get("args")), self._limits(top.get("limits")),
            self.number(top.get("idle_minutes", 60.0), ("idle_minutes",), least=0.0,
                        most=_LONGEST_MINUTES),
            self._inside(top.get("submission", "submission"), ("submission",)),
            self.text(top.get("image", "my_simulations"), ("image",)),
            self._containers(top.get("containers")))

    def _students(self, value: Any, port: int) -> Tuple[Student, ...]:
        """Read the students, a number or a list of names; their ports follow `port`."""
        path = ("students",)
        if isinstance(value, int) and not isinstance(value, bool):
            count = self.integer(value, path, 1, _MOST_STUDENTS)
            names = [f"student{number}" for number in range(1, count + 1)]
        else:
            names = list(self.names(value, path))
        if not 1 <= len(names) <= _MOST_STUDENTS:
            self.fault(path, "'students' must be a number or a list of names, at most"
                             f" {_MOST_STUDENTS}")
        for index, name in enumerate(names):
            if not _NAME.match(name):
                self.fault((*path, str(index)), f"{name!r} is not a valid name: lower-case letters,"
                                                " digits, _ and -, at most 32")
            if name in names[:index]:
                self.fault((*path, str(index)), f"two students have the name {name!r}")
        return tuple(Student(name, number, port + 1 + number)
                     for number, name in enumerate(names))

    def _launch(self, value: Any) -> Tuple[str, str]:
        if value is None:
            return "my_simulations", "lab_room.launch"
        words = self.text(value, ("launch",)).split()
        if len(words) != 2:
            self.fault(("launch",), "'launch' must be a package and a launch file of it, such as"
                                    " my_simulations lab_room.launch")
            return "", ""
        return words[0], words[1]

    def _arguments(self, value: Any) -> Tuple[str, ...]:
        if value is None:
            return ()
        if not isinstance(value, Mapping):
            self.fault(("args",), f"'args' must be a mapping, is {describe_value(value)}")
            return ()
        return tuple(f"{name}:={_format_argument(given)}" for name, given in value.items())

    def _limits(self, value: Any) -> ClassLimits:
        inside = self.mapping(value, ("limits",), _LIMITS)
        default = vars(ClassLimits())
        memory, size, home = (self.number(inside.get(name, default[name]), ("limits", name),
                                          above=0.0)
                              for name in ("memory_mb", "file_mb", "home_mb"))
        processors, processes = (self.integer(inside.get(name, default[name]), ("limits", name), 1,
                                            100000) for name in ("processors", "processes"))
        return ClassLimits(memory, processors, processes, size, home)

    def _containers(self, value: Any) -> str:
        """Return the name of the container program; "" for processes without containers."""
        if value is None or value in PROGRAMS:
            return value or ""
        self.fault(("containers",), f"'containers' must be one of {', '.join(PROGRAMS)}, is"
                                    f" {value!r}")
        return ""

    def _inside(self, value: Any, path: Tuple[str, ...]) -> str:
        """A path below the home folder."""
        text = self.text(value, path)
        found = os.path.normpath(text[2:] if text.startswith("~/") else text)
        if os.path.isabs(found) or found.split(os.sep)[0] in ("..", "~"):
            self.fault(path, f"'{'.'.join(path)}' must be below the home folder, is {text!r}")
        return found


def _format_argument(value: Any) -> str:
    """A value of YAML as roslaunch takes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
