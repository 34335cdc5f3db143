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

/// A JSON value as it is written: for what is nested.
struct JsonText {
  std::string text;

  friend bool operator==(const JsonText&, const JsonText&) = default;
};

/// Values of an event: numbers stay numbers in JSON.
using EventValue = std::variant<std::string, double, std::int64_t, bool, JsonText>;

/// Something that happened at one scan, as it stands in the stream "<rig>/events": one JSON object a sample,
///
///     {"event":"marker","segment":0,"scan":1250,"text":"eyes closed"}
///
/// | event   | further keys |
/// |---------|--------------|
/// | segment | host_time_ns, reason and missing_scans after a gap: stands at scan 0 (or the first recorded scan, first_scan) of a segment |
/// | marker  | text |
/// | trigger | edge ("rising", "falling"), channel |
/// | session | state, message |
/// | device  | state, message |
/// | trial   | phase, trial, attempt, block, condition and its labels |
/// | reach, class | see reach_record.h |
/// | result  | trial, attempt, condition and, if known, target_cm, expected_class, number, class, trunk_deg ...: of a reaching trial; once
/// |         | when it is decided and once, with is_at_end, when the session ends |
/// | sway    | trial, attempt, condition, labels and what came of a trial of quiet standing: see session/sway_record.h |
/// | figure  | name, value, unit, details: of the whole session |
/// | loss    | scans: the recorder was too slow; the next sample starts a segment |
struct RecordedEvent {
  std::string event;
  std::uint32_t segment = 0;
  core::ScanIndex scan;  ///< Of the rig's raw stream.
  std::vector<std::pair<std::string, EventValue>> values{};

  friend bool operator==(const RecordedEvent&, const RecordedEvent&) = default;
};

/// One line of JSON. Bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string to_json(const RecordedEvent& event);
/// Fails with DataDamaged: no object, no "event", numbers out of range, more than 64 keys or 64 KiB. Nested values are kept as they are
/// written.
[[nodiscard]] core::Result<RecordedEvent> event_of_json(const std::string& text);

/// The values alone as one JSON object, all but that of the key `without`; empty when nothing is left.
[[nodiscard]] std::string values_json(const RecordedEvent& event, const std::string& without);

/// A value as text: numbers with the digits that read back as the same double.
[[nodiscard]] std::string text_of(const EventValue& value);
/// The value of a key as text; empty when absent.
[[nodiscard]] std::string text_of(const RecordedEvent& event, const std::string& key);

}  // namespace dts::record
