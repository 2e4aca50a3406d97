#!/usr/bin/env bash
# From a fresh clone to a report: installs the packages, builds the program into build/ and runs
# `foucault demo`. Arguments go to it, e.g. `apps/demo.sh --out DIR`.
set -euo pipefail
cd "$(dirname "$0")/.."

apps/build.sh foucault

echo "demo: running build/foucault demo $*"
build/foucault demo "$@"
