"""What the set-up decides by os-release, dpkg and apt, on systems that are only told here."""
from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import tarfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import test_setup_shell as shells

REPOSITORY = Path(__file__).resolve().parents[3]

SYSTEMS = {
    # name: (ID, PRETTY_NAME, the folder of /opt/ros that is there, apt has ROS 1)
    "focal": ("ubuntu", "Ubuntu 20.04 LTS", "noetic", True),
    "jammy": ("ubuntu", "Ubuntu 22.04 LTS", "", True),
    "jammy with ROS One": ("ubuntu", "Ubuntu 22.04 LTS", "one", True),
    "noble": ("ubuntu", "Ubuntu 24.04 LTS", "", False),
    "bullseye": ("debian", "Debian GNU/Linux 11 (bullseye)", "", True),
    "bookworm": ("debian", "Debian GNU/Linux 12 (bookworm)", "", True),
    "trixie": ("debian", "Debian GNU/Linux 13 (trixie)", "", True),
}
RECENT = {"libembree4-4": ["trixie"], "chromium-headless-shell": ["bookworm", "trixie"]}
"""Packages that not all of them have, and which have them."""


class System:
    """A home on a system with an apt that knows and installs what it is told."""

    def __init__(self, clone, home, name, root=True, universe=True, machine="x86_64"):
        self.clone, self.home = clone, home
        kind, title, self.prefix, has_ros = SYSTEMS[name]
        home.mkdir(parents=True)
        (home / "os-release").write_text(f'ID={kind}\nPRETTY_NAME="{title}"\n')
        if self.prefix:
            (home / self.prefix).mkdir()
            (home / self.prefix / "setup.bash").write_text("")
        no_ros = "" if has_ros and universe else "*ros*) ;;"
        shells.fake(home, "id", f"echo {0 if root else 1000}")
        shells.fake(home, "uname", f"echo {machine}")
        shells.fake(home, "getent", "exit 0")
        shells.fake(home, "fake_python", "echo 13" if name == "trixie" else "echo 11")
        shells.fake(home, "dpkg-query", "shift 2; mapfile -t all <$HOME/installed; for name; do "
                    "[[ \" ${all[*]} \" == *\" $name \"* ]] && echo installed $name; "
                    f"[ $name != ros-{self.prefix}-catkin ] || echo installed $name; done")
        shells.fake(home, "apt-get", 'echo "$@" >>$HOME/calls')
        shells.fake(home, "apt-cache", "if [ $1 = policy ]; then "
                    f"echo '500 archive jammy/{'universe' if universe else 'main'} all'; exit; fi\n"
                    "shift; found=1; for name; do case $name in --*) continue ;; " + no_ros +
                    "".join(f" {package}) true ;;" for package, systems in RECENT.items()
                            if name not in systems) +
                    " *) echo Package: $name; found=0 ;; esac; done; exit $found")
        (home / "installed").write_text("")

    def run(self, script):
        """`script` in a shell of this system."""
        return shells.shell(
            self.clone, f"ROS_PREFIX=$HOME/{self.prefix or 'noetic'}; STEPS=9\n"
            "OS_RELEASE=$HOME/os-release\n"
            "PYTHON=$HOME/bin/fake_python; WORKSPACE=$HOME/ws; OWN=$HOME/ws; LOGS=$HOME/logs\n"
            "mkdir -p $OWN/src; rospack() { :; }; COMMAND=tools/run\n"
            "command() { case $2 in sudo|npm) false ;; *) builtin command \"$@\" ;; esac; }\n"
            + script, self.home)


@pytest.fixture
def clone(tmp_path):
    return shells.make_clone(tmp_path / "clone")


@pytest.mark.parametrize("name", [name for name in SYSTEMS if name != "noble"])
def test_system_with_ros_installs_its_lists_and_no_others(clone, tmp_path, name):
    system = System(clone, tmp_path / "home", name)
    done = system.run("COMMON_PACKAGES=0; install_system_packages")
    assert done.returncode == 0, done.stderr
    update, install = (system.home / "calls").read_text().splitlines()
    assert update == "-q update"
    words = install.split()
    assert ("python3-rospy" in words, "catkin" in words) == (not system.prefix, not system.prefix)
    of_prefix = [word for word in words if word.startswith(("ros-noetic-", "ros-one-"))]
    assert bool(of_prefix) is bool(system.prefix)
    assert all(word.startswith(f"ros-{system.prefix}-") for word in of_prefix)
    assert {"python3-venv", "libegl1", "npm"} <= set(words)


