// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace dts::session {

/// The texts of a protocol, condition or field in another language than English; what is empty has no translation.
struct Translation {
  std::string language;  ///< "de"
  std::string title{};
  std::string sentence{};
  std::string label{};
  std::string unit{};  ///< Only for a unit that is a word: "years".
  std::string help{};
  std::vector<std::string>
      choices{};  ///< As many as the field has, in its order: what a form shows. The recorded value stays the English word.

  friend bool operator==(const Translation&, const Translation&) = default;
};

/// A value that a protocol requests about the subject before the session starts (thesis Table 6.1): body measures, never names.
struct ProtocolField {
  std::string name;     ///< "arm_length_cm": includes the unit.
  std::string label{};  ///< "Arm length": how a form names the field.
  std::string unit{};   ///< "cm"; empty: none.
  std::string help{};   ///< One sentence; may be empty.
  bool is_required = false;
  double minimum = 0.0;  ///< For a number.
  double maximum = 0.0;
  std::vector<std::string> choices{};  ///< If not empty, the value is one of these words and not a number.
  std::vector<Translation> translations{};

  friend bool operator==(const ProtocolField&, const ProtocolField&) = default;
};

/// The label of every event of a trial in which the subject sees the own COP on the patient screen. Feedback changes sway, so that such
/// trials are never mixed with others.
inline constexpr const char* kFeedbackLabel = "feedback";
inline constexpr const char* kCopFeedback = "cop";
/// The name of a condition with feedback ends so, and no other name: results of both are kept apart by name in every table and trend.
inline constexpr std::string_view kFeedbackEnding = "-feedback";

/// One kind of trial, for example a target or a stance.
struct Condition {
  std::string name;                                           ///< "120", "max", "eyes-open-two-feet"
  std::string title{};                                        ///< "Eyes open, two feet"
  std::vector<std::pair<std::string, std::string>> labels{};  ///< {"eyes", "open"}: part of every event of the trial.
  std::optional<double> target_percent;                       ///< In percent of the arm length.
  bool is_maximum_reach = false;                              ///< The target is at the subject's own maximum reach.
  std::vector<Translation> translations{};

  friend bool operator==(const Condition&, const Condition&) = default;
};

enum class TrialOrder : std::uint8_t {
  AsListed,    ///< Repeats the conditions in the order of the list, across blocks.
  Randomised,  ///< Each block is shuffled; the counts of any two conditions in it differ by at most one (thesis 6.3.3).
};

/// How the trials of a protocol run. Times in s; 0: no delay, no limit or no rest.
struct TrialPlan {
  std::vector<Condition> conditions{};
  std::uint32_t trials_per_block = 0;
  std::uint32_t blocks = 1;
  TrialOrder order = TrialOrder::AsListed;
  bool starts_by_itself = false;  ///< Starts the next trial after the rest. false, and for the first trial: waits for `session trial next`.
  double cue_delay_min_s = 0.0;   ///< From the trial's start to "Go"; random up to the maximum, so that nobody anticipates the cue.
  double cue_delay_max_s = 0.0;
  double settle_s = 0.0;      ///< After the cue, before the measurement starts (thesis 4.6: 5 s).
  double duration_s = 0.0;    ///< After settling; 0: until the next command.
  double rest_s = 0.0;        ///< After each trial.
  double block_rest_s = 0.0;  ///< After the last trial of a block, in place of `rest_s`.

  friend bool operator==(const TrialPlan&, const TrialPlan&) = default;
};

/// A protocol as the clinic writes it (config/protocols), with checked values.
struct Protocol {
  std::string name = "free";  ///< [a-z0-9-], at most 32
  std::string title{};        ///< "Romberg's test"
  std::string sentence{};     ///< What the protocol does.
  std::string rig_kind{};     ///< "floor", "chair"; empty: any.
  double settle_s = 0.0;      ///< For the whole session; a protocol with trials sets it per trial.
  double duration_s = 0.0;    ///< 0: until stopped.
  std::vector<ProtocolField> fields{};
  std::optional<TrialPlan> trials;
  std::vector<Translation> translations{};
  std::string definition;  ///< The file's text, recorded with every session.

  friend bool operator==(const Protocol&, const Protocol&) = default;
};

/// Returns the protocol that always exists: it records until it is stopped and has no fields.
[[nodiscard]] Protocol free_protocol();

/// Fails with InvalidArgument, naming the field, if it is unknown, duplicate, missing though required, not a number, out of range or not
/// one of the choices. The message repeats no value, and the name of an unknown field only if it looks like one: others could be a person's
/// name. A condition at maximum reach needs the field max_reach_cm; a condition in percent needs arm_length_cm. Rejects a target beyond the
/// maximum reach, for safety and as in the thesis (6.3.3).
[[nodiscard]] core::Status check_fields(const Protocol& protocol, const std::vector<std::pair<std::string, std::string>>& fields);

/// Returns whether the subject sees the own COP in trials of this condition.
[[nodiscard]] bool has_feedback(const Condition& condition);

/// Returns a field's number; nothing if the field is absent or not a number.
[[nodiscard]] std::optional<double> field_number(const std::vector<std::pair<std::string, std::string>>& fields, const std::string& name);

/// Returns the distance in cm from the acromion to the condition's target for this subject; nothing without a target or the field.
[[nodiscard]] std::optional<double> target_cm(const Condition& condition, const std::vector<std::pair<std::string, std::string>>& fields);

/// Returns the same in percent of the arm length; nothing without a target or if the arm length is unknown.
[[nodiscard]] std::optional<double> target_percent(const Condition& condition,
                                                   const std::vector<std::pair<std::string, std::string>>& fields);

}  // namespace dts::session
