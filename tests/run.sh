#!/usr/bin/env bash
# Installs what the tests need, builds everything into build-tests/ and runs every test with ctest.
# Arguments go to ctest, e.g. `tests/run.sh -R so3`.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "tests: $*" >&2
  exit 1
}

apps/setup.sh --tests

echo "tests: building into build-tests/ (minutes the first time, seconds afterwards)"
generator=()
[[ -f build-tests/CMakeCache.txt ]] || ! command -v ninja >/dev/null || generator=(-G Ninja)
cmake -S . -B build-tests "${generator[@]}" -DCMAKE_BUILD_TYPE=Release -DFOUCAULT_TESTS=ON >/dev/null ||
  fail "cmake could not configure the build; its reason stands above"
cmake --build build-tests --parallel "$(nproc)" ||
  fail "the build failed; the compiler's reason stands above"

echo "tests: running"
ctest --test-dir build-tests --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
