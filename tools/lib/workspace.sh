# shellcheck shell=bash
# Chooses the catkin workspace of this clone, and links packages into it. Installs nothing.

# choose_workspace: sets WORKSPACE (absolute, may not exist yet) for the clone at CLONE.
choose_workspace() {
  if [ -n "${MY_SIMULATIONS_WS:-}" ]; then
    WORKSPACE=$(realpath -m -- "$MY_SIMULATIONS_WS")
    return
  fi
  local place
  for place in "$CLONE_AS_CALLED" "$CLONE"; do
    case $place in
      */src/my_simulations)
        WORKSPACE=${place%/src/my_simulations}
        # ~/src is a folder of sources, not a workspace whose build belongs in the home folder.
        [ "$WORKSPACE" = "$HOME" ] || [ -z "$WORKSPACE" ] || return 0 ;;
    esac
  done
  WORKSPACE="$HOME/simulation_ws"
}

# package_name FOLDER: the name in its package.xml; empty if there is none.
package_name() {
  [ -f "$1/package.xml" ] || return 0
  tr '\n' ' ' <"$1/package.xml" |
    sed -n 's/<!--[^>]*-->//g; s/.*<name>[[:space:]]*\([^<[:space:]]*\)[[:space:]]*<\/name>.*/\1/p'
}

# package_folders SRC: every package in a source space, as catkin finds them.
package_folders() {
  [ -d "$1" ] || return 0
  find -L "$1" -maxdepth 4 -name package.xml -printf '%h\n' 2>/dev/null | sort |
    awk '{ for (outer in seen) if (index($0, outer "/") == 1) next; seen[$0] = 1; print }'
}

# foreign_package SRC: the folder of a package my_simulations in SRC that is not this clone.
foreign_package() {
  local folder
  while IFS= read -r folder; do
    [ "$(package_name "$folder")" = my_simulations ] || continue
    [ "$(realpath -- "$folder")" = "$CLONE" ] || { printf '%s\n' "$folder"; return; }
  done < <(package_folders "$1")
  folder="$1/my_simulations"
  if [ -e "$folder" ] && [ "$(realpath -- "$folder")" != "$CLONE" ]; then
    printf '%s\n' "$folder"
  fi
}

# own_package SRC: the folder in SRC through which catkin finds this clone; empty if none.
own_package() {
  local folder
  while IFS= read -r folder; do
    [ "$(realpath -- "$folder")" != "$CLONE" ] || { printf '%s\n' "$folder"; return; }
  done < <(package_folders "$1")
}

# link TARGET NAME: create the symbolic link NAME unless it is correct.
link() {
  [ "$(readlink -- "$2" || true)" = "$1" ] || ln -sfn -- "$1" "$2"
}

# others_in SRC: colon-separated package folders of a source space outside of this clone.
others_in() {
  local folder real paths=''
  while IFS= read -r folder; do
    real=$(realpath -- "$folder")
    case $real/ in "$CLONE"/*) continue ;; esac
    paths="$paths:$folder"
  done < <(package_folders "$1")
  printf '%s' "${paths#:}"
}

# real_package NAME SRC...: the folder of NAME that rospack finds, except this clone's companions.
real_package() {
  local name="$1" paths='' entry source_space
  shift
  for source_space in "$@"; do paths="$paths:$(others_in "$source_space")"; done
  while IFS= read -r entry; do
    case $entry/ in
      "$WORKSPACE"/* | "$CLONE"/*) ;;
      *) paths="$paths:$entry" ;;
    esac
  done < <(tr ':' '\n' <<<"${ROS_PACKAGE_PATH:-}")
  ROS_PACKAGE_PATH="$paths" rospack find "$name" 2>/dev/null || true
}

# spoken_of NAME: whether a package of the workspace names that package, or controllers of it.
spoken_of() {
  local folders
  [ -z "${ALL_COMPANIONS:-}" ] || return 0
  folders=$(others_in "$WORKSPACE/src")
  [ -n "$folders" ] || return 1
  tr ':' '\n' <<<"$folders" | xargs -d '\n' grep -rqs --include='*.xml' --include='*.yaml' \
    --include='*.launch' --include='*.py' --exclude-dir='.*' -e "${1%_msgs}_" --
}

# link_companions: link each package of compat/ that rospack does not find elsewhere. Messages of
# some robots are linked only if a package of the workspace names them.
link_companions() {
  local name target place real
  COMPANIONS=
  for name in cob_bringup_sim cob_gazebo_objects cob_gazebo_worlds control_msgs controller_manager \
    controller_manager_msgs force_torque_sensor_controller four_wheel_steering_msgs gazebo_msgs \
    gazebo_ros imu_sensor_controller joint_state_controller my_simulations_msgs \
    teleop_twist_keyboard unitree_legged_msgs xacro; do
    target="$CLONE/compat/$name"
    place="$WORKSPACE/src/$name"
    real=$(real_package "$name" "$WORKSPACE/src")
    case $name in
      four_wheel_steering_msgs | unitree_legged_msgs) [ -n "$real" ] || spoken_of "$name" || real=none ;;
    esac
    if [ -n "$real" ] && [ "$name" = gazebo_ros ] && [ "$USE_COMPANIONS" = 1 ]; then
      case $real/ in
        "$WORKSPACE"/src/*)
          stop "gazebo_ros lies in this workspace, at $real: two packages of one name cannot." \
            "Take that folder out of the workspace, or leave out --use-companions." ;;
      esac
      real=
    fi
    if [ -z "$real" ]; then
      link "$target" "$place"
      COMPANIONS="$COMPANIONS $name"
    elif [[ $(readlink -- "$place") == */compat/"$name" ]]; then
      rm -- "$place"
      forget_build "$name"
    fi
  done
}

# link_underlay: if the workspace has its own package my_simulations, link ours as the package
# my_simulations_underlay, which provides the files that theirs lacks; otherwise remove that link.
link_underlay() {
  local target="$CLONE/compat/my_simulations_underlay" place="$WORKSPACE/src/my_simulations_underlay"
  if [ -n "$FOREIGN" ]; then
    [ -L "$place" ] || forget_build my_simulations
    link "$target" "$place"
  elif [ -L "$place" ]; then
    rm -- "$place"
    forget_build my_simulations_underlay
    forget_build my_simulations
  fi
}

# underlay_chosen: whether --overlay was chosen by an earlier run.
underlay_chosen() {
  [ -L "$WORKSPACE/src/my_simulations_underlay" ] || [ -d "$OWN/overlay" ]
}
