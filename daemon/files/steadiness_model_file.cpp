// SPDX-License-Identifier: Apache-2.0
#include "files/steadiness_model_file.h"

#include <filesystem>
#include <string>
#include <utility>

#include "files/whole_file.h"
#include "pattern/decision.h"

namespace dts::files {
namespace {

constexpr std::string_view kModel = "model";

/// Returns the text of the model and its name for messages.
std::optional<std::pair<std::string, std::string>> text_of(TomlReader& reader, References references) {
  const std::string given = reader.text(kModel, "");
  if (given.empty()) {
    if (reader.has(kModel)) reader.report(kModel, "[steadiness] model is empty: name a file, or remove the table");
    return std::nullopt;
  }
  if (references == References::None) return std::pair(given, std::string("the recorded model"));
  const auto file = (std::filesystem::path(reader.file()).parent_path() / given).lexically_normal().string();
  auto text = read_whole_file(file, pattern::kLongestModelText);
  if (text) return std::pair(std::move(*text), file);
  reader.report(kModel, file + ": " + text.error().what);
  return std::nullopt;
}

std::vector<std::pair<std::string, std::string>> read_labels(TomlReader& reader) {
  std::vector<std::pair<std::string, std::string>> labels;
  TomlReader table = reader.table("trials");
  for (const std::string& label : table.remaining_keys()) labels.emplace_back(label, table.short_text(label));
  table.finish();
  return labels;
}

}  // namespace

std::optional<pipeline::SteadinessModel> read_steadiness_model(TomlReader& top, References references) {
  if (!top.has("steadiness")) return std::nullopt;
  TomlReader reader = top.table("steadiness");
  reader.require(kModel);
  auto labels = read_labels(reader);
  auto text = text_of(reader, references);
  reader.finish();
  if (!text) return std::nullopt;
  auto model = pattern::read_model_text(text->first, text->second);
  const core::Status usable = model ? pattern::check_for_rig(*model) : core::Status();
  if (!model || !usable) {
    reader.report(kModel, core::to_string(model ? usable.error() : model.error()));
    return std::nullopt;
  }
  if (!model->condition.empty() && labels.empty()) {
    reader.report(kModel, "the model was trained with " + model->condition +
                              " only: name its trials in [steadiness], for example trials = { eyes = \"closed\" }");
    return std::nullopt;
  }
  return pipeline::SteadinessModel{.model = std::move(*model), .text = std::move(text->first), .labels = std::move(labels)};
}

}  // namespace dts::files
