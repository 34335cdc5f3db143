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

/// One thing wrong with a configuration file. Line and column are 0 when the whole file is meant.
struct Problem {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
  std::string text;
};

/// "file:line:column: text", as editors jump to.
[[nodiscard]] std::string to_string(const Problem& problem);

using Problems = std::vector<Problem>;

/// Parses `file`; a syntax error or an unreadable file becomes a problem and nothing is returned.
[[nodiscard]] std::optional<toml::table> parse_toml(const std::string& file, Problems& problems);

/// The same for a text that is in memory already; `name` stands for the file in problems.
[[nodiscard]] std::optional<toml::table> parse_toml_text(std::string_view text, const std::string& name, Problems& problems);

/// Where what a file refers to may stand: in files beside it, or in itself alone (a definition out of a recording must not make
/// anybody read files of this machine).
enum class References : std::uint8_t { Files, None };

inline constexpr std::size_t kLongestText = 200;  ///< Of a name, a serial number, a time.

/// Reads one table and keeps the books: what is missing, of the wrong type or out of range becomes a problem with its
/// position, and `finish` reports every key that nobody asked for. Reading goes on after a problem, so that one run
/// shows them all; the value returned then is the default.
class TomlReader {
 public:
  /// `where` names the table in messages: "[plate]"; empty for the top level. `table` outlives the reader; nullptr: the
  /// table is absent, everything takes its default.
  TomlReader(const toml::table* table, std::string where, std::string file, Problems& problems);

  [[nodiscard]] double number(std::string_view key, double fallback, double minimum, double maximum);
  [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t fallback, std::int64_t minimum, std::int64_t maximum);
  [[nodiscard]] bool boolean(std::string_view key, bool fallback);
  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback);
  [[nodiscard]] std::string short_text(std::string_view key);  ///< At most `kLongestText` characters; empty when absent.
  [[nodiscard]] std::string choice(std::string_view key, const std::vector<std::string_view>& choices);  ///< First is the default.
  [[nodiscard]] std::vector<std::int64_t> integers(std::string_view key, std::int64_t minimum, std::int64_t maximum);
  [[nodiscard]] std::vector<std::string> texts(std::string_view key, std::vector<std::string> fallback);
  /// Marks a value as required: its absence is a problem. Of a table that is absent only the absence of the table is one.
  void require(std::string_view key);
  [[nodiscard]] bool has(std::string_view key) const;

  [[nodiscard]] TomlReader table(std::string_view key);
  /// The table that is the value of `key`, or that of the file whose name is, relative to this file. Nothing, and a problem, when that
  /// cannot be had; nothing without a problem when the key is absent or an empty text. `parsed` keeps a file's table and outlives the
  /// reader.
  [[nodiscard]] std::optional<TomlReader> table_or_file(std::string_view key, References references, std::optional<toml::table>& parsed);
  /// Each table of an array of tables [[key]].
  [[nodiscard]] std::vector<TomlReader> tables(std::string_view key);
  /// All keys with scalar values that were not asked for yet (a stage's options are checked elsewhere), as asked for.
  [[nodiscard]] std::vector<std::string> remaining_keys();
  [[nodiscard]] const toml::node* node(std::string_view key);

  /// A problem at a key of this table, or at the table itself for an empty key.
  void report(std::string_view key, const std::string& text);
  /// False, and a problem at the key, when the file that it names cannot be read.
  [[nodiscard]] bool can_read(std::string_view key, const std::string& file);
  /// Where a key's value stands, as a problem without text.
  [[nodiscard]] Problem position(std::string_view key) const;
  /// Reports unknown keys with a suggestion. Call it once, when everything was read.
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
  bool has_told_absence_ = false;
  std::set<std::string, std::less<>> asked_;
};

/// Returns the numbers of the list `found`, which stands at `key` or within it. Reports a problem and returns nothing unless there are
/// `minimum_count` to `maximum_count`, all finite and at most `largest` in size.
[[nodiscard]] std::vector<double> read_list(TomlReader& reader, std::string_view key, const toml::node* found, std::size_t minimum_count,
                                            std::size_t maximum_count, double largest);

}  // namespace dts::files
