// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stage_registry.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/join.h"
#include "core/suggest.h"
#include "pipeline/stages/classify.h"
#include "pipeline/stages/cop.h"
#include "pipeline/stages/force_cop.h"
#include "pipeline/stages/force_plate.h"
#include "pipeline/stages/guard.h"
#include "pipeline/stages/linearise.h"
#include "pipeline/stages/reach.h"
#include "pipeline/stages/steadiness.h"
#include "pipeline/stages/transient.h"
#include "pipeline/stages/window_filter.h"

namespace dts::pipeline {
namespace {

template <class AStage>
constexpr StageEntry entry() {
  return {.describe = &AStage::description,
          .create = [](const StageOptions& options, const StageContext& context) -> std::unique_ptr<Stage> {
            return std::make_unique<AStage>(options, context);
          }};
}

constexpr std::array kStages = {
    entry<Guard>(),     entry<WindowFilter>(), entry<Linearise>(), entry<Cop>(),        entry<Steadiness>(),
    entry<Transient>(), entry<Reach>(),        entry<Classify>(),  entry<ForcePlate>(), entry<ForceCop>(),
};

const StageEntry* find_stage(std::string_view id) {
  const auto found = std::ranges::find_if(kStages, [id](const StageEntry& candidate) { return candidate.describe().id == id; });
  return found == kStages.end() ? nullptr : &*found;
}

std::string shortest(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string check_number(const OptionDescription& option, double value) {
  std::ostringstream text;
  if (!(value >= option.minimum && value <= option.maximum)) {  // also rejects NaN
    text << "is " << value << "; the range is " << option.minimum << " to " << option.maximum;
  } else if (option.is_whole && value != std::floor(value)) {
    text << "is " << value << "; it must be a whole number from " << option.minimum << " to " << option.maximum;
  }
  return text.str();
}

/// Returns the problem with `value` as the end of a sentence about the option; empty if there is none.
std::string check_value(const OptionDescription& option, const OptionValue& value) {
  const std::string* const word = std::get_if<std::string>(&value);
  if (option.choices.empty()) {
    return word == nullptr ? check_number(option, std::get<double>(value)) : "must be a number, not the word '" + *word + "'";
  }
  if (word == nullptr) return "must be a word (" + core::join(option.choices) + "), not a number";
  if (std::ranges::find(option.choices, *word) != option.choices.end()) return {};
  return "cannot be '" + *word + "'; " + core::known_words_hint(*word, option.choices);
}

/// Returns the problem with one option as a sentence; empty if there is none.
std::string check_option(const StageDescription& stage, const std::string& name, const OptionValue& value) {
  const auto option = std::ranges::find(stage.options, name, &OptionDescription::name);
  if (option == stage.options.end()) {
    std::vector<std::string_view> known(stage.options.size());
    std::ranges::transform(stage.options, known.begin(), &OptionDescription::name);
    return "unknown option '" + name + "' of stage " + std::string(stage.id) + "; " + core::known_words_hint(name, known);
  }
  const std::string problem = check_value(*option, value);
  return problem.empty() ? problem : "option '" + name + "' of stage " + std::string(stage.id) + " " + problem;
}

OptionValue default_of(const OptionDescription& option) {
  if (option.choices.empty()) return option.default_value;
  return std::string(option.choices.front());
}

}  // namespace

std::span<const StageEntry> stage_registry() { return kStages; }

std::vector<std::string> check_stage(const StageConfig& config) {
  const StageEntry* const found = find_stage(config.id);
  if (found == nullptr) {
    std::vector<std::string_view> known(kStages.size());
    std::ranges::transform(kStages, known.begin(), [](const StageEntry& candidate) { return candidate.describe().id; });
    return {"unknown stage '" + config.id + "'; " + core::known_words_hint(config.id, known)};
  }
  std::vector<std::string> problems;
  for (const auto& [name, value] : config.options) {
    std::string problem = check_option(found->describe(), name, value);
    if (!problem.empty()) problems.push_back(std::move(problem));
  }
  return problems;
}

std::string stage_text(const StageConfig& config) {
  std::string text = config.id;
  const StageEntry* const found = find_stage(config.id);
  if (found == nullptr) return text;
  for (const OptionDescription& option : found->describe().options) {
    const auto given = config.options.find(option.name);
    const OptionValue value = given != config.options.end() ? given->second : default_of(option);
    const double* const number = std::get_if<double>(&value);
    text += " " + std::string(option.name) + "=" + (number != nullptr ? shortest(*number) : std::get<std::string>(value));
  }
  return text;
}

core::Result<std::unique_ptr<Stage>> create_stage(const StageConfig& config, const StageContext& context) {
  if (const auto problems = check_stage(config); !problems.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, core::join(problems, "\n"));
  }
  const StageEntry& found = *find_stage(config.id);
  auto values = config.options;
  for (const OptionDescription& option : found.describe().options) values.try_emplace(std::string(option.name), default_of(option));
  return found.create(StageOptions(std::move(values)), context);
}

}  // namespace dts::pipeline
