// SPDX-License-Identifier: Apache-2.0
#include "fhir/recorded_session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "dts/wire/event_json.h"
#include "posturography/analysis.h"
#include "posturography/prepare.h"
#include "record/catalogue/corrections.h"
#include "record/catalogue/trial_collector.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "report/recorded_definitions.h"
#include "report/watched_recording.h"
#include "session/corrected_results.h"
#include "session/recorded_reaches.h"
#include "session/recorded_sway.h"
#include "session/session_events.h"

namespace dts::fhir {
namespace {

constexpr double kLargestUtcNs = 9e18;
constexpr std::size_t kMostPlaces = 1'000'000;

auto interrupted() { return core::fail(core::ErrorCode::Failed, "the export was interrupted: nothing was written"); }

/// What one pass over the items of a recording gives.
struct Items {
  record::TrialCollector trials;
  std::map<std::pair<std::uint32_t, std::uint64_t>, double> step_times_s{};  ///< Of steps of trials, by segment and scan.
  double first_time_s = std::numeric_limits<double>::infinity();             ///< Of the earliest scan.
};

core::Result<Items> read_items(record::Recording& recording, const std::function<bool(double)>& progress) {
  Items items{.trials = record::TrialCollector(recording.find_stream("raw"))};
  while (true) {
    DTS_TRY_ASSIGN(const auto item, recording.next());
    if (!item) return items;
    items.trials.add(*item);
    if (const auto* scans = std::get_if<record::RecordedScans>(&*item)) {
      items.first_time_s = std::min(items.first_time_s, scans->first_time_s);
    } else if (const auto* timed = std::get_if<record::TimedEvent>(&*item);
               timed != nullptr && timed->event.has_trial() && items.step_times_s.size() < kMostPlaces) {
      items.step_times_s[{timed->event.segment(), timed->event.scan()}] = timed->time_s;
    }
    const double done = static_cast<double>(recording.offset()) / std::max(1.0, static_cast<double>(recording.size()));
    if (!progress(done)) return interrupted();
  }
}

std::optional<std::int64_t> utc_of(double time_s, const record::SessionFacts& facts) {
  const double utc_ns = std::round(time_s * 1e9) + static_cast<double>(facts.utc_minus_monotonic_ns);
  if (facts.started_utc_ns <= 0 || !(utc_ns > 0.0 && utc_ns < kLargestUtcNs)) return std::nullopt;
  return static_cast<std::int64_t>(std::round(time_s * 1e9)) + facts.utc_minus_monotonic_ns;
}

Period period_of(const record::TrialRow& row, const Items& items, const record::SessionFacts& facts) {
  const auto utc_at = [&](std::uint32_t segment, std::uint64_t scan) -> std::optional<std::int64_t> {
    const auto found = items.step_times_s.find({segment, scan});
    return found == items.step_times_s.end() ? std::nullopt : utc_of(found->second, facts);
  };
  Period period{.begins_utc_ns = utc_at(row.segment, row.first_scan), .ends_utc_ns = utc_at(row.last_segment, row.last_scan)};
  if (period.begins_utc_ns && period.ends_utc_ns && *period.ends_utc_ns < *period.begins_utc_ns) period.ends_utc_ns.reset();
  return period;
}

/// Adds the attempts that were done at some time: others never were a result.
void add_trials(const Items& items, const record::Corrections& corrections, RecordedPart& part) {
  const std::uint32_t number = record::leading_part(part.facts);
  for (record::TrialRow& row : items.trials.rows()) {
    row.session_id = part.facts.session_id;
    row.part = number;
    bool was_done = row.outcome == "done";
    bool is_corrected = false;
    for (const record::Correction& one : corrections.all) {
      if (one.field != record::CorrectedField::Outcome || one.part != number || one.trial != row.trial || one.attempt != row.attempt)
        continue;
      is_corrected = true;
      was_done = was_done || one.new_value == "done";
      row.outcome = one.new_value;
    }
    part.has_corrected_outcomes = part.has_corrected_outcomes || is_corrected;
    if (!was_done) continue;
    const Period period = period_of(row, items, part.facts);
    part.trials.push_back({.row = std::move(row), .period = period, .is_corrected = is_corrected});
  }
}

/// Returns `is_wanted` for a WatchedRecording, which then fails; `is_interrupted` says that this was the reason.
std::function<bool()> watch(const std::function<bool()>& is_wanted, bool& is_interrupted) {
  return [&is_wanted, &is_interrupted] {
    is_interrupted = is_interrupted || !is_wanted();
    return !is_interrupted;
  };
}

bool lacks_result(const RecordedTrial& trial) { return trial.row.result.empty(); }

/// The result of the last trial may not have been recorded before the part was interrupted. It is computed as in the report.
core::Status analyse_standing(record::Recording& opened, const std::function<bool()>& is_wanted, RecordedPart& part) {
  bool is_interrupted = false;
  report::WatchedRecording recording(opened, watch(is_wanted, is_interrupted));
  DTS_TRY(recording.rewind());
  auto standing = session::read_recorded_standing(recording, [](double) {});
  if (is_interrupted) return interrupted();
  DTS_TRY(standing);
  for (RecordedTrial& trial : part.trials) {
    if (!lacks_result(trial)) continue;
    const auto found = std::ranges::find_if(standing->trials, [&trial](const session::StandingTrial& attempt) {
      return attempt.trial == trial.row.trial && attempt.attempt == trial.row.attempt;
    });
    if (found == standing->trials.end()) continue;
    session::SwayTrialResult result{.trial = found->trial,
                                    .attempt = found->attempt,
                                    .condition = found->condition,
                                    .labels = found->labels,
                                    .segment = found->segment,
                                    .first_scan = found->first_scan,
                                    .end_scan = found->end_scan,
                                    .end_segment = found->end_segment,
                                    .problem = found->problem};
    if (result.problem.empty()) {
      auto analysis = posturography::analyse(found->cop, {.preparation = posturography::kReportPreparation});
      if (analysis) result.analysis = std::move(*analysis);
      if (!analysis) result.problem = analysis.error().what;
    }
    trial.row.result = wire::to_json(session::to_event(result, part.facts.session_id, part.facts.software));
  }
  return {};
}

/// At the end of a session, dtsd judges its reaches again with the subject's own scale. A part that ended before lacks these results, and
/// that of its last trial. They are computed here as in the report, so that the bundle and its PDF have the same.
core::Status judge_reaches(record::Recording& opened, const std::function<bool()>& is_wanted, RecordedPart& part) {
  bool is_interrupted = false;
  report::WatchedRecording recording(opened, watch(is_wanted, is_interrupted));
  const auto model = report::recorded_trunk_model(*recording.session());
  DTS_TRY(recording.rewind());
  const auto reaches = session::read_recorded_reaches(recording, model ? &*model : nullptr, [](double) {});
  if (is_interrupted) return interrupted();
  DTS_TRY(reaches);
  for (RecordedTrial& trial : part.trials) {
    const auto found = std::ranges::find_if(reaches->attempts, [&trial](const session::RecordedReachTrial& attempt) {
      return attempt.trial == trial.row.trial && attempt.attempt == trial.row.attempt && attempt.result.has_value();
    });
    if (found != reaches->attempts.end()) trial.row.result = wire::to_json(session::to_event(*found->result, part.facts.session_id));
  }
  return {};
}

core::Status add_results(const std::string& path, const Items& items, RecordedPart& part) {
  part.results = items.trials.session_results();
  if (!part.has_corrected_outcomes) return {};
  const std::uint32_t number = record::leading_part(part.facts);
  record::SessionRow session{.id = part.facts.session_id, .rig = part.facts.rig};
  session.parts.push_back({.session_id = session.id, .part = number, .file = path, .leading_part = number});
  for (const RecordedTrial& trial : part.trials) session.trials.push_back(trial.row);
  DTS_TRY_ASSIGN(part.results, session::corrected_results(session));
  return {};
}

core::Result<RecordedPart> read_part(const std::string& path, const record::Corrections& corrections, const BundleProgress& progress) {
  DTS_TRY_ASSIGN(auto recording, record::Recording::open(path));
  if (!recording->session()) {
    return core::fail(core::ErrorCode::Unsupported, "'" + path + "' is not a recording of dtsd: it names no session",
                      "give a session of dtsd: dtsctl session list");
  }
  RecordedPart part{.facts = record::corrected(*recording->session(), corrections),
                    .file = std::filesystem::path(path).filename().string(),
                    .damage = recording->damage()};
  // Wrong values look plausible; only the checksums reveal them. A record must not have values from a damaged file.
  bool is_wanted = true;
  const auto verified = record::verify(path, [&](std::uint64_t done, std::uint64_t of) {
    is_wanted = progress(of > 0 ? 0.5 * static_cast<double>(done) / static_cast<double>(of) : 0.5);
    return is_wanted;
  });
  if (!is_wanted) return interrupted();
  if (!verified && part.damage.empty()) {
    return core::fail(verified.error().code, verified.error().what, "copy the undamaged part: dtsctl session recover " + path);
  }
  DTS_TRY_ASSIGN(const auto items, read_items(*recording, [&](double done) { return progress(0.5 + 0.5 * done); }));
  if (std::isfinite(items.first_time_s)) {
    part.period = {.begins_utc_ns = utc_of(items.first_time_s, part.facts),
                   .ends_utc_ns = utc_of(items.first_time_s + recording->duration_s(), part.facts)};
  }
  part.has_corrected_subject = corrections.value(record::CorrectedField::Subject) != nullptr;
  add_trials(items, corrections, part);
  part.is_interrupted = items.trials.session_results().empty() && std::ranges::any_of(items.trials.rows(), record::is_valid);
  const auto is_still_wanted = [&progress] { return progress(1.0); };
  if (part.is_interrupted && part.facts.kind == "chair") DTS_TRY(judge_reaches(*recording, is_still_wanted, part));
  if (part.is_interrupted && part.facts.kind != "chair" && recording->find_stream("cop") && std::ranges::any_of(part.trials, lacks_result))
    DTS_TRY(analyse_standing(*recording, is_still_wanted, part));
  DTS_TRY(add_results(path, items, part));
  return part;
}

}  // namespace

core::Result<RecordedSession> read_recorded_session(const std::vector<std::string>& files, const BundleProgress& progress) {
  if (files.empty()) return core::fail(core::ErrorCode::InvalidArgument, "no recording to export");
  const auto is_companion = [](const std::string& file) {
    const auto facts = record::read_session_facts(file);
    return facts && facts->leading_part != 0;
  };
  std::vector<std::string> leading;
  std::ranges::remove_copy_if(files, std::back_inserter(leading), is_companion);
  if (leading.empty()) leading = files;
  RecordedSession session;
  for (std::size_t index = 0; index < leading.size(); ++index) {
    if (index == 0) {
      if (const auto facts = record::read_session_facts(leading.front())) {
        DTS_TRY_ASSIGN(session.corrections, record::corrections_beside(leading.front(), *facts));
      }
    }
    const auto count = static_cast<double>(leading.size());
    DTS_TRY_ASSIGN(auto part, read_part(leading[index], session.corrections,
                                        [&](double done) { return progress((static_cast<double>(index) + done) / count); }));
    session.parts.push_back(std::move(part));
    if (session.parts.back().facts.session_id != session.parts.front().facts.session_id) {
      return core::fail(core::ErrorCode::Unsupported, "'" + leading[index] + "' is of another session", "export one session at a time");
    }
  }
  // Results of a part are not those of the session: an interrupted part has none, and the last part has those of its own trials.
  if (session.parts.size() > 1) {
    for (RecordedPart& part : session.parts) part.results.clear();
  }
  return session;
}

}  // namespace dts::fhir
