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
#include "device/device_uri.h"

namespace dts::device {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  ///< Written "never" in a URI.

enum class OptionKind : std::uint8_t { Number, Integer, Word, File, Numbers, Text };

/// One option of a device.
struct UriOption {
  std::string_view name;  ///< With its unit: "weight_n".
  OptionKind kind = OptionKind::Number;
  std::string_view default_text;  ///< The default as a user would write it; empty: no default.
  double minimum = 0.0;           ///< Lower limit of every number, inclusive.
  double maximum = 0.0;           ///< Upper limit, inclusive; `kNever`: the word "never" is allowed too.
  std::string_view choices;       ///< For Word only: allowed words, separated by '|': "feet|point".
  std::string_view sentence;
};

/// The options of one URI, checked and with defaults.
class UriOptions {
 public:
  /// Checks every option of `uri` against `known` and adds the defaults. Fails with InvalidArgument, naming every wrong option,
  /// its value and the allowed values; for an unknown name it suggests a known one.
  [[nodiscard]] static core::Result<UriOptions> read(const DeviceUri& uri, std::span<const UriOption> known);

  /// Returns a number; `name` must be a Number or Integer of the table.
  [[nodiscard]] double number(std::string_view name) const { return numbers_.at(std::string(name)); }
  /// Returns at least one number; `name` must be a Numbers of the table, with a value in the URI or a default.
  [[nodiscard]] const std::vector<double>& numbers(std::string_view name) const { return lists_.at(std::string(name)); }
  /// Returns a text; `name` must be a Word, File or Text of the table. Empty if the URI has no such File or Text.
  [[nodiscard]] const std::string& text(std::string_view name) const { return texts_.at(std::string(name)); }
  /// Returns true if the URI contains this option.
  [[nodiscard]] bool is_given(std::string_view name) const { return given_.contains(name); }

 private:
  /// Stores the value; returns false if it is not allowed.
  [[nodiscard]] bool set(const UriOption& option, const std::string& value);
  [[nodiscard]] bool set_list(const UriOption& option, const std::string& value);

  std::map<std::string, double, std::less<>> numbers_;
  std::map<std::string, std::vector<double>, std::less<>> lists_;
  std::map<std::string, std::string, std::less<>> texts_;
  std::set<std::string, std::less<>> given_;
};

/// Returns the allowed values of an option: "50..2000", "feet|point", "FILE", "TEXT".
[[nodiscard]] std::string allowed(const UriOption& option);

/// Returns the table as help text, one line per option.
[[nodiscard]] std::string describe_options(std::span<const UriOption> options);

}  // namespace dts::device
