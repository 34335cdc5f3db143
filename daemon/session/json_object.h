// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dts::session {

/// Builds a JSON object as text for the details of a session's result. This folder uses no JSON library, because writing needs none. Skips
/// numbers that are absent or not finite.
class JsonObject {
 public:
  void add(std::string_view name, double value);
  void add(std::string_view name, std::optional<double> value);
  void add(std::string_view name, std::size_t count);
  void add(std::string_view name, const std::string& words);
  /// Adds `json`, which must already be a JSON value.
  void add_json(std::string_view name, const std::string& json);

  [[nodiscard]] std::string text() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

}  // namespace dts::session
