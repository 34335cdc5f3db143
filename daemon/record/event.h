// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/result.h"
#include "core/units.h"

namespace dts::record {

/// A nested JSON value, kept as its text.
struct JsonText {
  std::string text;

  friend bool operator==(const JsonText&, const JsonText&) = default;
};

/// One value of an event. Numbers stay numbers in JSON.
using EventValue = std::variant<std::string, double, std::int64_t, bool, JsonText>;

/// An event at one scan. The stream "<rig>/events" holds one JSON object per sample:
///
///     {"event":"marker","segment":0,"scan":1250,"text":"eyes closed"}
///
/// | event   | further keys |
/// |---------|--------------|
/// | segment | host_time_ns; after a gap also reason and missing_scans. Its scan is the first recorded scan of the segment |
/// | marker  | text |
/// | trigger | edge ("rising", "falling"), channel |
/// | session | state, message |
/// | device  | state, message |
/// | trial   | phase, trial, attempt, block, condition and its labels |
/// | reach, class | see reach_record.h |
/// | result  | of a reaching trial: trial, attempt, condition and, if known, target_cm, expected_class, number, class, trunk_deg ...
/// |         | Written when the trial is decided, and again, with is_at_end, when the session ends |
/// | sway    | of a trial of quiet standing: trial, attempt, condition, labels and the results, see session/sway_record.h |
/// | figure  | a result of the whole session: name, value, unit, details |
/// | loss    | scans: the number of scans lost here, because the recorder was too slow |
struct RecordedEvent {
  std::string event;
  std::uint32_t segment = 0;
  core::ScanIndex scan;  ///< Scan of the rig's raw stream.
  std::vector<std::pair<std::string, EventValue>> values{};

  friend bool operator==(const RecordedEvent&, const RecordedEvent&) = default;
};

/// Returns one line of JSON. Replaces bytes that are not UTF-8.
[[nodiscard]] std::string to_json(const RecordedEvent& event);
/// Fails with DataDamaged if the text is no JSON object, has no "event", is nested too deeply, has numbers out of range, or has more than
/// 64 keys or 64 KiB.
/// Keeps nested values as text.
[[nodiscard]] core::Result<RecordedEvent> event_of_json(const std::string& text);

/// Returns the values as one JSON object, without the key `without`; empty if no value is left.
[[nodiscard]] std::string values_json(const RecordedEvent& event, const std::string& without);

/// Returns a value as text. A number reads back as the same double.
[[nodiscard]] std::string text_of(const EventValue& value);
/// Returns the value of a key as text; empty if the key is absent.
[[nodiscard]] std::string text_of(const RecordedEvent& event, const std::string& key);

}  // namespace dts::record
