# shellcheck shell=bash
# What the system is, and what apt knows there. Decides by /etc/os-release, dpkg and apt's lists.

OS_RELEASE=/etc/os-release

# os_value KEY: a value of os-release, without quotes; empty if there is none.
os_value() { sed -n "s/^$1=//p" "$OS_RELEASE" 2>/dev/null | tr -d "\"'" | head -n 1; }

# choose_ros_prefix: the folder of a ROS 1 beside the system's packages: the one that is named, else that
# of the distribution that this shell has sourced, else Noetic's or ROS One's.
choose_ros_prefix() {
  local name
  for name in "${ROS_DISTRO:-}" noetic one; do
    case $name in noetic | one) [ ! -f "/opt/ros/$name/setup.bash" ] || break ;; esac
  done
  printf '%s' "${MY_SIMULATIONS_ROS_PREFIX:-/opt/ros/$name}"
}

# ros_source: where ROS comes from: `apt` (the distribution's own packages), `prefix` (packages of dpkg
# below ROS_PREFIX), or `sources` (the same folder, filled without dpkg).
ros_source() {
  if [ ! -f "$ROS_PREFIX/setup.bash" ]; then
    printf apt
  elif [ -n "$(missing_packages "ros-$(basename -- "$ROS_PREFIX")-catkin")" ]; then
    printf sources
  else
    printf prefix
  fi
}

# ros_prefix_packages: what the list names for Noetic, for the distribution at ROS_PREFIX.
ros_prefix_packages() {
  packages_of "$CLONE/tools/apt-packages-noetic.txt" |
    sed "s/^ros-noetic-/ros-$(basename -- "$ROS_PREFIX")-/"
}

# unknown_packages NAME...: those that apt has no version of, by the lists that are there.
unknown_packages() {
  comm -13 <(apt-cache show --no-all-versions "$@" 2>/dev/null | sed -n 's/^Package: //p' | sort -u) \
    <(printf '%s\n' "$@" | sort -u)
}

# refuse_unknown NAME...: stop where apt does not know them, and say what is wrong with this system.
refuse_unknown() {
  local unknown system
  mapfile -t unknown < <(unknown_packages "$@")
  [ "${#unknown[@]}" -gt 0 ] || return 0
  system=$(os_value PRETTY_NAME)
  if [ "$(os_value ID)" = ubuntu ] && [[ $(apt-cache policy 2>/dev/null) != *'/universe '* ]]; then
    stop "the part 'universe' of Ubuntu's archive is not enabled here; it has ${unknown[*]}." \
      "As root: add-apt-repository universe && apt-get update; then run $COMMAND again."
  fi
  case " ${unknown[*]} " in
    *' python3-rospy '*)
      stop "${system:-this system} has no packages of ROS 1 (python3-rospy), and neither \
/opt/ros/noetic nor /opt/ros/one is there." \
        "Debian 11, 12 and 13 and Ubuntu 22.04 have them. On Ubuntu 20.04 install ROS Noetic; on Ubuntu \
22.04 and 24.04, ROS One." \
        "On this system, use the container: docker/Dockerfile." ;;
  esac
  stop "apt knows no ${unknown[*]} on ${system:-this system}." \
    "Is a part of the archive missing in /etc/apt/sources.list (main)? apt-cache policy shows them."
}

# ask_administrator REASON NAME...: stop with one command for all that needs root: the packages, those
# that PyBullet is compiled with where it may have to be, and the name localhost.
ask_administrator() {
  local reason="$1" names command compiled=()
  shift
  # shellcheck disable=SC2046
  ! needs_compiler || mapfile -t compiled < <(missing_packages $(compile_packages))
  names=("$@" "${compiled[@]}")
  command="apt-get update && apt-get install --no-install-recommends ${names[*]}"
  localhost_resolves || command+=" && echo '127.0.0.1 localhost' >>/etc/hosts"
  stop "${#names[@]} system packages are missing, and $reason." "As root: $command" \
    "Everything else is installed below this user's home: then run $COMMAND again."
}

# embree_packages: Embree 4 where no wheel brings it, for lasers; nothing where apt has no such version.
embree_packages() {
  [ "$(uname -m)" = x86_64 ] || ! apt-cache show libembree4-4 >/dev/null 2>&1 || printf 'libembree4-4\n'
}

# browser_packages: what the tests of the page run in. The shell draws the same without windows, in
# four fifths of the time; older distributions have only the whole Chromium.
browser_packages() {
  if apt-cache show chromium-headless-shell >/dev/null 2>&1; then
    printf 'chromium-headless-shell\n'
  else
    printf 'chromium\n'
  fi
}
