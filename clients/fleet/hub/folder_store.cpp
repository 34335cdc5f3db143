// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "fleet/hub/durable_file.h"
#include "fleet/hub/store.h"

namespace dts::fleet::hub {
namespace {

class FolderStore final : public Store {
 public:
  explicit FolderStore(const std::string& folder) : Store(folder) {}

  [[nodiscard]] core::Status put(const RecordingName& name, const std::string& file) override {
    DTS_TRY(create_folder(clinic_folder(name)));
    if (std::rename(file.c_str(), path(name).c_str()) != 0) {
      return core::fail_errno(errno, "cannot move '" + file + "' to '" + path(name) + "'", "check that both are on one file system");
    }
    return synchronise(clinic_folder(name));
  }

  [[nodiscard]] core::Result<bool> has(const RecordingName& name) const override {
    struct stat status {};
    if (::stat(path(name).c_str(), &status) == 0) return true;
    if (errno == ENOENT) return false;
    return core::fail_errno(errno, "cannot look for '" + path(name) + "'", "check the disk");
  }

  [[nodiscard]] core::Result<std::optional<LocalFile>> file(const RecordingName& name) const override {
    DTS_TRY_ASSIGN(const bool is_here, has(name));
    return is_here ? std::optional(LocalFile::of_store(path(name))) : std::nullopt;
  }

  [[nodiscard]] core::Result<bool> remove(const RecordingName& name) override { return remove_file(path(name)); }

  [[nodiscard]] core::Result<std::vector<RecordingName>> list() const override {
    std::vector<RecordingName> names;
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator entry(folder() + "/objects", error), end; !error && entry != end;
         entry.increment(error)) {
      if (entry.depth() != 1) continue;
      if (auto name = name_of(entry->path().lexically_relative(folder()).string())) names.push_back(*std::move(name));
    }
    if (error) return core::fail(core::ErrorCode::Failed, "cannot list '" + folder() + "/objects': " + error.message(), "check the disk");
    return names;
  }

 private:
  [[nodiscard]] std::string clinic_folder(const RecordingName& name) const { return folder() + "/objects/" + name.clinic; }
  [[nodiscard]] std::string path(const RecordingName& name) const { return folder() + "/" + key_of(name); }
};

}  // namespace

core::Result<std::unique_ptr<Store>> open_folder_store(const std::string& folder) {
  DTS_TRY(create_folder(folder + "/objects"));
  return std::make_unique<FolderStore>(folder);
}

}  // namespace dts::fleet::hub
