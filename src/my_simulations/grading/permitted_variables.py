"""Which environment variables a student's processes get: all others may hold secrets."""
from __future__ import annotations

from typing import Dict, Mapping

_OF_ONE_PROCESS = ("MY_SIMULATIONS_PARENT", "MY_SIMULATIONS_RECORD")
"""Variables of this package that hold for one process, not for those that it starts."""

_NAMES = frozenset((
    "PATH", "LD_LIBRARY_PATH", "LANG", "LANGUAGE", "TZ", "PKG_CONFIG_PATH", "CMAKE_PREFIX_PATH",
    "CATKIN_SHELL", "PYTHONPATH", "PYTHONHOME", "PYTHONUNBUFFERED", "PYTHONDONTWRITEBYTECODE",
    "PYTHONIOENCODING", "PYTHONUTF8", "PYTHONHASHSEED",
    # wiki.ros.org/ROS/EnvironmentVariables
    "ROS_ROOT", "ROS_ETC_DIR", "ROS_DISTRO", "ROS_VERSION", "ROS_PYTHON_VERSION",
    "ROS_PACKAGE_PATH", "ROSLISP_PACKAGE_DIRECTORIES", "ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME",
    "ROS_IPV6", "ROS_LANG_DISABLE", "ROS_OS_OVERRIDE", "ROS_PARALLEL_JOBS", "ROSCONSOLE_FORMAT",
    "ROSCONSOLE_STDOUT_LINE_BUFFERED",
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS",
))
_PREFIXES = ("LC_", "GAZEBO_", "MY_SIMULATIONS_")
_SECRET_WORDS = ("TOKEN", "SECRET", "PASSWORD", "CREDENTIAL", "KEY")


def permitted_variables(environment: Mapping[str, str]) -> Dict[str, str]:
    """Return the variables of Python, ROS and this package, without those named like secrets."""
    return {name: value for name, value in environment.items()
            if (name in _NAMES or name.startswith(_PREFIXES)) and name not in _OF_ONE_PROCESS
            and not any(word in name for word in _SECRET_WORDS)}
