// SPDX-License-Identifier: Apache-2.0
#include "report/page_parts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>

#include "core/join.h"
#include "report/number_text.h"
#include "report/result_names.h"
#include "session/session_events.h"

namespace dts::report {

namespace {

/// Returns "26 Nov 2026".
std::string day_text(std::int64_t utc_ns) {
  constexpr std::array<const char*, 12> kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::chrono::sys_time<std::chrono::nanoseconds> instant{std::chrono::nanoseconds(utc_ns)};
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(instant));
  return std::to_string(static_cast<unsigned>(date.day())) + " " + kMonths.at(static_cast<unsigned>(date.month()) - 1) + " " +
         std::to_string(static_cast<int>(date.year()));
}

std::string protocol_title(const SessionInfo& session) {
  return session.protocol.title.empty() ? session.facts->protocol : session.protocol.title;
}

}  // namespace

std::string session_title(const SessionInfo& session) {
  if (!session.facts) return "Quiet standing";
  std::vector<std::string> parts{session.facts->subject, protocol_title(session)};
  if (session.facts->started_utc_ns > 0) parts.push_back(day_text(session.facts->started_utc_ns));
  std::erase(parts, "");
  return core::join(parts);
}

std::string protocol_text(const SessionInfo& session) {
  if (!session.facts || session.facts->protocol.empty()) return "-";
  const std::string title = protocol_title(session);
  return title == session.facts->protocol ? title : title + " (" + session.facts->protocol + ")";
}

std::string condition_text(const SessionInfo& session, const std::string& condition) {
  if (condition.empty()) return "-";
  if (!session.protocol.trials) return condition;
  const auto& conditions = session.protocol.trials->conditions;
  const auto known = std::ranges::find(conditions, condition, &session::Condition::name);
  return known == conditions.end() || known->title.empty() ? condition : known->title;
}

Fact field_fact(const SessionInfo& session, const std::string& name, const std::string& value) {
  const auto known = std::ranges::find(session.protocol.fields, name, &session::ProtocolField::name);
  if (known == session.protocol.fields.end() || known->label.empty()) return {.name = name, .value = value};
  return {.name = known->label, .value = value + (known->unit.empty() ? "" : " " + known->unit)};
}

std::string labels_text(const TrialData& trial) {
  std::string text;
  for (const auto& [name, word] : trial.recorded.labels) {
    if (text.size() > 200) break;
    text += (text.empty() ? "" : ", ") + name + " " + word;
  }
  return text;
}

namespace {

/// Returns why a trial that was done does not count, or is shorter than planned; empty: it is whole.
std::string invalid_text(const TrialData& trial) {
  const std::string fault = fault_words(record::fault_of(session::to_event(session::SwayTrialResult{.analysis = trial.analysis}, "", "")));
  if (!fault.empty()) return ", not valid: " + fault;
  return trial.analysis->is_cut() ? ", cut short by a gap" : "";
}

}  // namespace

std::string outcome_text(const TrialData& trial) {
  if (trial.recorded.outcome.empty()) return trial.recorded.trial == 0 ? "no protocol" : "not ended: not valid";
  const std::string text = trial.recorded.outcome == "done" ? "done" + invalid_text(trial) : trial.recorded.outcome + ": not valid";
  return text + (trial.recorded_outcome.empty() ? "" : " (corrected; recorded: " + trial.recorded_outcome + ")");
}

std::string stance_text(const std::string& stance) {
  std::string text;
  for (const char letter : stance) text += letter == ',' ? std::string(", ") : std::string(1, letter == '=' ? ' ' : letter);
  return text;
}

std::string filter_text(const posturography::Analysis& analysis) {
  if (analysis.profile == posturography::Profile::AsIs) return "no filter";
  return "Butterworth low-pass of 4th order, 10 Hz, forward and backward";
}

std::vector<Fact> provenance_of(const SessionInfo& session, std::size_t first_part, std::size_t end_part, std::vector<Fact> of_rig) {
  std::vector<Fact> facts;
  for (std::size_t part = first_part; part < end_part && part < session.parts.size(); ++part) {
    const PartData& file = session.parts[part];
    const std::string proof = file.sha256.empty() ? "no SHA-256: the file is damaged" : file.state + ", SHA-256 " + file.sha256;
    facts.push_back({.name = "Recording", .value = file.file + ", " + proof});
  }
  const std::string computed = session.software.empty() ? "-" : session.software;
  if (!session.facts) {
    facts.push_back({.name = "Computed by", .value = computed + "; recorded by another program"});
    return facts;
  }
  const record::SessionFacts& about = *session.facts;
  facts.push_back({.name = "Recorded by", .value = about.software + "; computed by " + computed});
  std::string device = about.device_model.empty() ? "-" : about.device_model;
  if (!about.device_serial.empty()) device += ", serial " + about.device_serial;
  if (!about.firmware.empty()) device += ", firmware " + about.firmware;
  facts.push_back({.name = "Device", .value = device + " (" + about.device_uri + ")"});
  std::ranges::move(of_rig, std::back_inserter(facts));
  facts.push_back({.name = "Stages", .value = about.stages.empty() ? "-" : core::join(about.stages, "; ")});
  return facts;
}

