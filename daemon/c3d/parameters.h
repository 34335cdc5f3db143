// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "c3d/encoding.h"

namespace dts::c3d {

/// A named value of a file. Names are in capital letters.
struct Parameter {
  std::string group;
  std::string name;
  std::vector<std::size_t> dimensions{};  ///< The first index changes fastest. Empty: one value.
  std::vector<double> numbers{};          ///< Bytes are 0 to 255, whole numbers -32768 to 32767.
  std::vector<std::string> texts{};       ///< Instead of numbers: rows of letters, without the spaces and zeros at their ends.

  /// Returns the size of a dimension; 1 if the parameter has fewer.
  [[nodiscard]] std::size_t dimension(std::size_t index) const noexcept;
};

/// All parameters of a file, and what is wrong with them.
class Parameters {
 public:
  /// Reads the section that begins at `section` (its first four bytes are its head). Records that contradict the section are left out and
  /// named in `warnings`. Work and memory are bounded by the size of the section.
  [[nodiscard]] static Parameters read(std::string_view section, Encoding encoding, std::vector<std::string>& warnings);

  /// Returns the first parameter of this name; nullptr if there is none.
  [[nodiscard]] const Parameter* find(std::string_view group, std::string_view name) const noexcept;
  /// Returns one number of a parameter; nothing if it is absent, a text, or too short.
  [[nodiscard]] std::optional<double> number(std::string_view group, std::string_view name, std::size_t index = 0) const noexcept;
  /// Returns the same number as one without a sign: counts above 32767 are stored as negative numbers.
  [[nodiscard]] std::optional<double> count(std::string_view group, std::string_view name, std::size_t index = 0) const noexcept;
  /// Returns the first text of a parameter; empty if there is none.
  [[nodiscard]] std::string text(std::string_view group, std::string_view name) const;

  [[nodiscard]] const std::vector<Parameter>& all() const noexcept { return all_; }

 private:
  std::vector<Parameter> all_;
};

}  // namespace dts::c3d
