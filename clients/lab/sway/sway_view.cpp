// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "cli/table.h"

namespace dts::lab::sway {
namespace {

using posturography::Analysis;
using posturography::Measure;

struct Group {
  const char* title;
  Measure first;
  Measure last;
};
constexpr std::array kGroups{
    Group{"Time domain", Measure::Mdist, Measure::Sd1Ml},
    Group{"Areas", Measure::AreaCc, Measure::AreaSw},
    Group{"Time domain, combined", Measure::Mfreq, Measure::Lfs},
    Group{"Velocity", Measure::VmaxAp, Measure::Aamv5sMl},
    Group{"Frequency, 0.15 to 5 Hz, eight sine tapers (MT8)", Measure::PowerRd, Measure::MpfResWelchhalf},
    Group{"Random walk", Measure::Msd100msRes, Measure::SdaTcMl},
    Group{"Entropy and direction", Measure::SampenAp, Measure::HcRate},
    Group{"Limits of stability", Measure::ApUse, Measure::ApUse},
};

constexpr std::array kOverview{Measure::Mvelo, Measure::Rdist, Measure::RangeAp, Measure::RangeMl, Measure::Pea95F, Measure::Mfreq};

std::string unit_text(std::string_view unit) { return unit == "1" ? std::string() : std::string(unit); }

void print_group(const Group& group, const Analysis& analysis, cli::Console& console) {
  cli::Table table({"SYMBOL", ">VALUE", "UNIT", "MEANING"});
  bool is_empty = true;
  for (auto k = static_cast<std::size_t>(group.first); k <= static_cast<std::size_t>(group.last); ++k) {
    const auto value = analysis.measures.get(static_cast<Measure>(k));
    if (!value) continue;
    const auto& about = posturography::info(static_cast<Measure>(k));
    table.add({{std::string(about.symbol)}, {significant(*value)}, {unit_text(about.unit)}, {std::string(about.sentence)}});
    is_empty = false;
  }
  if (is_empty) return;
  console.out << '\n' << cli::styled(console, cli::Style::Bold, group.title) << '\n';
  table.print(console);
}

std::vector<std::uint32_t> bits_of(std::uint32_t flags) {
  std::vector<std::uint32_t> bits;
  for (std::uint32_t k = 0; k < posturography::sway_flag::kCount; ++k) {
    if ((flags & (1U << k)) != 0) bits.push_back(1U << k);
  }
  return bits;
}

cli::Style style_of(std::uint32_t flag) { return (flag & posturography::sway_flag::kInvalid) != 0 ? cli::Style::Bad : cli::Style::Warning; }

void print_flags(const Analysis& analysis, cli::Console& console) {
  if (analysis.flags != 0) console.out << '\n';
  for (const std::uint32_t bit : bits_of(analysis.flags)) {
    const auto names = posturography::names_of(bit);
    const std::string_view flag = names.empty() ? std::string_view("?") : names.front();
    console.out << cli::styled(console, style_of(bit), flag) << ": " << posturography::sentence_of(bit) << '\n';
  }
  if (!analysis.is_valid()) {
    console.out << cli::styled(console, cli::Style::Bad, "This trial is not valid: do not use its values to judge steadiness.") << '\n';
  }
}

std::vector<cli::Cell> overview_row(const MeasuredTrial& trial) {
  std::vector<cli::Cell> row{{trial.title()}};
  if (!trial.analysis) {
    row.push_back({"-"});
    for (std::size_t k = 0; k < kOverview.size(); ++k) row.push_back({"-"});
    row.push_back({trial.problem, cli::Style::Warning});
    return row;
  }
  row.push_back({significant(trial.analysis->duration_s)});
  for (const Measure measure : kOverview) {
    const auto value = trial.analysis->measures.get(measure);
    row.push_back({value ? significant(*value, 4) : "-"});
  }
  std::string flags;
  for (const std::string_view flag : posturography::names_of(trial.analysis->flags))
    flags += (flags.empty() ? "" : " ") + std::string(flag);
  row.push_back({flags, style_of(trial.analysis->flags)});
  return row;
}

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

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return end.ec == std::errc() ? std::string(text.data(), end.ptr) : std::string("-");
}

void print_measures(const MeasuredTrial& trial, cli::Console& console) {
  console.out << cli::styled(console, cli::Style::Bold, cli::printable(trial.title())) << '\n';
  if (!trial.analysis) {
    console.out << cli::styled(console, cli::Style::Warning, cli::printable(trial.problem)) << '\n';
    return;
  }
  const Analysis& analysis = *trial.analysis;
  console.out << "profile " << posturography::name(analysis.profile) << ", " << significant(analysis.duration_s) << " s, "
              << analysis.samples << " samples at " << significant(analysis.rate_hz) << " Hz";
  if (analysis.missing > 0) console.out << ", " << analysis.missing << " missing, " << analysis.interpolated << " interpolated";
  console.out << '\n';
  for (const Group& group : kGroups) print_group(group, analysis, console);
  print_flags(analysis, console);
}

void print_overview(std::span<const MeasuredTrial> trials, cli::Console& console) {
  std::vector<std::string> headers{"TRIAL", ">s"};
  for (const Measure measure : kOverview) {
    const auto& about = posturography::info(measure);
    headers.push_back(">" + std::string(about.symbol) + " (" + std::string(about.unit) + ")");
  }
  headers.emplace_back("FLAGS");
  cli::Table table(headers);
  for (const MeasuredTrial& trial : trials) table.add(overview_row(trial));
  table.print(console);
}

void print_live(std::span<const MeasuredTrial> trials, cli::Console& console) {
  const auto compared = std::ranges::count_if(trials, [](const MeasuredTrial& trial) { return trial.is_as_recorded.has_value(); });
  const auto differing = std::ranges::count_if(trials, [](const MeasuredTrial& trial) { return !trial.is_as_recorded.value_or(true); });
  if (compared == 0) return;
  const std::string comparison =
      differing == 0 ? "live and recomputed values match" : std::to_string(differing) + " differ from the recomputed values";
  console.out << compared
              << " live results in the recording: " << cli::styled(console, differing == 0 ? cli::Style::Good : cli::Style::Bad, comparison)
              << '\n';
}

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
  if (trial.is_as_recorded) json["as_recorded"] = *trial.is_as_recorded;
  return json;
}

}  // namespace dts::lab::sway
