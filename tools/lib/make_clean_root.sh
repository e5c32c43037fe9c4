#!/usr/bin/env bash
# make_clean_root.sh WORK SUITE WORD...: make a clean Debian root in the folder WORK/root, clone the last
# commit into it and run `tools/test WORD...` there. It mounts file systems: clean_root.sh calls it in
# a mount name space of its own.
set -euo pipefail
CLONE=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
for part in causes progress oldest; do
  # shellcheck disable=SC1090
  . "$CLONE/tools/lib/$part.sh"
done
ROOT=$1/root
LOGS=$1/log
SUITE=$2
shift 2
STEPS=1

# What the caller's machine needs to reach package indexes. Files with certificates are copied.
SETTINGS='.*_proxy|.*_PROXY|PIP_(INDEX_URL|EXTRA_INDEX_URL|TRUSTED_HOST|DEFAULT_TIMEOUT)'
SETTINGS+='|npm_config_registry|NPM_CONFIG_REGISTRY|CI|TERM|MY_SIMULATIONS_TEST_LANES'
CERTIFICATES='SSL_CERT_FILE|PIP_CERT|REQUESTS_CA_BUNDLE|CURL_CA_BUNDLE|NODE_EXTRA_CA_CERTS'
SYSTEM_FILES=(etc/hosts etc/resolv.conf etc/pip.conf usr/local/share/ca-certificates)
HOME_FILES=(.config/pip/pip.conf .npmrc)
ENVIRONMENT=(HOME=/root LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin)

# debian_mirror: where the apt of a Debian host gets its packages; nothing on other systems.
debian_mirror() {
  # shellcheck disable=SC2016
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' 2>/dev/null |
    grep -m 1 '^http://' || true
}

# copy_present FROM TO NAME...: copy those of the files and folders that exist.
copy_present() {
  local from="$1" to="$2" name
  shift 2
  for name in "$@"; do
    [ ! -e "$from/$name" ] || (cd -- "$from" && cp -rL --parents -- "$name" "$to")
  done
}

# make_root: Debian's smallest system with the caller's settings, and nothing of the project.
make_root() {
  local name
  # shellcheck disable=SC2046
  logged debootstrap "Is there a network, and 5 GB in a file system without nodev and noexec? TMPDIR \
names another folder." debootstrap --variant=minbase "$SUITE" "$ROOT" $(debian_mirror)
  copy_present / "$ROOT" "${SYSTEM_FILES[@]}"
  copy_present "$HOME" "$ROOT/root" "${HOME_FILES[@]}"
  # As in Debian's container images: dpkg does not wait for the disk.
  printf 'force-unsafe-io\n' >"$ROOT/etc/dpkg/dpkg.cfg.d/unsafe-io"
  apt-config dump 2>/dev/null | grep -E '^Acquire::(https?|Check-)' >"$ROOT/etc/apt/apt.conf.d/caller" ||
    true
  while IFS= read -r name; do
    if [[ $name =~ ^($SETTINGS)$ ]]; then
      ENVIRONMENT+=("$name=${!name}")
    elif [[ $name =~ ^($CERTIFICATES)$ ]] && [ -f "${!name}" ]; then
      cp -L -- "${!name}" "$ROOT/etc/caller-$name.crt"
      ENVIRONMENT+=("$name=/etc/caller-$name.crt")
    fi
  done < <(compgen -e)
}

# clone_commit: the last commit with its history, also where another user owns the repository.
clone_commit() {
  git config --file "$LOGS/gitconfig" safe.directory '*'
  [ -z "$(GIT_CONFIG_GLOBAL=$LOGS/gitconfig git -C "$CLONE" status --porcelain)" ] ||
    say "without the changes that are not committed"
  GIT_CONFIG_GLOBAL=$LOGS/gitconfig logged clone "Is $CLONE a git repository?" \
    git clone --no-hardlinks --template= "$CLONE" "$ROOT/root/simulation_ws/src/my_simulations"
}

# lend_oldest_python: show the root a Python 3.8 of this machine, which no release of Debian has. Only the
# unit tests that run on it see it.
lend_oldest_python() {
  local prefix
  choose_oldest_python 1
  [ -n "$OLDEST_PYTHON" ] || return 0
  prefix=$("$OLDEST_PYTHON" -c 'import sys; print(sys.base_prefix)')
  [ "$prefix" != /usr ] || return 0
  mkdir -p -- "$ROOT$prefix"
  mount --bind "$prefix" "$ROOT$prefix"
  mount -o remount,bind,ro "$ROOT$prefix"
  ENVIRONMENT+=("MY_SIMULATIONS_OLDEST_PYTHON=$prefix/bin/python3.8")
}

# enter WORD...: run `tools/test WORD...` in the root.
enter() {
  mount -t proc proc "$ROOT/proc"
  mount -t sysfs -o ro sysfs "$ROOT/sys"
  mount --rbind /dev "$ROOT/dev"
  mount -t tmpfs tmpfs "$ROOT/dev/shm"
  chroot "$ROOT" env -i "${ENVIRONMENT[@]}" \
    /root/simulation_ws/src/my_simulations/tools/test "$@" </dev/null
}

begin "A clean root of Debian $SUITE"
mkdir -p -- "$ROOT" "$LOGS"
mount --bind "$ROOT" "$ROOT"   # "/" is a mount point then, as on a machine: programs may mount it read-only
make_root
clone_commit
finish
lend_oldest_python
say "In it: tools/test $*"
enter "$@"
