// SPDX-License-Identifier: Apache-2.0
#include "gateway/config_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "cli/suggestion.h"

namespace dts::gateway {
namespace {

constexpr std::uintmax_t kMostBytes = 1U << 20U;
constexpr std::string_view kBlank = " \t\r";

std::string trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  return begin == std::string_view::npos ? "" : std::string(text.substr(begin, text.find_last_not_of(kBlank) - begin + 1));
}

std::string meant(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = cli::nearest(word, known);
  return near.empty() ? "" : "; did you mean " + near + "?";
}

std::vector<std::string> keys_of(const CLI::App& app) {
  std::vector<std::string> keys;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) keys.push_back(name);
  }
  return keys;
}

std::vector<std::string> tables_of(const CLI::App& app) {
  std::vector<std::string> tables;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) tables.push_back(command->get_name());
  return tables;
}

/// Checks the lines of a file one by one.
class Lines {
 public:
  explicit Lines(const CLI::App& app) : app_(app), table_(&app) {}

  /// Returns what is wrong with the next line; empty if it is correct.
  [[nodiscard]] std::string check(const std::string& line) {
    if (is_in_list_) return end_of_list(line);
    if (line.empty() || line.front() == '#') return {};
    if (line.front() == '[') return begin_table(trimmed(line.substr(1, line.find(']') - 1)));
    const std::size_t equals = line.find('=');
    std::string key = trimmed(line.substr(0, equals));
    if (key.size() > 1 && key.front() == '"' && key.back() == '"') key = key.substr(1, key.size() - 2);
    if (equals == std::string::npos) return "'" + key + "' has no value";
    const auto keys = keys_of(*table_);
    if (std::ranges::find(keys, key) == keys.end()) return "unknown key '" + key + "'" + place() + meant(key, keys);
    const std::string value = trimmed(line.substr(equals + 1));
    is_in_list_ = value.starts_with('[') && value.find(']') == std::string::npos;
    return {};
  }

 private:
  [[nodiscard]] std::string end_of_list(const std::string& line) {
    is_in_list_ = line.find(']') == std::string::npos;
    return {};
  }
  [[nodiscard]] std::string begin_table(const std::string& name) {
    const auto tables = tables_of(app_);
    if (std::ranges::find(tables, name) == tables.end()) return "unknown table [" + name + "]" + meant(name, tables);
    table_ = app_.get_subcommand(name);
    return {};
  }
  [[nodiscard]] std::string place() const { return table_ == &app_ ? " before the first table" : " in [" + table_->get_name() + "]"; }

  const CLI::App& app_;
  const CLI::App* table_;
  bool is_in_list_ = false;
};

}  // namespace

std::string problem_of_config(const std::string& file, const CLI::App& app) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return file + " is not a readable file";
  if (std::filesystem::file_size(file, unknown) > kMostBytes) return file + " is larger than 1 MiB: that is no configuration";
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return file + " cannot be read";
  Lines lines(app);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (const std::string problem = lines.check(trimmed(line)); !problem.empty())
      return file + ":" + std::to_string(number) + ": " + problem;
  }
  return {};
}

}  // namespace dts::gateway
