// SPDX-License-Identifier: Apache-2.0
#include "golden/golden_case.h"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "core/clock.h"
#include "device/registry.h"
#include "files/protocol_file.h"
#include "files/rig_file.h"

namespace dts::golden {
namespace {

constexpr std::int64_t kLongAfterNs = 1'000'000'000;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

std::string path_of(const std::string& name, const std::string& ending) { return folder() + "/" + name + ending; }

template <class Value>
Value checked(const core::Result<Value>& result, const std::string& where) {
  if (!result) fail(where + ": " + core::to_string(result.error()));
  return *result;
}

/// Returns a rig definition that uses the plate model: for weights, and for other estimators.
std::string without_calibration(const std::string& rig_text) {
  toml::table rig = toml::parse(rig_text);
  rig.erase("calibration");
  std::ostringstream text;
  text << toml::toml_formatter(rig, toml::format_flags::none) << '\n';
  return std::move(text).str();
}

pipeline::RigConfig read_rig(std::string text, const std::string& name) {
  files::Problems problems;
  pipeline::RigConfig rig = files::read_rig_text(text, name, problems);
  if (!problems.empty()) fail(files::to_string(problems.front()) + "\n" + text);
  rig.name = rig.kind;
  return rig;
}

session::Protocol read_protocol(const std::string& file) {
  files::Problems problems;
  session::Protocol protocol = files::read_protocol(DTS_SOURCE_DIR "/" + file, problems);
  if (!problems.empty()) fail(files::to_string(problems.front()));
  return protocol;
}

void replace(std::string& text, const std::string& rule, const std::string& where) {
  const auto arrow = rule.find(" => ");
  if (arrow == std::string::npos) fail(where + ": replace needs OLD => NEW");
  const std::string old = rule.substr(0, arrow);
  auto at = text.find(old);
  if (at == std::string::npos) fail(where + ": the rig's text has no '" + old + "':\n" + text);
  std::string fresh = rule.substr(arrow + 4);
  for (auto mark = fresh.find("\\n"); mark != std::string::npos; mark = fresh.find("\\n")) fresh.replace(mark, 2, "\n");
  for (; at != std::string::npos; at = text.find(old, at + fresh.size())) text.replace(at, old.size(), fresh);
}

device::ChannelRole role_of(const std::string& word) {
  if (word == "sensor") return device::ChannelRole::Sensor;
  return word == "marker" ? device::ChannelRole::Marker : device::ChannelRole::Auxiliary;
}

std::string word_of(device::ChannelRole role) {
  if (role == device::ChannelRole::Sensor) return "sensor";
  return role == device::ChannelRole::Marker ? "marker" : "aux";
}

/// Codes of the converter where it has codes: short, and the same on every machine.
std::string sample_text(const device::ChannelDescription& channel, double value, std::uint8_t quality) {
  std::array<char, 40> text{};
  if (std::isnan(value)) {
    std::snprintf(text.data(), text.size(), "nan");
  } else if (channel.resolution > 0.0) {
    std::snprintf(text.data(), text.size(), "%lld", std::llround(value / channel.resolution));
  } else {
    std::snprintf(text.data(), text.size(), "%.5g", value);
  }
  return text.data() + (quality != 0 ? ":" + std::to_string(quality) : std::string());
}

}  // namespace

std::string folder() { return DTS_SOURCE_DIR "/tests/golden/cases"; }

std::string read_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail("cannot read " + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text << std::flush;
  if (!out) fail("cannot write " + file);
}

std::size_t Case::scan_count() const {
  std::size_t sum = 0;
  for (const Step& step : steps) {
    if (step.verb == "run") sum += std::stoul(step.rest);
  }
  return sum;
}

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder())) {
    if (entry.path().extension() == ".case") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

Case read_case(const std::string& name) {
  Case golden{.name = name, .rig = {}, .protocols = {session::free_protocol()}, .sim = {}, .cues = {}, .holds = {}, .steps = {}};
  std::string rig_text;
  std::istringstream file(read_text(path_of(name, ".case")));
  std::vector<Step> settings;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto space = line.find(' ');
    const Step step{.verb = line.substr(0, space), .rest = space == std::string::npos ? "" : line.substr(space + 1), .line = number};
    const std::string where = name + ".case:" + std::to_string(number);
    std::istringstream words(step.rest);
    if (step.verb == "rig") {
      rig_text = checked(files::rig_definition(DTS_SOURCE_DIR "/" + step.rest), where);
    } else if (step.verb == "uncalibrated") {
      rig_text = without_calibration(rig_text);
    } else if (step.verb == "replace") {
      replace(rig_text, step.rest, where);
    } else if (step.verb == "block" || step.verb == "publish" || step.verb == "trigger") {
      settings.push_back(step);
    } else if (step.verb == "protocol") {
      golden.protocols.push_back(read_protocol(step.rest));
    } else if (step.verb == "sim") {
      golden.sim = step.rest;
    } else if (step.verb == "cue") {
      double at_s = 0.0;
      double target_cm = 0.0;
      words >> at_s >> target_cm;
      golden.cues.push_back({.is_go = true, .at_ns = std::llround(at_s * 1e9), .target_cm = target_cm});
    } else if (step.verb == "hold") {
      Hold hold;
      words >> hold.channel >> hold.from >> hold.to >> hold.value;
      golden.holds.push_back(hold);
    } else {
      golden.steps.push_back(step);
    }
  }
  golden.rig = read_rig(rig_text, name);
  golden.rig.device_uri = "recorded:" + name;
  if (golden.rig.cop_calibration) {  // as if measured with this device
    golden.rig.cop_calibration->origin.rig = golden.rig.name;
    golden.rig.cop_calibration->origin.daq_model = kRecordedModel;
  }
  for (const Step& setting : settings) {
    std::istringstream words(setting.rest);
    if (setting.verb == "block") words >> golden.rig.block_scans;
    if (setting.verb == "publish") {
      golden.rig.published.assign(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
    }
    if (setting.verb != "trigger") continue;
    pipeline::TriggerInput trigger{.edges = pipeline::TriggerEdges::Both};
    words >> trigger.channel >> trigger.level;
    golden.rig.trigger = trigger;
  }
  return golden;
}

Scans read_scans(const std::string& name) {
  Scans scans;
  std::istringstream file(read_text(path_of(name, ".scans")));
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    if (line.starts_with('#')) continue;
    if (line.starts_with("channel ")) {
      device::ChannelDescription channel;
      std::string word;
      words >> word >> channel.name >> channel.unit >> word >> channel.minimum >> channel.maximum >> channel.resolution;
      channel.role = role_of(word);
      scans.channels.push_back(channel);
      continue;
    }
    std::vector<Sample> row;
    for (std::string word; words >> word;) {
      const device::ChannelDescription& channel = scans.channels.at(row.size());
      const auto colon = word.find(':');
      const double number = std::stod(word.substr(0, colon));
      row.push_back({.value = channel.resolution > 0.0 ? number * channel.resolution : number,
                     .quality = static_cast<std::uint8_t>(colon == std::string::npos ? 0 : std::stoi(word.substr(colon + 1)))});
    }
    if (row.size() != scans.channels.size()) fail(name + ".scans: a scan has " + std::to_string(row.size()) + " values: " + line);
    scans.rows.push_back(std::move(row));
  }
  return scans;
}