def test_lists_of_apt_are_fetched_once_in_a_run(clone, tmp_path):
    system = System(clone, tmp_path / "home", "trixie")
    done = system.run("WITH_TEST_TOOLS=1; install_system_packages; begin X; install_compiler")
    assert done.returncode == 0, done.stderr
    calls = [line.split()[1] if line.startswith("-q update") else "install"
             for line in (system.home / "calls").read_text().splitlines()]
    assert calls == ["update"] + ["install"] * 4  # needed, common, for tests, compiler


def test_package_that_only_new_lists_name_is_installed(clone, tmp_path):
    system = System(clone, tmp_path / "home", "trixie", machine="aarch64")
    known = (system.home / "bin" / "apt-cache").read_text()
    shells.fake(system.home, "apt-cache", "[ -e $HOME/calls ] || exit 100\n" + known)
    done = system.run("COMMON_PACKAGES=0; install_system_packages")
    assert done.returncode == 0, done.stderr
    assert "libembree4-4" in (system.home / "calls").read_text().split()


@pytest.mark.parametrize("name", ["bookworm", "focal"])
def test_tests_have_the_browser_without_windows_where_there_is_one(clone, tmp_path, name):
    system = System(clone, tmp_path / "home", name)
    done = system.run("WITH_TEST_TOOLS=1; system_packages all; WITH_TEST_TOOLS=0; echo; "
                      "system_packages all")
    browsers = [[word for word in part.split() if word.startswith("chromium")]
                for part in done.stdout.split("\n\n")]
    expected = "chromium-headless-shell" if name == "bookworm" else "chromium"
    assert browsers == [[expected], []]


def test_system_without_ros_is_told_what_has_it_before_anything_is_installed(clone, tmp_path):
    system = System(clone, tmp_path / "home", "noble")
    done = system.run("install_system_packages")
    assert done.returncode == 1
    assert "Ubuntu 24.04 LTS has no packages of ROS 1" in done.stderr
    assert "docker/Dockerfile" in done.stderr
    assert (system.home / "calls").read_text().splitlines() == ["-q update"]


def test_universe_that_is_not_enabled_is_named(clone, tmp_path):
    system = System(clone, tmp_path / "home", "jammy", universe=False)
    done = system.run("install_system_packages")
    assert done.returncode == 1
    assert "add-apt-repository universe" in done.stderr


@pytest.mark.parametrize(("there", "variables", "expected"), [
    (["one"], {}, "/one sources"), (["noetic", "one"], {}, "/noetic sources"), ([], {}, "/one apt"),
    (["noetic", "one"], {"ROS_DISTRO": "one"}, "/one sources"),
    (["one", "humble"], {"ROS_DISTRO": "humble"}, "/one sources"),
    (["noetic"], {"MY_SIMULATIONS_ROS_PREFIX": "/opt/mine"}, "/opt/mine apt")])
def test_ros_is_the_one_of_the_shell_or_the_first_that_is_there(clone, tmp_path, there, variables,
                                                                expected):
    folder = tmp_path / "opt"
    for name in there:
        (folder / name).mkdir(parents=True)
        (folder / name / "setup.bash").touch()
    library = clone / "tools" / "lib" / "system.sh"
    library.write_text(library.read_text().replace("/opt/ros/", f"{folder}/"))
    done = shells.shell(clone, "echo $ROS_PREFIX $(ros_source)", tmp_path / "home", **variables)
    assert done.stdout.strip().replace(str(folder), "") == expected, done.stderr


def test_noetic_from_sources_needs_no_package_of_ros(clone, tmp_path):
    system = System(clone, tmp_path / "home", "bookworm")
    (system.home / "noetic").mkdir()
    (system.home / "noetic" / "setup.bash").write_text("")
    done = system.run("ros_source; echo; system_packages all")
    assert done.stdout.splitlines()[0] == "sources"
    assert not re.search(r"^(catkin|python3-rospy|ros-noetic-.*)$", done.stdout, re.MULTILINE)


@pytest.mark.parametrize(("name", "compiled"), [("bookworm", False), ("trixie", True)])
def test_administrator_is_told_all_in_one_command(clone, tmp_path, name, compiled):
    system = System(clone, tmp_path / "home", name, root=False)
    done = system.run("install_system_packages")
    assert done.returncode == 1
    (command,) = (line for line in done.stderr.splitlines() if "apt-get install" in line)
    words = command.split()
    assert {"python3-venv", "python3-rospy", "catkin", "npm", "libegl1"} <= set(words)
    assert ("python3-dev" in words) is compiled
    assert len(set(words)) >= len(words) - 2  # "apt-get", and "install" once more at most
    assert "/etc/hosts" not in command
    assert not (system.home / "calls").exists()


def test_administrator_is_told_of_localhost_in_the_same_command(clone, tmp_path):
    system = System(clone, tmp_path / "home", "bookworm", root=False)
    shells.fake(system.home, "getent", "exit 2")
    done = system.run("install_system_packages")
    (command,) = (line for line in done.stderr.splitlines() if "apt-get install" in line)
    assert command.endswith(" && echo '127.0.0.1 localhost' >>/etc/hosts")


