// SPDX-License-Identifier: Apache-2.0
#include "session/trial_record.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "record/event_values.h"

namespace dts::session {
namespace {

/// Every other key with text is a label.
constexpr std::array<std::string_view, 7> kOwnKeys{"phase", "trial", "attempt", "block", "condition", "target_cm", "rest_s"};

std::optional<TrialEventKind> kind_of(const std::string& phase) {
  using enum TrialEventKind;
  for (const auto kind : {Ready, Go, Measure, Done, Redone, Rejected, Aborted, Rest, Finished}) {
    if (phase == name(kind)) return kind;
  }
  return std::nullopt;
}

/// Reads a number; a whole number of centimetres may have been recorded as an integer.
std::optional<double> number_of(record::EventValues& values, const std::string& key) {
  if (values.find(key) == nullptr) return std::nullopt;
  const double number = values.number(key);
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

}  // namespace

record::RecordedEvent to_record(const TrialEvent& event) {
  record::RecordedEvent out{.event = "trial"};
  out.values.emplace_back("phase", std::string(name(event.kind)));
  out.values.emplace_back("trial", std::int64_t{event.trial});
  out.values.emplace_back("attempt", std::int64_t{event.attempt});
  out.values.emplace_back("block", std::int64_t{event.block});
  out.values.emplace_back("condition", event.condition);
  for (const auto& [label, value] : event.labels) out.values.emplace_back(label, value);
  if (event.target_cm) out.values.emplace_back("target_cm", *event.target_cm);
  if (event.rest_s > 0.0) out.values.emplace_back("rest_s", event.rest_s);
  return out;
}

core::Result<TrialEvent> trial_of(const record::RecordedEvent& event) {
  record::EventValues values(event);
  const auto kind = kind_of(record::text_of(event, "phase"));
  if (!kind) values.refuse("phase");
  TrialEvent trial{.kind = kind.value_or(TrialEventKind::Ready),
                   .trial = values.count<std::uint32_t>("trial"),
                   .attempt = values.count<std::uint32_t>("attempt"),
                   .block = values.find("block") != nullptr ? values.count<std::uint32_t>("block") : 1,
                   .condition = record::text_of(event, "condition"),
                   .target_cm = number_of(values, "target_cm"),
                   .rest_s = number_of(values, "rest_s").value_or(0.0)};
  for (const auto& [key, value] : event.values) {
    const auto* word = std::get_if<std::string>(&value);
    if (word != nullptr && std::ranges::find(kOwnKeys, key) == kOwnKeys.end()) trial.labels.emplace_back(key, *word);
  }
  if (auto checked = values.check(); !checked) return tl::make_unexpected(checked.error());
  return trial;
}

}  // namespace dts::session
