# shellcheck shell=bash
# What tools/run and tools/test have in common: the strict shell, the clone's place, the options.

set -euo pipefail
export LC_ALL=C.UTF-8

CLONE_AS_CALLED=$(cd -L -- "$(dirname -- "${BASH_SOURCE[1]}")/.." && pwd -L)
CLONE=$(realpath -- "$CLONE_AS_CALLED")
COMMAND="${BASH_SOURCE[1]}"

for part in causes progress workspace pybullet setup; do
  # shellcheck disable=SC1090
  . "$CLONE/tools/lib/$part.sh"
done

# common_option WORD: take an option that both commands know; false when it is none.
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
  --overlay          where the workspace has a package my_simulations of its own: use its files,
                     and ours where it has none of that name
  --use-companions   use this project's gazebo_ros also where a real one is installed
  --no-common-packages
                     leave out the system packages that only other packages of the workspace may
                     want: tools/apt-packages-common.txt
  --python           install Debian's python-is-python3, for scripts that begin with
                     '#!/usr/bin/env python'
  -h, --help         show this help

Environment:
  MY_SIMULATIONS_WS                      the catkin workspace (default: the one this clone lies in,
                                         else ~/simulation_ws)
  MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS=1   the same as --use-companions
TEXT
}
