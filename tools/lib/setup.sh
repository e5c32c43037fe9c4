# shellcheck shell=bash
# Sets up a workspace, from a bare Debian to a built one. Every part first checks whether there is
# anything to do, so a second run neither installs nor builds nor uses the network.

ROS_PREFIX=$(choose_ros_prefix)
PYTHON=/usr/bin/python3
WITH_TEST_TOOLS=0
COMMON_PACKAGES=1
PYTHON_NAME=0
USE_COMPANIONS="${MY_SIMULATIONS_OVERRIDE_GAZEBO_ROS:-0}"
OVERLAY=0
SET_UP_STEPS=6
APT_LISTS_ARE_NEW=0

# source_setup FILE: catkin's setup files use unset variables and failing tests.
source_setup() {
  set +eu
  # shellcheck disable=SC1090
  . "$1"
  set -eu
}

set_up() {
  find_workspace
  [ -z "${BUNDLE_FILE:-}" ] || open_bundle "$BUNDLE_FILE"
  install_system_packages
  prepare_workspace
  prepare_python "$CLONE/requirements.txt"
  [ "$WITH_TEST_TOOLS" = 0 ] || prepare_python "$CLONE/requirements-test.txt"
  finish "$PYTHON_REMARK"
  prepare_page
  build_workspace
  use_loopback
}

find_workspace() {
  begin "Choosing the workspace"
  choose_workspace
  OWN="$WORKSPACE/.my_simulations"
  LOGS="$OWN/log"
  VENV="$OWN/venv"
  usable_path "$WORKSPACE" "The workspace's path" "MY_SIMULATIONS_WS=/another/ws $COMMAND"
  usable_path "$CLONE" "This clone's path" "mv '$CLONE' /another/place"
  FOREIGN=$(foreign_package "$WORKSPACE/src")
  [ -z "$FOREIGN" ] || accept_foreign
  if [ -z "$FOREIGN" ] && [ "$OVERLAY" = 1 ]; then
    stop "there is nothing to overlay: $WORKSPACE/src has no other package my_simulations." \
      "Leave out --overlay."
  fi
  mkdir -p -- "$OWN" || stop "$WORKSPACE cannot be written to." \
    "Name another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
  choose_builder
  one_at_a_time
  finish "$WORKSPACE"
}

# usable_path PATH WHAT ADVICE: stop for a path that catkin or colon-separated path lists do not support.
usable_path() {
  local bad='[[:space:]:;$`#&()<>|*?{}!"\\'"']"
  [[ $1 =~ $bad ]] || return 0
  stop "$2, $1, contains ${BASH_REMATCH[0]/ /a space}, which catkin does not support. Nothing was \
changed." "Letters of any alphabet, digits and - _ . + , are allowed: $3"
}

# accept_foreign: stop if the workspace has its own package my_simulations and --overlay was not
# chosen or is not possible.
accept_foreign() {
  local ours
  if [ "$OVERLAY" = 0 ] && ! underlay_chosen; then
    stop "$FOREIGN exists already; a workspace cannot have two packages my_simulations. \
Nothing was changed." \
      "To use it, with its files before ours of the same name: \
$COMMAND --overlay (that package stays untouched; the choice is remembered)." \
      "To use another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
  fi
  ours=$(own_package "$WORKSPACE/src")
  [ -z "$ours" ] || stop "$FOREIGN and this clone, $ours, are two packages my_simulations in one \
workspace. Nothing was changed." "Move the clone out of the workspace: mv $ours ~/ and run it there."
  [ "$(package_name "$FOREIGN")" = my_simulations ] ||
    stop "$FOREIGN is not the ROS package my_simulations: its package.xml is missing or has another name. Nothing was \
changed." "Make it one: cd $WORKSPACE/src && catkin_create_pkg my_simulations"
  [ -z "$(find -L "$FOREIGN" -path '*/my_simulations/__init__.py' -print -quit)" ] ||
    stop "$FOREIGN has a Python module my_simulations, the name of our module. Nothing was \
changed." "Give the module another name."
}

