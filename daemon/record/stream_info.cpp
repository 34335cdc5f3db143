// SPDX-License-Identifier: Apache-2.0
#include "record/stream_info.h"

#include <algorithm>

namespace dts::record {

std::string fact(const std::vector<std::pair<std::string, std::string>>& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &std::pair<std::string, std::string>::first);
  return found != facts.end() ? found->second : std::string();
}

std::string short_name(const std::string& stream) { return stream.substr(stream.rfind('/') + 1); }

}  // namespace dts::record
