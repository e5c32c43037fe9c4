# shellcheck shell=bash
# Running checks and tests one after the other, and counting what came of them.

PASSED=0
FAILED=0
FAULTS=()         # the names of what failed, for the end
MARK="$$.$(date +%s)."   # every lane adds its number (lanes.sh)
ADOPT="$(dirname -- "$(realpath -- "${BASH_SOURCE[0]}")")/adopt.py"
COSTLY=test/costly_tests.txt   # tests that only complete runs make, with their processor time
RESULTS=          # folder of the result files, set once the workspace is known

# marked: the processes that a check started, told by a variable in their environment.
marked() {
  local file
  while IFS= read -r file; do
    # A process that has ended and waits for its parent is none.
    grep -q '^State:[[:space:]]*Z' "${file%/environ}/status" 2>/dev/null ||
      basename "${file%/environ}"
  done < <(grep -lz "^MY_SIMULATIONS_TEST_RUN=${MARK//./\\.}" /proc/[0-9]*/environ 2>/dev/null)
}

# end_leftovers: end every process that a check started and did not end; says how many it had to.
end_leftovers() {
  local signal pids=() left until
  for signal in 0 INT TERM KILL; do
    mapfile -t pids < <(marked)
    left=${#pids[@]}
    [ "$left" -gt 0 ] || return 0
    [ "$signal" = 0 ] || printf '(ending %d processes left running: %s) ' "$left" "${pids[*]}"
    kill -s "$signal" "${pids[@]}" 2>/dev/null || true
    until=$((SECONDS + 4))
    while [ "$SECONDS" -lt "$until" ]; do
      [ -n "$(marked)" ] || return 0
      sleep 0.1
    done
  done
}

# attempt NAME SECONDS COMMAND...: run a check with a time limit; its output goes to a log. Returns
# the check's status and leaves the log's path in LOG.
attempt() {
  local limit="$2" status=0
  LOG="$LOGS/$1.log"
  shift 2
  printf '+ %s\n' "$*" >"$LOG"
  # Not through a pipe: a process that is left running would keep it open.
  MY_SIMULATIONS_TEST_RUN=$MARK python3 -I -S "$ADOPT" \
    timeout --foreground -k 20 "$limit" "$@" </dev/null >>"$LOG" 2>&1 || status=$?
  [ "$status" -ne 124 ] || printf 'not done after %s s\n' "$limit" >>"$LOG"
  end_leftovers
  return "$status"
}

# judge NAME TESTS BROKEN STATUS: add to the counts and close the step. A status that no broken
# test explains (a crash, a time limit, a check that is no test) counts as one failure.
judge() {
  local name="$1" tests="$2" broken="$3" status="$4"
  if [ "$status" -ne 0 ] && [ "$broken" -eq 0 ]; then broken=1 tests=$((tests + 1)); fi
  PASSED=$((PASSED + tests - broken))
  FAILED=$((FAILED + broken))
  if [ "$broken" -eq 0 ]; then
    if [ "$tests" -gt 0 ]; then finish "$tests ok"; else finish ok; fi
    return
  fi
  FAULTS+=("$name: $broken failed, see $LOG")
  finish "FAILED"
  show_failures "$LOG"
}

# Of one check; a test that compares long texts may write as much as it likes.
MOST_FAILURE_LINES=400

# show_failures LOG: the failed tests that the log has, and its last lines.
show_failures() {
  local blocks
  blocks=$(failure_blocks "$1")
  if [ -n "$blocks" ]; then
    printf -- '--- failed tests in %s ---\n' "$1"
    head -n "$MOST_FAILURE_LINES" <<<"$blocks"
  fi
  printf -- '--- the last lines of %s ---\n' "$1"
  tail -n "$([ -n "$blocks" ] && printf 15 || printf 60)" "$1"
  printf -- '---\n'
}

# failure_blocks LOG: what TAP, pytest and rostest write about each test that failed.
failure_blocks() {
  # rostest colours some lines.
  sed 's/\x1b\[[0-9;]*m//g' "$1" | awk '
    /^ *not ok /                         { tap = 1 }
    /^=+ (FAILURES|ERRORS) =+$/          { pytest = 1 }
    /^\[[^]]*\]\[(FAILURE|ERROR)\]-*$/   { rostest = 1 }
    tap || pytest || rostest
    /^ *\.\.\.$/                         { tap = 0 }
    /^-----+$/                           { rostest = 0 }'
}

