# Defines the parts of ./test --full, the functions that build and test for them, and the table that is printed at the
# end. ./test and .ci/run source this file.

# Each part has a line with four fields: its name; the minutes that it takes from scratch on two idle cores; the
# sections of tools/packages.txt that it needs besides [run] and [test] ("-" for none); and a pattern of files ("-" for
# none). If a change touches such a file, .ci/run runs the part at once, even if it is not the turn of this part. The
# expected minutes are printed beside the measured minutes; no part fails because of them.
parts_table='
data        3   -                 -
slow        4   -                 ^tests/(faults/|support/cpu_time)|^src/io/bytes/output_file
browser     6   web,node          ^(web|js)/
python      4   python            ^python/
sanitizers  16  -                 ^fuzz/|^src/io/bytes/
npm         14  web,node,wasm     ^js/|^web/|^cmake/wasm|^tools/w
presets     28  -                 ^CMakePresets|^CMakeLists|^cmake/(compiler|product)
clang       28  clang             ^cmake/compiler
tidy        14  clang             ^\.clang-tidy
fuzz        26  clang             ^fuzz/
viewers       20  web,node,wasm     ^tests/viewers/.*_page
pipelines   18  web,node,blender  ^tests/viewers/(pipelines|blender)|^blender/
windows     14  cross,machines          ^src/io/system/|^tools/machines|^tests/machines|^cmake/(windows|bits)
arm64       22  cross,machines,node,web  ^src/simd/|/kernels/|^tools/(machines|two_files)|^tests/(machines|install/two_files)|^cmake/(arm64|bits)
exact       20  -                 ^tests/support/exact_|^src/normals/control/exact
faults      20  -                 ^tests/faults/
embedding   28  embedding,node    ^(capi|tests/install)/|^cmake/(install|product)|^python/setup
everywhere  30  web,node,wasm     ^tests/viewers/same_bytes
pages       15  latex,plots,python  ^tools/pages/|^bench/results/|^cli/reports/compare
scale       28  vtk,plots         ^(vtk|cli/ranks|tests/(ranks|streams)|tools/pages/vtk)
peers       20  bench,peers       ^bench/
dist        28  dist,cross,python,node,site  ^tools/(dist|site)|^tests/dist/|^packaging/|^cmake/(sources|install|product)|^\.github/|^run$
'

part_names() { awk 'NF { print $1 }' <<<"$parts_table"; }
part_field() { awk -v name="$1" -v field="$2" '$1 == name { print $field }' <<<"$parts_table"; }
part_minutes() { part_field "$1" 2; }
part_packages() { part_field "$1" 3 | tr ',' '\n' | grep -v '^-$' || true; }

# parts_of_change FILE...: prints the parts whose pattern matches one of the named files.
parts_of_change() {
  local name pattern
  for name in $(part_names); do
    pattern=$(part_field "$name" 4)
    if [ "$pattern" != - ] && printf '%s\n' "$@" | grep -qE "$pattern"; then echo "$name"; fi
  done
}

done_names=() done_seconds=() done_jobs=()

# count_jobs: sets `jobs` to the processor seconds of this script's children so far. Do not call it in a subshell, where
# `times` counts only the children of the subshell.
count_jobs() {
  times >build/times
  jobs=$(awk 'NR == 2 { for (i = 1; i <= 2; ++i) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } print int(s) }' build/times)
}

# part NAME COMMAND...: runs a part and records its time. If the part fails, prints the table and ends the script.
part() {
  local name=$1 begin=$SECONDS jobs before status=0
  shift
  count_jobs
  before=$jobs
  say "== $name"
  # The part runs in a subshell, so that its first error ends the part.
  set +e
  (set -e; "$@")
  status=$?
  set -e
  done_names+=("$name") done_seconds+=($((SECONDS - begin)))
  count_jobs
  done_jobs+=($((jobs - before)))
  if [ "$status" -ne 0 ]; then
    say "the part $name failed (exit code $status); the first error above says why"
    print_parts
    exit 1
  fi
}

