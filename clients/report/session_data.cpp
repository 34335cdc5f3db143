// SPDX-License-Identifier: Apache-2.0
#include "report/session_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

#include "record/catalogue/catalogue.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "report/number_text.h"
#include "report/recorded_definitions.h"
#include "report/watched_recording.h"
#include "session/protocol.h"
#include "session/standing_load.h"

namespace dts::report {
namespace {

using posturography::Measure;

constexpr double kReadingShare = 0.5;  // fraction of the work, for the progress bar

core::Status read_part(const std::string& path, Waiting& waiting, const Share& share, SessionData& session) {
  const double middle = share.begin + (share.end - share.begin) / 3.0;
  DTS_TRY_ASSIGN(const auto opened, open_part(path, waiting, {.begin = share.begin, .end = middle}, session));
  const std::uint32_t number = opened->session() ? opened->session()->part : 1;
  if (!opened->find_stream("cop")) {
    return core::fail(core::ErrorCode::NotFound, "'" + path + "' has no centre of pressure and no reaches: nothing to report",
                      "choose a session of a floor platform or of a chair: dtsctl session list");
  }
  WatchedRecording recording(*opened, [&waiting] { return waiting.is_wanted(); });
  auto standing =
      session::read_recorded_standing(recording, [&](double fraction) { waiting.report({.begin = middle, .end = share.end}, fraction); });
  if (!waiting.is_wanted()) return interrupted();
  if (!standing) return tl::make_unexpected(standing.error());
  for (session::StandingTrial& trial : standing->trials) {
    const auto host_ns = recording.host_time_ns(trial.segment, trial.first_scan, standing->raw_rate_hz);
    TrialData added;
    if (const std::string* outcome = session.corrections.outcome(number, trial.trial, trial.attempt);
        outcome && *outcome != trial.outcome) {
      added.recorded_outcome = std::exchange(trial.outcome, *outcome);
    }
    added.begins_utc_ns = utc_of(host_ns, recording.session());
    added.recorded = std::move(trial);
    added.part = session.parts.size() - 1;
    session.trials.push_back(std::move(added));
  }
  // A resumed session has results for its parts; only results for the whole session are comparable with those computed here.
  for (session::SessionFigure& result : standing->live_results) session.summary.push_back(std::move(result));
  return {};
}

void compare_with_live(TrialData& trial) {
  if (!trial.recorded.live || !trial.recorded.live->analysis || !trial.analysis) return;
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    const auto live = trial.recorded.live->analysis->measures.get(measure);
    const auto computed = trial.analysis->measures.get(measure);
    if (live && (!computed || !is_same_value(*live, *computed))) trial.differing.emplace_back(posturography::info(measure).symbol);
  }
}

void analyse(TrialData& trial, const std::optional<double>& foot_length_mm) {
  trial.problem = trial.recorded.problem;
  if (!trial.problem.empty()) return;
  auto prepared = posturography::prepare(trial.recorded.cop, posturography::kReportPreparation);
  if (!prepared) {
    trial.problem = prepared.error().what;
    return;
  }
  trial.analysis = posturography::analyse(*prepared, foot_length_mm);
  if ((trial.analysis->flags & posturography::sway_flag::kShortRecord) == 0) trial.spectra = posturography::multitaper_spectra(*prepared);
  trial.prepared = std::move(*prepared);
  compare_with_live(trial);
}

void name_pages(std::vector<TrialData>& trials) {
  std::set<std::string> taken{"session"};
  std::uint64_t standing = 0;
  for (TrialData& trial : trials) {
    std::string name = trial.recorded.trial == 0 ? "standing-" + two_digits(++standing) : "trial-" + two_digits(trial.recorded.trial);
    if (trial.recorded.attempt > 1) name += "-attempt-" + std::to_string(trial.recorded.attempt);
    trial.page = name;
    for (std::uint64_t again = 2; !taken.insert(trial.page).second; ++again) trial.page = name + "-part-" + std::to_string(again);
  }
}

/// Summarises the trials that count, as the daemon does.
void summarise(SessionData& session) {
  const std::vector<session::SessionFigure> live = std::exchange(session.summary, {});
  std::vector<session::SwayTrialResult> results;
  std::vector<session::SwayTrialResult> all;
  for (const TrialData& trial : session.trials) {
    all.push_back({.trial = trial.recorded.trial,
                   .attempt = trial.recorded.attempt,
                   .condition = trial.recorded.condition,
                   .labels = trial.recorded.labels,
                   .segment = trial.recorded.segment,
                   .first_scan = trial.recorded.first_scan,
                   .end_scan = trial.recorded.end_scan,
                   .end_segment = trial.recorded.end_segment,
                   .analysis = trial.is_kept() ? trial.analysis : std::nullopt,
                   .problem = trial.problem,
                   .mean_load_n = session::mean_load_n(trial.recorded.cop)});
    if (trial.is_kept()) results.push_back(all.back());
  }
  session.summary = session::sway_summary(results);
  if (session.corrects_two_feet && session.facts) {
    session.load = session::standing_load(results, session.facts->fields);
    if (session.load) session.summary.push_back(session::to_figure(*session.load));
  }
  session.missing_quotients = session::missing_quotients(all);
  const auto is_corrected = [](const TrialData& trial) { return !trial.recorded_outcome.empty(); };
  if (session.parts.size() != 1 || std::ranges::any_of(session.trials, is_corrected)) return;
  for (const session::SessionFigure& result : live) {
    const auto found = std::ranges::find(session.summary, result.name, &session::SessionFigure::name);
    if (found != session.summary.end() && !is_same_value(found->value, result.value)) session.differing_results.push_back(result.name);
  }
}

std::optional<double> foot_length_mm(const std::optional<record::SessionFacts>& facts) {
  if (!facts) return std::nullopt;
  const auto length_cm = session::field_number(facts->fields, "foot_length_cm");
  if (length_cm && *length_cm > 5.0 && *length_cm < 50.0) return 10.0 * *length_cm;
  return std::nullopt;
}

}  // namespace