# packages_of FILE: the package names in a list with comments.
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

# may_install: whether this user can install system packages.
may_install() { [ "$(id -u)" = 0 ] || command -v sudo >/dev/null; }

# apt_get NAME WORD...: apt-get without questions; its output goes to the log of that NAME.
apt_get() {
  local name="$1"
  shift
  recorded "$name" as_root env DEBIAN_FRONTEND=noninteractive apt-get -q "$@"
}

# apt_update: fetch apt's lists, once in a run: a second time takes seconds and finds nothing new.
apt_update() {
  [ "$APT_LISTS_ARE_NEW" = 0 ] || return 0
  apt_get apt-update update || return
  APT_LISTS_ARE_NEW=1
}

# apt_install NAME ADVICE PACKAGE...: install the packages or stop; the log has that NAME.
apt_install() {
  local name="$1" advice="$2"
  shift 2
  apt_get "$name" -y --no-install-recommends install "$@" || failed "$name" "$?" "$advice"
}

# system_packages PURPOSE: the names of what apt must have installed here: `run` for what a workspace
# that is built needs, `all` for what sets it up, too.
system_packages() {
  local lists=(packages) list
  [ "$1" = run ] || lists+=(packages-build)
  case $(ros_source) in
    apt)
      lists+=(packages-ros)
      [ "$1" = run ] || lists+=(packages-ros-build) ;;
    prefix) ros_prefix_packages ;;
  esac
  [ "$WITH_TEST_TOOLS" = 0 ] || lists+=(packages-test)
  [ "$PYTHON_NAME" = 0 ] || lists+=(packages-python)
  [ "$1" = run ] || ! lacks_npm || lists+=(packages-page)
  for list in "${lists[@]}"; do packages_of "$CLONE/tools/apt-$list.txt"; done
  embree_packages
  [ "$WITH_TEST_TOOLS" = 0 ] || browser_packages
}

# lacks_npm: whether npm must be installed. A Node.js from elsewhere is as good, and Debian's npm brings
# 300 packages. A page that is installed or part of an archive needs no npm.
lacks_npm() {
  ! command -v npm >/dev/null || return 1
  [ "$WITH_TEST_TOOLS" = 0 ] || return 0
  [ -z "${BUNDLED:-}" ] && ! page_is_there
}

install_system_packages() {
  begin "System packages"
  local wanted missing
  [ ! -f "$ROS_PREFIX/setup.bash" ] || source_setup "$ROS_PREFIX/setup.bash"
  mapfile -t wanted < <(system_packages all)
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  SYSTEM_REMARK="all there"
  if [ "${#missing[@]}" -gt 0 ]; then
    may_install || ask_administrator "there is neither root nor sudo" "${missing[@]}"
    say "installing ${#missing[@]}, a few minutes"
    # Asks for the password now, while the screen is free for it.
    [ "$(id -u)" = 0 ] || sudo true || ask_administrator "sudo does not let this user install them" \
      "${missing[@]}"
    apt_update || failed apt-update "$?" "Is there a network? Then run $COMMAND again."
    # New lists may name more than old ones did: some packages are asked for where apt has them.
    mapfile -t wanted < <(system_packages all)
    mapfile -t missing < <(missing_packages "${wanted[@]}")
    refuse_unknown "${missing[@]}"
    apt_install apt-install "Is there room on the disk (df -h)? Then run $COMMAND again." "${missing[@]}"
    SYSTEM_REMARK="${#missing[@]} installed"
  fi
  if [ "$COMMON_PACKAGES" = 1 ] && [ "$(ros_source)" = apt ]; then
    install_optional common "other packages"
  fi
  [ "$WITH_TEST_TOOLS" = 0 ] || install_optional sdformat "some tests"
  finish "$SYSTEM_REMARK"
  hint_at_python
  local name
  for name in message_generation trajectory_msgs std_srvs rostest; do
    rospack find "$name" >/dev/null 2>&1 || stop "the ROS package $name is not installed." \
      "Install it the way ROS was installed here, e.g. ros-$(basename -- "$ROS_PREFIX")-${name//_/-}."
  done
}

