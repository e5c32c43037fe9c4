# shellcheck shell=bash
# Checks side by side, each told of in one line when it has ended.

# Most checks wait half of their time, for a node or for sim time.
LANES=${MY_SIMULATIONS_TEST_LANES:-$(($(nproc) + 2))}
QUEUE=()          # commands, their words quoted
declare -A LANE=()   # process of each that runs, by its number in QUEUE
OUTCOMES=         # folder of what came of each, set by run_queue
PROCESSOR_MS=0    # processor time of all checks, their programs included
PROCESSOR=()      # that of each, as "SECONDS NAME"

# queue COMMAND...: a check (checks.sh) for run_queue.
queue() { QUEUE+=("$(printf '%q ' "$@")"); }

# run_queue: run what is queued, LANES at a time, begun in this order.
run_queue() {
  local next=0 job
  OUTCOMES=$(mktemp -d)
  while [ "$next" -lt "${#QUEUE[@]}" ] || [ "${#LANE[@]}" -gt 0 ]; do
    while [ "$next" -lt "${#QUEUE[@]}" ] && [ "${#LANE[@]}" -lt "$LANES" ]; do
      # A process group of its own; without that, the programs of a lane would ignore Ctrl-C.
      set -m
      in_lane "$next" </dev/null >"$OUTCOMES/$next.text" 2>&1 &
      set +m
      LANE[$next]=$!
      next=$((next + 1))
    done
    show_lanes
    wait -n || true
    for job in "${!LANE[@]}"; do
      if ! kill -0 "${LANE[$job]}" 2>/dev/null; then
        unset "LANE[$job]"
        report_lane "$job"
      fi
    done
  done
  QUEUE=()
  rm -rf -- "$OUTCOMES"
}

# in_lane NUMBER: run one check; what came of it goes to a file for report_lane.
in_lane() {
  trap - EXIT INT TERM HUP
  local IN_LANE=1 PASSED=0 FAILED=0 FAULTS=() REMARK='' SPAN=0
  MARK="$MARK$1."
  eval "${QUEUE[$1]}"
  times >"$OUTCOMES/$1.times"   # of this shell: every pipe and substitution starts at 0
  printf '%s\0' "$PASSED" "$FAILED" "$SPAN" "$REMARK" "$STEP_TEXT" \
    "$(processor_ms <"$OUTCOMES/$1.times")" "${FAULTS[@]}" >"$OUTCOMES/$1.done"
}

# processor_ms: the milliseconds in what `times` has written, as 0m1.234s.
processor_ms() {
  awk -F '[ms ]+' '{ total += ($1 + $3) * 60 + $2 + $4 } END { printf "%d", total * 1000 }'
}

# report_lane NUMBER: print the result of a check that has ended, and count it.
report_lane() {
  local told=(0 1 0 FAILED "${QUEUE[$1]}" 0 "${QUEUE[$1]}: ended without a result") seconds
  [ ! -e "$OUTCOMES/$1.done" ] || mapfile -d '' -t told <"$OUTCOMES/$1.done"
  PASSED=$((PASSED + told[0]))
  FAILED=$((FAILED + told[1]))
  FAULTS+=("${told[@]:6}")
  PROCESSOR_MS=$((PROCESSOR_MS + told[5]))
  printf -v seconds '%d.%03d' $((told[5] / 1000)) $((told[5] % 1000))
  PROCESSOR+=("$seconds ${told[4]}")
  STEP=$((STEP + 1))
  [ ! -t 1 ] || printf '\r\033[K'
  printf '[%d/%d] %s ... %s(%d s, processor %.1f s)\n' "$STEP" "$STEPS" "${told[4]}" \
    "${told[3]:+${told[3]} }" "${told[2]}" "$seconds"
  cat -- "$OUTCOMES/$1.text"
  # What was ended by force is told in the middle of a line.
  [ -z "$(tail -c 1 -- "$OUTCOMES/$1.text")" ] || printf '\n'
}

# show_lanes: on a terminal, what runs now.
show_lanes() {
  local job name words=()
  [ -t 1 ] || return 0
  for job in "${!LANE[@]}"; do
    read -r _ name _ <<<"${QUEUE[$job]}"
    words+=("$(basename "$name" .test)")
  done
  printf '\r\033[K    running: %s' "${words[*]}"
}

# show_processor_times COUNT: the checks, then the tests of pytest, that used the most.
show_processor_times() {
  say "Processor seconds of the checks:"
  printf '%s\n' "${PROCESSOR[@]}" | sort -rn
  say "Processor seconds of the tests:"
  cat -- "$LOGS"/*.log | grep -E '^ *[0-9.]+ test/[^ ]*::' | sort -rn | head -n "$1" || true
}

# end_lanes: end what still runs.
end_lanes() {
  local process
  for process in "${LANE[@]}"; do kill -s KILL -- "-$process" 2>/dev/null || true; done
  LANE=()
  [ -z "$OUTCOMES" ] || rm -rf -- "$OUTCOMES"
}
