"""Where the Python package is: for catkin, which calls this, and for pip where there is no ROS."""
import os
import re
from typing import Any, Collection, Dict, List, Tuple

from setuptools import find_packages, setup

HERE = os.path.dirname(os.path.abspath(__file__))
DATA = ("Media", "config", "launch", "models", "objects", "urdf", "world")
SYSTEM = ["numpy", "scipy", "lxml", "PyYAML", "Pillow"]  # what tools/run takes from the system
EXTRAS = {"editor": ("aiohttp", "shapely"), "sensors": ("embreex", "glcontext", "moderngl")}


def text_of(name: str) -> str:
    """The content of a file of this folder."""
    with open(os.path.join(HERE, name), encoding="utf-8") as stream:
        return stream.read()


def data_files() -> List[Tuple[str, List[str]]]:
    """The models, worlds and other data, below share/my_simulations of the prefix."""
    found = []
    for folder in DATA:
        for path, _, names in sorted(os.walk(os.path.join(HERE, folder))):
            inside = os.path.relpath(path, HERE)
            found.append((os.path.join("share", "my_simulations", inside),
                          [os.path.join(inside, name) for name in sorted(names)]))
    return found


def name_of(requirement: str) -> str:
    """The name of what a line of requirements.txt asks for."""
    return re.split(r"[^\w-]", requirement, maxsplit=1)[0]


def requirements() -> Tuple[List[str], Dict[str, List[str]]]:
    """What pip installs, and the extras: requirements.txt, whose pins become lower bounds."""
    lines = [line.replace("==", ">=", 1) for line in text_of("requirements.txt").splitlines()
             if line.strip() and not line.startswith("#")]

    def named(names: Collection[str]) -> List[str]:
        return [line for line in lines if name_of(line) in names]

    extras = {extra: named(names) for extra, names in EXTRAS.items()}
    extras["gym"] = ["gymnasium>=1.1.1"]  # what the ROS package needs not
    # Scheduler, workers and driver must be of one version, so these are exact.
    extras["dask"] = [line for line in text_of("requirements-test.txt").splitlines()
                      if name_of(line) == "distributed"]
    others = {name for names in EXTRAS.values() for name in names}
    return SYSTEM + [line for line in lines if name_of(line) not in others], extras


def between(manifest: str, tag: str) -> str:
    """The content of an element of package.xml."""
    return manifest.split(f"<{tag}>", 1)[1].split(f"</{tag}>", 1)[0]


def for_pip() -> Dict[str, Any]:
    """The arguments of `setup` where catkin is not installed."""
    manifest = text_of("package.xml")
    required, extras = requirements()
    return {
        "name": "my_simulations",
        "version": between(manifest, "version"),
        "description": " ".join(between(manifest, "description").split()),
        "license": "Apache-2.0",
        "python_requires": ">=3.8",
        "install_requires": required,
        "extras_require": extras,
        "data_files": data_files(),
        "entry_points": {"console_scripts": ["study = my_simulations.cli.study_command:main"]},
    }


COMMON = {
    "packages": find_packages("src"),
    "package_dir": {"": "src"},
    "package_data": {"my_simulations": ["py.typed"]},
}

try:
    from catkin_pkg.python_setup import generate_distutils_setup
except ImportError:
    setup(**COMMON, **for_pip())
else:
    setup(**generate_distutils_setup(**COMMON))
