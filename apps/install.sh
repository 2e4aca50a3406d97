#!/usr/bin/env bash
# From a fresh clone to the installed program: installs the packages, builds into build/, makes two
# Debian packages and installs them: foucault (program, manual, completion) and libfoucault-dev
# (libraries, headers, examples).
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "install: $*" >&2
  exit 1
}

apps/setup.sh --packages
apps/build.sh

echo "install: making packages and installing them"
rm -f build/foucault_*.deb build/libfoucault-dev_*.deb
# Folders of a package have the umask's permissions; they are for all users of the machine.
(umask 022 && cd build && cpack >cpack.log 2>&1) || {
  tail -n 20 build/cpack.log >&2
  fail "cpack could not make the packages"
}
as_root=(env)
[[ "$(id -u)" == 0 ]] || as_root=(sudo env)
"${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 install --yes \
  --no-install-recommends --reinstall ./build/foucault_*.deb ./build/libfoucault-dev_*.deb \
  >build/apt.log 2>&1 || {
  tail -n 20 build/apt.log >&2
  fail "apt-get could not install the packages in build/"
}
echo "install: $(foucault -V) is there; try: foucault demo"
