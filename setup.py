"""Packaging: for catkin, which reads this file, and for pip where there is no ROS."""
import os
import re
import subprocess
from typing import Any, Collection, Dict, List, Tuple

from setuptools import find_packages, setup
from setuptools.command.sdist import sdist

try:
    from setuptools.command.build import build
except ImportError:  # setuptools before 62.4, where only catkin reads this file
    from distutils.command.build import build  # type: ignore[no-redef]

HERE = os.path.dirname(os.path.abspath(__file__))
SHARE = os.path.join("share", "my_simulations")
DATA = ("Media", "config", "launch", "models", "objects", "urdf", "web", "world")
PAGE = "page"  # the folder of an sdist that has the packed modules of the editor's page
SYSTEM = ["lxml", "numpy", "Pillow", "PyYAML", "scipy"]  # from apt-packages.txt in a workspace
EXTRAS = {"editor": ("aiohttp", "shapely"), "sensors": ("embreex", "glcontext", "moderngl")}
COMMANDS = ("check_model", "gazebo", "study")  # of the package `cli`
CLASSIFIERS = [
    "Development Status :: 4 - Beta",
    "Intended Audience :: Education",
    "Intended Audience :: Science/Research",
    "Operating System :: POSIX :: Linux",
    *(f"Programming Language :: Python :: 3.{minor}" for minor in range(8, 12)),  # tried
    "Topic :: Scientific/Engineering :: Physics",
]


def text_of(name: str) -> str:
    """The content of a file of this folder."""
    with open(os.path.join(HERE, name), encoding="utf-8") as stream:
        return stream.read()


def files_below(folder: str, target: str) -> List[Tuple[str, List[str]]]:
    """All files of a folder, as `data_files` that keep their places below `target`."""
    found = []
    for path, folders, names in os.walk(os.path.join(HERE, folder)):
        folders[:] = sorted(set(folders) - {"node_modules"})
        inside = os.path.relpath(path, os.path.join(HERE, folder))
        found.append((os.path.normpath(os.path.join(target, inside)),
                      [os.path.relpath(os.path.join(path, name), HERE) for name in sorted(names)]))
    return found


def make_page(folder: str) -> None:
    """Make the packed modules of the editor's page. Raises RuntimeError."""
    done = subprocess.run([os.path.join(HERE, "tools", "make_page"), folder],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"cannot make the editor's page: {done.stdout.strip()}")


class BuildWithPage(build):
    """Builds with the editor's page, which an sdist contains; a clone makes it if it can."""

    def run(self) -> None:
        page = os.path.join(HERE, PAGE)
        if not os.path.isdir(page):
            page = os.path.join(os.path.abspath(self.build_base), PAGE)
            try:
                make_page(page)
            except RuntimeError as fault:
                self.warn(f"built without the world editor: {fault}")
        if os.path.isdir(page):
            target = os.path.join(SHARE, "node_modules")
            self.distribution.data_files += files_below(os.path.relpath(page, HERE), target)
        super().run()


class SourceWithPage(sdist):
    """Packs the sources with the editor's page, so that installing it needs no Node.js."""

    def make_release_tree(self, base_dir: str, files: Any) -> None:
        super().make_release_tree(base_dir, files)
        if not os.path.isdir(os.path.join(base_dir, PAGE)):
            make_page(os.path.abspath(os.path.join(base_dir, PAGE)))


def name_of(requirement: str) -> str:
    """The name of what a line of requirements.txt asks for."""
    return re.split(r"[^\w-]", requirement, maxsplit=1)[0]


def bound_of(line: str) -> str:
    """A pinned requirement as pip shall read it.

    A pin is the oldest version that is allowed. For Pythons below a version it is the last one that
    runs there, and stays exact: newer ones may install, but fail.
    """
    return line if "python_version <" in line else line.replace("==", ">=", 1)


def requirements() -> Tuple[List[str], Dict[str, List[str]]]:
    """What pip installs, and the extras, from requirements.txt and requirements-test.txt."""
    lines = [bound_of(line) for line in text_of("requirements.txt").splitlines()
             if line.strip() and not line.startswith("#")]
    tests = text_of("requirements-test.txt").splitlines()

    def named(names: Collection[str], among: List[str]) -> List[str]:
        return [line for line in among if name_of(line) in names]

    extras = {extra: named(names, lines) for extra, names in EXTRAS.items()}
    extras["gym"] = [bound_of(line) for line in named(["gymnasium"], tests)]
    # Scheduler, workers and driver must be of one version, so these are exact.
    extras["dask"] = named(["distributed"], tests)
    others = {name for names in EXTRAS.values() for name in names}
    return SYSTEM + [line for line in lines if name_of(line) not in others], extras


def between(manifest: str, tag: str) -> str:
    """The content of the first element of that name in package.xml."""
    found = re.search(rf"<{tag}\b[^>]*>(.*?)</{tag}>", manifest, re.DOTALL)
    return " ".join(found.group(1).split()) if found else ""


def for_pip() -> Dict[str, Any]:
    """The arguments of `setup` where catkin is not installed."""
    manifest = text_of("package.xml")
    required, extras = requirements()
    address = between(manifest, "url")
    return {
        "name": "my_simulations",
        "version": between(manifest, "version"),
        "description": between(manifest, "description"),
        "long_description": text_of("README.md"),
        "long_description_content_type": "text/markdown",
        "author": between(manifest, "author"),
        "maintainer": between(manifest, "maintainer"),
        "url": address if address.startswith("https://") else None,
        "license": between(manifest, "license"),
        "classifiers": CLASSIFIERS,
        "keywords": ["Gazebo", "PyBullet", "robotics", "ROS", "SDFormat", "simulation", "URDF"],
        "python_requires": ">=3.8",
        "install_requires": required,
        "extras_require": extras,
        "data_files": [entry for folder in DATA
                       for entry in files_below(folder, os.path.join(SHARE, folder))],
        "entry_points": {"console_scripts": [
            f"my_simulations_{name} = my_simulations.cli.{name}_command:main"
            for name in COMMANDS]},
        "cmdclass": {"build": BuildWithPage, "sdist": SourceWithPage},
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
