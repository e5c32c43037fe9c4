# shellcheck shell=bash
# Runs tools/test in a clean Debian root: nothing that is installed on this machine can help there.
# make_clean_root.sh makes the root and enters it, in mount and process name spaces of its own. They
# end with their first process, whatever ends it, so no mount and no program stays behind.

CLEAN_SUITES='bookworm trixie bullseye'

# clean_root_obstacle: why no clean root can be made here; prints nothing if one can.
clean_root_obstacle() {
  if [ "$(id -u)" != 0 ]; then
    printf 'this user is not root'
  elif [ ! -e "$CLONE/.git" ] || ! command -v git >/dev/null; then
    printf '%s is not a git repository, or there is no git' "$CLONE"
  elif ! unshare --mount --pid --fork mount -t tmpfs none /mnt 2>/dev/null; then
    printf 'mounts are not allowed, as in a container without privileges'
  elif ! command -v debootstrap >/dev/null &&
    ! { apt-get update && apt-get install -y --no-install-recommends debootstrap \
      debian-archive-keyring; } >/dev/null 2>&1; then
    printf 'debootstrap is not installed'
  fi
}

# test_in_clean_root SUITE WORD...: `tools/test WORD...` for the last commit; the same status.
test_in_clean_root() {
  local obstacle status=0
  obstacle=$(clean_root_obstacle)
  [ -z "$obstacle" ] || stop "no clean root can be made: $obstacle." \
    "It takes root, git and debootstrap. As root: apt-get install debootstrap" \
    "Without --clean-root the tests run on this system."
  CLEAN_PROCESS=
  CLEAN_WORK=$(mktemp -d -t my_simulations.XXXXXX)
  trap end_clean_root EXIT
  trap 'printf "\ninterrupted\n" >&2; exit 130' INT TERM HUP
  # In the background: a trap has to wait for a program in the foreground. Ends if this shell is killed.
  setpriv --pdeathsig KILL unshare --mount --propagation private --pid --fork --kill-child --mount-proc \
    bash "$CLONE/tools/lib/make_clean_root.sh" "$CLEAN_WORK" "$@" &
  CLEAN_PROCESS=$!
  wait "$CLEAN_PROCESS" || status=$?
  CLEAN_PROCESS=
  [ "$status" -eq 0 ] || keep_clean_logs
  return "$status"
}

# keep_clean_logs: take the logs out of the root, which is removed.
keep_clean_logs() {
  local kept
  kept=$(mktemp -d -t my_simulations_logs.XXXXXX)
  cp -r -- "$CLEAN_WORK"/{log,root/root/simulation_ws/.my_simulations/{log,test_results}} "$kept" \
    2>/dev/null || true  # what ended early has not all of them
  say "The logs are kept in $kept."
}

# end_clean_root: end what runs there, and remove it.
end_clean_root() {
  local first
  if [ -n "$CLEAN_PROCESS" ]; then
    # The first process of the name space is gone only after all others there, then unshare ends.
    first=$(cat "/proc/$CLEAN_PROCESS/task/$CLEAN_PROCESS/children" 2>/dev/null || true)
    kill -s KILL ${first:-"$CLEAN_PROCESS"} 2>/dev/null || true
    wait "$CLEAN_PROCESS" 2>/dev/null || true
  fi
  rm -rf --one-file-system -- "$CLEAN_WORK"
}
