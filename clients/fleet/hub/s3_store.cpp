// SPDX-License-Identifier: Apache-2.0
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "fleet/hub/durable_file.h"
#include "fleet/hub/store.h"
#include "fleet/s3/bucket.h"
#include "fleet/s3/sha256.h"

namespace dts::fleet::hub {
namespace {

constexpr std::size_t kRandomBytes = 8;

/// What the names of this machine's copies begin with until it is started again.
std::string boot_id() {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return id;
}

/// Returns the beginning of the names of this process's copies: "BOOT.PID.". dts-hub rebuild may run beside dts-hub.
std::string own_prefix() { return boot_id() + "." + std::to_string(::getpid()) + "."; }

class S3Store final : public Store {
 public:
  S3Store(const std::string& folder, std::unique_ptr<s3::Bucket> bucket) : Store(folder), bucket_(std::move(bucket)) {}

  [[nodiscard]] core::Status put(const RecordingName& name, const std::string& file) override {
    DTS_TRY(bucket_->put(key_of(name), file, name.sha256));
    static_cast<void>(::unlink(file.c_str()));
    return {};
  }

  [[nodiscard]] core::Result<bool> has(const RecordingName& name) const override {
    DTS_TRY_ASSIGN(const auto size, bucket_->size(key_of(name)));
    return size.has_value();
  }

  [[nodiscard]] core::Result<std::optional<LocalFile>> file(const RecordingName& name) const override {
    std::string random(kRandomBytes, '\0');
    if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) return core::fail_errno(errno, "getrandom");
    const std::string path = fetched_folder() + "/" + own_prefix() + s3::hexadecimal(random);
    const auto got = bucket_->get(key_of(name), path, [] { return true; });
    if (got) return std::optional(LocalFile::copy(path));
    if (got.error().code == core::ErrorCode::NotFound) return std::nullopt;
    return tl::make_unexpected(got.error());
  }

  [[nodiscard]] core::Result<bool> remove(const RecordingName& name) override { return bucket_->remove(key_of(name)); }

  [[nodiscard]] core::Result<std::vector<RecordingName>> list() const override {
    std::vector<RecordingName> names;
    std::string next;
    do {
      DTS_TRY_ASSIGN(s3::Page page, bucket_->list("objects/", next));
      for (const std::string& key : page.keys) {
        if (auto name = name_of(key)) names.push_back(*std::move(name));
      }
      next = std::move(page.next);
    } while (!next.empty());
    return names;
  }

  /// Removes copies that a hub has left that was killed: of another boot, of a process that is gone, and of one that had our number.
  [[nodiscard]] core::Status prepare() const {
    DTS_TRY(create_folder(fetched_folder()));
    const std::string boot = boot_id() + ".";
    const std::string own = own_prefix();
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(fetched_folder(), error)) {
      const std::string file = entry.path().filename().string();
      const bool is_of_boot = file.starts_with(boot);
      const std::string process = is_of_boot ? file.substr(boot.size(), file.find('.', boot.size()) - boot.size()) : "";
      const bool is_used = is_of_boot && !file.starts_with(own) && std::filesystem::exists("/proc/" + process, error);
      if (!is_used) std::filesystem::remove(entry.path(), error);
    }
    return {};
  }

 private:
  [[nodiscard]] std::string fetched_folder() const { return folder() + "/fetched"; }

  std::unique_ptr<s3::Bucket> bucket_;
};

}  // namespace

core::Result<std::unique_ptr<Store>> open_s3_store(const std::string& folder, const s3::Settings& settings) {
  DTS_TRY_ASSIGN(auto bucket, s3::Bucket::open(settings));
  auto store = std::make_unique<S3Store>(folder, std::move(bucket));
  DTS_TRY(store->prepare());
  return store;
}

}  // namespace dts::fleet::hub
