// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/store.h"

#include <sys/statvfs.h>
#include <unistd.h>

#include <string_view>

#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {
namespace {

constexpr std::string_view kObjects = "objects/";

}  // namespace

LocalFile::~LocalFile() {
  if (is_copy_) ::unlink(path_.c_str());
}

LocalFile::LocalFile(LocalFile&& other) noexcept : path_(std::move(other.path_)), is_copy_(std::exchange(other.is_copy_, false)) {}

double Store::used_percent() const {
  struct statvfs disk {};
  if (::statvfs(folder_.c_str(), &disk) != 0) return 100.0;
  const auto used = static_cast<double>(disk.f_blocks - disk.f_bfree);
  return 100.0 * used / (used + static_cast<double>(disk.f_bavail));
}

std::uint64_t Store::free_bytes() const {
  struct statvfs disk {};
  return ::statvfs(folder_.c_str(), &disk) != 0 ? 0 : std::uint64_t{disk.f_bavail} * disk.f_frsize;
}

std::string key_of(const RecordingName& name) { return std::string(kObjects) + name.clinic + "/" + wire::hex_of(name.sha256); }

std::optional<RecordingName> name_of(const std::string& key) {
  const std::size_t slash = key.rfind('/');
  if (!key.starts_with(kObjects) || slash < kObjects.size()) return std::nullopt;
  const auto sum = wire::bytes_of_hex(key.substr(slash + 1));
  std::string clinic = key.substr(kObjects.size(), slash - kObjects.size());
  if (!sum || !wire::is_clinic_name(clinic)) return std::nullopt;
  return RecordingName{std::move(clinic), *sum};
}

core::Result<std::unique_ptr<Store>> open_store(const Settings& settings) {
  return settings.s3 ? open_s3_store(settings.directory, *settings.s3) : open_folder_store(settings.directory);
}

}  // namespace dts::fleet::hub
