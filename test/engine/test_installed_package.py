"""What pip installs is whole: the modules, and the models and worlds that they find."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SET_UP = ("import sys, runpy\n"
          "sys.modules['catkin_pkg'] = None\n"  # as on a machine without ROS
          "sys.argv[0] = 'setup.py'\n"
          "runpy.run_path('setup.py', run_name='__main__')\n")


def run(*words, **variables):
    environment = {"PATH": os.environ["PATH"], "HOME": os.environ["HOME"], **variables}
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=300,
                          cwd=ROOT, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_world_opens_from_an_installation_without_ros(tmp_path):
    prefix = tmp_path / "prefix"
    run("-c", SET_UP, "-q", "egg_info", "--egg-base", str(tmp_path),
        "build", "--build-base", str(tmp_path / "build"), "--build-lib", str(prefix / "lib"),
        "install_data", "--install-dir", str(prefix))
    script = ("import my_simulations\n"
              "with my_simulations.open_world('lab_room.world', objects=['MY_OBJECT']) as world:\n"
              "    world.step(10)\n"
              "    print(my_simulations.__file__, 'MY_OBJECT' in world.names, len(world.names))\n")
    words = run("-c", f"import os; os.chdir({str(tmp_path)!r})\n{script}",
                PYTHONPATH=str(prefix / "lib")).split()
    assert words == [str(prefix / "lib/my_simulations/__init__.py"), "True", "13"]


def test_its_version_is_that_of_the_ros_package():
    told = run("-c", SET_UP, "--name", "--version").split()
    assert told[0] == "my_simulations"
    assert f"<version>{told[1]}</version>" in (ROOT / "package.xml").read_text()
