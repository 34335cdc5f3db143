# SPDX-License-Identifier: Apache-2.0
# The second boot of the scenario "packages": what a reboot and an upgrade leave as it was, and what a purge removes.

look_after_reboot() {
  check 'dtsd is active after a reboot' within 60 is_active dtsd
  check 'dts-gateway is active after a reboot' within 60 is_active dts-gateway
  check_boot_time
  say "$(systemd-analyze time | head -1)"
  check 'the configuration is the same' [ "$(sha256sum </etc/dtsd/dtsd.toml)" = "$configuration" ]
  check 'the keys are the same' [ "$(keys_sum)" = "$keys" ]
  check 'the key opens the daemon' quiet dtsctl --key /root/ward-3.key status
  check 'the finished recording is sound' quiet dtsctl session verify "$whole"
  check 'the DAQ streams' within 120 is_streaming
  check 'the session that ran is complete, in its two parts' is_complete "$resumed" 2
  dtsctl session show "$resumed"
  check 'its recording is sound' quiet dtsctl session verify "$resumed"
  check 'the gateway hears the daemon' within 60 gateway_sees_daemon
}

# The new packages are the old ones with a higher version and two configuration files changed by their maker: dtsd.toml, which the site has
# changed too, and protocols/free.toml, which it has not.
upgrade() {
  local before
  before=$(daemon MainPID)
  dtsctl session start --rig floor --protocol free >session 2>last.log || cat last.log
  sleep 5
  check 'apt upgrades the packages' quiet apt-get install -y -o Dpkg::Options::=--force-confold /opt/dts/next/*.deb
  check 'the version is the new one' [ "$(dpkg-query -W -f '${Version}' dtsd)" = "$(cat next/version)" ]
  check 'dtsd is active after the upgrade' within 90 is_active dtsd
  check 'it is another process' [ "$(daemon MainPID)" -ne "$before" ]
  check 'the configuration of the site is kept' [ "$(sha256sum </etc/dtsd/dtsd.toml)" = "$configuration" ]
  check 'the new one lies beside it' contains 'changed by its maker' /etc/dtsd/dtsd.toml.dpkg-dist
  check 'what the site had not changed is new' contains 'changed by its maker' /etc/dtsd/protocols/free.toml
  check 'the keys are the same after the upgrade' [ "$(keys_sum)" = "$keys" ]
  check 'the session that ran is complete' is_complete "$(cat session)" 1
  check 'the DAQ streams after the upgrade' within 90 is_streaming
  check 'the gateway serves after the upgrade' within 60 gateway_serves
}

remove() {
  recordings >before
  check 'there are recordings' [ "$(wc -l <before)" -ge 5 ]
  check 'apt removes the packages' quiet apt-get remove -y dtsd dts-clients dts-gateway python3-dts
  check 'the daemon is stopped' is_gone pgrep -x dtsd
  check 'the gateway is stopped' is_gone pgrep -x dts-gateway
  check 'the relay is stopped' is_gone pgrep -x dts-relay
  check 'removing keeps the configuration' [ "$(sha256sum </etc/dtsd/dtsd.toml)" = "$configuration" ]
  check 'removing keeps the keys' [ "$(keys_sum)" = "$keys" ]
}

# python3-dts is not named: it has no configuration, and apt does not know a removed package without any.
purge() {
  check 'apt purges the packages' quiet apt-get purge -y dtsd dts-clients dts-gateway
  check 'it says that recordings are kept' contains 'the recordings in /var/lib/dtsd are kept' last.log
  check 'the configuration is gone' is_absent /etc/dtsd
  check 'the keys are gone' is_absent /var/lib/dtsd/keys
  check 'the configuration of the gateway is gone' is_absent /etc/dts-gateway
  check 'the cache of the gateway is gone' is_absent /var/cache/dts-gateway
  recordings >after
  check 'the recordings are kept' cmp before after
  check 'their catalogue is kept' [ -s /var/lib/dtsd/catalogue.sqlite ]
  check 'the user dtsd is kept' quiet id dtsd
  check 'the unit of the daemon is gone' is_gone systemctl cat dtsd
  check 'the unit of the gateway is gone' is_gone systemctl cat dts-gateway
  check 'nothing has failed' [ "$(systemctl list-units --failed --no-legend 'dts*' | wc -l)" -eq 0 ]
  say "left of the packages: $(dpkg-query -W -f '${Package} ' 'dts*' 2>/dev/null)$(find /var/lib/dtsd | wc -l) files in /var/lib/dtsd"
}

second_boot() {
  look_after_reboot
  upgrade
  remove
  purge
}