def test_user_without_root_goes_on_where_all_is_installed(clone, tmp_path):
    system = System(clone, tmp_path / "home", "bookworm", root=False)
    (system.home / "installed").write_text(system.run("system_packages all").stdout)
    done = system.run("COMMON_PACKAGES=0; install_system_packages")
    assert done.returncode == 0, done.stderr
    assert "all there" in done.stdout
    assert not (system.home / "calls").exists()


def test_packages_to_run_hold_no_compiler(clone, tmp_path):
    system = System(clone, tmp_path / "home", "bookworm")
    needed, everything = (set(system.run(f"system_packages {what}").stdout.split())
                          for what in ("run", "all"))
    assert needed < everything
    assert {"build-essential", "cmake", "catkin", "npm"} <= everything - needed


@pytest.mark.parametrize(("name", "machine", "embree"), [
    ("bookworm", "x86_64", False), ("bookworm", "aarch64", False), ("trixie", "aarch64", True)])
def test_embree_comes_from_the_system_where_there_is_no_wheel(clone, tmp_path, name, machine,
                                                               embree):
    system = System(clone, tmp_path / "home", name, machine=machine)
    assert ("libembree4-4" in system.run("system_packages run").stdout.split()) is embree
    done = system.run("needs_compiler && echo compiles; compile_packages")
    assert ("compiles" in done.stdout) is (machine == "aarch64")
    assert ("libx11-dev" in done.stdout) is (machine == "aarch64")


# -- archives for machines without a network ------------------------------------------------------

BUNDLE_PYTHON = """
echo "$@" >>$HOME/calls
case "$*" in
  -c*) echo Python 3.11 on x86_64 ;;
  --version) echo Python 3.11.2 ;;
  *"pip wheel"*) for word; do [ "$last" != --wheel-dir ] || out=$word; last=$word; done
    touch $out/pybullet.whl ;;
esac
"""


@pytest.fixture
def classroom(clone, tmp_path):
    """A system whose set-up is done, apart from the archive."""
    system = System(clone, tmp_path / "home", "bookworm")
    shells.fake(system.home, "fake_python", BUNDLE_PYTHON)
    shells.fake(system.home, "npm", "echo npm >>$HOME/calls")
    (clone / "requirements.txt").write_text("pybullet==3.2.7\n")
    (clone / "web").mkdir()
    for name in ("package.json", "package-lock.json"):
        (clone / "web" / name).write_text("{}")
    own = system.home / "ws" / ".my_simulations"
    (own / "venv" / "bin").mkdir(parents=True)
    (own / "venv" / "bin" / "python3").symlink_to(system.home / "bin" / "fake_python")
    (own / "node_modules" / "three").mkdir(parents=True)
    system.set = "OWN=$HOME/ws/.my_simulations; VENV=$OWN/venv; FILE=$HOME/class.tgz\n"
    done = system.run(system.set + "sha256sum <$CLONE/web/package-lock.json >$OWN/.page\n"
                      "stamp=$(cat $OWN/.page); printf '%s' \"$stamp\" >$OWN/.page\n"
                      "make_bundle $FILE")
    assert done.returncode == 0, done.stderr
    return system


def test_archive_holds_wheels_modules_and_names_of_packages(classroom):
    with tarfile.open(classroom.home / "class.tgz") as archive:
        names = {name[2:] for name in archive.getnames()}
        packages = archive.extractfile("./apt-packages.txt").read().decode().split()
    assert {"wheels/pybullet.whl", "page/node_modules/three", "page/.page", "system"} <= names
    assert "python3-rospy" in packages and "npm" not in packages


def test_set_up_from_an_archive_asks_no_index(classroom):
    (classroom.home / "calls").unlink()
    done = classroom.run(classroom.set + "rm -rf $OWN/node_modules $OWN/.page; begin X\n"
                         "open_bundle $FILE; prepare_python $CLONE/requirements.txt\nprepare_page")
    assert done.returncode == 0, done.stderr
    calls = (classroom.home / "calls").read_text().splitlines()
    (install,) = (line for line in calls if "pip install" in line)
    assert "--no-index" in install and "bundle/wheels" in install
    assert "npm" not in calls
    assert (classroom.home / "ws" / ".my_simulations" / "node_modules" / "three").is_dir()