# install_optional NAME WHO: install the packages in apt-packages-NAME.txt, which WHO may need, but ours
# does not. A failure is reported, does not stop the set-up, and is not repeated for the same list.
install_optional() {
  local wanted missing tried="$OWN/$1-packages"
  mapfile -t wanted < <(packages_of "$CLONE/tools/apt-packages-$1.txt")
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  [ "${#missing[@]}" -gt 0 ] || return 0
  [ "$(cat "$tried" 2>/dev/null || true)" != "${missing[*]}" ] || return 0
  if may_install; then
    say "installing ${#missing[@]} that $2 commonly ask for"
    if apt_update &&
       apt_get "apt-install-$1" -y --no-install-recommends install "${missing[@]}"; then
      SYSTEM_REMARK="$SYSTEM_REMARK, ${#missing[@]} for $2 installed"
      return 0
    fi
  fi
  printf '%s' "${missing[*]}" >"$tried"
  say "not installed, $2 may want them: \
apt-get install --no-install-recommends ${missing[*]}$(optional_reason "$1")"
}

# optional_reason NAME: why the optional packages NAME were not installed, for the end of a sentence.
optional_reason() {
  local reason
  reason=$(sed -n 's/^E: //p' "$LOGS/apt-update.log" "$LOGS/apt-install-$1.log" 2>/dev/null |
    head -n 1)
  printf '%s' "${reason:+ ($reason)}"
}

# hint_at_python: explain how to run scripts that begin with "#!/usr/bin/env python", if there are such
# scripts and no such program.
hint_at_python() {
  local file line count=0
  ! command -v python >/dev/null || return 0
  while IFS= read -r -d '' file; do
    IFS= read -r line <"$file" 2>/dev/null || continue
    [[ $line =~ ^'#!'[[:blank:]]*/usr/bin/(env[[:blank:]]+)?python[[:space:]]*$ ]] || continue
    count=$((count + 1))
  done < <(find -L "$WORKSPACE/src" -maxdepth 6 -type f -perm /111 -print0 2>/dev/null)
  [ "$count" -eq 0 ] || say "$count programs of the workspace begin with '#!/usr/bin/env python', and \
there is no python: '$COMMAND --python' installs Debian's python-is-python3."
}

prepare_workspace() {
  begin "Linking packages"
  mkdir -p -- "$WORKSPACE/src"
  link_underlay
  rm -rf -- "${OWN:?}/overlay"  # of earlier versions
  if [ -z "$FOREIGN" ] && [ "$CLONE" != "$(realpath -m -- "$WORKSPACE/src/my_simulations")" ] &&
     [ -z "$(own_package "$WORKSPACE/src")" ]; then
    ln -sfn -- "$CLONE" "$WORKSPACE/src/my_simulations"
  fi
  link_companions
  finish "my_simulations${FOREIGN:+ behind $FOREIGN}$COMPANIONS"
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
  # Replace an interrupted or foreign environment: repair takes longer.
  if ! "$VENV/bin/python3" -m pip --version >/dev/null 2>&1 ||
     [ "$("$VENV/bin/python3" --version)" != "$("$PYTHON" --version)" ]; then
    rm -rf -- "$VENV"
    logged venv "Remove $VENV and run $COMMAND again." \
      "$PYTHON" -m venv --system-site-packages "$VENV"
  fi
  pip_install "$name" "$1"
  printf '%s' "$stamp" >"$stamped"
}

