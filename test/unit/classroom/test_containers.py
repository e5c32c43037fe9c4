"""Containers of a class, with a stand-in for the program that manages them."""
from __future__ import annotations

import io
import tarfile
import time

import pytest

from my_simulations.classroom.class_file import read_class
from my_simulations.classroom.container_world import ContainerWorld
from my_simulations.classroom.containers import Containers
from my_simulations.classroom.world_states import ENDED, STARTING, STOPPED
from my_simulations.errors import CommandError, InputError

PROGRAM = """#!/bin/sh
# A container is a folder: exec runs the command there, if the file `running` exists.
echo "$@" >> {folder}/calls
if [ "$1" = -n ]; then shift 2; fi
word=$1; shift
case $word in
  start) [ -d {folder}/$1 ] || {{ echo "no such container: $1" >&2; exit 125; }}
         touch {folder}/$1/running ;;
  stop) rm {folder}/$1/running ;;
  exec) shift; name=${{1##*/}}; shift; if [ "$1" = -- ]; then shift; fi
        [ -e {folder}/$name/running ] || {{ echo "container $name is not running" >&2; exit 1; }}
        cd {folder}/$name && HOME={folder}/$name PATH={folder}/bin:$PATH exec "$@" ;;
esac
"""
SECONDS = 30.0


@pytest.fixture(params=["docker", "kubectl"])
def plan(request, tmp_path, monkeypatch):
    (tmp_path / "bin").mkdir()
    program = tmp_path / "bin" / request.param
    program.write_text(PROGRAM.format(folder=tmp_path))
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:/usr/bin:/bin")
    (tmp_path / "lab.yaml").write_text(
        f"students: [anna, ben]\ncontainers: {request.param}\nlimits: {{file_mb: 1}}\n")
    home = tmp_path / ("anna" if request.param == "kubectl" else "lab-anna")
    (home / "submission" / ".git").mkdir(parents=True)
    (home / "running").touch()
    found = read_class(str(tmp_path / "lab.yaml"))[0]
    return found, Containers(found), home


def test_a_file_goes_into_a_home_and_files_of_a_submission_come_out(plan, tmp_path):
    plan, containers, home = plan
    anna = plan.students[0]
    assert containers.send(anna, "-a b.txt", b"one") == "received/-a b.txt"
    assert containers.send(anna, "-a b.txt", b"two") == "received/-a b.txt"
    assert (home / "received" / "-a b.txt").read_bytes() == b"two"
    assert (tmp_path / "calls").exists()
    submission = home / "submission"
    (submission / "src").mkdir()
    (submission / "src" / "go.py").write_text("go")
    (submission / "src" / "go.py").chmod(0o755)
    (submission / ".git" / "config").write_text("hidden")
    (submission / "link").symlink_to("/etc/passwd")
    out = tmp_path / "out"
    assert containers.collect(anna, str(out)) == 1
    assert [str(path.relative_to(out)) for path in out.rglob("*") if not path.is_dir()] == [
        "anna/src/go.py"]
    assert (out / "anna" / "src" / "go.py").stat().st_mode & 0o111
    (submission / "src" / "go.py").unlink()
    assert containers.collect(anna, str(out)) == 0
    assert not (out / "anna").exists()


def archive(*members):
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as made:
        for name, content, kind in members:
            member = tarfile.TarInfo(name)
            member.size, member.type, member.linkname = len(content), kind, "/etc/passwd"
            made.addfile(member, io.BytesIO(content))
    return stream.getvalue()


@pytest.mark.parametrize("data, files", [
    (archive(("../evil", b"1", tarfile.REGTYPE), ("/etc/evil", b"1", tarfile.REGTYPE),
             ("a/../../evil", b"1", tarfile.REGTYPE), ("good", b"1", tarfile.REGTYPE)), ["good"]),
    (archive(("link", b"", tarfile.SYMTYPE), ("hard", b"", tarfile.LNKTYPE),
             ("fifo", b"", tarfile.FIFOTYPE), ("good", b"1", tarfile.REGTYPE)), ["good"]),
    (archive(("small", b"1", tarfile.REGTYPE), ("big", bytes(2000000), tarfile.REGTYPE),
             ("after", b"1", tarfile.REGTYPE)), ["small"]),
    (b"no archive at all", []), (b"", [])])
def test_an_archive_that_a_student_forged_writes_nothing_elsewhere(plan, tmp_path, data, files):
    plan, containers, home = plan
    (tmp_path / "forged").write_bytes(data)
    tar = tmp_path / "bin" / "tar"
    tar.write_text(f"#!/bin/sh\nexec cat {tmp_path}/forged\n")
    tar.chmod(0o755)
    out = tmp_path / "deep" / "out"
    if files or not data:
        assert containers.collect(plan.students[0], str(out)) >= len(files)
    else:
        with pytest.raises(CommandError, match="anna: the archive is invalid"):
            containers.collect(plan.students[0], str(out))
    assert sorted(str(path.relative_to(out / "anna")) for path in out.rglob("*")
                  if path.is_file()) == files
    assert not (tmp_path / "deep" / "evil").exists() and not (tmp_path / "evil").exists()


def test_a_container_that_does_not_run_is_named(plan, tmp_path, monkeypatch):
    plan, containers, _ = plan
    ben = plan.students[1]
    assert containers.status(ben)["state"] == "stopped"
    assert "is not running" in containers.status(ben)["reason"]
    with pytest.raises(CommandError, match="is not running"):
        containers.send(ben, "a", b"")
    with pytest.raises(CommandError, match="is not running"):
        containers.collect(ben, str(tmp_path / "out"))
    monkeypatch.setenv("PATH", str(tmp_path / "none"))
    with pytest.raises(CommandError, match="cannot be run"):
        containers.send(ben, "a", b"")


def looked(world, condition):
    until = time.monotonic() + SECONDS
    while not condition() and time.monotonic() < until:
        world.poll()
    assert condition(), (world.state, world.reason)


@pytest.mark.parametrize("plan", ["docker"], indirect=True)
def test_the_world_of_a_container_starts_ends_and_stops(plan):
    plan, _, home = plan
    world = ContainerWorld(plan, plan.students[0], "token")
    assert (world.state, world.monitor) == (STOPPED, plan.students[0].port)
    (home / "running").unlink()
    world.start()
    assert world.state == STARTING
    looked(world, (home / "running").exists)
    world.stop("enough")
    assert (world.state, world.reason) == (STOPPED, "enough")
    assert not (home / "running").exists()
    world.start()
    looked(world, (home / "running").exists)
    (home / "running").unlink()
    looked(world, lambda: world.state == ENDED)
    other = ContainerWorld(plan, plan.students[1], "token")
    other.start()
    looked(other, lambda: other.state == ENDED)
    assert other.reason == "no such container: lab-ben"


def test_the_program_is_one_of_three(tmp_path):
    (tmp_path / "lab.yaml").write_text("students: 2\ncontainers: lxc\n")
    with pytest.raises(InputError) as caught:
        read_class(str(tmp_path / "lab.yaml"))
    assert [(issue.line, issue.code) for issue in caught.value.issues] == [(2, "class-value")]