# check NAME SECONDS COMMAND...: a check that is right or wrong as a whole, and is no test.
check() {
  local status=0
  begin "$1"
  attempt "$@" || status=$?
  judge "$1" 0 0 "$status"
}

# check_and_report NAME SECONDS COMMAND...: as check; the step ends with the last line of the output.
check_and_report() {
  local status=0
  begin "$1"
  attempt "$@" || status=$?
  if [ "$status" -eq 0 ]; then finish "$(tail -n 1 "$LOG")"; else judge "$1" 0 0 "$status"; fi
}

# is_left_out NAME: whether this run leaves out a test because it is costly.
is_left_out() {
  [ "${COMPLETE:-1}" = 0 ] && sed 's/^[0-9.]* *//' "$CLONE/$COSTLY" | grep -q -x -F "$1"
}

# pytest_files NAME SECONDS FILE...: the tests of the given files, long ones where LONG is 1, and
# costly ones unless COMPLETE is 0.
pytest_files() {
  local title="$1" limit="$2" status=0 head name results options=()
  [ "${LONG:-0}" = 1 ] || options=(-m "not long")
  [ "${PROCESSOR_TIME:-0}" = 0 ] || options+=(--processor-time 60)
  [ "${COMPLETE:-1}" = 1 ] || options+=(--leave-out "$CLONE/$COSTLY")
  name=${title//[\/ ]/-}
  results="$RESULTS/$name.xml"
  shift 2
  begin "$title"
  attempt "$name" "$limit" env PYTHONPATH="$CLONE/src${PYTHONPATH:+:$PYTHONPATH}" \
    MY_SIMULATIONS_LONG="${LONG:-0}" MY_SIMULATIONS_RELIABILITY="$RESULTS/reliability.jsonl" \
    "${TEST_PYTHON:-$VENV/bin/python3}" -m pytest -p no:cacheprovider --junitxml="$results" \
    "${options[@]}" "$@" || status=$?
  # All tests of the files are costly (ExitCode.NO_TESTS_COLLECTED).
  [ "$status" -ne 5 ] || [ "${COMPLETE:-1}" = 1 ] || status=0
  head=$(grep -o '<testsuite [^>]*>' "$results" 2>/dev/null | head -n 1 || true)
  judge "$title" $(($(attribute tests "$head") - $(attribute skipped "$head"))) \
    $(($(attribute errors "$head") + $(attribute failures "$head"))) "$status"
}

# node_tests NAME SECONDS FILE...: tests of the page's modules, which need no browser.
node_tests() {
  local name="$1" limit="$2" status=0
  shift 2
  begin "$name"
  attempt "${name//\//-}" "$limit" env NODE_OPTIONS="--import=file://$CLONE/test/page/built_modules.mjs" \
    MY_SIMULATIONS_NODE_MODULES="$OWN/node_modules" \
    node --test --test-reporter=tap "$@" || status=$?
  judge "$name" "$(tap tests)" "$(tap fail)" "$status"
}

# tap WORD: the number behind WORD at the end of what node's test runner wrote, 0 without one.
tap() {
  local number
  number=$(sed -n "s/^# $1 \([0-9]*\)$/\1/p" "$LOG" | tail -n 1)
  printf '%s' "${number:-0}"
}

# attribute NAME ELEMENT: a number in an XML start tag, 0 where it is missing.
attribute() {
  local number
  number=$(sed -n "s/.* $1=\"\([0-9]*\)\".*/\1/p" <<<"$2")
  printf '%s' "${number:-0}"
}

# rostest_file FILE SECONDS: one launch file of tests, on a master of its own.
rostest_file() {
  local status=0 name
  name=$(basename "$1" .test)
  begin "rostest $name"
  attempt "rostest-$name" "$2" env ROS_TEST_RESULTS_DIR="$RESULTS" \
    rostest my_simulations "$(basename "$1")" || status=$?
  judge "rostest $name" "$(summary TESTS)" $(($(summary ERRORS) + $(summary FAILURES))) "$status"
}

# summary WORD: the number behind WORD in the summary that rostest ends with, 0 without one.
summary() {
  local number
  # rostest colours the lines of what failed.
  number=$(sed 's/\x1b\[[0-9;]*m//g' "$LOG" | sed -n "s/^ \* $1: \([0-9]*\).*/\1/p" | tail -n 1)
  printf '%s' "${number:-0}"
}
