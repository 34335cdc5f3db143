// SPDX-License-Identifier: Apache-2.0
#include "ctl/doctor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <ranges>

#include "cli/exit_status.h"
#include "cli/table.h"
#include "core/notice_words.h"
#include "ctl/commands.h"
#include "ctl/json.h"
#include "ctl/latency.h"
#include "ctl/recording_view.h"
#include "ctl/status_view.h"
#include "dts/subscriber.h"

namespace dts::ctl {
namespace {

using std::chrono::milliseconds;
namespace words = core::notice_words;

constexpr milliseconds kDataDeadline{2000};
constexpr double kRateTolerance = 0.01;
constexpr double kFullestPercent = 50.0;
constexpr double kMostLatencyMs = 50.0;  // above this, live plots with 20 frames per second are visibly late
constexpr double kNearlyAllBlocks = 0.95;
constexpr std::uint32_t kSessionsLookedAt = 200;
constexpr std::size_t kMostNamed = 3;
constexpr std::size_t kOutcomeColumns = 7;  // "wrong  "

Check good(std::string name, std::string finding) { return {std::move(name), true, std::move(finding), {}}; }
Check bad(std::string name, std::string finding, std::string fix) { return {std::move(name), false, std::move(finding), std::move(fix)}; }
/// For a setting that works but can be improved.
Check note(std::string name, std::string finding, std::string fix) { return {std::move(name), true, std::move(finding), std::move(fix)}; }
Check bad(std::string name, const client::Error& error) { return bad(std::move(name), error.what, error.hint); }

bool has_notice_about(const v1::StatusSnapshot& status, std::string_view word) {
  return std::ranges::any_of(status.notices(), [&](const std::string& notice) { return notice.find(word) != std::string::npos; });
}

/// Returns a notice that begins with these words; it lives as long as the status.
std::optional<std::string_view> notice_that_begins(const v1::StatusSnapshot& status, std::string_view words) {
  const auto found = std::ranges::find_if(status.notices(), [&](const std::string& notice) { return notice.starts_with(words); });
  if (found == status.notices().end()) return std::nullopt;
  return *found;
}

/// Divides a notice of the daemon into what is wrong and what to do.
std::pair<std::string, std::string> finding_and_fix(std::string_view notice) {
  const std::size_t end = notice.find("; ");
  if (end == std::string_view::npos) return {std::string(notice), {}};
  return {std::string(notice.substr(0, end)), std::string(notice.substr(end + 2))};
}

/// Returns the date in a calibration's ID, "cop-20260131T120000Z-1a2b3c4d": 2026-01-31; empty: it has none.
std::string date_of_calibration(std::string_view id) {
  constexpr std::string_view kBegin = "cop-";
  constexpr std::size_t kDigits = 8;
  if (!id.starts_with(kBegin)) return {};
  const std::string date(id.substr(kBegin.size(), kDigits));
  if (date.size() < kDigits || date.find_first_not_of("0123456789") != std::string::npos) return {};
  return date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6, 2);
}

Check check_rate(const v1::RigStatus& rig) {
  const std::string name = rig.rig().name() + " rate";
  const double nominal = rig.nominal_rate_hz();
  const double measured = rig.measured_rate_hz();
  if (!(measured > 0.0)) return bad(name, "not measured yet", "wait 10 s, then run dtsctl doctor again");
  const std::string finding = cli::decimal(measured, 2) + " of " + cli::decimal(nominal, 2) + " Hz";
  if (std::abs(measured - nominal) <= kRateTolerance * nominal) return good(name, finding);
  return bad(name, finding, "check the load of this machine, the losses in dtsctl status and the rate that is set at the device");
}

/// Returns what to check first: the machine was too slow, or the connection to the device is bad.
std::string advice_on(const v1::RigStatus& rig) {
  bool is_machine = rig.dropped_blocks_total() > 0;
  bool is_cable = false;
  for (const v1::LossCount& loss : rig.losses()) {
    const bool is_of_machine = loss.reason() == v1::GAP_REASON_OVERRUN || loss.reason() == v1::GAP_REASON_RING_FULL;
    (is_of_machine ? is_machine : is_cable) = true;
  }
  std::string advice = "find the causes with dtsctl status and journalctl -u dtsd";
  if (is_machine) advice += "; the machine was too slow: allow SCHED_FIFO and end other programs";
  if (is_cable) advice += "; check the cable and the USB hub";
  return advice;
}

Check check_losses(const v1::RigStatus& rig) {
  const std::string name = rig.rig().name() + " losses";
  const std::string finding = counted(rig.lost_scans_total(), "scan") + " lost in " + counted(rig.gaps_total(), "gap") + ", " +
                              counted(rig.dropped_blocks_total(), "block") + " dropped since the start";
  if (rig.lost_scans_total() == 0 && rig.gaps_total() == 0 && rig.dropped_blocks_total() == 0) return good(name, "none");
  return bad(name, finding, advice_on(rig));
}

Check check_queues(const v1::RigStatus& rig) {
  const std::string name = rig.rig().name() + " queues";
  const v1::RingFill& fill = rig.ring_fill();
  const std::string finding = "highest fill in the last 30 s: " + cli::decimal(fill.frames_percent(), 0) + " % before the data socket, " +
                              cli::decimal(fill.record_percent(), 0) + " % before the recorder";
  if (std::max(fill.frames_percent(), fill.record_percent()) < kFullestPercent) return good(name, finding);
  return bad(name, finding, "end other programs and allow SCHED_FIFO; if the queue before the recorder is full, check the disk");
}

/// A replay runs at any requested speed: its rate, queues and latency show nothing about this machine.
bool is_replay(const v1::RigStatus& rig) { return rig.rig().device_uri().starts_with("replay:"); }

std::optional<Check> check_latency(const v1::RigStatus& rig) {
  const auto latency_ms = latency_quantile_ms(rig.latency(), kNearlyAllBlocks);
  if (!latency_ms) return std::nullopt;
  const std::string name = rig.rig().name() + " latency";
  const std::string finding = "95 % of the blocks since the start were published within " + cli::decimal(*latency_ms, 1) + " ms";
  if (*latency_ms <= kMostLatencyMs) return good(name, finding);
  return bad(name, finding, "end other programs and allow SCHED_FIFO; dtsctl top shows the last seconds");
}

bool sends_scans(const v1::RigStatus& rig) { return rig.device() == v1::DEVICE_STATE_STREAMING && rig.rig().published_size() > 0; }

Check check_data(const Target& where, const v1::StatusSnapshot& status, milliseconds deadline) {
  const std::string name = "data";
  const std::string& endpoint = where.endpoints.data;
  if (endpoint.empty()) return bad(name, "the data address is not known", "give it with --data URI or DTSD_DATA");
  if (auto somebody = client::probe(endpoint); !somebody) return bad(name, somebody.error());
  auto subscriber = client::Subscriber::open({.endpoint = endpoint, .topics = {""}, .key = where.key});
  if (!subscriber) return bad(name, subscriber.error());
  const bool has_scans = std::ranges::any_of(status.rigs(), sends_scans);  // without scans, the daemon's status is sufficient
  const auto begin = std::chrono::steady_clock::now();
  const auto spent = [&] { return std::chrono::ceil<milliseconds>(std::chrono::steady_clock::now() - begin); };
  while (spent() < deadline) {
    const auto message = subscriber->receive(deadline - spent());
    if (!message) return bad(name, message.error());
    if (*message && (!has_scans || std::holds_alternative<client::Block>(**message))) {
      return good(name, (has_scans ? "scans arrive, after " : "no rig publishes scans; the status arrives, after ") +
                            std::to_string(spent().count()) + " ms");
    }
  }
  return bad(name,
             (has_scans ? "no scans arrived from " : "no data arrived from ") + endpoint + " within " +
                 cli::decimal(1e-3 * static_cast<double>(deadline.count()), 1) + " s",
             "restart dtsd; read journalctl -u dtsd");
}

Check check_wall_clock(const SystemFacts& facts, const std::optional<v1::StatusSnapshot>& status, Daemon where) {
  const std::string name = "clock";
  if (const auto late = status ? notice_that_begins(*status, words::kClockBehindBegin) : std::nullopt) {
    const auto [finding, fix] = finding_and_fix(*late);
    return bad(name, finding, fix);
  }
  const std::string whose = where == Daemon::Elsewhere ? ", of this machine; dtsd may run on another one" : "";
  if (!facts.is_clock_set) return good(name, "unknown if it is synchronised: the system does not say" + whose);
  if (*facts.is_clock_set) return good(name, "synchronised" + whose);
  if (where == Daemon::Elsewhere) return good(name, "not synchronised" + whose);
  return note(name, "not synchronised, so date and order of visits are those of this machine alone",
              "turn on time synchronisation: timedatectl set-ntp true; without a network, compare the time with a watch");
}

Check check_clock_source(const SystemFacts& facts) {
  const std::string name = "clock source";
  const std::string finding = facts.clock_source.empty() ? "unknown" : facts.clock_source;
  // Other clock sources need a microsecond or more per reading (values from users of hpet and acpi_pm, not measured here).
  const bool is_fast = finding.find("tsc") != std::string::npos || finding == "arch_sys_counter" || finding == "kvm-clock";
  if (is_fast) return good(name, finding);
  return note(name, finding,
              "select a faster clock: echo tsc > /sys/devices/system/clocksource/clocksource0/current_clocksource; if that fails, search "
              "dmesg for 'tsc'");
}

int report(const std::vector<Check>& checks, bool is_json, cli::Console& console) {
  const bool is_well = std::ranges::all_of(checks, &Check::is_good);
  if (is_json) {
    cli::Json list = cli::Json::array();
    for (const Check& check : checks) {
      cli::Json one{{"name", check.name}, {"ok", check.is_good}, {"finding", check.finding}};
      if (!check.fix.empty()) one["fix"] = check.fix;
      list.push_back(std::move(one));
    }
    console.out << cli::document({{"ok", is_well}, {"checks", std::move(list)}});
  } else {
    for (const Check& check : checks) {
      const bool is_note = check.is_good && !check.fix.empty();
      const std::string outcome = is_note         ? cli::styled(console, cli::Style::Warning, "note ")
                                  : check.is_good ? cli::styled(console, cli::Style::Good, "ok   ")
                                                  : cli::styled(console, cli::Style::Bad, "wrong");
      const std::string advice = check.fix.empty() ? "" : (is_note ? "; better: " : "; try: ") + check.fix;
      console.out << outcome << "  "
                  << cli::wrapped_at(console, kOutcomeColumns, cli::printable(check.name + ": " + check.finding + advice)) << '\n';
    }
  }
  console.out.flush();
  return is_well ? cli::kOk : cli::kFailed;
}

/// Returns the daemon's status; adds the steps of the connection to `checks`.
std::optional<v1::StatusSnapshot> ask_daemon(const Arguments& arguments, Daemon where, std::vector<Check>& checks) {
  auto dts = connect(arguments);
  auto status = dts ? dts->status() : tl::make_unexpected(dts.error());
  if (!status) {
    checks.push_back(bad("daemon", status.error()));
    return std::nullopt;
  }
  checks.push_back(good("daemon", "dtsd " + status->version() + " answers, up " + cli::duration(status->uptime_s())));
  checks.push_back(check_version(status->version()));
  for (const v1::RigStatus& rig : status->rigs()) {
    std::ranges::move(check_rig(rig), std::back_inserter(checks));
    if (auto calibration = check_calibration(*status, rig.rig())) checks.push_back(std::move(*calibration));
    std::ranges::move(check_sensor_curves(*status, rig.rig()), std::back_inserter(checks));
  }
  if (status->rigs_size() == 0) checks.push_back(bad("rigs", "no rig is configured", "add a [[rig]] to the daemon's configuration"));
  std::ranges::move(check_disk(status->disk()), std::back_inserter(checks));
  v1::ListSessionsRequest newest;
  newest.set_limit(kSessionsLookedAt);
  // Without an answer there is no check: this daemon records nothing, or this key may not list sessions.
  if (const auto sessions = dts->list_sessions(newest)) checks.push_back(check_sessions(*sessions));
  // Without an answer, for example without the role for it, the address of dts-relay is not known.
  const auto keys = status->has_network() && where == Daemon::Here ? dts->list_keys() : v1::ListKeysResponse();
  const std::string relay = keys ? keys->control_endpoint() : "";
  checks.push_back(check_network(*status, relay.empty() || has_listener(relay) ? "" : relay));
  return std::move(*status);
}

}  // namespace

