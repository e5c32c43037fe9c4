"""Reads docker/Dockerfile, and builds it in folders, for machines with root and without Docker.

The instructions are executed as `docker build` would: each RUN as the shell line that it is, in a
root of its own, in a mount and process name space of its own, with what ARG, ENV, WORKDIR and USER
have set.
"""
from __future__ import annotations

import json
import os
import shlex
import shutil
import socket
import subprocess
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple

REPOSITORY = Path(__file__).resolve().parents[3]
DOCKERFILE = REPOSITORY / "docker" / "Dockerfile"
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
CERTIFICATES = ("SSL_CERT_FILE", "PIP_CERT", "NODE_EXTRA_CA_CERTS")
"""Variables with the authorities that this machine's network needs; handed on, as with
`docker build --build-arg` for proxies."""


class Instruction(NamedTuple):
    """A line of the file: a word such as RUN, and what follows it."""

    word: str
    rest: str


def instructions() -> List[Instruction]:
    """All instructions, with continued lines in one."""
    found = []
    for line in DOCKERFILE.read_text(encoding="utf-8").replace("\\\n", " ").splitlines():
        if line.strip() and not line.startswith("#"):
            word, rest = line.split(None, 1)
            found.append(Instruction(word, rest))
    return found


def stages() -> List[List[Instruction]]:
    """The instructions of each stage, beginning with its FROM."""
    found: List[List[Instruction]] = []
    for instruction in instructions():
        if instruction.word == "FROM":
            found.append([])
        if found:
            found[-1].append(instruction)
    return found


def arguments() -> Dict[str, str]:
    """The build arguments with their defaults."""
    return dict(rest.split("=", 1) for word, rest in instructions() if word == "ARG")


def context() -> List[str]:
    """What `COPY .` copies: the files that git knows or would add."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            cwd=REPOSITORY, capture_output=True, text=True, check=True, timeout=60)
    return [name for name in listed.stdout.split("\0") if name and (REPOSITORY / name).exists()]


class Stage:
    """A root in which a stage is built, and its image's settings."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.environment: Dict[str, str] = {}
        self.user = "root"
        self.folder = "/"
        self.settings: Dict[str, str] = {}
        self.commands: List[str] = []

    def account(self) -> List[str]:
        """Name, numbers and home of USER, from the root's passwd."""
        for line in (self.root / "etc" / "passwd").read_text().splitlines():
            fields = line.split(":")
            if fields[0] == self.user:
                return fields
        raise LookupError(f"the image has no user {self.user}")

    def command(self, line: str, **variables: str) -> List[str]:
        """The words that execute `line` by the root's shell, as USER in WORKDIR."""
        fields = self.account()
        environment = {"PATH": PATH, "HOME": fields[5], **self.environment, **variables}
        words = [f"{name}={value}" for name, value in environment.items()]
        inside = ["chroot", f"--userspec={fields[2]}:{fields[3]}", str(self.root), "env", "-i",
                  *words, "sh", "-c", f"cd {shlex.quote(self.folder)} && {line}"]
        root = shlex.quote(str(self.root))
        # Only this command sees the mounts, and its processes end with it.
        return ["unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c",
                f"mount -t proc proc {root}/proc && mount --rbind /dev {root}/dev && "
                f"exec {shlex.join(inside)}"]

    def run(self, line: str, limit: float) -> None:
        """Execute a RUN line, with the authorities of this machine; fails with its last lines."""
        variables = {}
        for name in CERTIFICATES:
            if name in os.environ:
                # Not where it is here: there ca-certificates puts its own.
                variables[name] = f"/etc/{name.lower()}.crt"
                shutil.copy(os.environ[name], self.root / variables[name].lstrip("/"))
        shutil.copy("/etc/resolv.conf", self.root / "etc" / "resolv.conf")
        done = subprocess.run(self.command(line, **variables), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=limit, check=False)
        self.commands.append(line)
        assert done.returncode == 0, f"RUN {line}\n{done.stdout[-3000:]}"

    def inside(self, path: str) -> Path:
        """The place of a path of the image."""
        return self.root / os.path.join(self.folder, path).lstrip("/")

    def copy(self, rest: str, others: Mapping[str, Stage]) -> None:
        """Execute a COPY of the context or of another stage."""
        words = rest.split()
        options = dict(word[2:].split("=", 1) for word in words if word.startswith("--"))
        source, target = (word for word in words if not word.startswith("--"))
        place = self.inside(target)
        place.mkdir(parents=True, exist_ok=True)
        if "from" in options:
            origin = others[options["from"]].inside(source)
            subprocess.run(["cp", "-a", f"{origin}/.", str(place)], check=True, timeout=300)
        else:
            prefix = "" if source == "." else f"{source}/"
            for name in context():
                if name.startswith(prefix):
                    (place / name[len(prefix):]).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(REPOSITORY / name, place / name[len(prefix):])
        if "chown" in options:
            subprocess.run(["chroot", str(self.root), "chown", "-R", options["chown"],
                            os.path.join(self.folder, target)], check=True, timeout=300)

    def execute(self, instruction: Instruction, others: Mapping[str, Stage], limit: float) -> None:
        """Execute an instruction of the stage after its FROM."""
        word, rest = instruction
        if word == "RUN":
            self.run(rest, limit)
        elif word == "COPY":
            self.copy(rest, others)
        elif word == "ENV":
            self.environment.update(part.split("=", 1) for part in shlex.split(rest))
        elif word == "USER":
            self.user = rest
        elif word == "WORKDIR":
            self.folder = os.path.join(self.folder, rest)
            self.inside("").mkdir(parents=True, exist_ok=True)
        elif word == "ARG":
            raise NotImplementedError("an ARG inside of a stage")
        else:
            self.settings[word] = rest

    def words(self, setting: str) -> List[Any]:
        """The list that ENTRYPOINT, CMD or HEALTHCHECK names in brackets."""
        text = self.settings[setting]
        return list(json.loads(text[text.index("["):]))

    def megabytes(self) -> float:
        """What the files take, as an image's size counts them, in 10^6 bytes."""
        seen, total = set(), 0
        for folder, folders, names in os.walk(self.root):
            if Path(folder) == self.root:
                folders[:] = [name for name in folders if name not in ("proc", "dev", "sys")]
            for name in names:
                status = os.lstat(os.path.join(folder, name))
                if (status.st_dev, status.st_ino) not in seen:
                    seen.add((status.st_dev, status.st_ino))
                    total += status.st_size
        return total / 1e6


def build(base: Path, work: Path, limit: float) -> Stage:
    """Build all stages in folders of `work`, each from a copy of the root `base`; gives the last.

    Raises AssertionError with the last lines of a RUN that fails. `limit`: seconds for one RUN.
    """
    built: Dict[str, Stage] = {}
    stage = Stage(work)
    for number, (first, *others) in enumerate(stages()):
        name = first.rest.split()[-1] if " AS " in first.rest else str(number)
        stage = Stage(work / name)
        subprocess.run(["cp", "-a", str(base), str(stage.root)], check=True, timeout=300)
        # Docker puts these names into each container.
        (stage.root / "etc" / "hosts").write_text(
            f"127.0.0.1 localhost\n127.0.1.1 {socket.gethostname()}\n")
        for instruction in others:
            stage.execute(instruction, built, limit)
        built[name] = stage
    return stage
