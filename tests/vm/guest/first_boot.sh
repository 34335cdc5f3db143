# SPDX-License-Identifier: Apache-2.0
# The first boot of the scenario "packages": a clean Debian, then installed, in real time, configured, unplugged and frozen.

install_packages() {
  say "kernel $(uname -r), $(systemctl --version | head -1), $(nproc) processors, $(dpkg -l | grep -c '^ii') packages"
  check 'nothing of dtsd is here' is_gone id dtsd
  check 'apt installs the packages' quiet apt-get install -y /opt/dts/debs/*.deb
  check 'dtsd is active' within 60 is_active dtsd
  check 'dts-gateway is active' within 60 is_active dts-gateway
  check 'without [network] dts-relay has ended, and has not failed' is_gone systemctl is-failed --quiet dts-relay
  check 'without a rig the daemon answers' within 30 quiet dtsctl status
  check 'the gateway serves the dashboard' within 30 gateway_serves
  check 'the gateway hears the daemon' within 30 gateway_sees_daemon
  check 'the Python client is there' quiet python3 -I -c 'import dts'
}

look_at_users_and_modes() {
  check 'dtsd runs as dtsd' user_of dtsd 'dtsd dtsd'
  check 'dts-gateway runs as dts-gateway' user_of dts-gateway 'dts-gateway dts-gateway'
  check 'mode of /run/dtsd' modes /run/dtsd 'dtsd dtsd 750'
  check 'mode of /var/lib/dtsd' modes /var/lib/dtsd 'dtsd dtsd 750'
  check 'mode of the gateway cache' modes /var/cache/dts-gateway 'dts-gateway dts-gateway 700'
  check 'mode of /etc/dts-gateway' modes /etc/dts-gateway 'root dts-gateway 2750'
  check 'nobody else sees a socket' is_closed_to_others /run/dtsd
  check 'nobody else sees a recording' is_closed_to_others /var/lib/dtsd
  say "$(systemd-analyze security dtsd --no-pager | tail -1)"
  say "$(systemd-analyze security dts-gateway --no-pager | tail -1)"
  say "$(systemd-analyze security dts-relay --no-pager | tail -1)"
}

# With the priorities of the installed configuration, inside the unit's sandbox. Only here: see the README. A simulated rig, since nothing of
# it needs a kernel thread.
run_in_real_time() {
  cp /etc/dtsd/dtsd.toml as-installed.toml
  printf '\n[[rig]]\nname = "floor"\nfile = "rigs/floor-sim.toml"\ndevice = "sim:floor?seed=7"\n' >>/etc/dtsd/dtsd.toml
  systemctl restart dtsd
  check 'a simulated rig streams' within 60 is_streaming
  local thread
  for thread in acq-floor publish ZMQbg/IO/0; do
    check "$thread has SCHED_FIFO" is_real_time $thread
  done
  check 'memory is locked' is_locked
  check 'the log has lines of this start' within 30 says_since_start 'serves control'
  check 'no priority was rejected' is_gone says_since_start rejected
  check 'no lock was refused' is_gone says_since_start 'not locked'
  say "$(ps -L -o cls=,rtprio=,comm= -p "$(daemon MainPID)" | awk '{printf "%s %s %s, ", $3, $1, $2}') $(grep VmLck "/proc/$(daemon MainPID)/status")"
  cp as-installed.toml /etc/dtsd/dtsd.toml
}

# As docs/operating.md says, for a DAQ that is wired to the simulated platform.
configure() {
  printf '\n[[rig]]\nname = "floor"\nfile = "rigs/floor-sim.toml"\ndevice = "mcc:1608fs-plus?range_v=5"\n' >>/etc/dtsd/dtsd.toml
  printf '\n[network]\ncontrol = "tcp://127.0.0.1:5555"\ndata = "tcp://127.0.0.1:5556"\n' >>/etc/dtsd/dtsd.toml
  # Real-time priorities on an emulated processor: see the README.
  sed -i 's/^# fifo_priority = .*/fifo_priority = 0/' /etc/dtsd/dtsd.toml
  check 'the configuration is right' quiet runuser -u dtsd -- dtsd --config /etc/dtsd/dtsd.toml --check-config
  systemctl restart dtsd dts-relay
  check 'dtsd is active with a rig' is_active dtsd
  check 'dts-relay is active with [network]' is_active dts-relay
  check 'a key is made' quiet dtsctl key new ward-3 --role viewer --host 127.0.0.1 --out /root/ward-3.key
  check 'the key opens the daemon' quiet dtsctl --key /root/ward-3.key status
}

plug_in() {
  systemctl start dts-emulator
  within 10 [ -p /run/dts-answers ]
  sleep 1
  exec 3<>/run/dts-commands 4<>/run/dts-answers
  check 'a DAQ is plugged in' emulator plug
  check 'its node belongs to group dtsd' within 60 is_for_group
  check 'dtsd streams' within 90 is_streaming
}

unplug_and_replug() {
  dtsctl session start --rig floor >session 2>last.log || cat last.log
  note whole "$(cat session)"
  sleep 5
  check 'unplugged' emulator unplug
  check 'the loss is seen' within 60 is_not_streaming
  check 'plugged in again' within 60 emulator plug
  check 'its node belongs to group dtsd again' within 60 is_for_group
  check 'it streams again' within 90 is_streaming
  check 'the session goes on' is_session_running
  sleep 5
  check 'it stops' quiet dtsctl session stop
  check 'its recording is sound' quiet dtsctl session verify "$(cat session)"
}

freeze() {
  local pid id
  dtsctl session start --rig floor >session 2>last.log || cat last.log
  id=$(cat session)
  note resumed "$id"
  sleep 5
  pid=$(daemon MainPID)
  say "dtsd ($pid) is frozen in session $id"
  kill -STOP "$pid"
  local frozen=$SECONDS
  check 'the watchdog ends it' within 90 is_gone test -d "/proc/$pid"
  say "ended after $((SECONDS - frozen)) s"
  check 'it was the watchdog' within 30 logs 'Watchdog timeout'
  check 'dtsd is active again' within 90 is_active dtsd
  check 'it was restarted once' [ "$(daemon NRestarts)" -eq 1 ]
  check 'the session goes on as its part 2' within 120 is_recorded_as_part "$id" 2
  check 'it streams again' within 90 is_streaming
  dtsctl session show "$id"
}

first_boot() {
  install_packages
  look_at_users_and_modes
  run_in_real_time
  configure
  plug_in
  unplug_and_replug
  freeze
  note keys "$(keys_sum)"
  note configuration "$(sha256sum </etc/dtsd/dtsd.toml)"
  touch stays-plugged
  quiet systemctl enable dts-emulator
}
