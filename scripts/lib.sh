# SPDX-License-Identifier: Apache-2.0
# Sourced by the other scripts: the Debian packages that this project needs, how they are installed, how it is built. Debian 13 and 12.

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

# The programs and the dashboard.
DTS_PACKAGES=(
  g++ cmake ninja-build ccache pkg-config git          # build
  protobuf-compiler libprotobuf-dev libzmq3-dev cppzmq-dev libspdlog-dev libfmt-dev libexpected-dev
  libtomlplusplus-dev libsystemd-dev libusb-1.0-0-dev libeigen3-dev libcli11-dev nlohmann-json3-dev
  libonnx-dev                                          # dtslab reach export and import: the schema of ONNX
  libsqlite3-dev libsodium-dev libpugixml-dev libboost-dev # recordings: catalogue, SHA-256, XML headers, CRC32C
  libutfcpp-dev                                        # texts from peers and files: which bytes are UTF-8
  libsqlitecpp-dev                                     # catalogue: statements and transactions of SQLite as C++ objects
  libkissfft-dev                                       # spectra of sway: a template of double, BSD licence (FFTW is GPL)
  libkainjow-mustache-dev                              # reports: the page is a template, not pasted strings
  libssl-dev libarchive-dev                            # dts-gateway: TLS; zip files of exports
  prometheus-cpp-dev                                   # dts-gateway /metrics: the text format and its escapes, not their HTTP server
  python3                                              # scripts/demo --check, checks of the sources
)
command -v npm >/dev/null || DTS_PACKAGES+=(nodejs npm) # the dashboard; node 18 or newer of another source will do (scripts/package adds packages)

# The Python client (clients/python).
DTS_PYTHON_PACKAGES=(python3-zmq python3-protobuf python3-numpy)

# The fleet (clients/fleet): built if these are installed; the other programs do not need them.
DTS_FLEET_PACKAGES=(
  libpq-dev                                            # the centre's catalogue
  libcurl4-openssl-dev                                 # the centre's recordings in a bucket of S3: HTTP with signatures
)
# What a centre runs on: scripts/fleet-demo and tests/fleet start both on this machine.
DTS_CENTRE_PACKAGES=(nats-server postgresql openssl)

# What tests/ adds to both.
DTS_TEST_PACKAGES=(
  "${DTS_PYTHON_PACKAGES[@]}"
  libgtest-dev libgmock-dev librapidcheck-dev relacy-dev
  libumockdev-dev umockdev                             # emulated USB under the real libusb
  libfuse3-dev                                         # disks whose power fails: scripts/fault power --disk
  python3-websocket                                    # tests/soak: a page of the dashboard without a browser
  faketime                                             # wall clocks that jump, the year 2038
  libxdf-dev                                           # an independent reader of our recordings
  libreaderwriterqueue-dev                             # a peer in the ring benchmark
  python3-onnx                                         # an independent reader of exported networks
  gnuplot-nox                                          # dtslab --plot
  librsvg2-bin poppler-utils                           # reports as PDF; poppler reads their text in the tests
  gcc-avr avr-libc binutils-avr make                   # clients/firmware: the firmware of a board
  libsimavr-dev libelf-dev                             # the firmware runs in simavr
  doxygen                                              # every public declaration of libdts has a comment
  mypy python3-matplotlib python3-build python3-setuptools python3-venv python3-wheel # tests of the Python client
  twine                                                # ... its packages, as a package index checks them
)

# scripts/docs: a site of Markdown files with checked links and a search that works without a server; the C++ interface.
DTS_DOCS_PACKAGES=(python3-sphinx python3-myst-parser python3-sphinx-rtd-theme doxygen)

# The programs of analysts (tests/analysis). Large, so only scripts/test --all installs them; elsewhere their tests run if they are there.
DTS_ANALYSIS_PACKAGES=(
  octave                                               # clients/octave, recipes: 117 packages, 250 MB
  python3-mne                                          # a recipe: 54 MB
)

# scripts/mutate: the syntax tree of the sources.
DTS_MUTATION_PACKAGES=(python3-clang-19)

say() { printf '\033[1m%s\033[0m\n' "$*" >&2; }

# show_progress WHAT: reads apt's status lines (dlstatus:PACKAGE:PERCENT:TEXT while it downloads, then pmstatus:...) and shows them as one line
# that moves; shows nothing where nobody watches.
show_progress() {
  local line
  while IFS= read -r line; do
    [ -t 2 ] && [[ $line =~ ^(dl|pm)status:.*:([0-9]+)[0-9.]*:(.*)$ ]] || continue
    printf '\r\033[K%s: %s %d %%  %.50s' "$1" "$([ "${BASH_REMATCH[1]}" = dl ] && echo download || echo install)" "${BASH_REMATCH[2]}" \
      "${BASH_REMATCH[3]}" >&2 # shorter than 80 columns: a line that wraps cannot be wiped
  done
  [ ! -t 2 ] || printf '\r\033[K' >&2
}

