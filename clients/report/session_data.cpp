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

constexpr double kSameValue = 1e-9;
constexpr double kReadingShare = 0.5;  // fraction of the work, for the progress bar
constexpr double kLargestUtcNs = 9e18;

/// The range [begin, end) of the progress for one part.
struct Share {
  double begin = 0.0;
  double end = 1.0;
};

/// Remembers that the report was stopped, because the callbacks below cannot.
class Waiting {
 public:
  Waiting(const ReportProgress& progress) : progress_(progress) {}
  void report(const Share& share, double fraction) {
    if (is_wanted_) is_wanted_ = progress_(share.begin + (share.end - share.begin) * std::clamp(fraction, 0.0, 1.0));
  }
  [[nodiscard]] bool is_wanted() const noexcept { return is_wanted_; }

 private:
  const ReportProgress& progress_;
  bool is_wanted_ = true;
};

auto interrupted() { return core::fail(core::ErrorCode::Failed, "the report was interrupted: no page was written"); }

core::Result<PartData> check_part(const std::string& path, const record::Recording& recording, Waiting& waiting, const Share& share) {
  PartData part{.file = std::filesystem::path(path).filename().string(),
                .sha256 = {},
                .damage = recording.damage(),
                .losses = to_text(recording.losses())};
  // Wrong values look like correct ones: only the checksums show damage. A value in a report must not be from a damaged file.
  const auto verified = record::verify(path, [&](std::uint64_t done, std::uint64_t of) {
    waiting.report(share, of > 0 ? static_cast<double>(done) / static_cast<double>(of) : 1.0);
    return waiting.is_wanted();
  });
  if (!waiting.is_wanted()) return interrupted();
  if (verified) {
    part.sha256 = verified->sha256;
    part.state = record::name(record::state_of(*verified, path));
  } else if (part.damage.empty()) {
    return core::fail(verified.error().code, verified.error().what, "copy the undamaged part: dtsctl session recover " + path);
  }
  return part;
}

std::optional<std::int64_t> utc_of(const std::optional<std::int64_t>& host_ns, const std::optional<record::SessionFacts>& facts) {
  if (!host_ns || !facts || facts->started_utc_ns <= 0) return std::nullopt;
  const double sum = static_cast<double>(*host_ns) + static_cast<double>(facts->utc_minus_monotonic_ns);
  if (!(std::abs(sum) < kLargestUtcNs)) return std::nullopt;
  return *host_ns + facts->utc_minus_monotonic_ns;
}

core::Status read_part(const std::string& path, Waiting& waiting, const Share& share, SessionData& session) {
  DTS_TRY_ASSIGN(auto opened, record::Recording::open(path));
  const double middle = share.begin + (share.end - share.begin) / 3.0;
  if (session.parts.empty() && opened->session()) {
    DTS_TRY_ASSIGN(session.corrections, record::corrections_beside(path, *opened->session()));
    session.facts = record::corrected(*opened->session(), session.corrections);
  }
  const std::uint32_t number = opened->session() ? opened->session()->part : 1;
  if (!opened->find_stream("cop")) {
    return core::fail(core::ErrorCode::NotFound, "'" + path + "' has no centre of pressure: reports exist only for the floor platform",
                      "for a session of the chair, show the results: dtsctl session show ID");
  }
  DTS_TRY_ASSIGN(auto part, check_part(path, *opened, waiting, {.begin = share.begin, .end = middle}));
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
    added.part = session.parts.size();
    session.trials.push_back(std::move(added));
  }
  // A resumed session has results for its parts; only results for the whole session are comparable with those computed here.
  for (session::SessionFigure& result : standing->live_results) session.summary.push_back(std::move(result));
  session.parts.push_back(std::move(part));
  return {};
}

/// Returns the files of the rig that leads the session: the trials and results are those of its recordings. Files of companions alone stay.
std::vector<std::string> leading_files(const std::vector<std::string>& files) {
  std::vector<std::string> leading;
  std::ranges::copy_if(files, std::back_inserter(leading), [](const std::string& file) {
    const auto facts = record::read_session_facts(file);
    return !facts || facts->leading_part == 0;
  });
  return leading.empty() ? files : leading;
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

bool is_same_value(double a, double b) noexcept { return std::abs(a - b) <= kSameValue * std::max(std::abs(a), std::abs(b)); }

std::string TrialData::label(const std::string& name) const {
  const auto found = std::ranges::find(recorded.labels, name, &std::pair<std::string, std::string>::first);
  return found == recorded.labels.end() ? "" : found->second;
}

std::string TrialData::number() const {
  if (recorded.trial == 0) return page.starts_with("standing-") ? "standing " + page.substr(9) : "standing";
  return std::to_string(recorded.trial) + (recorded.attempt > 1 ? ", attempt " + std::to_string(recorded.attempt) : "");
}

std::string SessionData::session_id() const { return facts ? facts->session_id : ""; }

core::Result<SessionData> read_session(const ReportSource& source, const ReportProgress& progress) {
  SessionData session{.software = source.software};
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
    session.protocol = recorded_protocol(*session.facts);
    session.planned_trials = planned_trials(*session.facts);
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
