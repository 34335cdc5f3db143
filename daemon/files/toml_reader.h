// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace dts::files {

/// One error in a configuration file. Line and column are 0 if the error concerns the whole file.
struct Problem {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  std::string text;
};

/// Returns "file:line:column: text", which editors can open.
[[nodiscard]] std::string to_string(const Problem& problem);

using Problems = std::vector<Problem>;

/// Parses `file`. If it has a syntax error or cannot be read, adds a problem and returns nothing.
[[nodiscard]] std::optional<toml::table> parse_toml(const std::string& file, Problems& problems);

/// Parses a text in memory. `name` replaces the file name in problems.
[[nodiscard]] std::optional<toml::table> parse_toml_text(std::string_view text, const std::string& name, Problems& problems);

/// Whether a definition may name other files. A definition from a recording must not: it could make the reader open files of this machine.
enum class References : std::uint8_t { Files, None };

inline constexpr std::size_t kLongestText = 200;  ///< Characters of a name, a serial number or a time.

/// Reads one table and reports errors: a value that is missing, of the wrong type or out of range becomes a problem with its position, and
/// `finish` reports every key that was not read. After a problem the reader returns the default value and continues, so that one run shows
/// all problems.
class TomlReader {
 public:
  /// `where`: name of the table in messages, such as "[plate]"; empty for the top level. `table` must outlive the reader; nullptr: the
  /// table is absent, and every value is its default.
  TomlReader(const toml::table* table, std::string where, std::string file, Problems& problems);

  [[nodiscard]] double number(std::string_view key, double fallback, double minimum, double maximum);
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t minimum, std::int64_t maximum);
  [[nodiscard]] bool boolean(std::string_view key, bool fallback);
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback);
  [[nodiscard]] std::string short_text(std::string_view key);  ///< At most `kLongestText` characters; empty if absent.
  [[nodiscard]] std::string choice(std::string_view key, const std::vector<std::string_view>& choices);  ///< The first is the default.
  [[nodiscard]] std::vector<std::int64_t> integers(std::string_view key, std::int64_t minimum, std::int64_t maximum);
  [[nodiscard]] std::vector<std::string> texts(std::string_view key, std::vector<std::string> fallback);
  /// Marks a value as required: its absence is a problem. If the whole table is absent, reports only that, and only once.
  void require(std::string_view key);
  [[nodiscard]] bool has(std::string_view key) const;

  [[nodiscard]] TomlReader table(std::string_view key);
  /// Returns a reader of the table at `key`, or of the file named at `key` (relative to this file). If it cannot be read, adds a problem
  /// and returns nothing. If the key is absent, returns nothing without a problem. `parsed` holds the table of the file and must outlive
  /// the returned reader.
  [[nodiscard]] std::optional<TomlReader> table_or_file(std::string_view key, References references, std::optional<toml::table>& parsed);
  /// Returns a reader for each table of an array of tables [[key]].
  [[nodiscard]] std::vector<TomlReader> tables(std::string_view key);
  /// Returns all keys that were not read yet, and marks them as read. For a stage's options, which the stage checks.
  [[nodiscard]] std::vector<std::string> remaining_keys();
  [[nodiscard]] const toml::node* node(std::string_view key);

  /// Adds a problem at a key of this table, or at the table itself if the key is empty.
  void report(std::string_view key, const std::string& text);
  /// Returns true if `file`, named at `key`, can be read; else adds a problem at the key.
  [[nodiscard]] bool can_read(std::string_view key, const std::string& file);
  /// Returns the position of a key's value as a problem without text.
  [[nodiscard]] Problem position(std::string_view key) const;
  /// Reports unknown keys with a suggestion. Call it once, after all reads.
  void finish();

  [[nodiscard]] const std::string& file() const noexcept { return file_; }

 private:
  [[nodiscard]] Problem problem_at(const toml::node* node) const;
  void report_at(const toml::node* node, const std::string& text);
  [[nodiscard]] std::string named(std::string_view key) const;

  const toml::table* table_;
  std::string where_;
  std::string file_;
  Problems* problems_;
  bool has_reported_absence_ = false;
  std::set<std::string, std::less<>> asked_;
};

/// Returns the numbers of the list `found`, which is the value of `key` or a part of that value. Reports a problem and returns an empty
/// list unless there are `minimum_count` to `maximum_count` numbers, all finite and with a magnitude of at most `largest`.
[[nodiscard]] std::vector<double> read_list(TomlReader& reader, std::string_view key, const toml::node* found, std::size_t minimum_count,
                                            std::size_t maximum_count, double largest);

}  // namespace dts::files
