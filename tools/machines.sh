# Sourced by ./test: compiles the core of the library for another kind of machine, 64-bit ARM, and runs in an emulator
# the tests that demand the same bits everywhere.

# fetch_arm64 FOLDER: unpacks the packages that tools/packages.txt lists under [machines-arm64] into FOLDER, unless they
# are already there. Nothing is installed, and the lists of packages are kept in FOLDER, so the settings of this machine
# do not change.
fetch_arm64() {
  local folder=$1 listed package
  listed=$(listed_packages machines-arm64 | xargs)
  [ "$(cat "$folder/.fetched" 2>/dev/null)" = "$listed" ] && return 0
  say "downloading the packages for ARM:" $listed
  rm -rf "$folder" && mkdir -p "$folder/.apt/lists/partial" "$folder/.apt/cache/archives/partial"
  cat >"$folder/.apt/sources.list" <<'LIST'
deb [arch=arm64 signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian bookworm main
LIST
  local options=(-o "Dir::Etc::SourceList=$folder/.apt/sources.list" -o Dir::Etc::SourceParts=/nonexistent
                 -o "Dir::State::Lists=$folder/.apt/lists" -o "Dir::Cache=$folder/.apt/cache"
                 -o APT::Sandbox::User="$(id -un)" -o APT::Architectures::=amd64 -o APT::Architectures::=arm64)
  if ! (cd "$folder" && apt-get -q "${options[@]}" update &&
        apt-get -q "${options[@]}" download $(printf '%s:arm64 ' $listed)) </dev/null >"$folder/.apt/log" 2>&1; then
    say "the ARM packages could not be fetched; the end of $folder/.apt/log says why:"
    tail -n 5 "$folder/.apt/log" >&2
    return 1
  fi
  for package in "$folder"/*.deb; do dpkg-deb -x "$package" "$folder" || return 1; done
  rm -f "$folder"/*.deb
  printf '%s\n' "$listed" >"$folder/.fetched"
}

# The floors that need no library except Highway; their tests that compare bits are run.
machine_floors=(core simd motion normals)
machine_tests=(tests/normals/curves/golden_bits_test.cpp tests/normals/times_test.cpp tests/support/random_seed.cpp)

# build_for_arm64: compiles these floors with the flags of the presets, as far as they are not up to date; makes
# build/arm64/tests.
build_for_arm64() {
  local build=$root/build/arm64 file
  fetch_arm64 "$root/build/arm64-packages" || return 1
  mkdir -p "$build"
  local packages=$root/build/arm64-packages/usr
  {
    for file in "${machine_floors[@]}"; do find "src/$file" -name '*.cpp'; done
    printf '%s\n' "${machine_tests[@]}"
  } | sort >"$build/sources"
  # Writes one rule for each source. The compiler records the included files beside the object.
  {
    printf 'cxx = %s\n' "${CHRONORMAL_ARM64_CXX:-aarch64-linux-gnu-g++}"
    # The instruction sets are the same as in the library's own build. Highway enables NEON with the instructions for
    # cryptography by a pragma, which GCC ignores in constructors that the compiler generates.
    local disabled
    disabled=$(sed -n 's/.*"\(HWY_DISABLED_TARGETS=[^"]*\)".*/\1/p' cmake/product.cmake)
    printf "flags = -DCHRONORMAL_HIGHWAY '-D%s'" "$disabled"
    printf ' -march=armv8-a+crypto -std=c++20 -O2 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wno-psabi'
    printf ' -I%s -I%s/src -I%s/include -isystem %s/include -isystem %s/include/aarch64-linux-gnu\n' \
      "$root" "$root" "$root" "$packages" "$packages"
    printf 'rule cxx\n  description = $in\n  command = $cxx $flags -MMD -MF $out.d -c $in -o $out\n'
    printf '  depfile = $out.d\n  deps = gcc\n'
    printf 'rule link\n  command = $cxx -o $out @$out.rsp -L%s/lib/aarch64-linux-gnu' "$packages"
    printf ' -Wl,-rpath,%s/lib/aarch64-linux-gnu' "$packages"
    printf ' -lhwy -lgtest_main -lgtest -lgmpxx -lgmp\n  rspfile = $out.rsp\n  rspfile_content = $in\n'
    local objects=()
    while read -r file; do
      objects+=("objects/$file.o")
      printf 'build objects/%s.o: cxx %s/%s\n' "$file" "$root" "$file"
    done <"$build/sources"
    printf 'build tests: link %s\n' "${objects[*]}"
  } >"$build/build.ninja"
  ninja -C "$build"
}

# compile_two_files NAME COMPILER FLAGS RUN: writes and compiles the two files of tools/two_files.py, and compares their
# results with the results of the library of build/release.
compile_two_files() {
  say "the two files by $1"
  cmake -DSOURCE="$root" -DFOLDER="$root/build/release/two_files" "-DCOMPILER=$2" "-DFLAGS=$3" "-DRUN=$4" \
    -P tests/install/two_files/run.cmake
}

# test_machine SYSTEM EMULATOR...: builds the program for a system (a preset), and compares it with that of build/release.
test_machine() {
  local system=$1 suffix=
  shift
  [ "$system" != windows ] || suffix=.exe
  build_cross "$system" bits
  WINEPREFIX=$root/build/$system/wine CHRONORMAL_SYSTEM=$system CHRONORMAL_PROGRAM=$root/build/release/chronormal \
    CHRONORMAL_OTHER="$* $root/build/$system/chronormal$suffix" CHRONORMAL_BITS="$* $root/build/$system/bits$suffix" \
    /usr/bin/python3 tests/machines/test_machine.py
}

part_machines() {
  part_build
  run_ctest release two_files -L two_files
  compile_two_files "GCC for this machine alone" g++ "-march=native -O3" ""
  compile_two_files "GCC without its vectors" g++ "-DCHRONORMAL_PLAIN_ARRAYS" ""
  compile_two_files Clang clang++-14 "" ""
  compile_two_files "GCC for 64-bit ARM" aarch64-linux-gnu-g++ "" "qemu-aarch64-static -L /usr/aarch64-linux-gnu"
  # Debian's Emscripten looks for modules of Node.js in Debian's folder, as in tools/wasm.sh.
  NODE_PATH=/usr/share/nodejs EM_NODE_JS=$(command -v node) compile_two_files Emscripten em++ "" "node --no-experimental-fetch"
  test_machine windows wine
  build_for_arm64
  rm -rf build/arm64/results
  qemu-aarch64-static -L /usr/aarch64-linux-gnu build/arm64/tests --gtest_brief=1 --gtest_output=xml:build/arm64/results/tests.xml
  report_results build/arm64/results
}
