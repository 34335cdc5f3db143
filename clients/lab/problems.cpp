// SPDX-License-Identifier: Apache-2.0
#include "lab/problems.h"

#include <algorithm>
#include <ostream>

#include "cli/exit_status.h"

namespace dts::lab {
namespace {

constexpr std::size_t kMostShown = 20;

}  // namespace

int report_problems(cli::Console& console, const files::Problems& problems) {
  const std::size_t shown = std::min(problems.size(), kMostShown);
  for (std::size_t k = 0; k < shown; ++k) console.talk << cli::printable(files::to_string(problems[k])) << '\n';
  if (shown < problems.size()) console.talk << "and " << problems.size() - shown << " more\n";
  console.talk.flush();
  return cli::kUsage;
}

int fail_with(cli::Console& console, const core::Error& error) {
  const int status = cli::fail_with(console, error);
  return error.code == core::ErrorCode::NotFound ? cli::kUsage : status;
}

void warn(cli::Console& console, const std::string& text) { console.talk << "warning: " << cli::printable(text) << std::endl; }

}  // namespace dts::lab
