// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::session {

/// Something that a protocol asks about the subject before it starts (thesis Table 6.1): measures, never names.
struct ProtocolField {
  std::string name;  ///< "arm_length_cm": the unit is part of it.
  std::string sentence;
  bool is_required = false;
  double minimum = 0.0;  ///< Of a number.
  double maximum = 0.0;
  std::vector<std::string> choices{};  ///< Not empty: one of these words instead of a number.

  friend bool operator==(const ProtocolField&, const ProtocolField&) = default;
};

/// One kind of trial: a target, a stance.
struct Condition {
  std::string name;                                           ///< "120", "max", "eyes-open-two-feet"
  std::vector<std::pair<std::string, std::string>> labels{};  ///< {"eyes", "open"}: go with every event of the trial.
  std::optional<double> target_percent;                       ///< Of the arm's length.
  bool is_maximum_reach = false;                              ///< The target stands at the subject's own maximum reach.

  friend bool operator==(const Condition&, const Condition&) = default;
};

enum class TrialOrder : std::uint8_t {
  AsListed,    ///< All repetitions of a round in the order of the conditions.
  Randomised,  ///< Every block is a shuffled multiset: each condition as often as any other, give or take one (thesis 6.3.3).
};

/// How the trials of a protocol run. Times in s; 0: at once, or none.
struct TrialPlan {
  std::vector<Condition> conditions{};
  std::uint32_t trials_per_block = 0;
  std::uint32_t blocks = 1;
  TrialOrder order = TrialOrder::AsListed;
  bool starts_by_itself = false;  ///< The next trial after the rest; false: on `session trial next`, as always the first one.
  double cue_delay_min_s = 0.0;   ///< From the trial's start to "Go": drawn evenly between the two, so that nobody anticipates it.
  double cue_delay_max_s = 0.0;
  double settle_s = 0.0;      ///< After the cue, before the trial counts (thesis 4.6: 5 s).
  double duration_s = 0.0;    ///< After settling; 0: until the next command.
  double rest_s = 0.0;        ///< After a trial.
  double block_rest_s = 0.0;  ///< After a block, instead.

  friend bool operator==(const TrialPlan&, const TrialPlan&) = default;
};

/// A protocol as a clinic writes it (config/protocols): checked values only.
struct Protocol {
  std::string name = "free";  ///< [a-z0-9-], at most 32
  std::string sentence;
  std::string rig_kind{};   ///< "floor", "chair"; empty: any.
  double settle_s = 0.0;    ///< Of the whole session; protocols with trials have it there.
  double duration_s = 0.0;  ///< 0: until stopped.
  std::vector<ProtocolField> fields{};
  std::optional<TrialPlan> trials;
  std::string definition;  ///< The file's text: recorded with every session.

  friend bool operator==(const Protocol&, const Protocol&) = default;
};

/// The protocol that always exists: records until it is stopped, asks for nothing.
[[nodiscard]] Protocol free_protocol();

/// Fails with InvalidArgument, naming the field: unknown, twice, missing though required, no number, out of range, none of the choices.
/// What was given is not repeated in the message, nor the name of an unknown field: it might be a person's. A condition at maximum reach
/// needs the field max_reach_cm, one in percent arm_length_cm; a target beyond the maximum reach is refused, since the thesis (6.3.3) and
/// caution ask nobody for it.
[[nodiscard]] core::Status check_fields(const Protocol& protocol, const std::vector<std::pair<std::string, std::string>>& fields);

/// A field's number; nothing when it is absent or none.
[[nodiscard]] std::optional<double> field_number(const std::vector<std::pair<std::string, std::string>>& fields, const std::string& name);

/// How far from the acromion a condition's target stands for this subject; nothing when it has no target or the field is missing.
[[nodiscard]] std::optional<double> target_cm(const Condition& condition, const std::vector<std::pair<std::string, std::string>>& fields);

}  // namespace dts::session
