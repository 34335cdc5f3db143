// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <iterator>
#include <set>

#include "core/utf8.h"
#include "posturography/cop_series.h"
#include "report/number_text.h"
#include "report/page_parts.h"
#include "report/session_tables.h"
#include "report/stabilogram.h"

namespace dts::report {
namespace {

constexpr std::size_t kCellsInRow = 7;
constexpr double kCellMm = 27.0;
constexpr double kCellTextMm = 6.5;
constexpr double kMostHalfMm = 11.8;
constexpr std::size_t kMostPointsOfCell = 1200;

/// Returns the corrected value with the recorded one; without it for a person's record: it may be the ID of another person.
std::string with_recorded(const SessionInfo& session, record::CorrectedField field, const std::string& value) {
  if (session.for_record) return value;
  const auto first = std::ranges::find(session.corrections.all, field, &record::Correction::field);
  if (first == session.corrections.all.end() || first->old_value == value) return value;
  return value + " (corrected; recorded: " + (first->old_value.empty() ? "none" : first->old_value) + ")";
}

/// Returns the largest scale at which every path fits its cell; one scale for all, so that sizes are comparable.
double common_scale(const std::vector<const TrialData*>& trials) {
  double half_mm = 1.0;
  for (const TrialData* trial : trials) {
    const HalfExtent half = half_extent(*trial->prepared, ellipse_outline(*trial->prepared));
    half_mm = std::max({half_mm, half.ml_mm, half.ap_mm});
  }
  return kMostHalfMm / half_mm;
}

std::string cut(const std::string& text, double width_mm, double size) {
  if (text_width(text, size) <= width_mm) return text;
  std::string shorter = text;
  while (!shorter.empty() && text_width(shorter + "...", size) > width_mm) {
    while (!shorter.empty() && !core::starts_character(shorter.back())) shorter.pop_back();
    if (!shorter.empty()) shorter.pop_back();
  }
  return shorter + "...";
}

void draw_cells(Canvas& canvas, const SessionData& session, const std::vector<const TrialData*>& trials) {
  const double scale = common_scale(trials);
  const double pitch = kFullWidthMm / static_cast<double>(kCellsInRow);
  for (std::size_t index = 0; index < trials.size(); ++index) {
    const TrialData& trial = *trials[index];
    Canvas cell =
        canvas.group(pitch * static_cast<double>(index % kCellsInRow), (kCellMm + kCellTextMm) * static_cast<double>(index / kCellsInRow));
    cell.text(0.0, 2.2, cut(trial.number() + (trial.counts() ? "" : " (not valid)"), pitch - 2.0, 2.1), {.size = 2.1, .is_bold = true});
    cell.text(0.0, 4.8, cut(condition_text(session, trial.recorded.condition), pitch - 2.0, 1.9),
              {.size = 1.9, .colour = colour::kDarkGrey});
    const double side = kCellMm - 2.0;
    cell.rect(0.0, 5.6, side, side, colour::kNone, {.colour = colour::kGrey, .width = 0.15});
    draw_path(cell, side / 2.0, 5.6 + side / 2.0, scale, *trial.prepared, kMostPointsOfCell, 0.12);
  }
}

Figure small_multiples(const SessionData& session, const std::vector<const TrialData*>& trials) {
  const double rows = static_cast<double>((trials.size() + kCellsInRow - 1) / kCellsInRow);
  const double side_mm = (kCellMm - 2.0) / common_scale(trials);
  return {.title = "Stabilograms: top = front, right = right. Each frame is " + fixed(side_mm, 1) + " mm wide and high",
          .width_mm = kFullWidthMm,
          .height_mm = rows * (kCellMm + kCellTextMm),
          .draw = [trials, &session](Canvas& canvas) { draw_cells(canvas, session, trials); }};
}

Notes left_out(const SessionData& session) {
  Notes notes{.title = "Excluded trials", .items = {}};
  std::set<std::uint32_t> done;
  for (const TrialData& trial : session.trials) {
    if (trial.counts()) done.insert(trial.recorded.trial);
    if (trial.counts() || notes.items.size() >= 20) continue;
    std::string why = trial.is_kept() ? "" : outcome_text(trial);
    if (!trial.problem.empty()) why += (why.empty() ? "" : "; ") + trial.problem;
    if (trial.analysis && !trial.analysis->is_valid())
      why += (why.empty() ? "" : "; ") + std::string("invalid: the subject stepped off or moved the feet");
    notes.items.push_back("Trial " + trial.number() + ": " + why + ".");
  }
  for (const TrialData& trial : session.trials) {
    if (!trial.counts() || !trial.analysis->is_cut() || notes.items.size() >= 40) continue;
    notes.items.push_back("Trial " + trial.number() + ": samples are missing; only the longest part without a gap was analysed: " +
                          fixed(trial.analysis->duration_s, 1) +
                          " s. The trial is in a mean only if every trial of its condition has missing samples.");
  }
  std::string missing;
  std::size_t count = 0;
  for (std::uint32_t trial = 1; trial <= session.planned_trials; ++trial) {
    if (done.contains(trial)) continue;
    if (++count <= 20) missing += (missing.empty() ? "" : ", ") + std::to_string(trial);
  }
  if (count > 0) {
    notes.items.push_back(std::to_string(count) + " of " + std::to_string(session.planned_trials) +
                          " planned trials have no valid result: " + missing + (count > 20 ? ", ..." : "") + ".");
  }
  for (const auto& [stance, reason] : session.missing_quotients) {
    notes.items.push_back("No Romberg quotient" + (stance.empty() ? "" : " for " + stance_text(stance)) + ": " + reason + ".");
  }
  if (notes.items.empty()) notes.items.emplace_back("None.");
  return notes;
}

Notes differences(const SessionData& session) {
  Notes notes{.title = "Notes", .items = {}};
  std::size_t compared = 0;
  std::size_t differing = 0;
  for (const TrialData& trial : session.trials) {
    if (!trial.recorded.live) continue;
    ++compared;
    if (!trial.differing.empty()) ++differing;
  }
  if (differing > 0 || !session.differing_results.empty()) {
    notes.items.push_back("Live values of the daemon and values computed now differ by more than 1e-9 in " + std::to_string(differing) +
                          " of " + std::to_string(compared) + " trials and " + std::to_string(session.differing_results.size()) +
                          " results of the session.");
  } else if (compared > 0) {
    notes.items.push_back("Live and recomputed values match in " + std::to_string(compared) + (compared == 1 ? " trial." : " trials."));
  }
  notes.items.push_back(accuracy_note(session));
  return notes;
}

}  // namespace

std::vector<Fact> session_facts(const SessionInfo& session, std::size_t valid_trials, const std::vector<Fact>& of_rig) {
  if (!session.facts) return {{.name = "Recording", .value = session.parts.front().file}};
  const record::SessionFacts& about = *session.facts;
  const auto or_dash = [](const std::string& text) { return text.empty() ? std::string("-") : text; };
  std::vector<Fact> facts{{.name = "Session", .value = or_dash(about.session_id)},
                          {.name = "Subject ID", .value = with_recorded(session, record::CorrectedField::Subject, or_dash(about.subject))},
                          {.name = "Rig", .value = or_dash(about.rig)},
                          {.name = "Protocol", .value = protocol_text(session)},
                          {.name = "Started", .value = about.started_utc_ns > 0 ? utc_text(about.started_utc_ns) : "unknown"}};
  facts.push_back({.name = "Trials",
                   .value = std::to_string(valid_trials) +
                            (session.planned_trials > 0 ? " of " + std::to_string(session.planned_trials) : "") + " valid"});
  for (const auto& [name, value] : about.fields) {
    if (facts.size() < 16) facts.push_back(field_fact(session, name, value));
  }
  std::ranges::copy(of_rig, std::back_inserter(facts));
  if (session.for_record) return facts;
  if (!about.label.empty()) {
    facts.push_back({.name = "Label", .value = with_recorded(session, record::CorrectedField::Label, about.label)});
  }
  const std::string* const notes = session.corrections.value(record::CorrectedField::Notes);
  if (notes != nullptr && !notes->empty()) facts.push_back({.name = "Notes", .value = *notes});
  return facts;
}

Notes corrections_of(const SessionInfo& session) {
  Notes notes{.title = "Corrections", .items = {}};
  if (session.for_record) return notes;
  const auto value = [](const std::string& text) { return text.empty() ? std::string("none") : text; };
  for (const record::Correction& correction : session.corrections.all) {
    if (correction.field == record::CorrectedField::Deleted) continue;
    if (notes.items.size() == 20) {
      notes.items.emplace_back("More corrections: dtsctl session show ID.");
      break;
    }
    std::string what(record::name(correction.field));
    if (correction.field == record::CorrectedField::Subject) what = "subject ID";
    if (correction.field == record::CorrectedField::Outcome) {
      what += " of trial " + std::to_string(correction.trial) + ", attempt " + std::to_string(correction.attempt);
    }
    notes.items.push_back(what + ": " + value(correction.old_value) + " -> " + value(correction.new_value) + ", " +
                          utc_text(correction.utc_ns) + ", " + correction.who + ": " + correction.reason + ".");
  }
  return notes;
}

PageContent session_content(const SessionData& session, const SessionPageLimits& limits) {
  const auto valid = std::ranges::count_if(session.trials, [](const TrialData& trial) { return trial.counts(); });
  std::vector<Fact> of_rig;
  if (session.load) of_rig.push_back({.name = "Load", .value = session.load->sentence()});
  PageContent page{
      .title = session_title(session),
      .subtitle = "quiet standing",
      .facts = session_facts(session, static_cast<std::size_t>(valid), of_rig),
      .alerts = session_alerts(session),
      .sections = {},
  };
  page.sections.push_back({.columns = {{trial_table(session, limits.trials)}}});
  std::vector<const TrialData*> shown;
  std::size_t drawable = 0;
  for (const TrialData& trial : session.trials) {
    if (!trial.prepared) continue;
    ++drawable;
    if (shown.size() < limits.pictures) shown.push_back(&trial);
  }
  if (!shown.empty()) page.sections.push_back({.columns = {{small_multiples(session, shown)}}});
  if (drawable > shown.size()) {
    page.alerts.push_back(std::to_string(drawable - shown.size()) + " more stabilograms are only on the pages of their trials.");
  }
  Section tables{.columns = {{}}};
  for (Table& table : condition_tables(session)) tables.columns[0].push_back(std::move(table));
  page.sections.push_back(std::move(tables));
  Notes provenance = provenance_notes(provenance_of(session, 0, session.parts.size()));
  Section rest{.columns = {{}, {left_out(session), differences(session)}}};
  if (auto corrections = corrections_of(session); !corrections.items.empty()) rest.columns[1].push_back(std::move(corrections));
  if (auto decisions = decision_table(session, session.trials)) rest.columns[0].push_back(std::move(*decisions));
  if (auto romberg = romberg_table(session)) rest.columns[0].push_back(std::move(*romberg));
  rest.columns[rest.columns[0].empty() ? 0 : 1].push_back(std::move(provenance));
  if (auto methods = methods_of(session, session.trials)) rest.columns[0].push_back(std::move(*methods));
  page.sections.push_back(std::move(rest));
  return page;
}

}  // namespace dts::report
