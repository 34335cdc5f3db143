// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <sstream>
#include <utility>

#include "files/rig_file.h"
#include "files/whole_file.h"
#include "pattern/pattern_model.h"

namespace dts::files {
namespace {

constexpr std::size_t kLargestDefinition = std::size_t{1} << 20U;  // the longest fact allowed in a recording

/// Replaces the file name at `key` by the table of that file.
void embed(toml::table& table, std::string_view key, const std::filesystem::path& folder, Problems& problems) {
  const toml::node* given = table.get(key);
  if (given == nullptr || !given->is_string()) return;
  const std::string name = given->value_or(std::string());
  if (name.empty()) return;
  auto named = parse_toml((folder / name).lexically_normal().string(), problems);
  if (!named) return;
  named->is_inline(true);
  table.insert_or_assign(key, std::move(*named));
}

/// Replaces the file name in [steadiness] model by the text of that file.
void embed_steadiness_model(toml::table& table, const std::filesystem::path& folder, Problems& problems) {
  toml::table* steadiness = table.get_as<toml::table>("steadiness");
  if (steadiness == nullptr) return;
  const std::string file = (folder / (*steadiness)["model"].value_or(std::string())).lexically_normal().string();
  auto text = read_whole_file(file, pattern::kLongestModelText);
  if (!text) {
    problems.push_back({file, 1, 1, text.error().what});
    return;
  }
  steadiness->insert_or_assign("model", std::move(*text));
}

std::string text_of(const toml::table& table) {
  std::ostringstream text;
  text << toml::toml_formatter(table, toml::format_flags::none) << '\n';  // writes floats with 17 digits
  return std::move(text).str();
}

tl::unexpected<core::Error> refuse(const std::string& file, const Problems& problems) {
  return core::fail(core::ErrorCode::InvalidArgument,
                    "cannot write the definition of the rig in " + file + ": " + to_string(problems.front()));
}

}  // namespace

core::Result<std::string> rig_definition(const std::string& file) {
  Problems problems;
  (void)read_rig_file(file, problems);
  if (!problems.empty()) return refuse(file, problems);
  auto table = parse_toml(file, problems);
  if (!table) return refuse(file, problems);
  const auto folder = std::filesystem::path(file).parent_path();
  embed(*table, "calibration", folder, problems);
  embed(*table, "model", folder, problems);
  embed_steadiness_model(*table, folder, problems);
  if (toml::array* sensors = table->get_as<toml::array>("sensor")) {
    sensors->for_each([&](toml::table& sensor) { embed(sensor, "curve", folder, problems); });
  }
  if (!problems.empty()) return refuse(file, problems);
  std::string text = text_of(*table);
  if (toml::table* calibration = table->get_as<toml::table>("calibration"); text.size() > kLargestDefinition && calibration != nullptr) {
    calibration->erase("point");
    text = text_of(*table);
  }
  if (text.size() <= kLargestDefinition) return text;
  return core::fail(core::ErrorCode::LimitExceeded, "the rig in " + file +
                                                        " is too large to be recorded with a session: " + std::to_string(text.size()) +
                                                        " bytes of at most " + std::to_string(kLargestDefinition));
}

}  // namespace dts::files
