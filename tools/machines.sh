# Compiles, with several compilers, the two files that tools/two_files.py writes, and runs the programs for other
# systems in emulators. The results must have the same bytes everywhere. ./test sources this file.

# compile_two_files NAME COMPILER FLAGS RUN: writes and compiles the two files of tools/two_files.py, and compares their
# results with the results of the library of build/release.
compile_two_files() {
  say "compiling the two files of tools/two_files.py: $1"
  cmake -DSOURCE="$root" -DFOLDER="$root/build/release/two_files" "-DCOMPILER=$2" "-DFLAGS=$3" "-DRUN=$4" \
    -P tests/install/two_files/run.cmake
}

# test_machine SYSTEM EMULATOR...: builds the program for a system (a preset), and compares its results with those of
# the program in build/release.
test_machine() {
  local system=$1 suffix=
  shift
  [ "$system" != windows ] || suffix=.exe
  build_cross "$system" bits
  WINEPREFIX=$root/build/$system/wine CHRONORMAL_SYSTEM=$system CHRONORMAL_PROGRAM=$root/build/release/chronormal \
    CHRONORMAL_OTHER="$* $root/build/$system/chronormal$suffix" CHRONORMAL_BITS="$* $root/build/$system/bits$suffix" \
    /usr/bin/python3 tests/machines/test_machine.py
}

part_windows() {
  configure_and_build release chronormal_cli
  test_machine windows wine
}
part_arm64() {
  configure_and_build release chronormal_cli
  run_ctest release two_files -L two_files
  compile_two_files "GCC for this machine alone" g++ "-march=native -O3" ""
  compile_two_files "GCC without its vectors" g++ "-DCHRONORMAL_PLAIN_ARRAYS" ""
  compile_two_files Clang clang++-14 "" ""
  compile_two_files "GCC for 64-bit ARM" aarch64-linux-gnu-g++ "" "qemu-aarch64-static -L /usr/aarch64-linux-gnu"
  # Debian's Emscripten looks for modules of Node.js in Debian's folder, as in tools/wasm.sh.
  NODE_PATH=/usr/share/nodejs EM_NODE_JS=$(command -v node) compile_two_files Emscripten em++ "" "node --no-experimental-fetch"
  test_machine arm64 qemu-aarch64-static
}