def test_set_up_after_one_from_an_archive_needs_no_npm(classroom):
    set_up = classroom.set + "begin X; open_bundle $FILE; prepare_page; release; BUNDLED=\n"
    done = classroom.run(classroom.set + "rm -rf $OWN/node_modules $OWN/.page; "
                         "lacks_npm && echo lacks it\n" + set_up + "lacks_npm || echo has it\n"
                         "[ -e $OWN/bundle ] || echo removed it\n"
                         "WITH_TEST_TOOLS=1; lacks_npm && echo tests lack it")
    assert [line for line in done.stdout.splitlines() if line.endswith(" it")] == [
        "lacks it", "has it", "removed it", "tests lack it"], done.stderr


def test_archive_for_another_python_is_refused(classroom):
    shells.fake(classroom.home, "fake_python", "echo Python 3.13 on aarch64")
    done = classroom.run(classroom.set + "begin X; open_bundle $FILE")
    assert done.returncode == 1
    assert "is for Python 3.11 on x86_64; here is Python 3.13 on aarch64" in done.stderr


# -- the release ----------------------------------------------------------------------------------

def test_version_is_the_same_wherever_it_is_stated():
    version = ElementTree.parse(REPOSITORY / "package.xml").getroot().findtext("version")
    module = (REPOSITORY / "src" / "my_simulations" / "__init__.py").read_text()
    assert re.search(r'^__version__ = "(.*)"$', module, re.MULTILINE).group(1) == version
    citation = (REPOSITORY / "CITATION.cff").read_text()
    assert re.search(r"^version: (.*)$", citation, re.MULTILINE).group(1) == version
    for name in ("my_simulations_msgs", "my_simulations_underlay"):
        path = REPOSITORY / "compat" / name / "package.xml"
        assert ElementTree.parse(path).getroot().findtext("version") == version
    sections = re.findall(r"^(\d+\.\d+\.\d+) \(", (REPOSITORY / "CHANGELOG.rst").read_text(),
                          re.MULTILINE)
    assert sections[:1] in ([], [version])


def test_lock_file_of_the_page_can_be_read():
    lock = json.loads((REPOSITORY / "web" / "package-lock.json").read_text())
    assert lock["packages"]["node_modules/three"]["integrity"].startswith("sha512-")


def test_library_of_the_system_casts_rays_where_no_wheel_does(monkeypatch):
    from my_simulations.sensing.rays import embree
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(embree.ctypes.util, "find_library", lambda name: f"lib{name}.so.4")
    assert embree.library_path() == "libembree4.so.4"


FAKE_PYTHON = """#!/bin/bash
# Makes environments of copies of this file, and builds nothing: it keeps package.xml.
case "$*" in
  "-m venv "*) mkdir -p "$3/bin"; cp "$0" "$3/bin/python"
    for name in pip twine; do printf '#!/bin/bash\necho "$0 $*"' >"$3/bin/$name"; done
    chmod +x "$3"/bin/* ;;
  "-m build --outdir "*)
    for end in .tar.gz -py3-none-any.whl; do
      cp "$5/package.xml" "$4/my_simulations-0.1.0$end"
    done ;;
  *) echo "python $*" ;;
esac
"""


def test_release_is_made_of_what_is_committed_without_ros(tmp_path):
    def run(*words):
        return subprocess.run(words, cwd=clone, check=False, capture_output=True, text=True,
                              timeout=60, env={**os.environ, "PATH": f"{tmp_path}:/usr/bin:/bin",
                                               "PYTHON": str(tmp_path / "python")})

    clone, address = tmp_path / "clone", "https://host.example/it"
    (clone / "tools").mkdir(parents=True)
    shutil.copy(REPOSITORY / "tools" / "release", clone / "tools" / "release")
    shutil.copy(REPOSITORY / "package.xml", clone)
    (tmp_path / "python").write_text(FAKE_PYTHON)
    (tmp_path / "python").chmod(0o755)
    for words in (("init", "-q"), ("add", "-A"), ("-c", "user.name=a", "-c", "user.email=a@b",
                                                  "commit", "-qm", "all")):
        assert run("git", *words).returncode == 0
    done = run("tools/release", str(tmp_path / "out"), f"{address}.git")
    assert done.returncode == 0, done.stderr
    (archive,) = (tmp_path / "out").glob("my_simulations-*.tar.gz")
    (wheel,) = (tmp_path / "out").glob("my_simulations-*.whl")
    for made in (archive, wheel):
        manifest = ElementTree.parse(made).getroot()
        assert manifest.find("url").attrib == {"type": "repository"}
        assert manifest.findtext("url") == address
        assert f"twine check --strict {archive} {wheel}" in done.stdout
    assert f"pip install --quiet {wheel}[editor]" in done.stdout
    assert "check_installation.py" in done.stdout and "git tag -a" in done.stdout
    (clone / "new").touch()
    done = run("tools/release", str(tmp_path / "again"), address)
    assert done.returncode == 1
    assert "changes that no commit has" in done.stderr
