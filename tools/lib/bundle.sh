# shellcheck shell=bash
# One archive for machines without a network: wheels, the page's modules, names of system packages.

BUNDLED=          # the unpacked archive that the set-up takes its packages from; empty for none

# bundle_system: what the wheels in an archive are for.
bundle_system() {
  "$PYTHON" -c 'import platform, sys
print("Python %d.%d on" % sys.version_info[:2], platform.machine())'
}

# make_bundle FILE: pack what the set-up of this workspace has fetched.
make_bundle() {
  local file work="$OWN/bundle-made" command
  file=$(realpath -m -- "$1")
  begin "Packing $file"
  rm -rf -- "$work"
  mkdir -p -- "$work/wheels" "$work/page"
  command=("$VENV/bin/python3" -m pip wheel --no-input --disable-pip-version-check
    --prefer-binary --wheel-dir "$work/wheels" -r "$CLONE/requirements.txt")
  [ ! -d "$(pybullet_wheels)" ] || command+=(--find-links "$(pybullet_wheels)")
  logged bundle-wheels "Is there a network? Then run $COMMAND again." "${command[@]}"
  cp -a -- "$OWN/node_modules" "$OWN/.page" "$work/page/"
  bundle_system >"$work/system"
  BUNDLED=$work system_packages all >"$work/apt-packages.txt"
  logged bundle-archive "Is there room on the disk (df -h)?" tar -czf "$file" -C "$work" .
  rm -rf -- "$work"
  finish "$(du -h -- "$file" | cut -f 1)"
  say "On a machine of the same kind ($(bundle_system)): $COMMAND --from-bundle $(basename -- "$file")"
}

# open_bundle FILE: unpack an archive, from which packages are taken from then on.
open_bundle() {
  [ -f "$1" ] || stop "there is no archive $1." "Make it where there is a network: $COMMAND --bundle $1"
  local made
  rm -rf -- "$OWN/bundle"
  mkdir -p -- "$OWN/bundle"
  logged bundle-open "Is $1 what $COMMAND --bundle made?" tar -xzf "$1" -C "$OWN/bundle"
  made=$(cat "$OWN/bundle/system" 2>/dev/null || true)
  [ "$made" = "$(bundle_system)" ] || stop "$1 is for ${made:-something else}; here is $(bundle_system)." \
    "Make one on a machine of this kind: $COMMAND --bundle FILE"
  BUNDLED="$OWN/bundle"
}
