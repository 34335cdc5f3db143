// SPDX-License-Identifier: Apache-2.0
#include "cli/suggestion.h"

namespace dts::cli {

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  return core::suggest(word, std::vector<std::string_view>(candidates.begin(), candidates.end()));
}

}  // namespace dts::cli