void record_scans(const Case& golden) {
  core::VirtualClock clock;
  std::string address = golden.sim;
  if (const auto at = address.find('@'); at != std::string::npos) address.replace(at, 1, folder());
  auto created = device::create_device(address, {.clock = clock, .rig = golden.rig.model});
  if (!created) fail(golden.name + ": " + core::to_string(created.error()));
  device::Device& device = **created;
  static_cast<void>(device.open());
  const core::Rate rate = checked(device.start({.rate = golden.rig.rate, .max_block_scans = 1}), golden.name);
  if (!(rate == golden.rig.rate)) fail(golden.name + ": the simulator's rate is " + std::to_string(rate.hz()));
  std::ostringstream out;
  out << "# " << golden.sim << "\n";
  out.precision(std::numeric_limits<double>::max_digits10);
  const auto& channels = device.describe().channels;
  for (const device::ChannelDescription& channel : channels) {
    out << "channel " << channel.name << ' ' << channel.unit << ' ' << word_of(channel.role) << ' ' << channel.minimum << ' '
        << channel.maximum << ' ' << channel.resolution << '\n';
  }
  core::Block block(channels.size(), 1);
  auto cue = golden.cues.begin();
  for (std::size_t scan = 0; scan < golden.scan_count(); ++scan) {
    for (; cue != golden.cues.end() && cue->at_ns <= clock.now_ns(); ++cue) device.hear(*cue);
    if (device.read(block, clock.now_ns() + kLongAfterNs).outcome != device::ReadOutcome::Scans) fail(golden.name + ": no scan");
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
      double value = block.column(channel)[0];
      for (const Hold& hold : golden.holds) {
        if (hold.channel == channel && hold.from <= scan && scan < hold.to) value = hold.value;
      }
      out << (channel > 0 ? " " : "") << sample_text(channels[channel], value, block.quality(channel)[0]);
    }
    out << '\n';
  }
  write_text(path_of(golden.name, ".scans"), out.str());
}

}  // namespace dts::golden
