#!/usr/bin/env bash
# From a fresh clone to a report: installs the packages, builds the program into build/ and runs
# `foucault demo`. Arguments go to it, e.g. `apps/demo.sh --out DIR`.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "demo: $*" >&2
  exit 1
}

apps/setup.sh

echo "demo: building into build/ (minutes the first time, seconds afterwards)"
generator=()
[[ -f build/CMakeCache.txt ]] || ! command -v ninja >/dev/null || generator=(-G Ninja)
cmake -S . -B build "${generator[@]}" -DCMAKE_BUILD_TYPE=Release \
  -DFOUCAULT_UNITY=ON >/dev/null ||
  fail "cmake could not configure the build; its reason stands above"
cmake --build build --parallel "$(nproc)" --target foucault ||
  fail "the build failed; the compiler's reason stands above"

echo "demo: running build/foucault demo $*"
build/foucault demo "$@"
