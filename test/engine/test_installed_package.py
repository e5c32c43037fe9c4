"""What pip installs is whole: the modules, the models and worlds, and the editor's page."""
from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
WORKSPACE = Path(sys.prefix).parents[1]
SET_UP = ("import sys, runpy\n"
          "sys.modules['catkin_pkg'] = None\n"  # as on a machine without ROS
          "sys.argv[0] = 'setup.py'\n"
          "runpy.run_path('setup.py', run_name='__main__')\n")


def run(*words, folder=ROOT, **variables):
    environment = {"PATH": os.environ["PATH"], "HOME": os.environ["HOME"], **variables}
    done = subprocess.run([sys.executable, *map(str, words)], capture_output=True, text=True,
                          timeout=300, cwd=folder, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def repository(tmp_path_factory):
    """A copy of the files that git has, or would have: packing leaves traces in its folder."""
    copy = tmp_path_factory.mktemp("repository")
    listed = subprocess.run(["git", "ls-files", "-coz", "--exclude-standard"], cwd=ROOT,
                            capture_output=True, check=True).stdout.decode().split("\0")
    names = sorted(name for name in listed if name and (ROOT / name).is_file())
    for name in names:
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, copy / name)
    return copy, names


@pytest.fixture(scope="module")
def source(repository, tmp_path_factory):
    """The unpacked source archive; its page is that of the workspace."""
    copy, names = repository
    place = tmp_path_factory.mktemp("source")
    run("-c", SET_UP, "-q", "sdist", "--dist-dir", place, folder=copy,
        MY_SIMULATIONS_WS=str(WORKSPACE))
    (archive,) = place.glob("*.tar.gz")
    with tarfile.open(archive) as packed:
        packed.extractall(place)
    archive.unlink()
    (folder,) = place.iterdir()
    return folder, names


def test_a_source_archive_has_all_files_of_the_repository_and_the_page(source):
    folder, names = source
    assert [name for name in names if not (folder / name).is_file()] == []
    assert {path.name for path in (folder / "page").iterdir()} == {"three", "my_simulations_page"}
    assert "MIT" in (folder / "page" / "three" / "LICENSE").read_text()
    made = (folder / "page" / "my_simulations_page" / "meta.json").read_text()
    assert ROOT.name + "/web" not in made and '"../web/js/main.ts"' in made


def test_a_world_and_its_editor_open_from_an_installation_without_ros(source, tmp_path):
    folder, _ = source
    prefix = tmp_path / "prefix"
    # Without npm: the archive has the page.
    run("-c", SET_UP, "-q", "build", "--build-lib", prefix / "lib", "install_data",
        "--install-dir", prefix, folder=folder, PATH="/nonexistent")
    words = run(ROOT / "tools" / "lib" / "check_installation.py", folder=tmp_path,
                PYTHONPATH=str(prefix / "lib"))
    assert words.startswith(f"{prefix}/lib/my_simulations/__init__.py: 13 models")
    assert re.search(r"editor page with \d+ files", words)


def test_a_clone_without_npm_is_installed_without_the_page(repository, tmp_path):
    copy, _ = repository
    (tmp_path / "bin").mkdir()
    for name in ("bash", "dirname", "mktemp", "realpath", "rm", "sha256sum", "cat"):
        (tmp_path / "bin" / name).symlink_to(shutil.which(name))
    words = run("-c", SET_UP, "build", "--build-base", tmp_path / "build", folder=copy,
                PATH=str(tmp_path / "bin"))
    assert (tmp_path / "build" / "lib" / "my_simulations" / "__init__.py").is_file()
    assert not (tmp_path / "build" / "page").exists(), words


def test_the_metadata_is_that_of_the_ros_package():
    told = run("-c", SET_UP, "--name", "--version", "--author", "--maintainer", "--license",
               "--description").splitlines()
    manifest = (ROOT / "package.xml").read_text()
    assert told[0] == "my_simulations"
    assert f"<version>{told[1]}</version>" in manifest
    assert f"<author>{told[2]}</author>" in manifest
    assert f">{told[3]}</maintainer>" in manifest
    assert f">{told[4]}</license>" in manifest
    assert told[5] in " ".join(manifest.split())
    assert "Topic :: Scientific/Engineering :: Physics" in run("-c", SET_UP, "--classifiers")


def requirements(tmp_path):
    run("-c", SET_UP, "-q", "egg_info", "--egg-base", tmp_path)
    text = (tmp_path / "my_simulations.egg-info" / "requires.txt").read_text()
    found = {"": []}
    condition = ""
    for line in text.splitlines():
        if line.startswith("["):
            condition = line.strip("[]").partition(":")[2]
        elif line:
            found.setdefault(condition, []).append(line)
    return found


def test_pip_takes_versions_that_run_on_old_pythons(tmp_path):
    found = requirements(tmp_path)
    assert "glcontext==3.0.0" in found['python_version < "3.9"']
    assert "glcontext>=3.1.0" in found['python_version >= "3.9"']
    assert "trimesh==4.12.2" in found['python_version < "3.10"']
    assert "pybullet>=3.2.7" in found[""]
    for condition, lines in found.items():
        assert not [line for line in lines if ">=" in line and "<" in condition], condition


def test_commands_begin_with_the_name_of_the_package(tmp_path):
    run("-c", SET_UP, "-q", "egg_info", "--egg-base", tmp_path)
    text = (tmp_path / "my_simulations.egg-info" / "entry_points.txt").read_text()
    commands = dict(line.split(" = ") for line in text.splitlines() if " = " in line)
    assert set(commands) == {f"my_simulations_{name}"
                             for name in ("check_model", "gazebo", "study")}
    for target in commands.values():
        module, _, function = target.partition(":")
        tree = ast.parse((ROOT / "src" / f"{module.replace('.', '/')}.py").read_text())
        assert function in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