# pip_install NAME REQUIREMENTS: into the environment; compiles PyBullet where no wheel of it exists.
pip_install() {
  local status=0 advice="Is there a network? Then run $COMMAND again." wheels
  local command=("$VENV/bin/python3" -m pip install --no-input --disable-pip-version-check
    --only-binary pybullet -r "$2")
  wheels=$(pybullet_wheels)
  [ ! -d "$wheels" ] || command+=(--find-links "$wheels")
  if [ -n "$BUNDLED" ]; then
    command+=(--no-index --find-links "$BUNDLED/wheels")
    logged "pip-$1" "The archive lacks what is named: make it again from this clone." "${command[@]}"
    return 0
  fi
  recorded "pip-$1" "${command[@]}" || status=$?
  [ "$status" -ne 0 ] || return 0
  pybullet_lacks_wheel "pip-$1" || failed "pip-$1" "$status" "$advice"
  build_pybullet
  logged "pip-$1" "$advice" "${command[@]}" --find-links "$wheels"
}

# prepare_page_checks: what checks the types and the style of the page's modules, in a folder of the
# workspace (PAGE_CHECKS) beside the configuration of TypeScript and ESLint.
prepare_page_checks() {
  begin "Packages of the page's checks"
  PAGE_CHECKS="$OWN/page_checks"
  local source="$CLONE/test/page" stamp
  stamp=$(printf '%s' "$CLONE $PAGE_CHECKS" |
    cat - "$source/package-lock.json" "$source/eslint.config.mjs" "$source/layers.mjs" "$source/tsconfig.json" |
    sha256sum)
  if [ "$(cat "$PAGE_CHECKS/.stamp" 2>/dev/null || true)" = "$stamp" ]; then
    finish "all there"
    return
  fi
  mkdir -p -- "$PAGE_CHECKS"
  rm -f -- "$PAGE_CHECKS/.stamp"
  cp -- "$source/package.json" "$source/package-lock.json" "$source/eslint.config.mjs" "$source/layers.mjs" "$PAGE_CHECKS/"
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

# compile_sources: bytecode of our own modules, so that the first start of a node does not
# wait for it, nor every start of a user who may not write here or has set PYTHONDONTWRITEBYTECODE.
compile_sources() {
  # It is only a matter of speed: a folder that cannot be written is none of its faults.
  "$VENV/bin/python3" -m compileall -q "$CLONE/src" "$CLONE/compat" >/dev/null 2>&1 || true
}

# use_loopback: if the host name does not resolve, as in bare containers, use the loopback address
# for ROS; the workspace's setup.bash sets it in other shells.
use_loopback() {
  local name mark="$OWN/loopback"
  resolve_localhost
  # What setup.bash has set is not the user's own choice.
  [ ! -f "$mark" ] || [ "${ROS_IP:-}" != 127.0.0.1 ] || unset ROS_IP
  name=$(uname -n)
  if [ -n "${ROS_IP:-}${ROS_HOSTNAME:-}" ] || timeout 5 getent hosts "$name" >/dev/null; then
    rm -f -- "$mark"
    return 0
  fi
  : >"$mark"
  export ROS_IP=127.0.0.1
  say "This machine's own name, $name, does not resolve; ROS_IP=127.0.0.1 is used: programs on this \
machine can connect, others cannot. To change that, add the name to /etc/hosts."
}

localhost_resolves() { timeout 5 getent hosts localhost >/dev/null; }

# resolve_localhost: add localhost to /etc/hosts if it does not resolve; roslaunch needs it.
resolve_localhost() {
  ! localhost_resolves || return 0
  may_install && as_root sh -c 'echo "127.0.0.1 localhost" >>/etc/hosts' ||
    stop "the name localhost does not resolve, and roslaunch needs it." \
      "As root: echo '127.0.0.1 localhost' >>/etc/hosts"
  say "The name localhost did not resolve: '127.0.0.1 localhost' was added to /etc/hosts."
}

# one_at_a_time: hold the lock of the workspace during the set-up; `release` releases it.
one_at_a_time() {
  exec 9>"$OWN/lock"
  flock -n 9 || { printf '(waiting for another set-up of this workspace) '; flock 9; }
}

# release: release the lock, so that another set-up of this workspace can start.
release() {
  rm -rf -- "$OWN/bundle"  # the unpacked files are installed by now
  exec 9>&-
}
