# shellcheck shell=bash
# Builds the workspace by the command that built it before: catkin_make, catkin build (catkin tools) or
# catkin_make_isolated.

# choose_builder: set BUILDER, and the folders of what it makes: BUILD_SPACE and DEVEL_SPACE.
choose_builder() {
  BUILDER=catkin_make BUILD_SPACE="$WORKSPACE/build" DEVEL_SPACE="$WORKSPACE/devel"
  if [ -d "$WORKSPACE/.catkin_tools" ]; then
    BUILDER="catkin build"
    command -v catkin >/dev/null || stop "$WORKSPACE is built with 'catkin build', and there is no \
command catkin." "As root: apt-get install catkin-tools (python3-catkin-tools from packages.ros.org)" \
      "To use another workspace: MY_SIMULATIONS_WS=~/another_ws $COMMAND"
    BUILD_SPACE=$(catkin locate --workspace "$WORKSPACE" --build)
    DEVEL_SPACE=$(catkin locate --workspace "$WORKSPACE" --devel)
  elif [ -d "$WORKSPACE/devel_isolated" ] && [ ! -d "$WORKSPACE/devel" ]; then
    BUILDER=catkin_make_isolated
    BUILD_SPACE="$WORKSPACE/build_isolated" DEVEL_SPACE="$WORKSPACE/devel_isolated"
  fi
}

# run_builder: build all packages, with the workspace's own Python.
run_builder() {
  local python="-DPYTHON_EXECUTABLE=$VENV/bin/python3"
  case $BUILDER in
    catkin_make) catkin_make -C "$WORKSPACE" -j"$(nproc)" "$python" ;;
    catkin_make_isolated) catkin_make_isolated -C "$WORKSPACE" -j"$(nproc)" "$python" ;;
    # It appends the argument to those of the user's profile.
    "catkin build") catkin --no-color build --workspace "$WORKSPACE" --no-status --cmake-args "$python" ;;
  esac
}

# built_elsewhere: the folder in which the build space was made; nothing if that is where it is.
built_elsewhere() {
  local cache made
  for cache in "$BUILD_SPACE"/CMakeCache.txt "$BUILD_SPACE"/*/CMakeCache.txt; do
    made=$(sed -n 's/^CMAKE_CACHEFILE_DIR:INTERNAL=//p' "$cache" 2>/dev/null) || continue
    [ "$(realpath -m -- "$made")" = "$(realpath -- "$(dirname -- "$cache")")" ] || printf '%s' "$made"
    return 0
  done
}

# remove_moved_build: remove the build of a workspace that was moved; it contains paths of the old place.
remove_moved_build() {
  local made
  made=$(built_elsewhere)
  [ -n "$made" ] || return 0
  say "this workspace was moved: it was built in $made. It is built again."
  rm -rf -- "$BUILD_SPACE" "$DEVEL_SPACE"
}

# forget_build NAME: remove build products of a package that is no longer linked.
forget_build() {
  local name="$1" devel="$DEVEL_SPACE"
  case $BUILDER in
    "catkin build")
      [ ! -d "$BUILD_SPACE/$name" ] ||
        recorded "clean-$name" catkin clean --workspace "$WORKSPACE" --yes "$name" || true
      return ;;
    catkin_make_isolated) rm -rf -- "$DEVEL_SPACE/$name" ;;
  esac
  # shellcheck disable=SC2115
  rm -rf -- "$BUILD_SPACE/$name" "$devel/share/$name" "$devel/lib/$name" \
    "$devel/lib/pkgconfig/$name.pc" "$devel/include/$name" \
    "$devel/lib/python3/dist-packages/$name" \
    "$devel/etc/catkin/profile.d/50.my_simulations_$name.sh"
  [ "$name" != xacro ] || rm -f -- "$devel/bin/xacro" "$devel/bin/xacro.py"
  [ "$name" != gazebo_ros ] || rm -rf -- "$devel/lib/gazebo_ros_commands"
  [ "$name" != my_simulations_underlay ] || rm -f -- "$devel/bin/roslaunch"
}

# build_inputs: a text that changes when the workspace must be built again.
build_inputs() {
  local folder
  printf '%s\n' "$VENV" "$WORKSPACE" "$CLONE" "$BUILDER"
  # The same from a shell that has sourced this workspace as from one that has not.
  tr ':' '\n' <<<"${CMAKE_PREFIX_PATH:-}" | sed '/^$/d' | grep -v -F -- "$WORKSPACE/" || true
  while IFS= read -r folder; do
    printf '%s\n' "$folder"
    cat "$folder/package.xml" "$folder/CMakeLists.txt" 2>/dev/null || true
  done < <(package_folders "$WORKSPACE/src")
  cat "$CLONE"/cmake/* "$CLONE/setup.py"
  find "$CLONE/compat" -type f ! -name '*.pyc' -print0 | sort -z | xargs -0 sha256sum
  find "$CLONE/scripts" "$CLONE/test/rostest" -type f ! -name '*.pyc' \
    -printf '%P %m\n' 2>/dev/null | sort
  head -q -c 2 "$CLONE"/test/rostest/*.py 2>/dev/null || true
}

build_workspace() {
  begin "Building the workspace"
  local stamp stamped="$OWN/built" setup="$DEVEL_SPACE/setup.bash"
  stamp=$(build_inputs | sha256sum)
  if [ -f "$setup" ] && [ "$(cat "$stamped" 2>/dev/null || true)" = "$stamp" ]; then
    finish "up to date"
  else
    rm -f -- "$stamped"
    remove_moved_build
    logged "${BUILDER// /_}" "Correct what the log names, in the package it names, and run $COMMAND \
again. 'Could not find a package configuration file' names a package that Debian may have: apt-cache search." \
      run_builder
    compile_sources
    printf '%s' "$stamp" >"$stamped"
    finish
  fi
  source_setup "$setup"
}
