// SPDX-License-Identifier: Apache-2.0
#include "ctl/status_view.h"

#include <algorithm>

#include "cli/table.h"
#include "ctl/json.h"
#include "ctl/recording_view.h"

namespace dts::ctl {
namespace {

/// Returns the word for an enumerator, "-" if unspecified.
template <class Enum>
std::string word(Enum value, const google::protobuf::EnumDescriptor* type) {
  return value == 0 ? "-" : enumerator_word(*type, static_cast<int>(value));
}

cli::Cell device_cell(v1::DeviceState state) {
  const cli::Style style = state == v1::DEVICE_STATE_STREAMING ? cli::Style::Good
                           : state == v1::DEVICE_STATE_GONE    ? cli::Style::Bad
                                                               : cli::Style::Warning;
  return {word(state, v1::DeviceState_descriptor()), style};
}

cli::Cell count_cell(std::uint64_t count) { return {std::to_string(count), count == 0 ? cli::Style::Plain : cli::Style::Warning}; }

std::string rate_of(const v1::Rate& rate) {
  return cli::decimal(static_cast<double>(rate.numerator()) / static_cast<double>(rate.denominator()), 2);
}

void print_messages(cli::Console& console, const v1::StatusSnapshot& status) {
  for (const v1::RigStatus& rig : status.rigs()) {
    if (rig.device_message().empty()) continue;
    console.out << cli::styled(console, cli::Style::Bad, cli::printable(rig.rig().name() + ": " + rig.device_message())) << '\n';
  }
  for (const std::string& notice : notice_lines(status)) {
    console.out << cli::styled(console, cli::Style::Warning, "notice: " + cli::printable(notice)) << '\n';
  }
}

void print_sensors(cli::Console& console, const v1::RigInfo& rig) {
  if (rig.sensors_size() == 0) return;
  cli::Table sensors({"SENSOR", ">X (mm)", ">Y (mm)", "CHANNEL", ">GAP (mm)", "CURVE"});
  for (const v1::SensorInfo& sensor : rig.sensors()) {
    sensors.add({{sensor.label()},
                 {cli::decimal(sensor.x_mm(), 1)},
                 {cli::decimal(sensor.y_mm(), 1)},
                 {sensor.channel()},
                 {cli::decimal(sensor.unloaded_gap_mm(), 2)},
                 {sensor.curve()}});
  }
  console.out << '\n';
  sensors.print(console);
}

void print_streams(cli::Console& console, const v1::RigInfo& rig) {
  if (rig.streams_size() == 0) return;
  cli::Table streams({"STREAM", ">RATE (Hz)", ">DELAY (ms)", "CHANNELS"});
  for (const v1::StreamFormat& stream : rig.streams()) {
    const std::string channels = cli::join(stream.channels(), " ", [](const v1::Channel& channel) { return channel.name(); });
    streams.add({{stream.name()}, {rate_of(stream.rate())}, {cli::decimal(static_cast<double>(stream.delay_ns()) * 1e-6, 1)}, {channels}});
  }
  console.out << '\n';
  streams.print(console);
}

}  // namespace

std::vector<std::string> notice_lines(const v1::StatusSnapshot& status) {
  constexpr std::string_view kThread = "thread ";
  struct Line {
    std::string threads;  ///< Empty: the notice names no thread.
    std::size_t count = 0;
    std::string text;
  };
  std::vector<Line> lines;
  for (const std::string& notice : status.notices()) {
    const std::size_t colon = notice.find(": ");
    const bool is_of_thread = notice.starts_with(kThread) && colon != std::string::npos;
    const std::string thread = is_of_thread ? notice.substr(kThread.size(), colon - kThread.size()) : "";
    const std::string text = is_of_thread ? notice.substr(colon) : notice;
    const auto same = std::ranges::find_if(lines, [&](const Line& line) { return line.count > 0 && is_of_thread && line.text == text; });
    if (same == lines.end()) {
      lines.push_back({thread, is_of_thread ? 1U : 0U, text});
    } else {
      same->threads += ", " + thread;
      ++same->count;
    }
  }
  std::vector<std::string> texts;
  for (const Line& line : lines)
    texts.push_back((line.count == 0 ? "" : line.count == 1 ? "thread " : "threads ") + line.threads + line.text);
  return texts;
}

bool needs_tare(const v1::RigStatus& rig) {
  const auto& stages = rig.rig().stages();
  const bool has_own_zero =
      std::ranges::any_of(stages, [](const std::string& stage) { return stage.find("baseline=nominal") != std::string::npos; });
  const bool is_replayed = rig.rig().device_uri().starts_with("replay:");
  const bool needs_zero = rig.rig().kind() == "chair" || rig.rig().is_force_plate();
  return needs_zero && rig.device() == v1::DEVICE_STATE_STREAMING && rig.tare() != v1::TARE_STATE_DONE && !has_own_zero && !is_replayed;
}

std::string session_line(const v1::SessionInfo& session) {
  if (session.session_id().empty()) return "-";
  const bool is_over = session.state() == v1::SESSION_STATE_IDLE;
  std::string line = session.session_id() + " " + (is_over ? "ended" : word(session.state(), v1::SessionState_descriptor()));
  if (session.elapsed_s() > 0.0) {
    line += (is_over ? " after " : " for ") + cli::duration(session.elapsed_s());
    if (session.duration_s() > 0.0) line += " of " + cli::duration(session.duration_s());
  }
  if (!session.message().empty()) line += ": " + session.message();
  return cli::printable(line);
}

std::string tare_line(const std::string& rig, const v1::TareResponse& tare) {
  std::string line = rig + ": tared, zero is now at";
  for (const double baseline : tare.baseline()) line += " " + cli::decimal(baseline, 3);
  return cli::printable(line + " " + tare.unit());
}

void print_status(cli::Console& console, const v1::StatusSnapshot& status) {
  console.out << cli::styled(console, cli::Style::Bold, "dtsd " + cli::printable(status.version())) << ", up "
              << cli::duration(status.uptime_s()) << '\n';
  cli::Table rigs({"RIG", "DEVICE", ">RATE (Hz)", ">NOMINAL", ">LOST", ">GAPS", ">DROPPED", "TARE", "SESSION"});
  for (const v1::RigStatus& rig : status.rigs()) {
    rigs.add({{rig.rig().name(), cli::Style::Bold},
              device_cell(rig.device()),
              {rig.measured_rate_hz() > 0.0 ? cli::decimal(rig.measured_rate_hz(), 2) : "-"},
              {cli::decimal(rig.nominal_rate_hz(), 2)},
              count_cell(rig.lost_scans_total()),
              count_cell(rig.gaps_total()),
              count_cell(rig.dropped_blocks_total()),
              {word(rig.tare(), v1::TareState_descriptor())},
              {session_line(rig.session())}});
  }
  if (status.rigs_size() == 0) console.out << "no rig is configured\n";
  rigs.may_drop({"NOMINAL", "DROPPED", "GAPS", "TARE"});
  rigs.print(console);
  print_recordings(console, status);
  print_messages(console, status);
}

void print_rigs(cli::Console& console, const v1::ListRigsResponse& rigs) {
  cli::Table table({"RIG", "KIND", "DEVICE", ">SENSORS", "STREAMS"});
  for (const v1::RigInfo& rig : rigs.rigs()) {
    table.add({{rig.name(), cli::Style::Bold},
               {rig.kind()},
               {rig.device_uri()},
               {std::to_string(rig.sensors_size())},
               {cli::join(rig.published(), " ")}});
  }
  if (rigs.rigs_size() == 0) console.out << "no rig is configured\n";
  table.print(console);
}

namespace {

/// Returns "drift -12.3 ppm, host times within 1.20 ms".
std::string clock_text(const v1::RigStatus& status) {
  if (status.scans_total() == 0) return "";
  const std::string drift =
      status.clock_drift_ppm() == 0.0 ? "drift not measured yet" : "drift " + cli::decimal(status.clock_drift_ppm(), 1) + " ppm";
  return drift + ", host times within " + cli::decimal(static_cast<double>(status.host_time_uncertainty_ns()) * 1e-6, 2) + " ms";
}

/// Returns "done, zero drifts by +0.21 N/min"; the drift is that of a force plate.
std::string tare_text(const v1::RigStatus& status) {
  std::string text = word(status.tare(), v1::TareState_descriptor());
  if (!status.has_zero_drift_n_per_min()) return text;
  const double drift = status.zero_drift_n_per_min();
  return text + ", zero drifts by " + (drift > 0.0 ? "+" : "") + cli::decimal(drift, 2) + " N/min";
}

cli::Style style_of(v1::CheckOutcome outcome) {
  if (outcome == v1::CHECK_OUTCOME_PASSED) return cli::Style::Good;
  return outcome == v1::CHECK_OUTCOME_SKIPPED ? cli::Style::Plain : cli::Style::Bad;
}

}  // namespace

void print_rig(cli::Console& console, const v1::RigStatus& status) {
  const v1::RigInfo& rig = status.rig();
  print_field(console, "rig", rig.name());
  print_field(console, "kind", rig.kind());
  print_field(console, "device", rig.device_uri() + ", " + device_cell(status.device()).text);
  print_field(console, "problem", status.device_message());
  print_field(console, rig.is_force_plate() ? "force plate" : "plate",
              cli::decimal(rig.plate_a_mm(), 1) + " x " + cli::decimal(rig.plate_b_mm(), 1) +
                  (rig.is_force_plate() ? "" : " x " + cli::decimal(rig.plate_h_mm(), 1)) + " mm");
  print_field(console, "rate",
              (status.measured_rate_hz() > 0.0 ? cli::decimal(status.measured_rate_hz(), 2) : "-") + " of " +
                  cli::decimal(status.nominal_rate_hz(), 2) + " Hz");
  print_field(console, "clock", clock_text(status));
  print_field(console, "scans",
              std::to_string(status.scans_total()) + ", lost " + std::to_string(status.lost_scans_total()) + " in " +
                  counted(status.gaps_total(), "gap") + ", segment " + std::to_string(status.segment()) + ", restarts " +
                  std::to_string(status.restarts_total()) + ", reconnects " + std::to_string(status.reconnects_total()));
  print_field(console, "calibration",
              rig.kind() != "floor"       ? ""
              : rig.is_force_plate()      ? "the maker's, in the rig file"
              : rig.calibration().empty() ? "none: the plate model is used"
                                          : rig.calibration());
  print_field(console, "tare", tare_text(status));
  print_field(console, "session", session_line(status.session()));
  print_field(console, "published", cli::join(rig.published(), " "));
  for (int index = 0; index < rig.stages_size(); ++index) print_field(console, index == 0 ? "stages" : "", rig.stages(index));
  print_sensors(console, rig);
  print_streams(console, rig);
}

void print_devices(cli::Console& console, const v1::GetDevicesResponse& devices) {
  cli::Table table({"RIG", "DEVICE", "MODEL", "SERIAL", "STATE", ">CHANNELS", "RATES (Hz)"});
  for (const v1::DeviceInfo& device : devices.devices()) {
    const bool has_rates = device.maximum_rate_hz() > 0.0;
    table.add({{device.rig().empty() ? "-" : device.rig()},
               {device.uri()},
               {device.model()},
               {device.serial()},
               device_cell(device.state()),
               {device.channels_size() > 0 ? std::to_string(device.channels_size()) : "-"},
               {has_rates ? cli::decimal(device.minimum_rate_hz(), 0) + " .. " + cli::decimal(device.maximum_rate_hz(), 0) : "-"}});
  }
  table.print(console);
  const auto is_free = [](const v1::DeviceInfo& device) { return device.rig().empty(); };
  if (std::ranges::any_of(devices.devices(), is_free)) {
    console.out << "\na device without a rig is connected but not used: to use it, add its DEVICE to a [[rig]] in dtsd.toml\n";
  }
  if (!devices.problem().empty()) {
    console.out << '\n'
                << cli::styled(console, cli::Style::Bad, cli::printable("cannot list the connected devices: " + devices.problem())) << '\n';
  }
  if (devices.kinds_size() > 0) console.out << "\nkinds of device that a rig can use:\n";
  for (const std::string& kind : devices.kinds()) console.out << "  " << cli::printable(kind) << '\n';
}

void print_device_test(cli::Console& console, const v1::TestDeviceResponse& test) {
  cli::Table table({"CHANNEL", ">MEAN", ">NOISE (RMS)", ">MINIMUM", ">MAXIMUM", "UNIT", ">GAP (mm)", "QUALITY"});
  for (const v1::TestDeviceResponse::ChannelTest& channel : test.channels()) {
    const auto doubts = quality_words(static_cast<std::uint8_t>(channel.quality()));
    table.add({{channel.name(), cli::Style::Bold},
               {cli::decimal(channel.mean(), 4)},
               {cli::decimal(channel.noise_rms(), 5)},
               {cli::decimal(channel.minimum(), 4)},
               {cli::decimal(channel.maximum(), 4)},
               {channel.unit()},
               {channel.has_gap_mm() ? cli::decimal(channel.gap_mm(), 3) : "-"},
               {doubts.empty() ? "good" : cli::join(doubts, " "), doubts.empty() ? cli::Style::Good : cli::Style::Bad}});
  }
  if (test.channels_size() > 0) table.print(console);
  cli::Table checks({"CHECK", "OUTCOME", "DETAIL"});
  for (const v1::TestDeviceResponse::Check& check : test.checks()) {
    checks.add({{check.name(), cli::Style::Bold},
                {enumerator_word(*v1::CheckOutcome_descriptor(), check.outcome()), style_of(check.outcome())},
                {check.detail()}});
  }
  if (test.checks_size() > 0) {
    if (test.channels_size() > 0) console.out << '\n';
    checks.print(console);
  }
  if (!test.serial().empty())
    print_field(console, "unit", test.serial() + (test.firmware().empty() ? "" : ", firmware " + test.firmware()));
  if (!test.problem().empty()) {
    console.out << cli::styled(console, cli::Style::Bad, cli::printable("not streaming: " + test.problem())) << '\n';
    return;
  }
  const std::string rate =
      test.measured_rate_hz() > 0.0 ? cli::decimal(test.measured_rate_hz(), 2) + " per second" : "rate not measured yet";
  console.out << counted(test.scans(), "scan") << ", " << rate << '\n';
}

}  // namespace dts::ctl
