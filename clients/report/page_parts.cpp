// SPDX-License-Identifier: Apache-2.0
#include "report/page_parts.h"

#include "core/join.h"
#include "report/number_text.h"

namespace dts::report {

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
  namespace flag = posturography::sway_flag;
  if (!trial.analysis) return ", not valid: no values";
  if ((trial.analysis->flags & flag::kSteppedOff) != 0) return ", not valid: stepped off";
  if (!trial.analysis->is_valid()) return ", not valid: feet moved";
  return (trial.analysis->flags & flag::kCutAtGap) != 0 ? ", cut short by a gap" : "";
}

}  // namespace

std::string outcome_text(const TrialData& trial) {
  if (trial.recorded.outcome.empty()) return trial.recorded.trial == 0 ? "no protocol" : "not ended: not valid";
  if (trial.recorded.outcome != "done") return trial.recorded.outcome + ": not valid";
  return "done" + invalid_text(trial);
}

std::string stance_text(const std::string& stance) {
  std::string text;
  for (const char letter : stance) text += letter == ',' ? std::string(", ") : std::string(1, letter == '=' ? ' ' : letter);
  return text;
}

std::string filter_text(const posturography::Analysis& analysis) {
  if (analysis.profile == posturography::Profile::AsIs) return "none";
  return "Butterworth low-pass of 4th order, 10 Hz, forward and backward";
}

std::vector<Fact> provenance_of(const SessionData& session, std::size_t first_part, std::size_t end_part) {
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
  facts.push_back(
      {.name = "Calibration", .value = about.calibration_id.empty() ? "none for this rig: the plate model is used" : about.calibration_id});
  facts.push_back({.name = "Two feet",
                   .value = session.corrects_two_feet ? "load and position are corrected for a person on two feet"
                                                      : "not corrected: on two feet the load reads too low and sway slightly too small"});
  facts.push_back({.name = "Stages", .value = about.stages.empty() ? "-" : core::join(about.stages, "; ")});
  return facts;
}

std::vector<std::string> session_alerts(const SessionData& session) {
  std::vector<std::string> alerts;
  if (session.is_synthetic()) {
    alerts.push_back("Synthetic data from a simulator (" + session.facts->device_uri + "). No person was measured.");
  }
  if (session.load && session.load->is_doubtful()) alerts.push_back("Load: " + session.load->sentence() + ".");
  for (const PartData& part : session.parts) {
    if (!part.damage.empty())
      alerts.push_back("The recording " + part.file + " is damaged (" + part.damage + "): only the undamaged part is shown.");
    if (!part.losses.empty()) alerts.push_back("The recording " + part.file + " has gaps: " + part.losses + ".");
  }
  return alerts;
}

std::string accuracy_note(const SessionData& session) {
  std::string note =
      "Accuracy: this kind of platform differed from a force plate by 1.05 mm (RMSE; thesis, Table 4.2). The requirement for "
      "posturography platforms is 0.1 mm (ISPGR committee, Scoppa et al. 2013; Gagey). Small differences between trials may come from "
      "the platform.";
  if (session.is_synthetic()) note += " Synthetic data have the errors of the simulator instead.";
  return note;
}

}  // namespace dts::report
