// SPDX-License-Identifier: Apache-2.0
#include "files/toml_reader.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/join.h"
#include "core/number_text.h"
#include "core/suggest.h"
#include "core/utf8.h"
#include "files/toml_text.h"
#include "files/whole_file.h"

namespace dts::files {
namespace {

std::string range_text(const std::string& minimum, const std::string& maximum) { return "; allowed: " + minimum + " .. " + maximum; }

/// Far larger than any file that people write. A parsed file needs twenty times its size in memory.
constexpr std::size_t kMostTomlBytes = std::size_t{4} << 20U;

std::optional<std::string> read_bounded(const std::string& file, Problems& problems) {
  auto text = read_whole_file(file, kMostTomlBytes);
  if (text) return std::move(*text);
  problems.push_back({.file = file, .text = text.error().what});
  return std::nullopt;
}

/// Most parts of a dotted key. toml++ 3.3 limits the nesting of values, but not this: it makes a table of each part and destroys tables by
/// recursion, so that a key of a hundred thousand parts, which fits into a definition, would overflow the stack.
constexpr std::size_t kMostKeyParts = 16;

/// Returns the position after the string whose opening quote is at `at`.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string closing(text.substr(at, 3) == std::string(3, quote) ? 3 : 1, quote);
  for (at += closing.size(); at < text.size(); ++at) {
    if (quote == '"' && text[at] == '\\') {
      ++at;
    } else if (text.substr(at, closing.size()) == closing) {
      at += closing.size();
      for (int own = 0; closing.size() == 3 && own < 2 && at < text.size() && text[at] == quote; ++own) ++at;  // """a""""" is a""
      return at;
    }
  }
  return text.size();
}

/// Returns the position of a key with more than kMostKeyParts parts; npos if there is none. Ignores dots in strings and comments; a number
/// has only one dot.
std::size_t find_deep_key(std::string_view text) {
  std::size_t parts = 1;
  for (std::size_t at = 0; at < text.size();) {
    const char letter = text[at];
    if (letter == '"' || letter == '\'') {
      at = end_of_string(text, at);
    } else if (letter == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else {
      if (letter == '.' && ++parts > kMostKeyParts) return at;
      if (std::string_view(",=[]{}\n").find(letter) != std::string_view::npos) parts = 1;
      ++at;
    }
  }
  return std::string_view::npos;
}

}  // namespace

std::string to_string(const Problem& problem) {
  if (problem.line == 0) return problem.file + ": " + problem.text;
  return problem.file + ":" + std::to_string(problem.line) + ":" + std::to_string(problem.column) + ": " + problem.text;
}

std::optional<toml::table> parse_toml(const std::string& file, Problems& problems) {
  const auto text = read_bounded(file, problems);
  return text ? parse_toml_text(*text, file, problems) : std::nullopt;
}

std::optional<toml::table> parse_toml_text(std::string_view text, const std::string& name, Problems& problems) {
  if (text.size() > kMostTomlBytes) {
    problems.push_back({.file = name, .text = "is larger than 4 MiB: this is not a file of dtsd"});
    return std::nullopt;
  }
  if (const std::size_t deep = find_deep_key(text); deep != std::string_view::npos) {
    const auto line = static_cast<std::uint32_t>(1 + std::ranges::count(text.substr(0, deep), '\n'));
    problems.push_back({.file = name, .line = line, .column = 1, .text = "a key has more than 16 parts"});
    return std::nullopt;
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    // It quotes the file: a line break in it would begin a line of its own in the log.
    problems.push_back(
        {name, static_cast<std::uint32_t>(at.line), static_cast<std::uint32_t>(at.column), core::printable(error.description())});
    return std::nullopt;
  }
}

TomlReader::TomlReader(const toml::table* table, std::string where, std::string file, Problems& problems)
    : table_(table), where_(std::move(where)), file_(std::move(file)), problems_(&problems) {}

const toml::node* TomlReader::node(std::string_view key) {
  asked_.emplace(key);
  return table_ == nullptr ? nullptr : table_->get(key);
}

bool TomlReader::has(std::string_view key) const { return table_ != nullptr && table_->contains(key); }

void TomlReader::require(std::string_view key) {
  if (has(key) || has_reported_absence_) return;
  has_reported_absence_ = table_ == nullptr;
  report("", (has_reported_absence_ ? where_ : named(key)) + " is missing");
}

bool TomlReader::can_read(std::string_view key, const std::string& file) {
  if (::access(file.c_str(), R_OK) == 0) return true;
  report(key, file + " cannot be read: " + std::strerror(errno));
  return false;
}

double TomlReader::number(std::string_view key, double fallback, double minimum, double maximum) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  const auto value = found->value<double>();  // an integer converts
  if (!value || !found->is_number()) {
    report(key, named(key) + " must be a number");
    return fallback;
  }
  if (!std::isfinite(*value) || *value < minimum || *value > maximum) {
    report(key, named(key) + " = " + core::number_text(*value) + " is out of range" +
                    range_text(core::number_text(minimum), core::number_text(maximum)));
    return fallback;
  }
  return *value;
}

