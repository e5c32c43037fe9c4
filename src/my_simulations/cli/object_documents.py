"""From an object of the list to the XML text that is spawned."""
from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from typing import Callable, List, Optional, Tuple

from ..errors import InputError, error
from ..objects.document import read_document, root_tag
from ..objects.listing import PlacedObject
from ..resources.own import PACKAGE, own_directory
from ..resources.packages import PackageIndex

# An empty entry is the current folder, where a file xacro.py would hide the module.
_RUN_XACRO = ("import sys; sys.path[:] = [p for p in sys.path if p]; "
              "import xacro; xacro.main()")

FindPackage = Callable[[str], Optional[str]]


def package_finder() -> FindPackage:
    """From a package's name to its folder; this package is found without rospack too."""
    index = PackageIndex()

    def find(name: str) -> Optional[str]:
        return index.find(name) or (own_directory() or None if name == PACKAGE else None)

    return find


def locate(placed: PlacedObject, find: FindPackage) -> str:
    """The path of the object's file.

    Raises:
        InputError: the package or the file does not exist.
    """
    folder = find(placed.file.package)
    if folder is None:
        raise InputError([error(
            "unknown-package",
            f"object '{placed.name}': there is no ROS package '{placed.file.package}'",
            xpath=f"{placed.param}/model",
            hint="source the workspace that holds it, or correct the name")])
    path = os.path.join(folder, *placed.file.path.split("/"))
    if not os.path.isfile(path):
        raise InputError([error(
            "object-file-missing", f"object '{placed.name}': there is no file {path}",
            xpath=f"{placed.param}/model")])
    return path


def load(placed: PlacedObject, find: FindPackage, timeout: float) -> Tuple[str, bool]:
    """The object's XML, through xacro where its file needs it.

    Returns:
        The text, and whether it is SDF (URDF otherwise).

    Raises:
        InputError: the file is missing, unreadable, empty, or xacro fails.
    """
    path = locate(placed, find)
    text = run_xacro(path, timeout) if placed.file.xacro else read_document(path)
    root = root_tag(text)
    if root in ("sdf", "robot"):
        return text, root == "sdf"
    return text, placed.file.sdf


def run_xacro(path: str, timeout: float) -> str:
    """What xacro makes of a file.

    Raises:
        InputError: xacro is not installed, fails, or takes longer than `timeout` wall seconds.
    """
    try:
        done = subprocess.run([*_xacro_command(path), path], capture_output=True, timeout=timeout,
                              check=False)
    except subprocess.TimeoutExpired as fault:
        raise InputError([error("xacro-timeout", f"xacro did not end within {timeout:g} s",
                                file=path)]) from fault
    except OSError as fault:
        raise InputError([error("xacro-failed", f"xacro does not start: {fault}",
                                file=path)]) from fault
    text = done.stdout.decode("utf-8", "replace")
    if done.returncode != 0 or not text.strip():
        raise InputError([error("xacro-failed", f"xacro failed: {_reason(done.stderr)}",
                                file=path)])
    return text


def _xacro_command(path: str) -> List[str]:
    if importlib.util.find_spec("xacro") is not None:
        return [sys.executable, "-c", _RUN_XACRO]
    command = shutil.which("xacro")
    if command is None:
        raise InputError([error("xacro-missing", "xacro is needed for this file and not installed",
                                file=path, hint="source the workspace's devel/setup.bash")])
    return [command]


def _reason(stderr: bytes) -> str:
    """What xacro says, without its deprecation notes and tracebacks' frames."""
    lines = [line.strip() for line in stderr.decode("utf-8", "replace").splitlines()]
    said = [line for line in lines if line and not line.lower().startswith("xacro: in-order")]
    if any(line.startswith("Traceback") for line in said):
        said = said[-1:]
    return "; ".join(said[:4]) or "no output"
