"""Builds the container in folders, line by line as its file says, and runs it. Takes half an hour.

Needs root, debootstrap and a network, and no Docker. The root to begin with is made for BASE, or
is the folder that MY_SIMULATIONS_BASE_ROOT names (what `docker export` gives of another base, for
example of ros:noetic-ros-core; it is only read).
"""
from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from dockerfile import Stage, arguments, build

BASE = os.environ.get("BASE", arguments()["BASE"])
SUITES = {"debian:12-slim": "bookworm", "debian:13-slim": "trixie"}
RUN_LIMIT = 3600.0
START_LIMIT = 300.0
LARGEST = 700.0
"""10^6 bytes that the container for running may take."""

pytestmark = [
    pytest.mark.long, pytest.mark.skipif(os.geteuid() != 0 or not shutil.which("debootstrap"),
                       reason="needs root and debootstrap")]


def slim(root: Path) -> None:
    """Remove what Debian's slim images lack; set dpkg as they do, not to wait for the disk."""
    for name in ("usr/share/doc", "usr/share/info", "usr/share/locale", "usr/share/man",
                 "var/cache/apt", "var/lib/apt/lists"):
        shutil.rmtree(root / name, ignore_errors=True)
    (root / "etc" / "dpkg" / "dpkg.cfg.d" / "docker-apt-speedup").write_text("force-unsafe-io\n")


@pytest.fixture(scope="module")
def image(tmp_path_factory) -> Stage:
    """The last stage, built."""
    work = tmp_path_factory.mktemp("container")
    given = os.environ.get("MY_SIMULATIONS_BASE_ROOT")
    base = Path(given) if given else work / "base"
    if not given:
        subprocess.run(["debootstrap", "--variant=minbase", SUITES[BASE], str(base)], check=True,
                       timeout=RUN_LIMIT, stdout=subprocess.DEVNULL)
        slim(base)
    yield build(base, work, RUN_LIMIT)
    shutil.rmtree(work)


class Running:
    """The container's command with a network of its own, which only has the loopback device."""

    def __init__(self, image: Stage, log: Path) -> None:
        self.log = log
        line = "exec " + " ".join([*image.words("ENTRYPOINT"), *image.words("CMD")])
        # A student's token as in compose.yaml.
        with open(log, "w", encoding="utf-8") as output:
            self.process = subprocess.Popen(
                ["unshare", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh",
                 *image.command(line, MY_SIMULATIONS_EDITOR_TOKEN="token-of-a-student")],
                stdout=output, stderr=subprocess.STDOUT)
        self.image = image

    def beside(self, *words: str) -> subprocess.CompletedProcess:
        """A command of this machine in the container's network."""
        return subprocess.run(["nsenter", f"--net=/proc/{self.process.pid}/ns/net", *words],
                              capture_output=True, text=True, timeout=60, check=False)

    def healthy(self) -> bool:
        """Whether HEALTHCHECK's command succeeds."""
        line = " ".join(self.image.words("HEALTHCHECK"))
        return self.beside(*self.image.command(line)).returncode == 0

    def listens(self) -> bool:
        """Whether the editor answers on all addresses."""
        return f"00000000:{11346:04X}" in self.beside("cat", "/proc/net/tcp").stdout

    def first_process(self) -> int:
        """The process with the number 1 of the container, as this machine counts."""
        pid = self.process.pid
        return int(Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])


@pytest.fixture
def running(image, tmp_path):
    """The container, which is healthy and has its editor."""
    container = Running(image, tmp_path / "container.log")
    try:
        # The editor may listen a moment after the first service answers.
        for condition in (container.healthy, container.listens):
            deadline = time.monotonic() + START_LIMIT
            while not condition():
                assert container.process.poll() is None, container.log.read_text()
                assert time.monotonic() < deadline, (
                    f"{condition.__name__}: not within {START_LIMIT} s; the container said "
                    f"{container.log.read_text()}")
                time.sleep(0.1)
        yield container
    finally:
        container.process.kill()
        container.process.wait(timeout=60)


def test_every_run_line_succeeds_and_the_image_is_small(image, record):
    assert image.user == "student"
    record("container", base=BASE, megabytes=round(image.megabytes()))
    assert image.megabytes() <= LARGEST or not BASE.startswith("debian:")


def test_container_serves_the_editor_to_others_and_ends_when_it_is_told(running):
    script = ("import urllib.request, sys\n"
              "page = urllib.request.urlopen(sys.argv[1], timeout=30)\nprint(page.status)")
    address = "http://127.0.0.1:11346/"
    allowed = running.beside("python3", "-c", script, address + "?token=token-of-a-student")
    assert allowed.stdout.strip() == "200", allowed.stderr
    assert "403" in running.beside("python3", "-c", script, address).stderr
    os.kill(running.first_process(), signal.SIGINT)
    assert running.process.wait(timeout=60) == 0


def test_container_draws_cameras_and_casts_rays(image):
    script = ("from my_simulations.sensing.rays import embree; import moderngl; "
              "context = moderngl.create_context(standalone=True, require=330, backend='egl'); "
              "print(embree.library_path()); print(context.info['GL_RENDERER'])")
    line = (f"exec {' '.join(image.words('ENTRYPOINT'))} "
            f'.my_simulations/venv/bin/python3 -c "{script}"')
    done = subprocess.run(image.command(line), text=True, capture_output=True, timeout=120,
                          check=False)
    assert done.returncode == 0, done.stderr
    library, renderer = done.stdout.split("\n", 1)
    assert "embree" in library and renderer.strip()