std::int64_t TomlReader::integer(std::string_view key, std::int64_t fallback, std::int64_t minimum, std::int64_t maximum) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  if (!found->is_integer()) {
    report(key, named(key) + " must be a whole number");
    return fallback;
  }
  const std::int64_t value = *found->value<std::int64_t>();
  if (value < minimum || value > maximum) {
    report(key,
           named(key) + " = " + std::to_string(value) + " is out of range" + range_text(std::to_string(minimum), std::to_string(maximum)));
    return fallback;
  }
  return value;
}

bool TomlReader::boolean(std::string_view key, bool fallback) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  if (found->is_boolean()) return *found->value<bool>();
  report(key, named(key) + " must be true or false");
  return fallback;
}

std::string TomlReader::text(std::string_view key, std::string_view fallback) {
  const toml::node* found = node(key);
  if (found == nullptr) return std::string(fallback);
  if (found->is_string()) return *found->value<std::string>();
  report(key, named(key) + " must be a text in quotes");
  return std::string(fallback);
}

std::string TomlReader::short_text(std::string_view key) {
  std::string found = text(key, "");
  if (found.size() > kLongestText) {
    report(key, std::string(key) + " is longer than " + std::to_string(kLongestText) + " characters");
    found.clear();
  }
  return found;
}

std::string TomlReader::choice(std::string_view key, const std::vector<std::string_view>& choices) {
  const std::string given = text(key, choices.front());
  if (std::ranges::find(choices, given) != choices.end()) return given;
  const std::string known = core::join(choices, ", ", [](std::string_view one) { return '"' + std::string(one) + '"'; });
  const std::string near = core::suggest(given, choices);
  report(key,
         named(key) + " = \"" + given + "\" is not known" + (near.empty() ? "" : "; did you mean \"" + near + "\"?") + "; known: " + known);
  return std::string(choices.front());
}

std::vector<std::int64_t> TomlReader::integers(std::string_view key, std::int64_t minimum, std::int64_t maximum) {
  const toml::node* found = node(key);
  std::vector<std::int64_t> values;
  if (found == nullptr) return values;
  if (!found->is_array()) {
    report(key, named(key) + " must be a list of whole numbers");
    return values;
  }
  for (const toml::node& element : *found->as_array()) {
    const auto value = element.value<std::int64_t>();
    if (!element.is_integer() || *value < minimum || *value > maximum) {
      report_at(&element, named(key) + " must hold whole numbers" + range_text(std::to_string(minimum), std::to_string(maximum)));
    } else {
      values.push_back(*value);
    }
  }
  return values;
}

std::vector<std::string> TomlReader::texts(std::string_view key, std::vector<std::string> fallback) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  if (!found->is_array()) {
    report(key, named(key) + " must be a list of texts");
    return fallback;
  }
  std::vector<std::string> values;
  for (const toml::node& element : *found->as_array()) {
    if (element.is_string()) {
      values.push_back(*element.value<std::string>());
    } else {
      report_at(&element, named(key) + " must hold texts in quotes");
    }
  }
  return values;
}

TomlReader TomlReader::table(std::string_view key) {
  const toml::node* found = node(key);
  if (found != nullptr && !found->is_table()) report(key, named(key) + " must be a table: [" + std::string(key) + "]");
  return {found != nullptr ? found->as_table() : nullptr, "[" + std::string(key) + "]", file_, *problems_};
}

