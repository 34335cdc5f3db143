// SPDX-License-Identifier: Apache-2.0
#include "cli/json.h"

#include <cmath>

namespace dts::cli {

std::string one_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string document(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

void set_number(Json& object, std::string_view key, double value) {
  if (std::isfinite(value)) object[std::string(key)] = value;
}

}  // namespace dts::cli