std::string TrialData::label(const std::string& name) const {
  const auto found = std::ranges::find(recorded.labels, name, &std::pair<std::string, std::string>::first);
  return found == recorded.labels.end() ? "" : found->second;
}

std::string TrialData::number() const {
  if (recorded.trial == 0) return page.starts_with("standing-") ? "standing " + page.substr(9) : "standing";
  return std::to_string(recorded.trial) + (recorded.attempt > 1 ? ", attempt " + std::to_string(recorded.attempt) : "");
}

core::Result<SessionData> read_session(const ReportSource& source, const ReportProgress& progress) {
  SessionData session;
  session.software = source.software;
  session.for_record = source.for_record;
  if (source.files.empty()) return core::fail(core::ErrorCode::InvalidArgument, "no recording for the report");
  Waiting waiting(progress);
  const std::vector<std::string> files = leading_files(source.files);
  const double share = kReadingShare / static_cast<double>(files.size());
  for (std::size_t part = 0; part < files.size(); ++part) {
    const double begin = share * static_cast<double>(part);
    DTS_TRY(read_part(files[part], waiting, {.begin = begin, .end = begin + share}, session));
  }
  if (session.facts) {
    const RecordedRig rig = recorded_rig(*session.facts);
    session.plate = rig.plate;
    session.is_force_plate = rig.is_force_plate;
    session.corrects_two_feet = rig.corrects_two_feet;
    session.foot_length_mm = foot_length_mm(session.facts);
  }
  name_pages(session.trials);
  for (std::size_t index = 0; index < session.trials.size(); ++index) {
    waiting.report({.begin = kReadingShare, .end = 0.9}, static_cast<double>(index) / static_cast<double>(session.trials.size()));
    if (!waiting.is_wanted()) return interrupted();
    analyse(session.trials[index], session.foot_length_mm);
  }
  summarise(session);
  return session;
}

}  // namespace dts::report
