#!/bin/sh
# usage: fuzz/run.sh TARGET [libFuzzer options]     e.g. fuzz/run.sh picture_png -max_total_time=60
# Builds and runs one target with the stable compiler; failing inputs go to fuzz/artifacts/TARGET.
set -eu
cd "$(dirname "$0")"
target=$1
shift
host=$(rustc -vV | sed -n 's/^host: //p')
# Coverage is LLVM's; naming the host as the target keeps it out of build scripts and macros.
flags='-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
  -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
  -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1 --cfg=fuzzing'
RUSTFLAGS=$(echo $flags) cargo build --release --target "$host" --bin "$target"
mkdir -p "corpus/$target" "artifacts/$target" "target/corpus/$target"
# New inputs stay under target/: only chosen ones are worth keeping in corpus/.
exec "target/$host/release/$target" "target/corpus/$target" "corpus/$target" \
  -artifact_prefix="artifacts/$target/" -rss_limit_mb=512 -malloc_limit_mb=160 -timeout=10 "$@"
