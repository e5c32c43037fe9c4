"""What a class consists of."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Tuple
from xml.sax.saxutils import quoteattr

FIRST_USER = 63000
"""User id of the first student: one that no account has (Debian policy, 9.2.2)."""


@dataclass(frozen=True)
class ClassLimits:
    """Limits of each student.

    Attributes:
        memory_mb: resident memory of all processes.
        processors: number of processors.
        processes: number of processes and threads.
        file_mb: size of a file, of /tmp, and of a collected submission.
        home_mb: size of all files of the home, of processes of this machine.
    """

    memory_mb: float = 2000.0
    processors: int = 1
    processes: int = 512
    file_mb: float = 500.0
    home_mb: float = 2000.0


@dataclass(frozen=True)
class Student:
    """A student of a class.

    Attributes:
        name: lower-case letters, digits, `_` and `-`.
        number: from 0.
        port: of the editor.
    """

    name: str
    number: int
    port: int

    @property
    def user(self) -> int:
        """Id of the user that the student's programs get where the system permits it."""
        return FIRST_USER + self.number


@dataclass(frozen=True)
class ClassPlan:
    """A class.

    Attributes:
        name: of the class.
        file: absolute path of the class file.
        folder: holds homes and the state of the class.
        host: address at which tutor's page and editors listen.
        port: of the tutor's page; the editors have the next ones.
        students: in order.
        launch: package and file of the launch file of each student.
        arguments: arguments of the launch file, `name:=value`.
        limits: of each student.
        idle_minutes: wall time without a browser after which a world is stopped; 0 for never.
        submission: folder in each home that is collected.
        image: container image of the manifests.
        containers: program that manages the containers of the class, `docker`, `podman` or
            `kubectl`; "" for a class of processes of this machine.
    """

    name: str
    file: str
    folder: str
    host: str
    port: int
    students: Tuple[Student, ...]
    launch: Tuple[str, str]
    arguments: Tuple[str, ...]
    limits: ClassLimits
    idle_minutes: float
    submission: str
    image: str
    containers: str = ""

    def home(self, student: Student) -> str:
        return os.path.join(self.folder, "students", student.name)

    @property
    def state(self) -> str:
        """Folder with tokens and the state of the class; only its owner can enter it."""
        return os.path.join(self.folder, "class")


def launch_text(plan: ClassPlan, port: int) -> str:
    """The roslaunch file of a student, whose editor listens at a port of all addresses."""
    package, file = plan.launch
    path = f"$(find {package})/{file if '/' in file else 'launch/' + file}"
    arguments = "".join(
        f"<arg name={quoteattr(name)} value={quoteattr(value)}/>"
        for name, _, value in (argument.partition(":=") for argument in plan.arguments))
    return (f'<launch>{arguments}<include file={quoteattr(path)} pass_all_args="true"/>'
            f'<param name="/gazebo/editor_port" type="int" value="{port}"/>'
            '<param name="/gazebo/editor_host" type="str" value="0.0.0.0"/></launch>')