Check check_version(const std::string& daemon_version) {
  const std::string mine(client::version());
  if (daemon_version.substr(0, daemon_version.find('+')) == mine) return good("version", mine + " of dtsctl and dtsd");
  return bad("version", "dtsctl " + mine + ", dtsd " + daemon_version, "install both from the same build, then restart dtsd");
}

std::vector<Check> check_rig(const v1::RigStatus& rig) {
  const std::string name = rig.rig().name() + " device";
  const std::string state = enumerator_word(*v1::DeviceState_descriptor(), rig.device());
  if (rig.device() == v1::DEVICE_STATE_WAITING) return {good(name, state + ": " + rig.device_message())};
  if (rig.device() != v1::DEVICE_STATE_STREAMING) {
    const std::string why = rig.device_message().empty() ? "" : ": " + rig.device_message();
    return {bad(name, state + why, "check its cable and power; see dtsctl device list and journalctl -u dtsd")};
  }
  std::vector<Check> checks{good(name, state), check_losses(rig)};
  if (!rig.device_message().empty()) {
    checks.front() = bad(name, state + ", but " + rig.device_message(), "check plate and sensors: dtsctl device test " + rig.rig().name());
  }
  if (!is_replay(rig)) {
    checks.push_back(check_rate(rig));
    checks.push_back(check_queues(rig));
    if (auto latency = check_latency(rig)) checks.push_back(std::move(*latency));
  }
  if (needs_tare(rig)) {
    checks.push_back(bad(rig.rig().name() + " tare", "not tared: no reach can be classified",
                         "clear the chair, then tare it: dtsctl tare --rig " + rig.rig().name()));
  }
  return checks;
}