std::vector<Fact> provenance_of(const SessionData& session, std::size_t first_part, std::size_t end_part) {
  std::vector<Fact> of_rig;
  if (session.is_force_plate) {
    of_rig.push_back({.name = "Calibration", .value = "of the force plate's maker, as in the recorded rig"});
  } else if (session.facts) {
    const std::string& id = session.facts->calibration_id;
    of_rig.push_back({.name = "Calibration", .value = id.empty() ? "none for this rig: the plate model is used" : id});
    of_rig.push_back({.name = "Two feet",
                      .value = session.corrects_two_feet
                                   ? "load and position are corrected for a person on two feet"
                                   : "not corrected: on two feet the load reads too low and sway slightly too small"});
  }
  return provenance_of(session, first_part, end_part, std::move(of_rig));
}

Notes provenance_notes(const std::vector<Fact>& facts) {
  Notes provenance{.title = "Source of the data", .items = {}};
  for (const Fact& fact : facts) provenance.items.push_back(fact.name + ": " + fact.value);
  return provenance;
}

namespace {

std::string platform_text(const SessionData& session) {
  if (session.is_force_plate) return "a force plate";
  if (!session.facts) return "a platform";
  return session.facts->kind == "chair" ? "an instrumented chair" : "a bending plate";
}

/// Returns "100.0 Hz", or "100.0 and 1000 Hz" if trials differ.
std::string rates_text(std::span<const TrialData> trials, double (*rate_hz)(const TrialData& trial)) {
  std::vector<std::string> rates;
  for (const TrialData& trial : trials) {
    if (!trial.analysis) continue;
    std::string rate = significant(rate_hz(trial));
    if (std::ranges::find(rates, rate) == rates.end()) rates.push_back(std::move(rate));
  }
  return core::join(rates, " and ") + " Hz";
}

}  // namespace

std::optional<Notes> methods_of(const SessionData& session, std::span<const TrialData> trials) {
  const auto analysed = std::ranges::find_if(trials, [](const TrialData& trial) { return trial.analysis.has_value(); });
  if (analysed == trials.end()) return std::nullopt;
  const posturography::Analysis& analysis = *analysed->analysis;
  std::string text = session.is_synthetic() ? "The data are synthetic, no person was measured: the centre of pressure was simulated for " +
                                                  platform_text(session)
                                            : "The centre of pressure was recorded with " + platform_text(session);
  if (session.facts && !session.facts->device_model.empty()) text += ", data acquisition by " + session.facts->device_model + ",";
  text += " at " + rates_text(trials, [](const TrialData& trial) { return trial.recorded.cop.rate_hz; });
  if (session.facts && !session.facts->software.empty()) text += " (" + session.facts->software + ")";
  text +=
      " and analysed at " + rates_text(trials, [](const TrialData& trial) { return trial.analysis->rate_hz; }) + " (" +
      filter_text(analysis) +
      "). Gaps of up to 50 ms were interpolated linearly, and the mean of each trial was subtracted. AP is positive forward, ML is "
      "positive to the right. Time-domain and spectral measures are defined as in Prieto et al. (1996), the 95 % prediction ellipse as in "
      "Schubert and Kirchner (2014), stabilogram diffusion as in Collins and De Luca (1993).";
  if (!session.software.empty()) text += " All measures were computed with " + session.software + ".";
  return Notes{
      .title = "Methods, for a paper",
      .items = {std::move(text),
                "Prieto TE et al. Measures of postural steadiness: differences between healthy young and elderly adults. IEEE Trans "
                "Biomed Eng 1996; 43: 956-966.",
                "Schubert P, Kirchner M. Ellipse area calculations and their applicability in posturography. Gait Posture 2014; 39: "
                "518-522.",
                "Collins JJ, De Luca CJ. Open-loop and closed-loop control of posture. Exp Brain Res 1993; 95: 308-318."}};
}

std::vector<std::string> session_alerts(const SessionInfo& session) {
  std::vector<std::string> alerts;
  if (session.is_synthetic()) {
    alerts.push_back("Synthetic data from a simulator (" + session.facts->device_uri + "). No person was measured.");
  }
  if (session.is_replayed()) {
    alerts.push_back("A recording was played on this rig (" + session.facts->device_uri + "). No person was measured in this session.");
  }
  for (const PartData& part : session.parts) {
    if (!part.damage.empty())
      alerts.push_back("The recording " + part.file + " is damaged (" + part.damage + "): only the undamaged part is shown.");
    if (!part.losses.empty()) alerts.push_back("The recording " + part.file + " has gaps: " + part.losses + ".");
  }
  return alerts;
}

std::vector<std::string> session_alerts(const SessionData& session) {
  std::vector<std::string> alerts = session_alerts(static_cast<const SessionInfo&>(session));
  if (session.load && session.load->is_doubtful()) alerts.push_back("Load: " + session.load->sentence() + ".");
  return alerts;
}

std::string accuracy_note(const SessionData& session) {
  std::string note = session.is_force_plate ? "Accuracy: that of the force plate; see its maker's data. "
                                            : "Accuracy: this kind of platform differed from a force plate by 1.05 mm (RMSE; thesis, Table "
                                              "4.2). ";
  note +=
      "The requirement for posturography platforms is 0.1 mm (ISPGR committee, Scoppa et al. 2013; Gagey). Small differences between "
      "trials "
      "may come from the platform.";
  if (session.is_synthetic()) note += " Synthetic data have the errors of the simulator instead.";
  return note;
}

}  // namespace dts::report