std::optional<TomlReader> TomlReader::table_or_file(std::string_view key, References references, std::optional<toml::table>& parsed) {
  const toml::node* found = node(key);
  if (found != nullptr && found->is_table()) return table(key);
  const std::string name = text(key, "");
  if (name.empty()) {  // definitions in older recordings may have one
    if (found != nullptr && found->is_string() && references == References::Files) {
      report(key, named(key) + " is empty: name a file, or remove the line");
    }
    return std::nullopt;
  }
  if (references == References::None) {
    report(key, named(key) + " names a file, but a recorded definition must contain the table itself");
    return std::nullopt;
  }
  const auto file = (std::filesystem::path(file_).parent_path() / name).lexically_normal().string();
  if (!can_read(key, file)) return std::nullopt;
  parsed = parse_toml(file, *problems_);
  if (!parsed) return std::nullopt;
  return TomlReader(&*parsed, "", file, *problems_);
}

std::vector<TomlReader> TomlReader::tables(std::string_view key) {
  std::vector<TomlReader> readers;
  const toml::node* found = node(key);
  if (found == nullptr) return readers;
  const toml::array* array = found->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
    report(key, named(key) + " must be written as [[" + std::string(key) + "]]");
    return readers;
  }
  for (const toml::node& element : *array) readers.emplace_back(element.as_table(), "[[" + std::string(key) + "]]", file_, *problems_);
  return readers;
}

std::vector<std::string> TomlReader::remaining_keys() {
  std::vector<std::string> keys;
  if (table_ == nullptr) return keys;
  for (const auto& [key, value] : *table_) {
    if (!asked_.contains(key.str())) keys.emplace_back(key.str());
  }
  for (const std::string& key : keys) asked_.insert(key);
  return keys;
}

void TomlReader::report(std::string_view key, const std::string& text) {
  const toml::node* at = table_ != nullptr && !key.empty() ? table_->get(key) : nullptr;
  report_at(at != nullptr ? at : table_, text);
}

void TomlReader::finish() {
  if (table_ == nullptr) return;
  std::vector<std::string_view> known(asked_.begin(), asked_.end());
  for (const auto& [key, value] : *table_) {
    if (asked_.contains(key.str())) continue;
    const std::string near = core::suggest(key.str(), known);
    const auto& at = key.source().begin;
    problems_->push_back({file_, static_cast<std::uint32_t>(at.line), static_cast<std::uint32_t>(at.column),
                          "unknown key '" + std::string(key.str()) + "'" + (where_.empty() ? "" : " in " + where_) +
                              (near.empty() ? "" : "; did you mean '" + near + "'?")});
  }
}

void TomlReader::report_at(const toml::node* node, const std::string& text) {
  problems_->push_back(problem_at(node));
  problems_->back().text = text;
}

Problem TomlReader::position(std::string_view key) const { return problem_at(table_ != nullptr ? table_->get(key) : nullptr); }

Problem TomlReader::problem_at(const toml::node* node) const {
  Problem problem{.file = file_};
  if (node != nullptr && node->source().begin) {
    problem.line = static_cast<std::uint32_t>(node->source().begin.line);
    problem.column = static_cast<std::uint32_t>(node->source().begin.column);
  }
  return problem;
}

std::string TomlReader::named(std::string_view key) const { return (where_.empty() ? "" : where_ + " ") + std::string(key); }

std::vector<double> read_list(TomlReader& reader, std::string_view key, const toml::node* found, std::size_t minimum_count,
                              std::size_t maximum_count, double largest) {
  const toml::array* const list = found == nullptr ? nullptr : found->as_array();
  if (list == nullptr || list->size() < minimum_count || list->size() > maximum_count) {
    const std::string count = minimum_count == maximum_count ? std::to_string(minimum_count)
                                                             : std::to_string(minimum_count) + " to " + std::to_string(maximum_count);
    reader.report(key, std::string(key) + " must be a list of " + count + " numbers");
    return {};
  }
  std::vector<double> values;
  for (const toml::node& element : *list) {
    const auto value = element.value<double>();
    if (!element.is_number() || !value || !(std::abs(*value) <= largest)) {
      reader.report(key, std::string(key) + ": number " + std::to_string(values.size() + 1) +
                             " of the list is not a finite number of at most " + core::number_text(largest) + " in size");
      return {};
    }
    values.push_back(*value);
  }
  return values;
}

}  // namespace dts::files
