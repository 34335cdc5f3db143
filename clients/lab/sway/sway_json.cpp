// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lab/sway/sway_view.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Analysis;
using posturography::Measure;

/// Returns the settings of sample entropy and heading change: without them, these values are meaningless.
cli::Json settings(const Analysis& analysis, const SwayArguments& arguments) {
  cli::Json json = cli::Json::object();
  if (arguments.trim_s > 0.0) json["trim_s"] = arguments.trim_s;
  if (arguments.foot_length_mm) json["foot_length_mm"] = *arguments.foot_length_mm;
  const auto every = [&](double rate_hz) { return std::max(1.0, std::round(analysis.rate_hz / rate_hz)); };
  if (analysis.measures.has(Measure::SampenAp) || analysis.measures.has(Measure::SampenMl)) {
    const double step = every(20.0);
    const auto kept = static_cast<std::uint64_t>(std::ceil(static_cast<double>(analysis.samples) / step));
    json["sample_entropy"] = {{"m", 2}, {"r", 0.2}, {"rate_hz", analysis.rate_hz / step}, {"n", kept}};
  }
  if (analysis.measures.has(Measure::HcMeanabs)) json["heading"] = {{"rate_hz", analysis.rate_hz / every(25.0)}};
  return json;
}

void add_analysis(const Analysis& analysis, const SwayArguments& arguments, cli::Json& json) {
  json["profile"] = posturography::name(analysis.profile);
  cli::set_number(json, "fs_hz", analysis.rate_hz);
  json["n"] = analysis.samples;
  cli::set_number(json, "duration_s", analysis.duration_s);
  json["flags"] = cli::Json::array();
  for (const std::string_view flag : posturography::names_of(analysis.flags)) json["flags"].push_back(flag);
  json["valid"] = analysis.is_valid();
  json["missing"] = analysis.missing;
  json["interpolated"] = analysis.interpolated;
  json["estimator"] = "MT8";
  json["settings"] = settings(analysis, arguments);
  json["measures"] = cli::Json::object();
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto value = analysis.measures.get(static_cast<Measure>(k));
    if (!value) continue;
    const auto& about = posturography::info(static_cast<Measure>(k));
    json["measures"][std::string(about.symbol)] = {{"value", *value}, {"unit", about.unit}};
  }
}

}  // namespace

cli::Json to_json(const MeasuredTrial& trial, const SwayArguments& arguments) {
  cli::Json json{{"file", trial.file}};
  if (!trial.session.empty()) json["session"] = trial.session;
  if (!trial.subject.empty()) json["subject"] = trial.subject;
  if (trial.trial > 0) json["trial"] = trial.trial;
  if (trial.trial > 0) json["attempt"] = trial.attempt;
  if (trial.stretch > 0) json["stretch"] = trial.stretch;
  if (!trial.condition.empty()) json["condition"] = trial.condition;
  if (!trial.outcome.empty()) json["outcome"] = trial.outcome;
  if (!trial.labels.empty()) {
    for (const auto& [name, value] : trial.labels) json["labels"][name] = value;
  }
  if (trial.analysis) add_analysis(*trial.analysis, arguments, json);
  if (!trial.problem.empty()) json["problem"] = trial.problem;
  if (trial.is_as_told) json["as_recorded"] = *trial.is_as_told;
  return json;
}

}  // namespace dts::lab::steadiness
