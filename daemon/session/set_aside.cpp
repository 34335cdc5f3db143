// SPDX-License-Identifier: Apache-2.0
#include "session/set_aside.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/utc_text.h"

namespace dts::session {
namespace {

/// The database is renamed first: without its log it would contain older data. The log is last: a log without a database shows that the
/// renames were interrupted.
constexpr std::array<const char*, 4> kCatalogueEndings{"", ".audit", "-shm", "-wal"};

bool is_there(const std::string& file) {
  std::error_code unknown;
  return std::filesystem::exists(std::filesystem::symlink_status(file, unknown));
}

/// Returns an unused name, so that a rename never replaces what was set aside earlier.
std::string name_to_set_aside(const std::string& catalogue, std::int64_t utc_ns) {
  std::string aside = catalogue + ".damaged-" + core::utc_text(utc_ns);
  std::ranges::replace(aside, ':', '-');
  const auto is_free = [](const std::string& name) {
    return std::ranges::none_of(kCatalogueEndings, [&name](const char* ending) { return is_there(name + ending); });
  };
  std::string name = aside;
  for (int number = 2; !is_free(name); ++number) name = aside + "." + std::to_string(number);
  return name;
}

}  // namespace

core::Result<std::string> set_aside(const std::string& catalogue, std::int64_t utc_ns) {
  const std::string aside = name_to_set_aside(catalogue, utc_ns);
  std::error_code error;
  for (const char* ending : kCatalogueEndings) {
    if (!is_there(catalogue + ending)) continue;
    std::filesystem::rename(catalogue + ending, aside + ending, error);
    if (error)
      return core::fail_errno(error.value(), "the damaged catalogue " + catalogue + " cannot be renamed",
                              "move it and all files beside it to another folder");
  }
  return aside;
}

bool is_half_set_aside(const std::string& catalogue) { return !is_there(catalogue) && is_there(catalogue + "-wal"); }

}  // namespace dts::session
