# shellcheck shell=bash
# Prints numbered steps, their progress, and for failures the reason and what to do.

STEP=0
STEPS=0           # set by the command that sources this file
LOGS=             # folder of the logs, set once the workspace is known

say() { printf '%s\n' "$*"; }

# stop WHAT_IS_WRONG [WHAT_TO_DO ...]
stop() {
  printf '\nSTOPPED: %s\n' "$1" >&2
  shift
  local advice
  for advice in "$@"; do printf '  -> %s\n' "$advice" >&2; done
  exit 1
}

# begin TEXT: announce the next step.
begin() {
  STEP=$((STEP + 1))
  STEP_TEXT="$1"
  STEP_BEGAN=$SECONDS
  [ -z "${IN_LANE:-}" ] || return 0
  printf '[%d/%d] %s ... ' "$STEP" "$STEPS" "$STEP_TEXT"
}

# finish [REMARK]: close the step that began last.
finish() {
  if [ -n "${IN_LANE:-}" ]; then
    REMARK="${1:-}" SPAN=$((SECONDS - STEP_BEGAN))
    return
  fi
  [ ! -t 1 ] || printf '\r\033[K[%d/%d] %s ... ' "$STEP" "$STEPS" "$STEP_TEXT"
  printf '%s(%d s)\n' "${1:+$1 }" "$((SECONDS - STEP_BEGAN))"
}

# Without a terminal, a part that takes longer shows its latest line after each such time.
PROGRESS_SECONDS=60

# follow LOG: copy the input to a log file, and show its latest line below the step: on a terminal each
# line, elsewhere one a minute.
follow() {
  local log="$1" line width shown=$SECONDS end=
  width=$(( ${COLUMNS:-80} - 4 ))
  while IFS= read -r line || [ -n "$line" ]; do
    printf '%s\n' "$line" >>"$log"
    if [ -t 1 ]; then
      printf '\r\033[K    %s' "${line:0:$width}"
    elif [ $((SECONDS - shown)) -ge "$PROGRESS_SECONDS" ]; then
      printf '\n    %s' "${line:0:$width}"
      shown=$SECONDS end='\n'
    fi
  done
  printf '%b' "$end"
}

# recorded NAME COMMAND...: run a part of a step; its output goes to the log NAME; the same status.
recorded() {
  local log="$LOGS/$1.log"
  shift
  mkdir -p "$LOGS"
  printf '+ %s\n' "$*" >"$log"
  "$@" </dev/null 2>&1 | follow "$log"
}

# failed NAME STATUS ADVICE: stop after a recorded part that did not work, with the cause that its log
# tells, else with the advice.
failed() {
  local log="$LOGS/$1.log" cause
  cause=$(cause_in "$log")
  printf '\n\n--- last lines of %s ---\n' "$log" >&2
  tail -n 25 "$log" >&2
  stop "step $STEP, $STEP_TEXT: '$1' failed with status $2." "${cause:-$3}" "The complete log: $log"
}

# logged NAME ADVICE COMMAND...: run and record a part of a step; stop where it fails.
logged() {
  local name="$1" advice="$2" status=0
  shift 2
  recorded "$name" "$@" || status=$?
  [ "$status" -eq 0 ] || failed "$name" "$status" "$advice"
}