std::optional<Check> check_calibration(const v1::StatusSnapshot& status, const v1::RigInfo& rig) {
  const std::string name = rig.name() + " calibration";
  if (rig.calibration().empty()) {
    const bool is_of_plate = rig.device_uri().starts_with("sim:") || rig.device_uri().starts_with("replay:");
    if (rig.kind() != "floor" || rig.is_force_plate() || is_of_plate) return std::nullopt;
    return note(name, "no calibration: the plate model is used", "dtsctl calibrate cop --rig " + rig.name());
  }
  if (const auto doubt = notice_that_begins(status, "rig '" + rig.name() + "': " + std::string(words::kCalibrationAfterRig))) {
    const auto [finding, fix] = finding_and_fix(*doubt);
    // Units of one model differ little; a calibration by `dtslab` knows no DAQ.
    const bool is_likely_good = finding.ends_with(words::kOtherUnit) || finding.ends_with(words::kOldCalibration) ||
                                finding.find(words::kNoDaq) != std::string::npos;
    return is_likely_good ? note(name, finding, fix) : bad(name, finding, fix);
  }
  const std::string date = date_of_calibration(rig.calibration());
  return good(name, rig.calibration() + (date.empty() ? "" : ", of " + date));
}

std::vector<Check> check_sensor_curves(const v1::StatusSnapshot& status, const v1::RigInfo& rig) {
  const std::string begin = "rig '" + rig.name() + "': " + std::string(words::kSensorCurvesAfterRig);
  const std::string name = rig.name() + " sensor curves";
  std::vector<Check> checks;
  for (const std::string& notice : status.notices()) {
    if (!notice.starts_with(begin)) continue;
    const auto [finding, fix] = finding_and_fix(notice);
    checks.push_back(finding.ends_with(words::kOtherUnit) ? note(name, finding, fix) : bad(name, finding, fix));
  }
  return checks;
}

