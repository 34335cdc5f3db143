// SPDX-License-Identifier: Apache-2.0
#include "session/sway_record.h"

#include <limits>

#include "record/event_values.h"
#include "record/sway_json.h"

namespace dts::session {
namespace {

constexpr std::int64_t kMostCount = std::numeric_limits<std::int64_t>::max();

std::string names_text(std::uint32_t flags) {
  std::string text;
  for (const std::string_view name : posturography::names_of(flags)) text += (text.empty() ? "" : " ") + std::string(name);
  return text;
}

void add(record::RecordedEvent& event, const posturography::Analysis& analysis, const std::string& software) {
  event.values.emplace_back("profile", std::string(posturography::name(analysis.profile)));
  event.values.emplace_back("rate_hz", analysis.rate_hz);
  event.values.emplace_back("samples", static_cast<std::int64_t>(analysis.samples));
  event.values.emplace_back("duration_s", analysis.duration_s);
  event.values.emplace_back("flags", std::int64_t{analysis.flags});
  event.values.emplace_back("flag_names", names_text(analysis.flags));
  event.values.emplace_back("missing", static_cast<std::int64_t>(analysis.missing));
  event.values.emplace_back("interpolated", static_cast<std::int64_t>(analysis.interpolated));
  event.values.emplace_back("is_valid", analysis.is_valid());
  event.values.emplace_back("software", software);
  event.values.emplace_back("measures", record::to_json(analysis.measures));
}

posturography::Analysis analysis_of(record::EventValues& values) {
  posturography::Analysis analysis;
  const auto profile = posturography::profile_named(values.text("profile"));
  if (!profile) values.refuse("profile");
  analysis.profile = profile.value_or(posturography::Profile::Lp10);
  analysis.rate_hz = values.number("rate_hz");
  if (!(analysis.rate_hz > 0.0) || analysis.rate_hz > 1e6) values.refuse("rate_hz");
  analysis.samples = static_cast<std::size_t>(values.whole("samples", 1, kMostCount));
  analysis.duration_s = values.number("duration_s");
  if (!(analysis.duration_s > 0.0) || analysis.duration_s > 1e9) values.refuse("duration_s");
  analysis.flags = values.count<std::uint32_t>("flags");
  analysis.missing = static_cast<std::size_t>(values.whole("missing", 0, kMostCount));
  analysis.interpolated = static_cast<std::size_t>(values.whole("interpolated", 0, kMostCount));
  if (auto measures = record::measures_of_json(values.json("measures"))) {
    analysis.measures = *measures;
  } else {
    values.refuse("measures");
  }
  return analysis;
}

}  // namespace

record::RecordedEvent to_record(const SwayTrialResult& result, const std::string& software) {
  record::RecordedEvent event{.event = "sway"};
  event.values.emplace_back("trial", std::int64_t{result.trial});
  event.values.emplace_back("attempt", std::int64_t{result.attempt});
  event.values.emplace_back("condition", result.condition);
  event.values.emplace_back("labels", record::to_json(result.labels));
  event.values.emplace_back("first_segment", std::int64_t{result.segment});
  event.values.emplace_back("first_scan", static_cast<std::int64_t>(result.first_scan.value));
  event.values.emplace_back("end_segment", std::int64_t{result.end_segment});
  event.values.emplace_back("end_scan", static_cast<std::int64_t>(result.end_scan.value));
  if (result.analysis) {
    add(event, *result.analysis, software);
  } else {
    event.values.emplace_back("problem", result.problem);
  }
  return event;
}

core::Result<SwayTrialResult> sway_of(const record::RecordedEvent& event) {
  record::EventValues values(event);
  SwayTrialResult result{.trial = values.count<std::uint32_t>("trial"),
                         .attempt = values.count<std::uint32_t>("attempt"),
                         .condition = values.text("condition"),
                         .segment = values.count<std::uint32_t>("first_segment"),
                         .first_scan = {values.count<std::uint64_t>("first_scan")},
                         .end_scan = {values.count<std::uint64_t>("end_scan")},
                         .end_segment = values.count<std::uint32_t>("end_segment")};
  if (auto labels = record::labels_of_json(values.json("labels"))) {
    result.labels = *labels;
  } else {
    values.refuse("labels");
  }
  if (values.find("problem") != nullptr) {
    result.problem = values.text("problem");
  } else {
    result.analysis = analysis_of(values);
  }
  if (auto checked = values.check(); !checked) return tl::make_unexpected(checked.error());
  return result;
}

}  // namespace dts::session
