// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "device/registry.h"

namespace dts::device {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  ///< Written "never" in a URI.

enum class OptionKind : std::uint8_t { Number, Integer, Word, File, Numbers, Text };

/// One option a device understands.
struct UriOption {
  std::string_view name;  ///< With its unit: "weight_n".
  OptionKind kind = OptionKind::Number;
  std::string_view default_text;  ///< What a user would have to write to get the default; empty: no default.
  double minimum = 0.0;           ///< Of every number, inclusive.
  double maximum = 0.0;           ///< `kNever`: the word "never" is allowed too.
  std::string_view choices;       ///< Words only, separated by '|': "feet|point".
  std::string_view sentence;
};

/// The options of one URI, complete and in range.
class UriOptions {
 public:
  /// Checks every option of `uri` against `known` and fills in the defaults. Fails with InvalidArgument naming every
  /// option that is wrong, its value and what is allowed; an unknown name gets a suggestion.
  [[nodiscard]] static core::Result<UriOptions> read(const DeviceUri& uri, std::span<const UriOption> known);

  /// `name` must be a Number or Integer of the table.
  [[nodiscard]] double number(std::string_view name) const { return numbers_.at(std::string(name)); }
  /// `name` must be a Numbers of the table that is given; at least one number.
  [[nodiscard]] const std::vector<double>& numbers(std::string_view name) const { return lists_.at(std::string(name)); }
  /// `name` must be a Word, File or Text of the table; empty when a File or Text was not given.
  [[nodiscard]] const std::string& text(std::string_view name) const { return texts_.at(std::string(name)); }
  /// The user wrote it.
  [[nodiscard]] bool is_given(std::string_view name) const { return given_.contains(name); }

 private:
  /// false: the value is not allowed.
  [[nodiscard]] bool take(const UriOption& option, const std::string& value);
  [[nodiscard]] bool take_list(const UriOption& option, const std::string& value);

  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::vector<double>, std::less<>> lists_;
  std::map<std::string, std::string, std::less<>> texts_;
  std::set<std::string, std::less<>> given_;
};

/// "50..2000", "feet|point", "FILE", "TEXT": what may be written.
[[nodiscard]] std::string allowed(const UriOption& option);

/// The table as text, one line per option, for help output.
[[nodiscard]] std::string describe_options(std::span<const UriOption> options);

}  // namespace dts::device
