# shellcheck shell=bash
# PyBullet from its sources, where the package index has no wheel of it for this interpreter or this
# processor. The wheel that is made stays in the user's cache: no other workspace compiles again.

# Of one core; the sources were compiled in 180 to 320 s of processor time on two machines.
PYBULLET_SECONDS=320

# pybullet_wheels: the folder of the wheels that were compiled here.
pybullet_wheels() { printf '%s' "${XDG_CACHE_HOME:-$HOME/.cache}/my_simulations/wheels"; }

# pybullet_lacks_wheel NAME: whether that is why the part NAME of this step, an installation by pip,
# has failed.
pybullet_lacks_wheel() {
  grep -q 'No matching distribution found for pybullet==' "$LOGS/$1.log"
}

# build_pybullet: compile the pinned source, whose hash is checked, and keep the wheel.
build_pybullet() {
  local pin work sources minutes
  pin=$(packages_of "$CLONE/tools/lib/pybullet-source.txt" | sed 's/ .*//')
  minutes=$(((PYBULLET_SECONDS / $(nproc) + 59) / 60))
  say "there is no wheel of ${pin/==/ } for $("$PYTHON" --version) on $(uname -m): compiling it, \
about $minutes minutes; this user's next workspace will find it in $(pybullet_wheels)"
  install_compiler
  work="$OWN/pybullet"
  rm -rf -- "$work"
  mkdir -p -- "$work" "$(pybullet_wheels)" || stop "the wheel cannot be kept." \
    "Make $(pybullet_wheels) writable, or set XDG_CACHE_HOME to a folder that is."
  logged pybullet-tools "Is there a network? Then run $COMMAND again." \
    "$VENV/bin/python3" -m pip install --no-input --disable-pip-version-check \
    --target "$work/tools" -r "$CLONE/tools/lib/pybullet-tools.txt"
  logged pybullet-source "Is there a network? Then run $COMMAND again." \
    env PYTHONPATH="$work/tools" "$VENV/bin/python3" -m pip download --no-input \
    --disable-pip-version-check --no-deps --no-build-isolation --no-binary pybullet \
    --require-hashes -d "$work" -r "$CLONE/tools/lib/pybullet-source.txt"
  logged pybullet-unpack "Is there room on the disk (df -h)? It takes 1 GB." \
    tar -xzf "$work"/pybullet-*.tar.gz -C "$work" --strip-components=1 --one-top-level=source
  # The plugin that draws by EGL is a second module of 56 files; cameras here draw without it.
  sed -i "/EGL_CXX_FLAGS += '-DBT_USE_EGL '/s/EGL_CXX_FLAGS.*/pass/" "$work/source/setup.py"
  sources=$(sed '/^egl_renderer_sources/,/^$/d' "$work/source/setup.py" |
    grep -c '\["[^"]*\.c\(pp\)\?"\]')
  logged pybullet-compile "The compiler says why; 1 GB of memory and of disk are needed." \
    compile_pybullet "$work" "$sources"
  mv -- "$work"/wheel/*.whl "$(pybullet_wheels)/"
  rm -rf -- "$work"
}

# compile_packages: what compiles it. The headers of NumPy come with python3-numpy.
compile_packages() {
  packages_of "$CLONE/tools/apt-packages-compile.txt"
  # Elsewhere glcontext has no wheel either, and needs the headers of X11.
  [ "$(uname -m)" = x86_64 ] || printf 'libx11-dev\n'
}

# needs_compiler: whether PyBullet has no wheel for this interpreter and processor, neither on the
# package index (3.7 to 3.11 on x86-64) nor in the cache.
needs_compiler() {
  local minor
  [ -z "$(ls "$(pybullet_wheels)" 2>/dev/null)" ] || return 1
  [ "$(uname -m)" = x86_64 ] || return 0
  minor=$("$PYTHON" -c 'import sys; print(sys.version_info[1])' 2>/dev/null) || return 1
  [ "$minor" -gt 11 ]
}

# install_compiler: what compiles, where it is not there.
install_compiler() {
  local wanted missing advice="Is there a network, and room on the disk (df -h)? Then run $COMMAND again."
  mapfile -t wanted < <(compile_packages)
  mapfile -t missing < <(missing_packages "${wanted[@]}")
  [ "${#missing[@]}" -gt 0 ] || return 0
  may_install || stop "PyBullet must be compiled, ${#missing[@]} system packages are missing for \
that, and there is neither root nor sudo." \
    "As root: apt-get install --no-install-recommends ${missing[*]}"
  apt_update || failed apt-update "$?" "$advice"
  apt_install apt-install-compile "$advice" "${missing[@]}"
}

# Runs setup.py with log messages on: since Python 3.12 it prints no compiler commands on its own.
RUN_SETUP_PY='import logging, runpy, sys
logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stdout)
sys.argv[:1] = []
runpy.run_path(sys.argv[0], run_name="__main__")'

# compile_pybullet FOLDER SOURCES: a wheel in FOLDER/wheel; says how many of the SOURCES are done, and
# how long the others take at the pace so far.
compile_pybullet() {
  # No debug information: half of the time and nine tenths of the size. GCC 14 refuses the pointers
  # that pybullet.c hands to NumPy without the other option.
  local flags="-g0 -Wno-incompatible-pointer-types" line count=0 began=$SECONDS left
  (
    cd -- "$1/source"
    CFLAGS="$flags" CXXFLAGS=-g0 PYTHONPATH="$1/tools" PYTHONUNBUFFERED=1 \
      "$VENV/bin/python3" -c "$RUN_SETUP_PY" setup.py -v bdist_wheel -d "$1/wheel" 2>&1
  ) | while IFS= read -r line; do
    case $line in
      *' -c '*)
        count=$((count + 1))
        line=${line#* -c }
        left=$((($2 - count) * (SECONDS - began) / count / 60))
        line="compiling $count of about $2, about $((left > 0 ? left : 0)) min left: ${line%% *}" ;;
    esac
    printf '%s\n' "$line"
  done
}
