#!/usr/bin/env bash
# Installs what the tests need, builds everything into build-tests/ and runs every test with ctest.
#   tests/run.sh [CTEST ARGUMENTS]              e.g. `tests/run.sh -R so3`
#   tests/run.sh --sanitize [CTEST ARGUMENTS]   with the address and undefined behaviour sanitizers,
#                                               in build-sanitize/; takes several times as long
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "tests: $*" >&2
  exit 1
}

build=build-tests
options=(-DCMAKE_BUILD_TYPE=Release -DFOUCAULT_TESTS=ON -DFOUCAULT_UNITY=ON)
if [[ "${1:-}" == --sanitize ]]; then
  shift
  build=build-sanitize
  options+=(-DFOUCAULT_SANITIZE=ON -DCMAKE_CXX_FLAGS_RELEASE=-O1) # with the assertions of Eigen
  export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}"
fi

apps/setup.sh --tests

echo "tests: building into $build/ (minutes the first time, seconds afterwards)"
generator=()
[[ -f $build/CMakeCache.txt ]] || ! command -v ninja >/dev/null || generator=(-G Ninja)
cmake -S . -B "$build" "${generator[@]}" "${options[@]}" >/dev/null ||
  fail "cmake could not configure the build; its reason stands above"
cmake --build "$build" --parallel "$(nproc)" ||
  fail "the build failed; the compiler's reason stands above"

echo "tests: running"
ctest --test-dir "$build" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
