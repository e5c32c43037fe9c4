# shellcheck shell=bash
# The unit tests with the oldest Python that is supported, where MY_SIMULATIONS_OLDEST_PYTHON names one.

OLDEST_PYTHON=${MY_SIMULATIONS_OLDEST_PYTHON:-}

# oldest_label: what the tests with it are called.
oldest_label() { printf 'test/unit on %s' "$("$OLDEST_PYTHON" --version 2>&1)"; }

# prepare_oldest_python: an environment of it, apart from the system's packages; requirements.txt is
# installed as on Ubuntu 20.04.
prepare_oldest_python() {
  begin "Packages of the oldest Python"
  local place="$OWN/oldest_python" stamp lists=() list
  for list in requirements requirements-test requirements-oldest; do
    lists+=(-r "$CLONE/$list.txt")
  done
  stamp="$("$OLDEST_PYTHON" --version) $(cat "$CLONE"/requirements*.txt | sha256sum)"
  if [ "$(cat "$place/.stamp" 2>/dev/null || true)" = "$stamp" ]; then
    finish "all there"
    return
  fi
  rm -rf -- "$place"
  logged oldest-venv "Does MY_SIMULATIONS_OLDEST_PYTHON name a Python 3.8 or later, with venv?" \
    "$OLDEST_PYTHON" -m venv "$place"
  logged oldest-pip "Is there a network? Then run $COMMAND again." \
    "$place/bin/python3" -m pip install --no-input --disable-pip-version-check \
    --only-binary pybullet "${lists[@]}"
  printf '%s' "$stamp" >"$place/.stamp"
  finish installed
}

# tests_without_ros: the unit tests that need none of ROS's Python packages, which are those of
# another Python.
tests_without_ros() {
  grep -rLE '^(from|import) (rospy|[a-z_]+_msgs|my_simulations\.ros)\b' test/unit \
    --include='test_*.py' | sort
}

# oldest_files FILE...: their tests with the oldest Python.
oldest_files() {
  # The paths of ROS lead to packages of another Python.
  PYTHONPATH='' TEST_PYTHON="$OWN/oldest_python/bin/python3" \
    pytest_files "$(oldest_label)" 1500 "$@"
}
