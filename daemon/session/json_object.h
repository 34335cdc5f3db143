// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dts::session {

/// A JSON object as text, for the details of a figure: the room knows no JSON library, and needs none to write. Numbers that are absent or
/// not finite are left out.
class JsonObject {
 public:
  void add(std::string_view name, double value);
  void add(std::string_view name, std::optional<double> value);
  void add(std::string_view name, std::size_t count);
  void add(std::string_view name, const std::string& words);
  /// `json` is a JSON value already.
  void add_json(std::string_view name, const std::string& json);

  [[nodiscard]] std::string text() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

}  // namespace dts::session
