# Builds the program for other systems, with libraries from Debian's sources. For browsers and Node.js, Debian's
# Emscripten makes a wasm module, from which the npm package is made. ./run and ./test source this file; the package
# also needs tools/web.sh.

# fetch_sources FOLDER: unpacks the source packages that tools/packages.txt lists under [wasm-sources] from Debian's
# archive into FOLDER, unless they are already there.
fetch_sources() {
  local folder=$1 listed
  listed=$(listed_packages wasm-sources)
  [ "$(cat "$folder/.fetched" 2>/dev/null)" = "$listed" ] && return 0
  say "getting the sources of" $listed
  rm -rf "$folder" && mkdir -p "$folder/.apt/lists/partial" "$folder/.apt/cache/archives/partial"
  # Keeps the lists of sources in FOLDER, so that the settings of the machine do not change.
  cat >"$folder/.apt/sources.list" <<'LIST'
deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main
LIST
  local options=(-o "Dir::Etc::SourceList=$folder/.apt/sources.list" -o Dir::Etc::SourceParts=/nonexistent
                 -o "Dir::State::Lists=$folder/.apt/lists" -o "Dir::Cache=$folder/.apt/cache" -o APT::Sandbox::User="$(id -un)")
  if ! (cd "$folder" && apt-get -q "${options[@]}" update && apt-get -q "${options[@]}" source $listed) \
      </dev/null >"$folder/.apt/log" 2>&1; then
    say "the sources of libraries could not be fetched; the end of $folder/.apt/log says why:"
    tail -n 5 "$folder/.apt/log" >&2
    return 1
  fi
  rm -f "$folder"/*.tar.* "$folder"/*.dsc
  printf '%s\n' "$listed" >"$folder/.fetched"
}

# build_cross PRESET [TARGET...]: builds the program, the C library and the named targets for another system
# (cmake/PRESET.cmake), in build/PRESET.
build_cross() {
  local preset=$1
  shift
  fetch_sources "$root/build/wasm-sources" || return 1
  build_report_page || return 1
  [ -e "$root/build/$preset/build.ninja" ] || (cd "$root" && cmake --preset "$preset") >&2
  cmake --build "$root/build/$preset" --target chronormal_cli chronormal_c "$@" >&2
}

# build_wasm PRESET [TARGET...]: configures and builds the named targets in build/PRESET.
build_wasm() {
  local preset=$1
  shift
  local build=$root/build/$preset
  fetch_sources "$root/build/wasm-sources" || return 1
  build_report_page || return 1  # the page that `chronormal report` needs
  mkdir -p "$build"
  (
    # Uses the system libraries of Emscripten as Debian has built them, since these builds also exist with support for
    # exceptions.
    export NODE_PATH=/usr/share/nodejs EM_NODE_JS
    EM_NODE_JS=$(command -v node)
    unset CMAKE_CXX_COMPILER_LAUNCHER
    cd "$root"
    [ -e "$build/build.ninja" ] || cmake --preset "$preset"
    cmake --build "$build" --target "${@:-chronormal_cli}"
  )
}

# build_npm: makes build/npm/chronormal-VERSION.tgz and prints its path.
build_npm() {
  build_wasm wasm npm_package || return 1
  local package=$root/build/wasm/package out=$root/build/npm
  mkdir -p "$out" && rm -f "$out"/*.tgz
  (cd "$package" && npm pack --silent --pack-destination "$out" >/dev/null)
  ls "$out"/*.tgz
}
