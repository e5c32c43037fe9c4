# shellcheck shell=bash
# From a bare Debian 12 to a built workspace. Every part looks first whether there is anything to
# do, so a second run neither installs nor builds nor asks the network.

ROS_PREFIX=/opt/ros/noetic
PYTHON=/usr/bin/python3
WITH_TEST_TOOLS=0
USE_COMPANIONS="${MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS:-0}"
OVERLAY=0
SET_UP_STEPS=6

# source_setup FILE: catkin's setup files use unset variables and failing tests.
source_setup() {
  set +eu
  # shellcheck disable=SC1090
  . "$1"
  set -eu
}

set_up() {
  find_workspace
  install_system_packages
  prepare_workspace
  prepare_python "$CLONE/requirements.txt"
  [ "$WITH_TEST_TOOLS" = 0 ] || prepare_python "$CLONE/requirements-test.txt"
  finish "$PYTHON_REMARK"
  prepare_page
  build_workspace
}

find_workspace() {
  begin "Choosing the workspace"
  choose_workspace
  OWN="$WORKSPACE/.my_simulations"
  LOGS="$OWN/log"
  VENV="$OWN/venv"
  BUILD_WORKSPACE="$WORKSPACE"
  FOREIGN=$(foreign_package "$WORKSPACE/src")
  if [ -n "$FOREIGN" ]; then
    if [ "$OVERLAY" = 0 ] && [ ! -d "$OWN/overlay" ]; then
      stop "$FOREIGN is there already, and two packages my_simulations cannot be in one workspace. \
Nothing was changed." \
        "To use its launch, world and urdf files in place of ours of the same name: \
$COMMAND --overlay (that package stays untouched; the choice is remembered)." \
        "To use another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
    fi
    BUILD_WORKSPACE="$OWN/overlay"
  elif [ "$OVERLAY" = 1 ]; then
    stop "there is nothing to overlay: $WORKSPACE/src has no other package my_simulations." \
      "Leave out --overlay."
  fi
  if [ -e "$WORKSPACE/.catkin_tools" ]; then
    stop "$WORKSPACE is built with 'catkin build', which catkin_make cannot share." \
      "Use another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
  fi
  mkdir -p -- "$OWN" || stop "$WORKSPACE cannot be written to." \
    "Name another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
  one_at_a_time
  finish "$BUILD_WORKSPACE"
}

# packages_of FILE: the names in a list with comments.
packages_of() { sed 's/#.*//; /^[[:space:]]*$/d' "$1"; }

