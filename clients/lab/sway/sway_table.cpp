// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <vector>

#include "core/cell_text.h"

namespace dts::lab::sway {
namespace {

using posturography::Measure;

constexpr std::array<std::string_view, 6> kIdentity{"file", "session", "subject", "trial", "attempt", "condition"};
constexpr std::array<std::string_view, 5> kCircumstances{"profile", "fs_hz", "n", "duration_s", "flags"};

/// Renames a recording's label that has the name of a column.
std::string column_of(const std::string& label) { return is_column_of_table(label) ? "label_" + label : label; }

std::string joined(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : "|") + std::string(word);
  return text;
}

std::string circumstances_text(const posturography::Analysis& analysis) {
  return std::string(posturography::name(analysis.profile)) + "," + number_text(analysis.rate_hz) + "," + std::to_string(analysis.samples) +
         "," + number_text(analysis.duration_s) + "," + joined(posturography::names_of(analysis.flags));
}

std::string row_text(const MeasuredTrial& trial, const std::set<std::string>& labels) {
  std::string text = cell_text(trial.file) + "," + cell_text(trial.session) + "," + cell_text(trial.subject) + ",";
  if (trial.trial > 0) text += std::to_string(trial.trial);
  text += ",";
  if (trial.trial > 0) text += std::to_string(trial.attempt);
  text += "," + cell_text(trial.condition);
  for (const std::string& label : labels) text += "," + cell_text(trial.label(label));
  text += "," + (trial.analysis ? circumstances_text(*trial.analysis) : ",,,,");
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    text += ",";
    if (!trial.analysis) continue;
    if (const auto value = trial.analysis->measures.get(static_cast<Measure>(k))) text += number_text(*value);
  }
  return text + "\n";
}

}  // namespace

bool is_column_of_table(std::string_view name) {
  return std::ranges::find(kIdentity, name) != kIdentity.end() || std::ranges::find(kCircumstances, name) != kCircumstances.end() ||
         posturography::measure_named(name).has_value();
}

std::string cell_text(std::string_view text) {
  std::string cell = core::csv_cell(text);
  std::ranges::replace_if(
      cell, [](char letter) { return letter == '\n' || letter == '\r'; }, ' ');
  return cell;
}

std::string number_text(double value) {
  if (!std::isfinite(value)) return {};
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return end.ec == std::errc() ? std::string(digits.data(), end.ptr) : std::string();
}

std::string table_text(std::span<const MeasuredTrial> trials) {
  std::set<std::string> labels;
  for (const MeasuredTrial& trial : trials) {
    for (const auto& label : trial.labels) labels.insert(label.first);
  }
  std::string text;
  const auto add = [&text](std::string_view column) { text += (text.empty() ? "" : ",") + cell_text(column); };
  std::ranges::for_each(kIdentity, add);
  for (const std::string& label : labels) add(column_of(label));
  std::ranges::for_each(kCircumstances, add);
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) add(posturography::info(static_cast<Measure>(k)).symbol);
  text += "\n";
  for (const MeasuredTrial& trial : trials) text += row_text(trial, labels);
  return text;
}

}  // namespace dts::lab::sway
