// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_inputs.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

#include "lab/sway/sway_table.h"
#include "record/xdf/recovery.h"

namespace dts::lab::sway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLabel = 200;

/// "eyes=open" for all inputs, "eyes=open,closed" for two.
struct Label {
  std::string name;
  std::vector<std::string> values;
};

core::Result<Label> label_of(const std::string& text, std::size_t inputs) {
  const auto wrong = [&](const std::string& why, const std::string& hint) {
    return core::fail(core::ErrorCode::InvalidArgument, "--label " + text + ": " + why, hint);
  };
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return wrong("is not NAME=VALUE", "--label eyes=open");
  if (text.size() > kLongestLabel) return wrong("is too long", "at most " + std::to_string(kLongestLabel) + " bytes");
  Label label{.name = text.substr(0, equals), .values = {}};
  for (std::size_t at = equals + 1; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    label.values.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  const bool is_identity = label.name == "subject" || label.name == "session" || label.name == "condition";
  if (!is_identity && is_column_of_table(label.name)) return wrong("tables already have a column with this name", "choose another name");
  if (std::ranges::any_of(text, [](char letter) { return static_cast<unsigned char>(letter) < 0x20U; })) {
    return wrong("has control characters", "letters and digits");
  }
  if (label.values.size() != 1 && label.values.size() != inputs) {
    return wrong(std::to_string(label.values.size()) + " values for " + std::to_string(inputs) + " files",
                 "give one value, or one value per file");
  }
  return label;
}

bool is_measurable(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array<std::string_view, 6> kEnds{".csv", ".xdf", ".xdf.part", ".c3d", ".mot", ".sto"};
  return std::ranges::any_of(kEnds, [&name](std::string_view end) { return name.ends_with(end); });
}

/// Removes duplicates: a recording left open by a crash and its repaired copy are the same recording.
void leave_out_repaired(std::vector<std::string>& files) {
  const std::set<std::string> known(files.begin(), files.end());
  std::erase_if(files,
                [&known](const std::string& file) { return file.ends_with(".part") && known.contains(record::recovered_name(file)); });
}

core::Result<std::vector<std::string>> files_below(const std::string& folder, const std::string& table) {
  std::vector<std::string> files;
  std::error_code error;
  fs::recursive_directory_iterator place(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && place != fs::recursive_directory_iterator(); place.increment(error)) {
    std::error_code none;
    if (!place->is_regular_file(none) || !is_measurable(place->path())) continue;
    if (!table.empty() && fs::equivalent(place->path(), table, none)) continue;
    files.push_back(place->path().string());
    if (files.size() > kMostFiles) break;  // the caller reports this
  }
  if (error) return core::fail(core::ErrorCode::Failed, folder + " cannot be read: " + error.message(), "give another folder");
  if (files.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, folder + " has no .csv, .xdf, .c3d, .mot and .sto files",
                      "give a folder of recordings");
  }
  leave_out_repaired(files);
  std::ranges::sort(files);
  return files;
}

void add(const Label& label, std::size_t input, SwayInput& file) {
  const std::string& value = label.values.size() == 1 ? label.values.front() : label.values[input];
  if (label.name == "subject") {
    file.subject = value;
  } else if (label.name == "session") {
    file.session = value;
  } else if (label.name == "condition") {
    file.condition = value;
  } else {
    std::erase_if(file.labels, [&](const auto& known) { return known.first == label.name; });
    file.labels.emplace_back(label.name, value);
  }
}

}  // namespace

core::Result<std::vector<SwayInput>> sway_inputs(const SwayArguments& arguments) {
  std::vector<Label> labels;
  for (const std::string& text : arguments.labels) {
    DTS_TRY_ASSIGN(auto label, label_of(text, arguments.inputs.size()));
    labels.push_back(std::move(label));
  }
  std::vector<SwayInput> inputs;
  for (std::size_t k = 0; k < arguments.inputs.size(); ++k) {
    std::vector<std::string> files{arguments.inputs[k]};
    std::error_code none;
    if (fs::is_directory(arguments.inputs[k], none)) {
      DTS_TRY_ASSIGN(files, files_below(arguments.inputs[k], arguments.table));
    }
    if (inputs.size() + files.size() > kMostFiles) {
      return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostFiles) + " files",
                        "process one folder at a time");
    }
    for (std::string& file : files) {
      inputs.push_back({.file = std::move(file)});
      for (const Label& label : labels) add(label, k, inputs.back());
    }
  }
  return inputs;
}

}  // namespace dts::lab::sway
