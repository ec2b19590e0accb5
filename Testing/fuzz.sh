#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Fuzzes each reader with libFuzzer under the address and undefined-behaviour sanitizers:
#   Testing/fuzz.sh [SECONDS [READER...]]      default: 60 seconds each of all
# The first inputs are the files that the tests write (build/ must be configured) and the regressions.
# A file that crashes, takes 20 s or 2.5 GB is kept in Testing/fuzz/regressions/READER, where every
# later test run tries it: mend the reader, then commit both.  EXPLICA_JOBS bounds the compilers at
# once, EXPLICA_RUNS the executions of each reader, which are printed; EXPLICA_SEED makes the inputs
# of one run those of another, and is printed.  A reader that is executed less often than 50 times a
# second of its time, or not as often as EXPLICA_RUNS says, fails: nothing was tried.  (itk-hdf5: once a
# second, since each reading takes a process of its own.)
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -gt 0 ] && shift
readers=$(sed -n 's/^ *{"\([a-z0-9-]*\)", "\([^"]*\)", read.*/\1:\2/p' Testing/fuzz/Readers.cpp)
for name in "$@"; do
  case "$(printf ' %s' $readers)" in
    *" $name:"*) ;;
    *) echo "fuzz: no reader '$name'; readers are$(printf ' %s' $readers | sed 's/:[^ ]*//g')" >&2; exit 1 ;;
  esac
done
[ -f build-fuzz/build.ninja ] || cmake --preset fuzz
cmake --build build-fuzz ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target ExplicaFuzz
cmake --build build ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target explica ExplicaIOPropertyTests
seeds=build-fuzz/seeds
EXPLICA_SEEDS=$seeds build/bin/ExplicaIOPropertyTests --gtest_brief=1 --gtest_filter='*WholeOnesAreSeeds*' >/dev/null
mkdir -p "$seeds/provenance.json" "$seeds/study.yaml" "$seeds/options.json"
cp ExampleData/study/study.yaml "$seeds/study.yaml/seed"
echo '{"unfold": {"radius": 30, "viewpoint": [1, 2.5, -3e2]}, "resume": true}' >"$seeds/options.json/seed"
rm -rf build-fuzz/shell
build/bin/explica phantom shell --size 8 --quiet --out build-fuzz/shell
cp build-fuzz/shell/provenance.json "$seeds/provenance.json/seed"

# Both libraries keep some hundred bytes of a header that they refuse.
printf 'leak:libITKNrrdIO\nleak:libITKMetaIO\n' >build-fuzz/leaks.supp
export LSAN_OPTIONS="suppressions=$PWD/build-fuzz/leaks.supp:print_suppressions=0"
# A third more executions a second; where a faulty block came from is told by its first callers.
export ASAN_OPTIONS=malloc_context_size=4:quarantine_size_mb=16
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
seed=${EXPLICA_SEED:-$(date +%Y%m%d)}
echo "fuzz: seed $seed (EXPLICA_SEED)"
failed=""
for reader in $readers; do
  name=${reader%%:*} file=${reader#*:}
  case " $* " in *" $name "*|"  ") ;; *) continue ;; esac
  corpus=build-fuzz/corpus/$name
  kept=Testing/fuzz/regressions/$name
  crashes=build-fuzz/crashes/$name
  mkdir -p "$corpus" "$crashes"
  found=0
  rate=50
  [ "$name" = itk-hdf5 ] && rate=1
  least=${EXPLICA_RUNS:-$((rate * seconds))}
  EXPLICA_FUZZ_READER=$name build-fuzz/bin/ExplicaFuzz "$corpus" "$seeds/$file" \
    $([ -d "$kept" ] && echo "$kept") -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2560 \
    -max_len=65536 -print_final_stats=1 -artifact_prefix="$crashes/" \
    -entropic=0 -runs="${EXPLICA_RUNS:--1}" -seed="$seed" \
    >"build-fuzz/$name.log" 2>&1 || found=1
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$name.log")
  took=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "build-fuzz/$name.log")
  echo "$name: ${runs:-?} executions in ${took:-?} s$([ $found = 0 ] || echo ', CRASH: see build-fuzz/'"$name.log")"
  if [ "${runs:-0}" -lt "$least" ] && [ $found = 0 ]; then
    echo "$name: at least $least executions were to be made; see build-fuzz/$name.log"
    failed="$failed $name"
  fi
  [ $found = 0 ] && continue
  failed="$failed $name"
  for artifact in "$crashes"/*; do
    [ -f "$artifact" ] || continue
    mkdir -p "$kept"
    mv "$artifact" "$kept"/
  done
done
[ -z "$failed" ] || { echo "fuzz: failed for$failed; files that do it are in Testing/fuzz/regressions"; exit 1; }
