#!/usr/bin/env bash
# Installs the packages that the program is built from and builds into build/: all, or the targets
# given.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "build: $*" >&2
  exit 1
}

apps/setup.sh

echo "build: building into build/ (minutes the first time, seconds afterwards)"
generator=()
[[ -f build/CMakeCache.txt ]] || ! command -v ninja >/dev/null || generator=(-G Ninja)
cmake -S . -B build "${generator[@]}" -DCMAKE_BUILD_TYPE=Release \
  -DFOUCAULT_UNITY=ON >/dev/null ||
  fail "cmake could not configure the build; its reason stands above"
cmake --build build --parallel "$(nproc)" ${1+--target "$@"} ||
  fail "the build failed; the compiler's reason stands above"
