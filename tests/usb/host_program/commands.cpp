// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/commands.h"

#include <cstdlib>
#include <exception>
#include <optional>
#include <sstream>
#include <utility>

namespace dts::emulator {

namespace {

/// nullopt: something else than a number.
std::optional<double> number(const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return used == text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string Commands::plug() {
  const auto plugged = bus_.plug(*daq_.device);
  return plugged ? "ok" : "error " + core::to_string(plugged.error());
}

std::string Commands::truth(const std::string& monotonic_ns) {
  const std::int64_t when_ns = monotonic_ns.empty() ? clock_.now_ns() : std::strtoll(monotonic_ns.c_str(), nullptr, 10);
  const RigSource::Truth truth = rig_->truth_at(when_ns);
  std::ostringstream answer;
  answer << "ok " << truth.ml_mm << ' ' << truth.ap_mm << ' ' << truth.load_n;
  return answer.str();
}

std::string Commands::hold(std::istream& volts) {
  std::vector<double> held;
  for (std::string word; volts >> word;) {
    const auto value = number(word);
    if (!value) return "error hold: \"" + word + "\" is not a number";
    held.push_back(*value);
  }
  held_->set(std::move(held));
  return "ok";
}

std::string Commands::run(const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  std::string first;
  std::string second;
  words >> verb;
  if (verb == "hold" && held_ != nullptr) return hold(words);
  words >> first >> second;
  if (verb == "plug") return plug();
  if (verb == "unplug" || verb == "replug") {
    bus_.unplug(*daq_.device);
    return verb == "unplug" ? "ok" : plug();
  }
  if (verb == "fault") {
    const auto value = number(second);
    if (!value) return "error fault " + first + ": \"" + second + "\" is not a number";
    bool is_known = false;
    bus_.locked(*daq_.device, [&] { is_known = set_fault(*daq_.faults, first, *value); });
    return is_known ? "ok" : "error no fault is called \"" + first + "\"; there are " + fault_names();
  }
  if (verb == "truth" && rig_ != nullptr) return truth(first);
  if (verb == "story" && rig_ != nullptr) return "ok " + std::to_string(static_cast<double>(clock_.now_ns() - rig_->start_ns()) * 1e-9);
  if (verb == "quit") {
    wants_to_quit_ = true;
    return "ok";
  }
  return "error no command is called \"" + verb +
         "\"; there are plug, unplug, replug, fault, quit; with a scene truth, story; without one hold";
}

}  // namespace dts::emulator