Check check_network(const v1::StatusSnapshot& status, const std::string& silent_relay) {
  if (!status.has_network()) return good("network", "off: this machine only");
  if (!silent_relay.empty()) {
    return bad("network", "on, but dts-relay does not listen at " + silent_relay + ": no client with a key can connect",
               "see systemctl status dts-relay, then: systemctl restart dts-relay");
  }
  return good("network", "on for clients with keys, through dts-relay");
}

Check check_sessions(const v1::ListSessionsResponse& sessions) {
  const std::string name = "sessions";
  std::vector<std::string> interrupted;
  for (const v1::SessionRecord& session : sessions.sessions()) {
    if (session.state() == "interrupted") interrupted.push_back(session.session_id());
  }
  if (interrupted.empty()) return good(name, "none is interrupted");
  const std::string rest = interrupted.size() > kMostNamed ? ", ..." : "";
  const std::string finding = counted(interrupted.size(), "session") + (interrupted.size() == 1 ? " is" : " are") +
                              " interrupted: " + cli::join(std::views::take(interrupted, kMostNamed)) + rest;
  return note(name, finding, "see dtsctl session show ID; to continue: dtsctl session resume ID");
}

std::vector<Check> check_disk(const v1::DiskStatus& disk) {
  const std::string name = "disk";
  switch (disk.state()) {
    case v1::DISK_STATE_UNSPECIFIED: return {};
    case v1::DISK_STATE_FINE: return {good(name, disk_line(disk))};
    case v1::DISK_STATE_LOW: return {bad(name, disk_line(disk), "move old recordings to another disk before the next long session")};
    case v1::DISK_STATE_FULL: return {bad(name, disk_line(disk), "free disk space; until then no recording can start")};
    default: return {bad(name, disk_line(disk), "check that the disk is not read-only or failing (dmesg) and that dtsd may write there")};
  }
}

