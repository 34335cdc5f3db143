// SPDX-License-Identifier: Apache-2.0
// Protocols, as a clinic writes them and as recordings bring them along. One that is accepted is bounded and can be run.
#include <cmath>

#include "files/protocol_file.h"
#include "fuzz/fuzz_support.h"
#include "session/trial_run.h"

namespace dts::fuzz::protocol {
namespace {

constexpr double kLongestPhaseS = 3600.0;

bool is_word(const std::string& text) {
  return !text.empty() && text.size() <= 32 && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") == std::string::npos;
}

void check_plan(const session::TrialPlan& plan) {
  for (const double time_s : {plan.cue_delay_min_s, plan.cue_delay_max_s, plan.settle_s, plan.duration_s, plan.rest_s, plan.block_rest_s}) {
    promise(time_s >= 0.0 && time_s <= kLongestPhaseS, "a phase has at most an hour");
  }
  const auto trials = session::make_plan(plan, 7);
  promise(!trials.empty() && trials.size() <= session::kMostTrials, "a plan has trials, at most 10000");
  promise(trials.size() == std::size_t{plan.blocks} * plan.trials_per_block, "all trials are in the plan");
  for (const session::PlannedTrial& trial : trials) {
    promise(trial.condition < plan.conditions.size(), "a trial has a condition");
    promise(trial.cue_delay_s >= plan.cue_delay_min_s - 1e-3 && trial.cue_delay_s <= plan.cue_delay_max_s + 1e-3,
            "a delay as the plan says");
  }
}

/// What a person may answer: the field's ends, and a word that is nobody's.
void check_fields(const session::Protocol& protocol) {
  std::vector<std::pair<std::string, std::string>> lowest;
  for (const session::ProtocolField& field : protocol.fields) {
    promise(is_word(field.name) && !field.label.empty() && field.unit.size() <= 16, "a field has a name, a label and a short unit");
    promise(!field.choices.empty() || (std::isfinite(field.minimum) && field.minimum <= field.maximum), "a field has a range");
    lowest.emplace_back(field.name, field.choices.empty() ? std::to_string(field.minimum) : field.choices.front());
  }
  (void)session::check_fields(protocol, lowest);
  promise(!session::check_fields(protocol, {{"no such field!", "1"}}), "an unknown field is refused");
  if (!protocol.trials) return;
  for (const session::Condition& condition : protocol.trials->conditions) {
    promise(is_word(condition.name) && condition.labels.size() <= 8, "a condition has a name and few labels");
    const auto target = session::target_cm(condition, lowest);
    promise(!target || std::isfinite(*target), "a target is a number");
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = fuzz::text_of(bytes, size);
  files::Problems problems;
  const session::Protocol protocol = files::read_protocol_text(text, "protocol.toml", problems);
  for (const files::Problem& problem : problems) promise(!problem.text.empty(), "a problem says what it is");
  if (!problems.empty()) return;
  promise(is_word(protocol.name) && protocol.title.size() <= 64 && protocol.sentence.size() <= 200,
          "a protocol has a name, a title and a sentence");
  promise(protocol.duration_s >= 0.0 && protocol.settle_s >= 0.0 && std::isfinite(protocol.duration_s), "times are times");
  promise(protocol.fields.size() <= 32, "at most 32 fields");
  if (protocol.trials) check_plan(*protocol.trials);
  check_fields(protocol);
  promise(files::read_protocol_text(protocol.definition, "protocol.toml", problems) == protocol, "what a recording keeps is the protocol");
}

}  // namespace dts::fuzz::protocol

DTS_FUZZ_TARGET(protocol)
