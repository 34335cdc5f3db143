// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/measured_trial.h"

#include <algorithm>
#include <filesystem>

namespace dts::lab::sway {

std::string MeasuredTrial::label(const std::string& name) const {
  const auto found = std::ranges::find(labels, name, &std::pair<std::string, std::string>::first);
  return found == labels.end() ? std::string() : found->second;
}

std::string MeasuredTrial::title() const {
  std::string text = std::filesystem::path(file).filename().string();
  if (trial > 0) text += ", trial " + std::to_string(trial);
  if (attempt > 1) text += ", attempt " + std::to_string(attempt);
  if (stretch > 0) text += ", stretch " + std::to_string(stretch);
  std::string details = condition;
  for (const auto& [name, value] : labels) details += (details.empty() ? "" : ", ") + name + "=" + value;
  return details.empty() ? text : text + " (" + details + ")";
}

}  // namespace dts::lab::sway
