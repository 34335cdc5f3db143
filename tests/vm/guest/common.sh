# SPDX-License-Identifier: Apache-2.0
# Sourced by what runs in a guest: one line per check, counted failures, the emulated DAQ. The sourcing script says where the daemon's
# log is (daemon_log).
failures=0

say() { echo "[$(cut -d' ' -f1 /proc/uptime)] dts: $*"; }
check() {  # check WHAT COMMAND...
  local what=$1
  shift
  if "$@"; then
    say "ok    $what"
  else
    say "FAIL  $what"
    failures=$((failures + 1))
    daemon_log | tail -4 | while read -r line; do say "dtsd: $line"; done
  fi
}
within() {  # within SECONDS COMMAND...: until it holds; `patience` times as long where the processor is emulated
  local until=$((SECONDS + $1 * ${patience:-1}))
  shift
  until "$@"; do
    [ $SECONDS -lt $until ] || return 1
    sleep 0.2
  done
}
number() { dtsctl status --json 2>/dev/null | awk -F'[:,]' -v key="\"$1\"" '$1 ~ key {print $2 + 0; exit}'; }
is_streaming() { dtsctl status --json 2>/dev/null | grep -q '"device": "streaming"'; }
is_not_streaming() { ! is_streaming; }
is_session_running() { dtsctl status --json 2>/dev/null | grep -q '"state": "running"'; }
has_at_least() { [ "$(number "$1")" -ge "$2" ]; }
has() { [ "$(number "$1")" -eq "$2" ]; }
node() { ls /dev/bus/usb/*/* 2>/dev/null | while read -r file; do [ -e "$file" ] && udevadm info -q property "$file" | grep -q '^ID_VENDOR_ID=09db' && echo "$file"; done; }
has_node() { [ -n "$(node)" ]; }
is_for_group() { [ "$(stat -c '%U %G %a' "$(node)" 2>/dev/null)" = 'root dtsd 660' ]; }
# Through the descriptors 3 (its commands) and 4 (its answers).
emulator() { echo "$1" >&3; read -r -t 30 answer <&4; [ "${answer%% *}" = ok ]; }
