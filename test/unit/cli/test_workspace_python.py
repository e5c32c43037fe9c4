"""A program whose Python lacks a package is told which Python has it."""
from __future__ import annotations

import importlib.util
import os
import sys

import pytest

import my_simulations
from my_simulations.child_process import child_environment
from my_simulations.errors import CommandError
from my_simulations.workspace_packages import use_workspace_packages
from my_simulations.workspace_python import require, require_extra


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """A sourced workspace, whose Python is not the one of this test."""
    python = tmp_path / ".my_simulations" / "venv" / "bin" / "python3"
    python.parent.mkdir(parents=True)
    python.write_text("")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", f"{tmp_path}/devel:/usr")
    monkeypatch.setattr(sys, "argv", ["examples/drop_test.py"])
    return python


def lack(monkeypatch, module):
    real = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec",
                        lambda name, *more: None if name == module else real(name, *more))


def test_a_workspace_that_is_sourced_names_its_python(workspace, monkeypatch):
    lack(monkeypatch, "pybullet")
    with pytest.raises(CommandError) as told:
        my_simulations.open_world()
    assert str(told.value) == (
        f"{sys.executable} has no module 'pybullet'; run the program with the Python of this "
        f"workspace: {workspace} examples/drop_test.py")


def test_pip_is_named_where_no_workspace_is_sourced(monkeypatch):
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "")
    lack(monkeypatch, "pybullet")
    with pytest.raises(CommandError, match="no module 'pybullet'; pip install my_simulations"):
        require("pybullet")


def test_the_python_of_the_workspace_is_not_told_to_use_itself(workspace, monkeypatch):
    monkeypatch.setattr(sys, "prefix", str(workspace.parent.parent))
    lack(monkeypatch, "pybullet")
    with pytest.raises(CommandError, match="pip install my_simulations"):
        require("pybullet")


def test_a_module_that_is_there_is_enough(workspace):
    require("json")


def test_an_import_that_fails_names_the_python_too(workspace, monkeypatch):
    monkeypatch.delattr(my_simulations, "python_api", raising=False)
    monkeypatch.setitem(sys.modules, "my_simulations.python_api", None)
    with pytest.raises(ImportError, match=f"with the Python of this workspace: {workspace}"):
        my_simulations.open_world


def test_a_module_that_no_workspace_brings_is_installed_with_the_python_that_has_the_rest(
        workspace, monkeypatch):
    lack(monkeypatch, "gymnasium")
    with pytest.raises(ImportError) as told:
        require_extra("gymnasium")
    assert str(told.value) == (
        f"{sys.executable} has no module 'gymnasium'; install it with {workspace} -m pip install "
        f"gymnasium, and run the program with it: {workspace} examples/drop_test.py")
    monkeypatch.setattr(sys, "prefix", str(workspace.parent.parent))
    with pytest.raises(ImportError, match=f"{workspace} -m pip install gymnasium$"):
        require_extra("gymnasium")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "")
    with pytest.raises(ImportError, match=f"{sys.executable} -m pip install gymnasium$"):
        require_extra("gymnasium")


def workspace_of_this_python(tmp_path, monkeypatch, folder):
    python = tmp_path / ".my_simulations" / "venv" / "bin" / "python3"
    python.parent.mkdir(parents=True)
    python.symlink_to(os.path.realpath(sys.executable))
    packages = tmp_path / ".my_simulations" / "venv" / "lib" / folder / "site-packages"
    packages.mkdir(parents=True)
    monkeypatch.setenv("CMAKE_PREFIX_PATH", f"{tmp_path}/devel:/usr")
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)
    monkeypatch.setattr(sys, "path", list(sys.path))
    return str(packages)


def test_packages_of_a_sourced_workspace_are_found_by_its_base_python(tmp_path, monkeypatch):
    here = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    packages = workspace_of_this_python(tmp_path, monkeypatch, here)
    assert packages not in sys.path
    for _ in range(2):
        use_workspace_packages()
        assert sys.path.count(packages) == 1
    assert packages in child_environment()["PYTHONPATH"].split(os.pathsep)


def test_packages_for_another_python_are_left_alone(tmp_path, monkeypatch):
    packages = workspace_of_this_python(tmp_path, monkeypatch, "python3.1")
    use_workspace_packages()
    assert packages not in sys.path
    assert packages not in child_environment()["PYTHONPATH"]


def test_a_virtual_environment_of_the_user_is_left_alone(tmp_path, monkeypatch):
    here = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    packages = workspace_of_this_python(tmp_path, monkeypatch, here)
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    use_workspace_packages()
    assert packages not in sys.path


def test_a_module_among_the_packages_of_a_workspace_is_found(tmp_path, monkeypatch):
    here = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    packages = workspace_of_this_python(tmp_path, monkeypatch, here)
    with pytest.raises(ImportError, match="-m pip install brought_by_the_user$"):
        require_extra("brought_by_the_user")
    with open(os.path.join(packages, "brought_by_the_user.py"), "w", encoding="utf-8"):
        importlib.invalidate_caches()
    require_extra("brought_by_the_user")
