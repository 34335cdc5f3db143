// SPDX-License-Identifier: Apache-2.0
#include "session/storage.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

namespace dts::session {
namespace {

constexpr double kMebibyte = 1024.0 * 1024.0;
constexpr const char* kHint = "make room, or set [storage] directory (or DTSD_STATE_DIR) to another disk";

std::string minutes(double seconds) {
  std::string text(32, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.0f min", seconds / 60.0)));
  return text;
}

}  // namespace

std::string_view name(DiskState state) noexcept {
  switch (state) {
    case DiskState::Fine: return "fine";
    case DiskState::Low: return "low";
    case DiskState::Full: return "full";
    case DiskState::Unusable: return "unusable";
  }
  return "unknown";
}

std::string catalogue_file(const StorageConfig& config) { return config.directory + "/catalogue.sqlite"; }

std::string sessions_directory(const StorageConfig& config) { return config.directory + "/sessions"; }

std::uint64_t size_of(const std::string& file) {
  std::error_code unknown;
  const auto size = std::filesystem::file_size(file, unknown);
  return unknown ? 0 : size;
}

core::Status prepare_storage(const StorageConfig& config) {
  const std::string directory = sessions_directory(config);
  std::error_code error;
  std::filesystem::create_directories(config.directory, error);
  if (::mkdir(directory.c_str(), 0750) != 0 && errno != EEXIST) {
    return core::fail_errno(errno, "the folder for recordings, " + directory + ", cannot be made", kHint);
  }
  if (::access(directory.c_str(), R_OK | W_OK | X_OK) != 0) {
    return core::fail_errno(errno, "the folder for recordings, " + directory + ", cannot be used", kHint);
  }
  return {};
}

DiskView look_at_disk(const StorageConfig& config, double bytes_per_s) {
  DiskView view{.directory = sessions_directory(config)};
  struct statvfs found {};
  if (::statvfs(view.directory.c_str(), &found) != 0) {
    view.state = DiskState::Unusable;
    view.problem = core::fail_errno(errno, view.directory, kHint).value().what;
    return view;
  }
  view.free_bytes = static_cast<std::uint64_t>(found.f_bavail) * found.f_frsize;
  const double usable = static_cast<double>(view.free_bytes) - config.stop_below_mib * kMebibyte;
  view.recordable_s = bytes_per_s > 0.0 && usable > 0.0 ? usable / bytes_per_s : 0.0;
  if ((found.f_flag & ST_RDONLY) != 0) {
    view.state = DiskState::Unusable;
    view.problem = view.directory + " is on a disk mounted read-only; " + kHint;
  } else if (bytes_per_s == 0.0) {
    // Without rigs, nothing is recorded and any disk is large enough.
  } else if (view.recordable_s < config.refuse_below_min * 60.0) {
    view.state = DiskState::Full;
    view.problem = view.directory + " has room for " + minutes(view.recordable_s) + " of recording; a session needs at least " +
                   minutes(config.refuse_below_min * 60.0) + "; " + kHint;
  } else if (view.recordable_s < config.warn_below_min * 60.0) {
    view.state = DiskState::Low;
    view.problem = view.directory + " has room for only " + minutes(view.recordable_s) + " of recording; " + kHint;
  }
  return view;
}

}  // namespace dts::session