# install_packages PACKAGE...: installs those that are missing; asks for nothing when all are there.
install_packages() {
  command -v dpkg-query >/dev/null || { echo "This script installs Debian packages; on another system install the equivalent packages: $*" >&2; return 1; }
  local missing=() package installed
  installed=$(dpkg-query -W -f '${db:Status-Abbrev} ${Package}\n' 2>/dev/null | awk '$1 ~ /^.i$/ {print $2}') # also those that are on hold
  for package in "$@"; do
    grep -qx "$package" <<<"$installed" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "These packages are missing. Only root can install them, and there is no sudo. Ask root to run:" >&2
      echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    root=(sudo)
  fi
  # sudo keeps no proxy by itself.
  local name proxies=()
  for name in http_proxy https_proxy no_proxy; do [ -z "${!name:-}" ] || proxies+=("$name=${!name}"); done
  say "Installing ${#missing[@]} packages and what they need: ${missing[*]}"
  local log status=0 begun=$SECONDS
  log=$(mktemp)
  # apt's status lines go to standard output, by a descriptor of their own, since apt makes it non-blocking; all else goes to the log.
  # Another apt may run, as after the start of a machine.
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive "${proxies[@]}" sh -c 'exec 3>&1 1>&2
    apt-get update -qq && apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=300 -o APT::Status-Fd=3 -o Dpkg::Use-Pty=0 "$@"' - "${missing[@]}" \
    2>"$log" </dev/null | show_progress Packages || status=$?
  if [ "$status" -ne 0 ]; then
    tail -n 30 "$log" >&2
    echo "Installing packages failed; all of apt's output is in $log" >&2
    return 1
  fi
  rm -f "$log"
  say "Packages installed in $((SECONDS - begun)) s"
}

# configure PRESET [OPTION...]: prints nothing unless it fails.
configure() {
  local preset=$1 log
  shift
  log=$(mktemp)
  # Warnings are errors in CI and with DTS_WERROR=1, for nobody else: another compiler may warn of something new.
  local is_strict=OFF
  [ "${CI:-}" != true ] && [ "${DTS_WERROR:-}" != 1 ] || is_strict=ON
  cmake --preset "$preset" -DCMAKE_COMPILE_WARNING_AS_ERROR=$is_strict "$@" >"$log" || { cat "$log" >&2; rm -f "$log"; return 1; }
  rm -f "$log"
}

# show_build WHAT: reads ninja's lines, of which NINJA_STATUS marks one for each finished file ("@12/530 ..."), and shows how far the build is and
# about how long it still takes: on a terminal as one line that moves, elsewhere as one line a minute. Passes on what compilers print.
show_build() {
  local line text finished all elapsed begun=$SECONDS shown=$SECONDS
  while IFS= read -r line; do
    if [[ ! $line =~ ^@([0-9]+)/([0-9]+)\  ]]; then
      [ "$line" = "ninja: no work to do." ] || printf '%s%s\n' "$([ ! -t 2 ] || printf '\r\033[K')" "$line" >&2
      continue
    fi
    finished=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]} elapsed=$((SECONDS - begun))
    text="$1: $finished of $all files"
    # Not at the beginning: it has few files, and other ones than most.
    if [ "$elapsed" -ge 15 ] && [ $((20 * finished)) -ge "$all" ]; then
      text+=", about $(((elapsed * (all - finished) / finished + 59) / 60)) min left"
    fi
    if [ -t 2 ]; then
      printf '\r\033[K%s' "$text" >&2
    elif [ $((SECONDS - shown)) -ge 60 ]; then
      printf '%s\n' "$text" >&2
      shown=$SECONDS
    fi
  done
  [ ! -t 2 ] || printf '\r\033[K' >&2
}

# compile PRESET [TARGET...]: builds the targets (default: all), and shows the progress.
compile() {
  local preset=$1 begun=$SECONDS
  shift
  [ -t 2 ] || say "Building ($preset)"
  # Ninja by itself runs two compilers more than there are cores, which takes longer beside another build.
  # pipefail here, too: a person's own shell, which has sourced this file, must see that a build failed.
  (
    set -o pipefail
    NINJA_STATUS="@%f/%t " cmake --build --preset "$preset" -j "${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}" ${1:+--target "$@"} 2>&1 |
      show_build "Compiling ($preset)"
  ) || return
  say "Built ($preset) in $((SECONDS - begun)) s"
}

# build_programs TARGET...: the release build of programs alone: it needs DTS_PACKAGES only. Tests that were configured before stay.
build_programs() {
  local tests=()
  [ -e build/release/build.ninja ] || tests=(-DBUILD_TESTING=OFF)
  configure release "${tests[@]}" && compile release "$@"
}

# build_release TARGET...: a release build of programs and tools of tests/, which need DTS_TEST_PACKAGES, too.
build_release() {
  configure release -DBUILD_TESTING=ON -DDTS_TESTS=suite && compile release "$@"
}
