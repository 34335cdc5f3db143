# SPDX-License-Identifier: Apache-2.0
# Sourced by the other scripts: where things are, and the packages from Debian 12 that building and testing need.

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

DTS_PACKAGES=(
  g++ cmake ninja-build ccache pkg-config git          # build
  protobuf-compiler libprotobuf-dev libzmq3-dev cppzmq-dev libspdlog-dev libfmt-dev libexpected-dev
  libtomlplusplus-dev libsystemd-dev libusb-1.0-0-dev libeigen3-dev libcli11-dev nlohmann-json3-dev
  libonnx-dev                                          # dtslab reach export and import: the schema of ONNX
  libsqlite3-dev libsodium-dev libpugixml-dev libboost-dev # recordings: catalogue, SHA-256, XML headers, CRC32C
  libkissfft-dev                                       # spectra of sway: a template of double, BSD licence (FFTW is GPL)
  libkainjow-mustache-dev                              # reports: the page is a template, not pasted strings
  libssl-dev libarchive-dev                            # dts-gateway: TLS; zip files of exports
  prometheus-cpp-dev                                   # dts-gateway /metrics: the text format and its escapes, not their HTTP server
  libgtest-dev libgmock-dev librapidcheck-dev relacy-dev # tests
  libumockdev-dev umockdev                             # emulated USB under the real libusb
  libxdf-dev                                           # an independent reader of our recordings
  libreaderwriterqueue-dev                             # a peer in the ring benchmark
  python3-onnx                                         # an independent reader of exported networks
  gnuplot-nox                                          # dtslab --plot
  python3 python3-zmq python3-protobuf python3-numpy   # clients/python
)
command -v npm >/dev/null || DTS_PACKAGES+=(nodejs npm) # the dashboard; node 18 or newer of another source will do (scripts/package adds packages)

say() { printf '\033[1m%s\033[0m\n' "$*" >&2; }

# Installs what is missing; asks for nothing when all is there. DTS_PACKAGES may be extended by the caller.
install_packages() {
  local missing=() package
  command -v dpkg-query >/dev/null || { echo "This script installs Debian packages; on another system install their like by hand: ${DTS_PACKAGES[*]}" >&2; return 1; }
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' 2>/dev/null | awk '$1 == "ii" {print $2}')
  for package in "${DTS_PACKAGES[@]}"; do
    grep -qx "$package" <<<"$installed" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "These packages are missing and neither root nor sudo is here to install them. Ask somebody who is root to run:" >&2
      echo "  apt-get install ${missing[*]}" >&2
      return 1
    fi
    root=(sudo)
  fi
  say "Installing ${#missing[@]} packages: ${missing[*]}"
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq || return 1
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# build PRESET [TARGET ...]: configures and builds the targets (default: all).
build() {
  local preset=$1 log
  shift
  log=$(mktemp)
  cmake --preset "$preset" >"$log" || { cat "$log" >&2; rm -f "$log"; return 1; }
  rm -f "$log"
  NINJA_STATUS='[%f/%t, %es] ' cmake --build --preset "$preset" ${1:+--target "$@"} >&2
}
