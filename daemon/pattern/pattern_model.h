// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "pattern/discriminant.h"

namespace dts::pattern {

/// Whether a label can be distinguished from sway, by people left out of the training (docs/using.md: which group the sway resembles).
enum class Verdict : std::uint8_t {
  NotTold = 0,
  Told,
  ToldByOther,  ///< Another fact of the people, such as their age, distinguishes it clearly better.
};

/// A figure with its 95 % interval.
struct Interval {
  double value = 0.0;
  double low = 0.0;
  double high = 1.0;
};

/// How well a model predicts its label in people left out of the training. An absent number is not defined for this model.
struct Figures {
  std::string scheme;                ///< "leave one out" or "10 x 10-fold".
  Interval auc;                      ///< Area under the ROC curve, of people: the trials of one person are pooled.
  double auc_trials = 0.5;           ///< The same, of single trials.
  double equal_error_correct = 0.5;  ///< Share of correct trials where both kinds of error are equally frequent.
  double brier = 0.0;                ///< Of single trials.
  double brier_base = 0.0;           ///< If the share of each group is always predicted.
  std::optional<double> slope;       ///< Of the calibration: 1 is right, below 1 too confident. Only for two groups.
  double accuracy = 0.0;             ///< Share of correct trials.
  double balanced_accuracy = 0.0;    ///< Mean over groups of the share of correct trials.
  double commonest_share = 0.0;      ///< Share of correct trials if the most frequent group is always predicted.
  double permutation_p = 1.0;        ///< Share of random labels of the people that are distinguished as well.
  std::string best_measure;          ///< The measure that most folds chose as the best one.
  Interval best_auc;                 ///< Of people, by the best measure alone.
  Interval gain;                     ///< AUC of the model minus that of the best measure.
  std::string rival;                 ///< "height_cm with sex": other facts of the people; empty: none was compared.
  Interval rival_auc;                ///< Of people, by these facts alone.
  Interval rival_gain;               ///< AUC of the model minus that of the rival.
};

/// One group that the model distinguishes from the others, as it was in the training.
struct Group {
  std::size_t people = 0;
  std::size_t trials = 0;
  std::size_t moved = 0;  ///< Trials that were left out because the subject stepped off or moved the feet.
};

/// A discriminant with the facts needed to use it.
struct PatternModel {
  std::string label;        ///< The column that it predicts: "group60".
  std::string condition;    ///< Which rows of the table were used: "condition=ec_firm"; empty: all.
  std::string about;        ///< What a reader must know about the people; may be empty.
  std::string profile;      ///< Of all training rows; empty: unknown or mixed.
  double rate_hz = 0.0;     ///< At which all training rows were analysed; 0: unknown or mixed.
  double duration_s = 0.0;  ///< Of all training trials; 0: unknown or mixed.
  double noise_mm = 0.0;    ///< Noise of the rig (SD of one scan, each axis) that was added to the training.
  Discriminant discriminant;
  std::size_t rows = 0;
  std::size_t people = 0;
  std::vector<Group> groups;  ///< One per class.
  Verdict verdict = Verdict::NotTold;
  std::string told_by;  ///< If ToldByOther: "age".
  Figures figures;
};

/// Returns "told", "not told" or "told by age, not by sway".
[[nodiscard]] std::string verdict_text(const PatternModel& model);

/// Returns the model as JSON, format 2. Every number reads back as exactly the same double.
[[nodiscard]] std::string model_text(const PatternModel& model);

/// Largest size of a model's text, in bytes.
inline constexpr std::size_t kLongestModelText = std::size_t{256} << 10U;

/// Reads the text of `model_text`. Error messages use `name` for the file. Fails with InvalidArgument if the text is too long, is not such
/// JSON, has another format, has sizes that do not match, numbers out of range or unknown measures.
[[nodiscard]] core::Result<PatternModel> read_model_text(std::string_view text, const std::string& name);

}  // namespace dts::pattern
