// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/json.h"

namespace dts::lab {

/// Returns a result of a session, which has a name, a value, a unit and details, as an object of a document.
template <class Figure>
[[nodiscard]] cli::Json figure_json(const Figure& figure) {
  cli::Json json{{"name", figure.name}};
  cli::set_number(json, "value", figure.value);
  json["unit"] = figure.unit;
  if (!figure.details.empty()) json["details"] = cli::Json::parse(figure.details);
  return json;
}

}  // namespace dts::lab
