#!/usr/bin/env bash
# Installs the Debian packages Foucault is built from; those already there are left alone.
#   apps/setup.sh              what the program needs
#   apps/setup.sh --tests      what its tests need as well
#   apps/setup.sh --packages   what making Debian packages of it needs as well
set -euo pipefail

build_packages=(
  g++ cmake ninja-build
  libeigen3-dev libmrpt-obs-dev
  libceres-dev
  libopencv-dev libopencv-contrib-dev # contrib: freetype, for text in the figures
  libcli11-dev nlohmann-json3-dev libfmt-dev libyaml-cpp-dev zlib1g-dev libpng-dev
  libisal-dev                                      # logs, in half the time of zlib
  libbz2-dev liblz4-dev libzstd-dev libsqlite3-dev # recordings of ROS 1 and 2
  fonts-dejavu-core
)
test_packages=(
  libgtest-dev libgmock-dev libgeographiclib-dev
  rtklib           # fixes of raw observations
  doxygen          # pages of the public headers
  chromium python3 # reports as readers see them
  parallel openmpi-bin slurmctld slurmd slurm-client munge # engines that start workers
)
package_packages=(dpkg-dev file)

fail() {
  echo "setup: $*" >&2
  exit 1
}

is_installed() {
  [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

missing_of() {
  local package
  for package in "$@"; do
    is_installed "$package" || echo "$package"
  done
}

as_root() {
  if [[ "$(id -u)" == 0 ]]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  else
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  fi
}

install_packages() {
  local log
  log="$(mktemp)"
  # One broken foreign source must not stop us: whether the packages are to be had is for the
  # installation to say.
  as_root apt-get -o DPkg::Lock::Timeout=300 update >"$log" 2>&1 ||
    echo "setup: warning: apt-get update: $(grep -m1 '^E:' "$log" || tail -n1 "$log")" >&2
  if ! as_root apt-get -o DPkg::Lock::Timeout=300 install --yes --no-install-recommends "$@" \
    >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    rm -f "$log"
    fail "apt-get could not install: $*"
  fi
  rm -f "$log"
}

packages=("${build_packages[@]}")
case "${1:-}" in
  --tests) packages+=("${test_packages[@]}") ;;
  --packages) packages+=("${package_packages[@]}") ;;
  "") ;;
  *) fail "unknown argument '$1' (use: apps/setup.sh [--tests | --packages])" ;;
esac

command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
  fail "this is not a Debian system; install by hand what stands for: ${packages[*]}"

missing=($(missing_of "${packages[@]}")) # not mapfile: a chroot without /proc has no /dev/fd
if [[ ${#missing[@]} == 0 ]]; then
  echo "setup: all ${#packages[@]} packages are there"
  exit 0
fi

[[ "$(id -u)" == 0 ]] || command -v sudo >/dev/null ||
  fail "installing packages needs root: run this as root, or install sudo"

echo "setup: installing ${missing[*]}"
((${#missing[@]} < 5)) || echo "setup: (on a bare system 350 MB, two minutes on a fast line)"
install_packages "${missing[@]}"
missing=($(missing_of "${missing[@]}")) # not mapfile: a chroot without /proc has no /dev/fd
[[ ${#missing[@]} == 0 ]] || fail "still missing after the installation: ${missing[*]}"
echo "setup: done"
