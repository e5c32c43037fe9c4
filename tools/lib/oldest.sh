# shellcheck shell=bash
# The unit tests with the oldest Python that is supported: the one that MY_SIMULATIONS_OLDEST_PYTHON
# names; without that variable any that is found, in runs of all tests.

OLDEST_PYTHON=

# choose_oldest_python ALL: set OLDEST_PYTHON; it stays empty where there is none, or nothing is to be
# looked for (ALL is 0).
choose_oldest_python() {
  local named="${MY_SIMULATIONS_OLDEST_PYTHON:-}" candidate
  if [ -n "$named" ]; then
    [ "$named" = none ] || OLDEST_PYTHON=$named
    return
  fi
  # Where it is the system's own, all tests run on it.
  if [ "$1" = 0 ] || is_oldest python3; then return; fi
  for candidate in python3.8 "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.8.*/bin/python3.8; do
    if is_oldest "$candidate"; then
      OLDEST_PYTHON=$candidate
      return
    fi
  done
}

# is_oldest PYTHON: whether it runs, is a 3.8 and can make environments.
is_oldest() {
  "$1" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info[:2] != (3, 8))' 2>/dev/null
}

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

# tell_oldest_python: say why no tests run on one, where one was looked for.
tell_oldest_python() {
  begin "Packages of the oldest Python"
  if [ "${MY_SIMULATIONS_OLDEST_PYTHON:-}" = none ]; then
    finish "not wanted"
  elif is_oldest python3; then
    finish "all tests run on it"
  else
    finish "no Python 3.8 found (MY_SIMULATIONS_OLDEST_PYTHON)"
  fi
}

# tests_without_ros: the unit tests that need none of ROS's Python packages, which are those of
# another Python. Those of the repository, its tools and the files it ships are the same for each.
tests_without_ros() {
  grep -rLE '^(from|import) (rospy|[a-z_]+_msgs|my_simulations\.ros)\b' test/unit \
    --include='test_*.py' --exclude-dir=project --exclude=test_content.py \
    --exclude=test_save_sdformat.py | sort
}

# tests_of_readers: those of them in folders whose code uses the packages that requirements-oldest.txt
# has in other versions. That all other code runs on Python 3.8, mypy and ruff check.
tests_of_readers() {
  tests_without_ros | grep -E '^test/unit/(description|formats|messages|objects|resources|studies)/'
}

# oldest_files FILE...: their tests with the oldest Python.
oldest_files() {
  # The paths of ROS lead to packages of another Python.
  PYTHONPATH='' TEST_PYTHON="$OWN/oldest_python/bin/python3" \
    pytest_files "$(oldest_label)" 3600 "$@"
}
