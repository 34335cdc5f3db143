// SPDX-License-Identifier: Apache-2.0
#include "ctl/recording_view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <string_view>

#include "ctl/json.h"
#include "report/result_names.h"

namespace dts::ctl {

std::string shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string counted(std::uint64_t count, const std::string& thing) { return std::to_string(count) + " " + thing + (count == 1 ? "" : "s"); }

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array<std::string_view, 5> kUnits{"B", "kB", "MB", "GB", "TB"};
  double size = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; size >= 999.95 && unit + 1 < kUnits.size(); ++unit) size /= 1000.0;
  return cli::decimal(size, unit == 0 ? 0 : 1) + " " + std::string(kUnits[unit]);
}

LossSum sum_of(const v1::SessionPart& part) {
  LossSum sum;
  for (const v1::LossCount& loss : part.losses()) {
    sum.gaps += loss.gaps_total();
    sum.lost_scans += loss.lost_scans_total();
  }
  sum.is_unknown = part.is_loss_unknown();
  return sum;
}

LossSum sum_of(const v1::SessionRecord& session) {
  LossSum sum;
  for (const v1::SessionPart& part : session.parts()) {
    const LossSum lost = sum_of(part);
    sum.gaps += lost.gaps;
    sum.lost_scans += lost.lost_scans;
    sum.is_unknown = sum.is_unknown || lost.is_unknown;
  }
  return sum;
}

std::uint64_t valid_trials(const v1::SessionRecord& session) {
  std::uint64_t sum = 0;
  for (const v1::SessionPart& part : session.parts()) sum += part.valid_trials();
  return sum;
}

std::string loss_text(const LossSum& sum) {
  if (sum.gaps == 0) return sum.is_unknown ? "losses not known" : "";
  return (sum.is_unknown ? "at least " : "") + counted(sum.lost_scans, "scan") + " lost in " + counted(sum.gaps, "gap");
}

std::string losses_text(const v1::SessionPart& part) {
  std::string text = loss_text(sum_of(part));
  const char* separator = ": ";
  for (const v1::LossCount& loss : part.losses()) {
    const bool is_known = loss.reason() != v1::GAP_REASON_UNSPECIFIED;
    text += separator + (is_known ? enumerator_word(*v1::GapReason_descriptor(), loss.reason()) : std::string("unknown")) + " " +
            std::to_string(loss.gaps_total());
    separator = ", ";
  }
  return text;
}

std::string trials_text(std::uint64_t valid, std::uint64_t planned) {
  return valid == 0 && planned == 0 ? "" : std::to_string(valid) + " of " + std::to_string(planned) + " trials valid";
}

std::string utc_text(std::int64_t utc_ns) {
  if (utc_ns == 0) return "-";
  namespace time = std::chrono;
  const time::sys_time<time::seconds> instant{time::floor<time::seconds>(time::nanoseconds(utc_ns))};
  const auto day = time::floor<time::days>(instant);
  const time::year_month_day date(day);
  const time::hh_mm_ss clock(instant - day);
  const auto two = [](auto number) { return (number < 10 ? "0" : "") + std::to_string(number); };
  return std::to_string(static_cast<int>(date.year())) + "-" + two(static_cast<unsigned>(date.month())) + "-" +
         two(static_cast<unsigned>(date.day())) + " " + two(clock.hours().count()) + ":" + two(clock.minutes().count()) + ":" +
         two(clock.seconds().count());
}

std::string outcome_words(const v1::TrialStatus& trial) {
  const std::string outcome = enumerator_word(*v1::TrialOutcome_descriptor(), trial.last_outcome());
  const std::string fault = report::fault_words(trial.last_fault());
  return fault.empty() ? outcome : outcome + ", not valid: " + fault;
}

