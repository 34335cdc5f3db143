// SPDX-License-Identifier: Apache-2.0
#include "lab/base/problems.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
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
  if (!problems.empty()) console.failure = cli::Failure{.what = files::to_string(problems.front()), .hint = {}};
  return cli::kUsage;
}

int fail_with(cli::Console& console, const core::Error& error) {
  const int status = cli::fail_with(console, error);
  return error.code == core::ErrorCode::NotFound ? cli::kUsage : status;
}

void warn(cli::Console& console, const std::string& text) { console.talk << "warning: " << cli::printable(text) << std::endl; }

namespace {

/// Returns whether the name or header is that of a file in a folder of reaching trials.
bool is_of_trials(const std::string& file) {
  const std::string name = std::filesystem::path(file).filename();
  if (name == "subjects.csv" || name == "trials.csv" || name == "sensors.csv" || name == "calibration.csv") return true;
  std::ifstream stream(file);
  std::string header(8, '\0');
  stream.read(header.data(), static_cast<std::streamsize>(header.size()));
  return header == "trial,v1";
}

}  // namespace

core::Status check_out(const std::string& out, const std::vector<std::string>& inputs) {
  namespace fs = std::filesystem;
  std::error_code none;
  if (!fs::exists(out, none)) return {};
  const fs::path folder = fs::path(out).has_parent_path() ? fs::path(out).parent_path() : fs::path(".");
  for (const std::string& input : inputs) {
    const bool is_same = !input.empty() && fs::equivalent(out, input, none);
    const bool lies_in = !input.empty() && fs::is_directory(input, none) && fs::equivalent(folder, input, none) && is_of_trials(out);
    if (!is_same && !lies_in) continue;
    const std::string what = is_same ? " is the input file " : " belongs to the trials in ";
    return core::fail(core::ErrorCode::InvalidArgument, out + what + input, "write to another file");
  }
  return {};
}

}  // namespace dts::lab
