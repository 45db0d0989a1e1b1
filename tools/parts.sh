# Sourced by ./test: parts that are timed, how they build and run tests, and the table at the end.

part_names=() part_seconds=() part_budgets=()
pace=1

# measure_pace: sets `pace` to how many times as long as on the machine of the budgets compiling takes on this one, on
# all cores at once, the best of three times; it is 1 where this machine is the faster one. The figure for the machine of
# the budgets is derived: where tools/pace.cpp takes 6.3 s, the part build takes 28 minutes; there it takes 15.
milliseconds_of_the_budgets=3300
measure_pace() {
  local best=0 begin took round
  for round in 1 2 3; do
    begin=$(date +%s%3N)
    seq "$(nproc)" | xargs -P 0 -I {} c++ -std=c++20 -O2 -c tools/pace.cpp -o /dev/null
    took=$(($(date +%s%3N) - begin))
    if [ "$best" -eq 0 ] || [ "$took" -lt "$best" ]; then best=$took; fi
  done
  pace=$(awk -v a="$best" -v b="$milliseconds_of_the_budgets" 'BEGIN { printf "%.1f", (a > b ? a / b : 1) }')
  say "compiling takes $pace times as long here as on the machine of the budgets ($best ms, $milliseconds_of_the_budgets there)"
}

# part NAME BUDGET COMMAND...: runs a part and notes how long it took; BUDGET is in minutes. The first part that fails
# ends everything, with the table of what there was.
part() {
  local name=$1 budget=$2 begin=$SECONDS status=0
  shift 2
  say "== $name"
  # In a subshell, so that the first error ends the part as it would end the script.
  set +e
  (set -e; "$@")
  status=$?
  set -e
  part_names+=("$name") part_seconds+=($((SECONDS - begin))) part_budgets+=("$budget")
  if [ "$status" -ne 0 ]; then
    say "the part $name failed (exit code $status); the first error above says why"
    print_parts
    exit 1
  fi
}

# configure_and_build PRESET [TARGET...]
configure_and_build() {
  local preset=$1
  shift
  cmake --preset "$preset" -DCHRONORMAL_ALL_TESTS=ON >/dev/null
  cmake --build --preset "$preset" ${1+--target "$@"}
}

# run_ctest PRESET NAME [CTEST-ARGUMENT...]: runs tests, and keeps what ctest says in build/PRESET/NAME.log.
run_ctest() {
  local preset=$1 name=$2
  shift 2
  ctest --test-dir "build/$preset" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@" |
    tee "build/$preset/$name.log"
  # "99% tests passed, 2 tests failed out of 1320"
  sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests failed out of ([0-9]+)$/\1 \2/p' "build/$preset/$name.log" \
    >>build/counts.txt
}

# known_skips: prints a pattern of the tests that this machine has no terminal, no device or no file system for. Where it
# has, they must run.
known_skips() {
  local known=all_keys_only folder
  folder=$(mktemp -d)
  script -qec true /dev/null </dev/null &>/dev/null || known+='|_on_a_terminal_'
  [ -c /dev/full ] || known+='|full_device_is_an_error'
  truncate -s 4097M "$folder/large" 2>/dev/null || known+='|more_than_a_glb_can_hold'
  if mount -t tmpfs -o size=64k none "$folder" 2>/dev/null; then umount "$folder"; else known+='|^InterruptedBake'; fi
  rm -rf "$folder"
  echo "$known"
}

# expect_skipped PRESET NAME: no test of run_ctest was skipped but those on real meshes where CHRONORMAL_DATA is not set,
# and those of known_skips, so that nothing that is missing drops a test unseen.
real_mesh_tests=47
expect_skipped() {
  local log=build/$1/$2.log expected=$real_mesh_tests skipped
  [ -z "${CHRONORMAL_DATA-}" ] || expected=0
  skipped=$(sed -nE 's/^[[:space:]]+[0-9]+ - (.*) \(Skipped\)$/\1/p' "$log" | grep -vE "$(known_skips)" || true)
  [ "$(grep -c . <<<"$skipped")" -eq "$expected" ] || {
    say "$expected tests may be skipped here, and these were:"
    say "$skipped"
    return 1
  }
}

# expect_skipped_under_sanitizers PRESET: the same of the shards, whose tests say in XML why they were skipped.
tests_without_sanitizers=18
expect_skipped_under_sanitizers() {
  local reasons elsewhere
  reasons=$(sed -nE 's/.*<skipped message="([^"]*)".*/\1/p' build/"$1"/sanitized_*.xml)
  elsewhere=$(grep -vE 'sanitizer|/dev/full|no terminal|may not mount|no small file system|files of 4 GiB|all keys only' <<<"$reasons" || true)
  [ -n "${CHRONORMAL_DATA-}" ] || elsewhere=$(grep -v CHRONORMAL_DATA <<<"$elsewhere" || true)
  [ -z "$elsewhere" ] || {
    say "under sanitizers, tests were skipped for another reason than those that tools/parts.sh knows:"
    say "$elsewhere"
    return 1
  }
  [ "$(grep -c sanitizer <<<"$reasons")" -eq "$tests_without_sanitizers" ] || {
    say "$tests_without_sanitizers tests say that they are not for sanitizers, and these did:"
    say "$reasons"
    return 1
  }
}

# show_counts NAME...: what Node's test runner counted in these.
show_counts() {
  local name
  for name; do
    say "what Node's test runner counted in $name:"
    grep -E '^# (tests|pass|fail|cancelled|skipped|duration_ms) ' "build/release/$name.tap"
  done
}

print_parts() {
  local i minutes over=false factor=${CHRONORMAL_TIME_FACTOR:-1}
  printf '\n%-12s %8s %8s\n' part minutes budget
  for i in "${!part_names[@]}"; do
    minutes=$(awk -v s="${part_seconds[i]}" 'BEGIN { printf "%.1f", s / 60 }')
    printf '%-12s %8s %8s' "${part_names[i]}" "$minutes" "${part_budgets[i]}"
    if awk -v s="${part_seconds[i]}" -v b="${part_budgets[i]}" -v f="$factor" -v p="$pace" \
      'BEGIN { exit !(s > 60 * b * f * p) }'; then
      printf '  over'
      over=true
    fi
    printf '\n'
  done
  printf '%-12s %8s\n' all "$(awk -v s="$SECONDS" 'BEGIN { printf "%.1f", s / 60 }')"
  ! $over
}

# finish_parts: the table, whether all parts kept their budgets, and the sum of all tests.
finish_parts() {
  local status=0
  if ! print_parts; then
    say "a part took longer than its budget (times $pace for the pace of this machine, times ${CHRONORMAL_TIME_FACTOR:-1}):"
    say "find out why, or set CHRONORMAL_TIME_FACTOR for a machine that is busy with other things"
    status=1
  fi
  if [ -s build/counts.txt ]; then
    awk '{ failed += $1; all += $2 } END { printf "tests: %d passed, %d failed\n", all - failed, failed }' build/counts.txt
  fi
  return $status
}
