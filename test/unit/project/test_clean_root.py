"""tools/test --clean-root and .ci/run: what a root contains and what is left of it.

The roots here hold a shell and a few programs instead of Debian; a script replaces tools/test.
Where this user may not mount, the tests check that the command says so.
"""
from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]

DEBOOTSTRAP = """#!/bin/bash
echo "$@" >"$CALLS"
mkdir -p "$3"/{proc,sys,dev,tmp,root,etc/apt/apt.conf.d,etc/dpkg/dpkg.cfg.d}
for program in /bin/bash /usr/bin/env /bin/cat /bin/sleep; do
  cp -L --parents $program $(ldd $program | grep -o '/[^ ]*') "$3"
done
"""
REPORT = """#!/bin/bash
echo "words: $*"
compgen -e | while read name; do echo "$name=${!name}"; done
cat $PIP_CERT
while read -r _ place _; do echo "mount: $place"; done </proc/mounts
echo 3 passed, 1 failed
exit 3
"""
HANGS = "#!/bin/bash\necho begun\nsleep 1000\n"


class Machine:
    """A clone whose committed tools/test is `script`, and programs before the real ones."""

    def __init__(self, folder: Path, script: str) -> None:
        self.folder = folder
        self.clone = folder / "clone"
        shutil.copytree(REPOSITORY / "tools", self.clone / "tools")
        shutil.copytree(REPOSITORY / ".ci", self.clone / ".ci")
        self.environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}",
                            "CALLS": str(folder / "calls"), "TMPDIR": str(folder / "tmp"),
                            "PYENV_ROOT": str(folder), "HOME": str(folder / "home")}
        for name in ("bin", "tmp", "home"):
            (folder / name).mkdir()
        self.program("debootstrap", DEBOOTSTRAP)
        self.program("python3.8", "#!/bin/false\n")
        shutil.copy(self.clone / "tools" / "test", folder / "outer")
        (self.clone / "tools" / "test").write_text(script)
        for words in (["init", "-q"], ["add", "-A"], ["-c", "user.name=a", "-c", "user.email=a@b",
                                                      "commit", "-qm", "all"]):
            subprocess.run(["git", *words], cwd=self.clone, check=True, timeout=60)
        # The work tree has the real file, the commit has the script.
        shutil.copy(folder / "outer", self.clone / "tools" / "test")

    def program(self, name: str, text: str) -> None:
        (self.folder / "bin" / name).write_text(text)
        (self.folder / "bin" / name).chmod(0o755)

    def start(self, *words: str, **variables: str) -> subprocess.Popen:
        return subprocess.Popen(
            words, cwd=self.folder, env={**self.environment, **variables}, text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def roots(self) -> list:
        """What is left in the folder for temporary files, apart from kept logs."""
        return [path for path in (self.folder / "tmp").iterdir() if "logs" not in path.name]


def can_mount() -> bool:
    """Whether this user may mount in a name space of its own."""
    return os.geteuid() == 0 and subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "true"], check=False, timeout=60).returncode == 0


def refuses(text: str) -> bool:
    """Whether the command says why it makes no root, as it must where mounts are not allowed."""
    assert can_mount() or "no clean root can be made" in text, text
    return not can_mount()


def test_tests_run_in_a_root_with_the_settings_for_package_indexes_only(tmp_path):
    machine = Machine(tmp_path, REPORT)
    (tmp_path / "authority.crt").write_text("a certificate\n")
    process = machine.start(
        str(machine.clone / "tools" / "test"), "--clean-root", "trixie", "sdf", "urdf",
        https_proxy="http://proxy:1", PIP_CERT=str(tmp_path / "authority.crt"), PRIVATE="1",
        PYTHONPATH="/installed/by/hand")
    text, _ = process.communicate(timeout=120)
    if refuses(text):
        return
    lines = text.splitlines()
    assert process.returncode == 3, text
    assert "words: sdf urdf" in lines and "3 passed, 1 failed" in lines
    assert {"HOME=/root", "LANG=C.UTF-8", "https_proxy=http://proxy:1",
            "a certificate"} <= set(lines)
    assert not re.search("PRIVATE|PYTHONPATH|CALLS|TMPDIR", text)
    assert {f"mount: /{name}" for name in ("proc", "sys", "dev", "dev/shm")} <= set(lines)
    assert (tmp_path / "calls").read_text().startswith(
        f"--variant=minbase trixie {tmp_path}/tmp/my_simulations.")
    assert "without the changes that are not committed" in text  # tools/test is another file there


def test_root_goes_and_logs_stay_after_a_failure(tmp_path):
    machine = Machine(tmp_path, REPORT)
    process = machine.start(str(machine.clone / "tools" / "test"), "--clean-root")
    text, _ = process.communicate(timeout=120)
    if refuses(text):
        return
    (kept,) = re.findall(r"^The logs are kept in (.*)\.$", text, re.MULTILINE)
    assert (Path(kept) / "log" / "debootstrap.log").exists()
    assert machine.roots() == []
    assert str(tmp_path) not in Path("/proc/self/mounts").read_text()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_interrupt_ends_all_programs_and_removes_the_root(tmp_path, number):
    machine = Machine(tmp_path, HANGS)
    process = machine.start(str(machine.clone / "tools" / "test"), "--clean-root")
    line = text = process.stdout.readline()
    while line and line != "begun\n":
        line = process.stdout.readline()
        text += line
    if not line and refuses(text):
        return
    process.send_signal(number)
    process.communicate(timeout=60)  # all programs with this output have ended
    if number == signal.SIGKILL:
        assert machine.roots() != []  # nothing is left to remove it
        return
    assert process.returncode == 130
    assert machine.roots() == []
    assert str(tmp_path) not in Path("/proc/self/mounts").read_text()


def test_ci_says_why_it_runs_without_a_root(tmp_path):
    machine = Machine(tmp_path, REPORT)
    machine.program("id", "#!/bin/sh\necho 1000\n")
    (machine.clone / "tools" / "test").write_text(
        "#!/bin/bash\necho tested \"$@\" in \"$MY_SIMULATIONS_WS\"\n"
        "echo 4 passed, 0 failed\nexit 5\n")
    process = machine.start("bash", str(machine.clone / ".ci" / "run"), "sdf",
                            MY_SIMULATIONS_WS="")
    text, _ = process.communicate(timeout=60)
    assert process.returncode == 5, text
    first, second, last = text.splitlines()
    assert first == "The tests run on this system, not in a clean root: this user is not root."
    assert second.startswith("tested --complete sdf in ") and last == "4 passed, 0 failed"
    assert not Path(second.split()[-1]).exists()


def test_ci_uses_a_clean_root_of_debian_12(tmp_path):
    machine = Machine(tmp_path, REPORT)
    process = machine.start("bash", str(machine.clone / ".ci" / "run"), "sdf")
    text, _ = process.communicate(timeout=120)
    if not can_mount():
        return
    assert process.returncode == 3, text
    assert "words: --complete sdf" in text and " bookworm " in (tmp_path / "calls").read_text()


def test_option_without_root_says_what_it_takes(tmp_path):
    machine = Machine(tmp_path, REPORT)
    machine.program("id", "#!/bin/sh\necho 1000\n")
    process = machine.start(str(machine.clone / "tools" / "test"), "--clean-root", "bullseye")
    text, _ = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "no clean root can be made: this user is not root." in text
    assert "apt-get install debootstrap" in text and not (tmp_path / "calls").exists()