std::string trial_line(const v1::TrialStatus& trial, const std::string& rig) {
  if (trial.phase() == v1::TRIAL_PHASE_FINISHED) {
    const std::string trials = trial.of() == 1 ? "the trial has" : "all " + std::to_string(trial.of()) + " trials have";
    const bool is_good = trial.last_outcome() <= v1::TRIAL_OUTCOME_DONE && trial.last_fault() == v1::TRIAL_FAULT_UNSPECIFIED;
    const std::string last = is_good ? "" : "; the last one: " + outcome_words(trial);
    return cli::printable(trials + " ended" + last + "; end the session: dtsctl session stop" + (rig.empty() ? "" : " --rig " + rig));
  }
  const std::string phase = trial.phase() == 0 ? "-" : enumerator_word(*v1::TrialPhase_descriptor(), trial.phase());
  std::string line = trial.trial() == 0 ? "none of the " + std::to_string(trial.of()) + " trials has started"
                                        : "trial " + std::to_string(trial.trial()) + " of " + std::to_string(trial.of());
  if (trial.attempt() > 1) line += ", attempt " + std::to_string(trial.attempt());
  const bool is_ended = trial.last_trial() == trial.trial() && trial.last_attempt() == trial.attempt();
  if (trial.trial() > 0 && is_ended) line += ", " + outcome_words(trial);
  line += ", " + phase;
  if (trial.remaining_s() > 0.0) line += ", " + cli::duration(trial.remaining_s()) + " left";
  if (!trial.condition().empty()) line += ": " + trial.condition();
  if (!trial.next_condition().empty()) line += "; next " + trial.next_condition();
  if (trial.next_target_cm() > 0.0) line += " at " + cli::decimal(trial.next_target_cm(), 1) + " cm";
  if (trial.next_target_percent() > 0.0) line += " (" + cli::decimal(trial.next_target_percent(), 0) + " % of the arm's length)";
  return cli::printable(line);
}

std::string disk_line(const v1::DiskStatus& disk) {
  if (disk.state() == v1::DISK_STATE_UNSPECIFIED) return "";
  std::string line = bytes_text(disk.free_bytes()) + " free";
  if (!disk.directory().empty()) line += " in " + disk.directory();
  if (disk.recordable_s() > 0.0) line += ", room for " + cli::duration(disk.recordable_s());
  if (disk.state() != v1::DISK_STATE_FINE) line += ", " + enumerator_word(*v1::DiskState_descriptor(), disk.state());
  if (!disk.problem().empty()) line += ": " + disk.problem();
  return cli::printable(line);
}

cli::Cell state_cell(const std::string& word) {
  if (word == "complete" || word.starts_with("complete, ")) return {word, cli::Style::Good};
  return {word, word == "running" || word == "recording" ? cli::Style::Plain : cli::Style::Bad};
}

void print_recording(cli::Console& console, const v1::SessionInfo& session) {
  const v1::RecordingStatus& recording = session.recording();
  if (!recording.file().empty()) {
    const std::string part = recording.part() > 1 ? "part " + std::to_string(recording.part()) + ", " : "";
    console.out << cli::printable((recording.is_recording() ? "recording " : "recorded ") + part + bytes_text(recording.bytes()) + " in " +
                                  recording.file())
                << '\n';
  }
  const std::string lost = recording.lost_scans_total() > 0 ? counted(recording.lost_scans_total(), "scan") + " missing in the file" : "";
  for (const std::string& problem : {recording.problem(), lost}) {
    if (problem.empty()) continue;
    console.out << cli::styled(console, cli::Style::Bad, "the recording is incomplete: " + cli::printable(problem)) << '\n';
  }
}

void print_field(cli::Console& console, const std::string& label, const std::string& value) {
  if (value.empty()) return;
  constexpr std::size_t kLabelColumns = 12;
  const std::size_t column = std::max(kLabelColumns, label.size() + 1);
  console.out << cli::styled(console, cli::Style::Faint, label + std::string(column - label.size(), ' '))
              << cli::wrapped_at(console, column, cli::printable(value)) << '\n';
}

void print_recordings(cli::Console& console, const v1::StatusSnapshot& status) {
  for (const v1::RigStatus& rig : status.rigs()) {
    const v1::SessionInfo& session = rig.session();
    const bool is_shown = session.recording().is_recording() || !session.recording().problem().empty();
    if (is_shown) {
      console.out << cli::printable(rig.rig().name()) << ": ";
      print_recording(console, session);
    }
    const bool leads = session.rigs().empty() || session.rigs(0) == rig.rig().name();  // companions have the same trials
    if (leads && session.has_trial() && session.state() == v1::SESSION_STATE_RUNNING) {
      console.out << cli::printable(rig.rig().name()) << ": " << trial_line(session.trial(), rig.rig().name()) << '\n';
    }
  }
  if (const std::string disk = disk_line(status.disk()); !disk.empty()) {
    const cli::Style style = status.disk().state() == v1::DISK_STATE_FINE ? cli::Style::Plain : cli::Style::Bad;
    console.out << cli::styled(console, style, "disk: " + disk) << '\n';
  }
}

}  // namespace dts::ctl
