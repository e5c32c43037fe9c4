# shellcheck shell=bash
# Shared by tools/run and tools/test: shell settings, the path of the clone, common options.

set -euo pipefail
export LC_ALL=C.UTF-8

CLONE_AS_CALLED=$(cd -L -- "$(dirname -- "${BASH_SOURCE[1]}")/.." && pwd -L)
CLONE=$(realpath -- "$CLONE_AS_CALLED")
COMMAND="${BASH_SOURCE[1]}"

for part in causes progress workspace system bundle pybullet page build setup; do
  # shellcheck disable=SC1090
  . "$CLONE/tools/lib/$part.sh"
done

# common_option WORD: handle an option of both commands; false for other words.
common_option() {
  case $1 in
    --overlay) OVERLAY=1 ;;
    --use-companions) USE_COMPANIONS=1 ;;
    --no-common-packages) COMMON_PACKAGES=0 ;;
    --python) PYTHON_NAME=1 ;;
    *) return 1 ;;
  esac
}

common_help() {
  cat <<'TEXT'
  --overlay          if the workspace has its own package my_simulations: use its files first, and
                     ours for files that it lacks
  --use-companions   use this project's gazebo_ros even if a real one is installed
  --no-common-packages
                     do not install system packages that only other packages of the workspace may
                     need: tools/apt-packages-common.txt
  --python           install Debian's python-is-python3, for scripts that begin with
                     '#!/usr/bin/env python'
  -h, --help         show this help

Environment:
  MY_SIMULATIONS_WS                      the catkin workspace (default: the one of this clone,
                                         else ~/simulation_ws)
  MY_SIMULATIONS_ROS_PREFIX              the folder of a ROS 1 (default: /opt/ros/noetic or
                                         /opt/ros/one if it exists, else the system's packages)
  MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS=1   the same as --use-companions
TEXT
}
