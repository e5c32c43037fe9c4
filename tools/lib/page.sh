# shellcheck shell=bash
# What the editor's page needs: packages of npm, and its modules as JavaScript, once each for itself
# and once in few files.

BUNDLE_REMARK=    # what a user should know of the few files; empty for nothing

page_stamp() { sha256sum <"$CLONE/web/package-lock.json"; }

# page_is_there: whether the workspace has what the editor's page needs, in this version.
page_is_there() {
  local stamped="${WORKSPACE:-}/.my_simulations/.page"
  [ -f "$stamped" ] && [ "$(cat "$stamped")" = "$(page_stamp)" ]
}

# prepare_page: what the editor's page needs from npm, in a folder of the workspace where the editor
# finds it.
prepare_page() {
  begin "Packages of the editor's page"
  local place="$WORKSPACE/.my_simulations" stamp
  stamp=$(page_stamp)
  if page_is_there; then
    bundle_page
    finish "all there$BUNDLE_REMARK"
    return
  fi
  mkdir -p -- "$place"
  if [ -n "$BUNDLED" ]; then
    [ "$(cat "$BUNDLED/page/.page")" = "$stamp" ] || stop "the archive has modules of another version." \
      "Make it again from this clone."
    rm -rf -- "$place/node_modules"
    cp -a -- "$BUNDLED/page/." "$place/"
    bundle_page
    finish "taken from the archive"
    return
  fi
  rm -f -- "$place/.page" "$place/page_bundler/package-lock.json"
  cp -- "$CLONE/web/package.json" "$CLONE/web/package-lock.json" "$place/"
  logged npm "Is there a network? Then run $COMMAND again." \
    npm ci --prefix "$place" --ignore-scripts --no-audit --no-fund
  printf '%s' "$stamp" >"$place/.page"
  bundle_page
  finish "installed$BUNDLE_REMARK"
}

# page_sources: one hash of all modules of the page and of three's version; the editor makes the same
# (src/my_simulations/editor/transport/page_bundle.py).
page_sources() {
  local modules="$WORKSPACE/.my_simulations/node_modules"
  {
    (cd -- "$CLONE/web" && find js -type f -name '*.ts' | LC_ALL=C sort | xargs -r sha256sum)
    (cd -- "$modules" && sha256sum three/package.json)
  } | sha256sum | cut -d ' ' -f 1
}

# bundle_page: make JavaScript of the page's modules. Few files reach a browser in half of the time;
# tests load single modules.
bundle_page() {
  local own="$WORKSPACE/.my_simulations" sources place work esbuild modules
  place="$own/node_modules/my_simulations_page"
  work="$own/page_made"
  BUNDLE_REMARK=
  [ -f "$own/node_modules/three/package.json" ] || return 0
  sources=$(page_sources)
  [ "$(cat "$place/sources" 2>/dev/null || true)" != "$sources" ] || return 0
  BUNDLE_REMARK=", its modules not built: see $LOGS/page-bundler.log"
  page_bundler >/dev/null || recorded page-bundler fetch_page_bundler || return 0
  esbuild=$(page_bundler) || return 0
  BUNDLE_REMARK=", its modules not built: see $LOGS/page-bundle.log"
  rm -rf -- "$work" "$place"
  mkdir -p -- "$work"
  recorded page-bundle env -C "$work" NODE_PATH="$own/node_modules" "$esbuild" \
    "$CLONE/web/js/main.ts" --bundle --splitting --format=esm --target=es2022 \
    --minify-whitespace --minify-syntax --legal-comments=eof --log-level=warning --outdir=. \
    --entry-names='bundle/[name]' --chunk-names='bundle/[name]-[hash]' --metafile=meta.json ||
    return 0
  recorded page-bundle env -C "$work" NODE_PATH="$own/node_modules" "$esbuild" \
    "$CLONE/web/js/replay/main.ts" --bundle --format=iife --target=es2022 --minify \
    --define:import.meta.url='""' --legal-comments=eof --log-level=warning --outfile=replay.js ||
    return 0
  mapfile -t modules < <(find "$CLONE/web/js" -type f -name '*.ts')
  recorded page-bundle "$esbuild" "${modules[@]}" --outbase="$CLONE/web/js" --outdir="$work/js" \
    --format=esm --target=es2022 --log-level=warning || return 0
  # Node.js before 20.19 takes modules of a package without this for CommonJS.
  printf '{"type": "module"}\n' >"$work/package.json"
  printf '%s\n' "$sources" >"$work/sources"
  mv -- "$work" "$place"
  BUNDLE_REMARK=
}

# page_bundler: the path of esbuild for this machine; fails without one of the right version.
page_bundler() {
  local own="$WORKSPACE/.my_simulations/page_bundler" found
  cmp -s -- "$CLONE/tools/page_bundler/package-lock.json" "$own/package-lock.json" || return 1
  # npm 7 fetches those of other systems, too.
  found=$own/node_modules/@esbuild/$(node -p 'process.platform + "-" + process.arch')/bin/esbuild
  [ -x "$found" ] && printf '%s' "$found"
}

# fetch_page_bundler: once; where it did not come, again only with other packages of the page.
fetch_page_bundler() {
  local own="$WORKSPACE/.my_simulations/page_bundler"
  if cmp -s -- "$CLONE/tools/page_bundler/package-lock.json" "$own/package-lock.json"; then
    printf 'It did not come when it was asked for; remove %s to ask again.\n' "$own"
    return 1
  fi
  mkdir -p -- "$own"
  cp -- "$CLONE/tools/page_bundler/package.json" "$CLONE/tools/page_bundler/package-lock.json" "$own/"
  npm ci --prefix "$own" --ignore-scripts --no-audit --no-fund
}
