// SPDX-License-Identifier: Apache-2.0
#include "ctl/reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "cli/console.h"
#include "cli/table.h"
#include "ctl/json.h"
#include "ctl/reach_reading.h"
#include "ctl/recording_view.h"
#include "ctl/sway_reading.h"

namespace dts::ctl {
namespace {

/// Converts "ml_mm" with unit "mm" to "ml".
std::string label(const client::ChannelFormat& channel) {
  std::string suffix = "_" + channel.unit;
  std::ranges::transform(suffix, suffix.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const bool has_suffix = channel.unit.size() > 0 && channel.name.size() > suffix.size() && channel.name.ends_with(suffix);
  return cli::printable(has_suffix ? channel.name.substr(0, channel.name.size() - suffix.size()) : channel.name);
}

/// Returns a value of constant width, about six significant digits, so that live values do not move on the screen.
std::string value_text(float value) {
  if (!std::isfinite(value)) return "      -";
  const double magnitude = std::abs(static_cast<double>(value));
  const int decimals = magnitude < 10.0 ? 4 : magnitude < 1000.0 ? 2 : 0;
  std::string text = cli::decimal(static_cast<double>(value), decimals);
  return text.size() < 7 ? std::string(7 - text.size(), ' ') + text : text;
}

std::string gap_text(const v1::Event& event) {
  const v1::Gap& gap = event.gap();
  const std::string reason = gap.reason() == 0 ? "" : enumerator_word(*v1::GapReason_descriptor(), gap.reason()) + ", ";
  return reason + (gap.is_exact() ? "" : "about ") + counted(gap.missing_scans(), "scan") + " missing before segment " +
         std::to_string(event.segment());
}

std::string change_text(const std::string& state, const std::string& subject, const std::string& message) {
  return subject + (subject.empty() ? "" : " ") + state + (message.empty() ? "" : ": " + message);
}

/// Returns "go, trial 3: 120 at 85.2 cm", "rest for 20.0 s".
std::string trial_text(const v1::TrialChange& change, const std::string& rig) {
  const bool is_undone = change.step() == v1::TRIAL_EVENT_KIND_UNDONE;
  const std::string what = is_undone ? "redo or reject taken back" : enumerator_word(*v1::TrialEventKind_descriptor(), change.step());
  if (change.step() == v1::TRIAL_EVENT_KIND_FINISHED) return "all trials have ended; end the session: dtsctl session stop --rig " + rig;
  if (change.step() == v1::TRIAL_EVENT_KIND_REST) return change.rest_s() > 0.0 ? "rest for " + cli::duration(change.rest_s()) : "rest";
  std::string text = what + ", trial " + std::to_string(change.trial());
  if (change.attempt() > 1) text += " attempt " + std::to_string(change.attempt());
  if (!change.condition().empty()) text += ": " + change.condition();
  if (change.target_cm() > 0.0) text += " at " + cli::decimal(change.target_cm(), 1) + " cm";
  return text;
}

std::string body_text(const v1::Event& event, const std::string& rig) {
  switch (event.body_case()) {
    case v1::Event::kGap: return gap_text(event);
    case v1::Event::kMarker: return event.marker().text();
    case v1::Event::kTrigger:
      return enumerator_word(*v1::TriggerEdge_descriptor(), event.trigger().edge()) + " edge on " + event.trigger().channel();
    case v1::Event::kDevice:
      return change_text(enumerator_word(*v1::DeviceState_descriptor(), event.device().state()), event.device().uri(),
                         event.device().message());
    case v1::Event::kSession:
      return change_text(enumerator_word(*v1::SessionState_descriptor(), event.session().state()), event.session().session_id(),
                         event.session().message());
    case v1::Event::kTrial: return trial_text(event.trial(), rig);
    case v1::Event::kReach: return reach_text(event.reach());
    case v1::Event::kMovement: return movement_text(event.movement());
    case v1::Event::kTrialResult: return trial_result_text(event.trial_result());
    case v1::Event::kSway: return sway_text(event.sway());
    case v1::Event::kSegmentStart:
    case v1::Event::kLoss:
    case v1::Event::kFigure:
    case v1::Event::BODY_NOT_SET: break;  // not published
  }
  return "(of a later version of dtsd)";
}

}  // namespace

std::vector<std::string> reading_parts(const client::StreamFormat& format, std::span<const float> scan,
                                       std::span<const std::uint8_t> quality) {
  std::vector<std::string> parts;
  std::uint8_t doubts = 0;
  for (std::size_t channel = 0; channel < format.channels.size(); ++channel) {
    const client::ChannelFormat& described = format.channels[channel];
    const bool has_unit = described.unit != "1";  // UCUM's unit for a pure number
    parts.push_back(label(described) + " " + value_text(scan[channel]) + (has_unit ? " " + cli::printable(described.unit) : ""));
    doubts = static_cast<std::uint8_t>(doubts | quality[channel]);
  }
  if (const auto words = quality_words(doubts); !words.empty()) parts.push_back("[" + cli::join(words, " ") + "]");
  const bool is_value_beyond_travel = format.name == "cop" && (doubts & v1::QUALITY_OUT_OF_RANGE) != 0 &&
                                      std::ranges::all_of(scan, [](float value) { return std::isfinite(value); });
  if (is_value_beyond_travel) parts.emplace_back("beyond the travel of the sensors: stand in the middle of the plate");
  return parts;
}

std::string reading(const client::StreamFormat& format, std::span<const float> scan, std::span<const std::uint8_t> quality) {
  return cli::join(reading_parts(format, scan, quality), "  ");
}

void copy_scan(const client::Block& block, std::size_t scan, std::vector<float>& values) {
  values.resize(block.channel_count());
  for (std::size_t channel = 0; channel < values.size(); ++channel) values[channel] = block.column(channel)[scan];
}

std::string event_line(const client::Event& event) {
  return cli::printable(std::string(event.kind) + ": " + body_text(*event.body, std::string(event.rig)));
}

}  // namespace dts::ctl
