#!/bin/sh
# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
# Fuzzes each reader with libFuzzer under the address and undefined-behaviour sanitizers:
#   Testing/fuzz.sh [SECONDS [READER...]]      default: 60 seconds each of all
# The first inputs are the files that the tests write (build/ must hold ExplicaIOPropertyTests) and the
# regressions.  A file that crashes is kept in Testing/fuzz/regressions/READER, where every later
# test run tries it: mend the reader, then commit both.  EXPLICA_JOBS bounds the compilers at once.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
[ $# -gt 0 ] && shift
readers=$(sed -n 's/^ *{"\([a-z0-9-]*\)", "\([^"]*\)", read.*/\1:\2/p' Testing/fuzz/Readers.cpp)
[ -f build-fuzz/build.ninja ] || cmake --preset fuzz
cmake --build build-fuzz ${EXPLICA_JOBS:+-j "$EXPLICA_JOBS"} --target ExplicaFuzz
seeds=build-fuzz/seeds
EXPLICA_SEEDS=$seeds build/bin/ExplicaIOPropertyTests --gtest_brief=1 --gtest_filter='*WholeOnesAreSeeds*' >/dev/null
mkdir -p "$seeds/provenance.json" "$seeds/study.yaml" "$seeds/options.json"
cp ExampleData/study/study.yaml "$seeds/study.yaml/seed"
echo '{"unfold": {"radius": 30, "viewpoint": [1, 2.5, -3e2]}, "resume": true}' >"$seeds/options.json/seed"
rm -rf build-fuzz/shell
build/bin/explica phantom shell --size 8 --quiet --out build-fuzz/shell
cp build-fuzz/shell/provenance.json "$seeds/provenance.json/seed"

printf 'leak:libITKNrrdIO\n' >build-fuzz/leaks.supp
export LSAN_OPTIONS="suppressions=$PWD/build-fuzz/leaks.supp:print_suppressions=0"
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
failed=""
for reader in $readers; do
  name=${reader%%:*} file=${reader#*:}
  case " $* " in *" $name "*|"  ") ;; *) continue ;; esac
  corpus=build-fuzz/corpus/$name
  kept=Testing/fuzz/regressions/$name
  mkdir -p "$corpus" build-fuzz/crashes
  found=0
  EXPLICA_FUZZ_READER=$name build-fuzz/bin/ExplicaFuzz "$corpus" "$seeds/$file" \
    $([ -d "$kept" ] && echo "$kept") -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2560 \
    -max_len=65536 -print_final_stats=1 -artifact_prefix="build-fuzz/crashes/$name-" \
    >"build-fuzz/$name.log" 2>&1 || found=1
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$name.log")
  echo "$name: ${runs:-?} executions$([ $found = 0 ] || echo ', CRASH: see build-fuzz/'"$name.log")"
  [ $found = 0 ] && continue
  failed="$failed $name"
  mkdir -p "$kept"
  cp build-fuzz/crashes/"$name"-* "$kept"/
done
[ -z "$failed" ] || { echo "fuzz: crashes in$failed; their files are in Testing/fuzz/regressions"; exit 1; }
