# shellcheck shell=bash
# Steps that say what they do, how far they are, and, when they fail, why and what to do.

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

# Copies its input to a log file; on a terminal the latest line shows behind the step.
follow() {
  local log="$1" line width
  width=$(( ${COLUMNS:-80} - 4 ))
  while IFS= read -r line || [ -n "$line" ]; do
    printf '%s\n' "$line" >>"$log"
    [ ! -t 1 ] || printf '\r\033[K    %s' "${line:0:$width}"
  done
}

# logged NAME ADVICE COMMAND...: run a part of a step; its output goes to the log NAME.
logged() {
  local name="$1" log="$LOGS/$1.log" advice="$2" status=0
  shift 2
  mkdir -p "$LOGS"
  printf '+ %s\n' "$*" >"$log"
  "$@" </dev/null 2>&1 | follow "$log" || status=$?
  [ "$status" -eq 0 ] && return
  printf '\n\n--- the last lines of %s ---\n' "$log" >&2
  tail -n 25 "$log" >&2
  stop "step $STEP, $STEP_TEXT: '$name' ended with status $status." "$advice" \
    "The whole log is $log."
}
