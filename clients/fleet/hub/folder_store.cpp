// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "fleet/hub/durable_file.h"
#include "fleet/hub/store.h"
#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {
namespace {

class FolderStore final : public Store {
 public:
  explicit FolderStore(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::string key(const RecordingName& name) const override {
    return "objects/" + name.clinic + "/" + wire::hex_of(name.sha256);
  }

  [[nodiscard]] core::Status put(const RecordingName& name, const std::string& file) override {
    DTS_TRY(create_folder(clinic_folder(name)));
    if (std::rename(file.c_str(), path(name).c_str()) != 0) {
      return core::fail_errno(errno, "cannot move '" + file + "' to '" + path(name) + "'", "check that both are on one file system");
    }
    return synchronise(clinic_folder(name));
  }

  [[nodiscard]] core::Result<std::optional<std::string>> file(const RecordingName& name) const override {
    struct stat status {};
    if (::stat(path(name).c_str(), &status) == 0) return std::optional(path(name));
    if (errno == ENOENT) return std::optional<std::string>();
    return core::fail_errno(errno, "cannot look for '" + path(name) + "'", "check the disk");
  }

  [[nodiscard]] core::Result<bool> remove(const RecordingName& name) override { return remove_file(path(name)); }

  [[nodiscard]] core::Result<std::vector<RecordingName>> list() const override {
    std::vector<RecordingName> names;
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator entry(folder_ + "/objects", error), end; !error && entry != end;
         entry.increment(error)) {
      if (entry.depth() != 1) continue;
      const auto sum = wire::bytes_of_hex(entry->path().filename().string());
      const std::string clinic = entry->path().parent_path().filename().string();
      if (sum && wire::is_clinic_name(clinic)) names.push_back({clinic, *sum});
    }
    if (error) return core::fail(core::ErrorCode::Failed, "cannot list '" + folder_ + "/objects': " + error.message(), "check the disk");
    return names;
  }

  [[nodiscard]] double used_percent() const override {
    struct statvfs disk {};
    if (::statvfs(folder_.c_str(), &disk) != 0) return 100.0;
    const auto used = static_cast<double>(disk.f_blocks - disk.f_bfree);
    return 100.0 * used / (used + static_cast<double>(disk.f_bavail));
  }

  [[nodiscard]] std::uint64_t free_bytes() const override {
    struct statvfs disk {};
    return ::statvfs(folder_.c_str(), &disk) != 0 ? 0 : std::uint64_t{disk.f_bavail} * disk.f_frsize;
  }

 private:
  [[nodiscard]] std::string clinic_folder(const RecordingName& name) const { return folder_ + "/objects/" + name.clinic; }
  [[nodiscard]] std::string path(const RecordingName& name) const { return folder_ + "/" + key(name); }

  std::string folder_;
};

}  // namespace

core::Result<std::unique_ptr<Store>> open_folder_store(const std::string& folder) {
  DTS_TRY(create_folder(folder + "/objects"));
  return std::make_unique<FolderStore>(folder);
}

}  // namespace dts::fleet::hub