/// The daemon's report decides if there is one; this user's rights matter only for a daemon of this user.
std::vector<Check> check_system(const SystemFacts& facts, const std::optional<v1::StatusSnapshot>& status, Daemon where) {
  std::vector<Check> checks;
  if (status ? !has_notice_about(*status, words::kNoFifo) : facts.may_use_fifo) {
    checks.push_back(good("scheduling", status ? "granted as the daemon requested" : "SCHED_FIFO is allowed for this user"));
  } else {
    checks.push_back(note("scheduling", status ? "the system denied SCHED_FIFO to the daemon" : "SCHED_FIFO is not allowed for this user",
                          "run dtsd by its systemd unit, or add 'USER - rtprio 60' to /etc/security/limits.d/dtsd.conf and log in again"));
  }
  const bool has_no_limit = facts.lockable_bytes == std::numeric_limits<std::uint64_t>::max();
  const std::string lockable = has_no_limit ? "no limit" : "at most " + std::to_string(facts.lockable_bytes >> 20U) + " MiB for this user";
  if (status ? !has_notice_about(*status, words::kNotLocked) : has_no_limit) {
    checks.push_back(good("locked memory", status ? "granted as the daemon requested" : lockable));
  } else {
    checks.push_back(
        note("locked memory", status ? "the system denied locked memory to the daemon" : lockable,
             "run dtsd by its systemd unit, or add 'USER - memlock unlimited' to /etc/security/limits.d/dtsd.conf and log in again"));
  }
  checks.push_back(check_wall_clock(facts, status, where));
  checks.push_back(check_clock_source(facts));
  return checks;
}

int run_doctor(const Arguments& arguments, cli::Console& console) {
  std::vector<Check> checks;
  std::optional<v1::StatusSnapshot> status;
  Daemon daemon = Daemon::Here;
  if (const auto where = target(arguments); where) {
    const std::string origin = where->key && arguments.endpoint.empty() ? "key '" + where->key->name + "'" : where->endpoints.origin;
    checks.push_back(good("address", where->endpoints.control + " (from " + origin + ")"));
    if (!where->endpoints.control.starts_with("ipc://")) daemon = Daemon::Elsewhere;
    status = ask_daemon(arguments, daemon, checks);
    const milliseconds deadline =
        arguments.timeout_s ? milliseconds(static_cast<std::int64_t>(*arguments.timeout_s * 1000.0)) : kDataDeadline;
    if (status) checks.push_back(check_data(*where, *status, deadline));
  } else {
    checks.push_back(bad("address", where.error()));
  }
  std::ranges::move(check_system(gather_system_facts(), status, daemon), std::back_inserter(checks));
  return report(checks, arguments.is_json, console);
}

}  // namespace dts::ctl