# configure PRESET [OPTION...]: runs CMake.
configure() {
  local preset=$1
  shift
  cmake --preset "$preset" -DCHRONORMAL_ALL_TESTS=ON "$@" >/dev/null
}

# configure_and_build PRESET [TARGET...]: runs CMake, and builds the named targets, or all targets.
configure_and_build() {
  local preset=$1
  shift
  configure "$preset"
  cmake --build --preset "$preset" ${1+--target "$@"}
}

# run_ctest PRESET NAME [CTEST-ARGUMENT...]: runs tests, keeps the output of ctest in build/PRESET/NAME.log, and records
# the numbers of tests that passed and failed.
run_ctest() {
  local preset=$1 name=$2 status=0
  shift 2
  rm -rf "build/$preset/results"
  ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@" |
    tee "build/$preset/$name.log" || status=$?
  # The pattern matches "99% tests passed, 2 tests failed out of 61". The numbers count test programs; report_results
  # counts the tests inside them.
  sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests failed out of ([0-9]+)$/\1 \2/p' "build/$preset/$name.log" >>build/counts.txt
  report_results "build/$preset/results" || status=1
  return "$status"
}

# report_results FOLDER: counts the tests in the XML files of GoogleTest in FOLDER, and prints the skipped tests with
# their reasons. A skipped test is an error only if its reason does not hold on this machine.
report_results() {
  local folder=$1 reasons wrong
  [ -d "$folder" ] || return 0
  sed -nE 's/^<testsuites tests="([0-9]+)" failures="([0-9]+)".*/\2 \1/p' "$folder"/*.xml |
    awk '{ failed += $1; all += $2 } END { print failed - 0, all - 0 }' >>build/counts.txt
  reasons=$(sed -nE 's/.*<skipped message="[^"&]*&#x0A;([^"]*)".*/\1/p' "$folder"/*.xml | sort | uniq -c | sort -rn)
  [ -n "$reasons" ] || return 0
  say "these tests were skipped, with the number and the reason:"
  printf '%s\n' "$reasons" >&2
  wrong=$(grep -E "$(wrong_reasons)" <<<"$reasons" || true)
  [ -z "$wrong" ] || { say "tests were skipped for reasons that are not true on this machine; make these tests run: $wrong"; return 1; }
}

# wrong_reasons: prints a pattern of reasons that do not hold on this machine. No test may be skipped for such a reason.
wrong_reasons() {
  printf '^$'  # matches no reason
  [ -z "${CHRONORMAL_DATA-}" ] || printf '|set CHRONORMAL_DATA'
  ! script -qec true /dev/null </dev/null &>/dev/null || printf '|makes no terminal'
  [ ! -c /dev/full ] || printf '|no /dev/full'
}

# show_counts NAME...: prints the numbers of tests that the test runner of Node.js counted in the named runs.
show_counts() {
  local name
  for name; do
    say "tests of $name, as Node's test runner counted them:"
    grep -E '^# (tests|pass|fail|cancelled|skipped|duration_ms) ' "build/release/$name.tap"
  done
}

print_parts() {
  local i jobs
  count_jobs
  printf '\n%-12s %8s %8s %12s\n' part minutes usual job-seconds
  for i in "${!done_names[@]}"; do
    printf '%-12s %8s %8s %12s\n' "${done_names[i]}" "$(minutes "${done_seconds[i]}")" "$(part_minutes "${done_names[i]}")" "${done_jobs[i]}"
  done
  printf '%-12s %8s %8s %12s\n' all "$(minutes "$SECONDS")" '' "$jobs"
}
minutes() { awk -v s="$1" 'BEGIN { printf "%.1f", s / 60 }'; }

# finish_parts: prints the table of the parts, and the number of all tests.
finish_parts() {
  print_parts
  if [ -s build/counts.txt ]; then
    awk '{ failed += $1; all += $2 } END { printf "tests: %d passed, %d failed\n", all - failed, failed }' build/counts.txt
  fi
}