# missing_packages NAME...: those that dpkg does not have installed.
missing_packages() {
  local present
  # dpkg-query's status only says that one of the names is unknown to it.
  present=$({ dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true; } |
    sed -n 's/^installed //p' | sort -u)
  comm -13 <(printf '%s\n' "$present") <(printf '%s\n' "$@" | sort -u)
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

install_system_packages() {
  begin "System packages"
  local lists=("$CLONE/tools/apt-packages.txt") wanted missing
  if [ -f "$ROS_PREFIX/setup.bash" ]; then
    source_setup "$ROS_PREFIX/setup.bash"
  else
    lists+=("$CLONE/tools/apt-packages-ros.txt")
  fi
  [ "$WITH_TEST_TOOLS" = 0 ] || lists+=("$CLONE/tools/apt-packages-test.txt")
  # A Node.js from elsewhere is as good, and Debian's npm brings 300 packages.
  command -v npm >/dev/null || lists+=("$CLONE/tools/apt-packages-page.txt")
  mapfile -t wanted < <(for list in "${lists[@]}"; do packages_of "$list"; done)
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  if [ "${#missing[@]}" -gt 0 ]; then
    if [ "$(id -u)" != 0 ] && ! command -v sudo >/dev/null; then
      stop "${#missing[@]} system packages are missing, and there is neither root nor sudo." \
        "As root: apt-get install --no-install-recommends ${missing[*]}"
    fi
    say "installing ${#missing[@]}, a few minutes"
    # Asks for the password now, while the screen is free for it.
    [ "$(id -u)" = 0 ] || sudo true || stop "sudo did not let the system packages be installed." \
      "As root: apt-get install --no-install-recommends ${missing[*]}"
    local advice="Is there a network, and room on the disk (df -h)? Then run $COMMAND again."
    logged apt-update "$advice" as_root env DEBIAN_FRONTEND=noninteractive apt-get -q update
    logged apt-install "$advice" as_root env DEBIAN_FRONTEND=noninteractive \
      apt-get -q -y --no-install-recommends install "${missing[@]}"
    finish "${#missing[@]} installed"
  else
    finish "all there"
  fi
  local name
  for name in message_generation trajectory_msgs std_srvs rostest; do
    rospack find "$name" >/dev/null 2>&1 || stop "the ROS package $name is not installed." \
      "Install it the way ROS was installed here, e.g. ros-noetic-${name//_/-}."
  done
}

prepare_workspace() {
  begin "Linking packages"
  mkdir -p -- "$BUILD_WORKSPACE/src"
  if [ -n "$FOREIGN" ]; then
    compose_overlay "$FOREIGN"
  elif [ "$CLONE" != "$(realpath -m -- "$WORKSPACE/src/my_simulations")" ] &&
       [ -z "$(own_package "$WORKSPACE/src")" ]; then
    ln -sfn -- "$CLONE" "$WORKSPACE/src/my_simulations"
  fi
  link_companions
  finish "my_simulations$COMPANIONS"
}

# prepare_python REQUIREMENTS: the virtual environment, with what the file lists.
prepare_python() {
  local name stamp stamped
  name=$(basename "$1" .txt)
  if [ "$name" = requirements ]; then begin "Python packages"; PYTHON_REMARK="all there"; fi
  stamp="$("$PYTHON" --version) $(sha256sum <"$1")"
  stamped="$VENV/.$name"
  [ "$(cat "$stamped" 2>/dev/null || true)" != "$stamp" ] || return 0
  [ "$PYTHON_REMARK" = installed ] || say "installing, a minute or two"
  PYTHON_REMARK=installed
  # An interrupted or foreign environment is cheaper to make anew than to mend.
  if ! "$VENV/bin/python3" -m pip --version >/dev/null 2>&1 ||
     [ "$("$VENV/bin/python3" --version)" != "$("$PYTHON" --version)" ]; then
    rm -rf -- "$VENV"
    logged venv "Remove $VENV and run $COMMAND again." \
      "$PYTHON" -m venv --system-site-packages "$VENV"
  fi
  logged "pip-$name" "Is there a network? Then run $COMMAND again." \
    "$VENV/bin/python3" -m pip install --no-input --disable-pip-version-check -r "$1"
  printf '%s' "$stamp" >"$stamped"
}

# prepare_page: what the editor's page needs from npm, in a folder of the workspace where the editor
# finds it.
prepare_page() {
  begin "Packages of the editor's page"
  local place="$BUILD_WORKSPACE/.my_simulations" stamp
  stamp=$(sha256sum <"$CLONE/web/package-lock.json")
  if [ "$(cat "$place/.page" 2>/dev/null || true)" = "$stamp" ]; then
    finish "all there"
    return
  fi
  mkdir -p -- "$place"
  rm -f -- "$place/.page"
  cp -- "$CLONE/web/package.json" "$CLONE/web/package-lock.json" "$place/"
  logged npm "Is there a network? Then run $COMMAND again." \
    npm ci --prefix "$place" --ignore-scripts --no-audit --no-fund
  printf '%s' "$stamp" >"$place/.page"
  finish installed
}

# prepare_page_checks: what checks the types and the style of the page's modules, in a folder of the
# workspace (PAGE_CHECKS) beside the configuration of TypeScript and ESLint.
prepare_page_checks() {
  begin "Packages of the page's checks"
  PAGE_CHECKS="$OWN/page_checks"
  local source="$CLONE/test/page" stamp
  stamp=$(cat "$source/package-lock.json" "$source/eslint.config.mjs" "$source/tsconfig.json" |
    sha256sum)
  if [ "$(cat "$PAGE_CHECKS/.stamp" 2>/dev/null || true)" = "$stamp" ]; then
    finish "all there"
    return
  fi
  mkdir -p -- "$PAGE_CHECKS"
  rm -f -- "$PAGE_CHECKS/.stamp"
  cp -- "$source/package.json" "$source/package-lock.json" "$source/eslint.config.mjs" "$PAGE_CHECKS/"
  logged npm-checks "Is there a network? Then run $COMMAND again." \
    npm ci --prefix "$PAGE_CHECKS" --ignore-scripts --no-audit --no-fund
  # TypeScript looks for packages beside the modules, where there are none.
  cat >"$PAGE_CHECKS/tsconfig.json" <<JSON
{
  "extends": "$source/tsconfig.json",
  "compilerOptions": {"paths": {
    "three": ["./node_modules/@types/three"],
    "three/addons/*": ["./node_modules/@types/three/examples/jsm/*"]
  }},
  "include": ["$CLONE/web/js"]
}
JSON
  printf '%s' "$stamp" >"$PAGE_CHECKS/.stamp"
  finish installed
}

# build_inputs: a text that changes when a new catkin_make is due.
build_inputs() {
  local folder
  printf '%s\n' "$VENV" "$BUILD_WORKSPACE"
  # The same from a shell that has sourced this workspace as from one that has not.
  tr ':' '\n' <<<"${CMAKE_PREFIX_PATH:-}" | sed '/^$/d' | grep -v -F -- "$WORKSPACE/" || true
  while IFS= read -r folder; do
    printf '%s\n' "$folder"
    cat "$folder/package.xml" "$folder/CMakeLists.txt" 2>/dev/null || true
  done < <(package_folders "$BUILD_WORKSPACE/src")
  cat "$CLONE"/cmake/* "$CLONE/setup.py"
  find "$CLONE/compat" -type f ! -name '*.pyc' -print0 | sort -z | xargs -0 sha256sum
  find "$CLONE/scripts" "$CLONE/test/rostest" -type f ! -name '*.pyc' \
    -printf '%P %m\n' 2>/dev/null | sort
  head -q -c 2 "$CLONE"/test/rostest/*.py 2>/dev/null || true
}

build_workspace() {
  begin "Building the workspace"
  local stamp stamped="$OWN/built" setup="$BUILD_WORKSPACE/devel/setup.bash"
  # An overlay extends the workspace that its files come from.
  [ -z "$FOREIGN" ] || [ ! -f "$WORKSPACE/devel/setup.bash" ] ||
    source_setup "$WORKSPACE/devel/setup.bash"
  stamp=$(build_inputs | sha256sum)
  if [ -f "$setup" ] && [ "$(cat "$stamped" 2>/dev/null || true)" = "$stamp" ]; then
    finish "up to date"
  else
    rm -f -- "$stamped"
    logged catkin_make "Mend what the log names, in the package it names, and run $COMMAND again." \
      catkin_make -C "$BUILD_WORKSPACE" -DPYTHON_EXECUTABLE="$VENV/bin/python3"
    printf '%s' "$stamp" >"$stamped"
    finish
  fi
  source_setup "$setup"
}

# one_at_a_time: hold the workspace's lock while it is set up; `release` gives it back.
one_at_a_time() {
  exec 9>"$OWN/lock"
  flock -n 9 || { printf '(waiting for another set-up of it) '; flock 9; }
}

release() { exec 9>&-; }
