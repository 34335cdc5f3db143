// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <system_error>

#include "fleet/hub/durable_file.h"
#include "fleet/hub/store.h"
#include "fleet/s3/bucket.h"

namespace dts::fleet::hub {
namespace {

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
    // The process's number: dts-hub rebuild may run beside dts-hub.
    const std::string path = fetched_folder() + "/" + std::to_string(::getpid()) + "-" + std::to_string(++copies_);
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

  /// Removes copies that a killed process has left. It may have had the number of this one: in a container, all have number 1.
  [[nodiscard]] core::Status prepare() const {
    DTS_TRY(create_folder(fetched_folder()));
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(fetched_folder(), error)) {
      const std::string file = entry.path().filename().string();
      const std::string process = file.substr(0, file.find('-'));
      const bool is_own = process == std::to_string(::getpid());
      if (is_own || !std::filesystem::exists("/proc/" + process, error)) std::filesystem::remove(entry.path(), error);
    }
    return {};
  }

 private:
  [[nodiscard]] std::string fetched_folder() const { return folder() + "/fetched"; }

  std::unique_ptr<s3::Bucket> bucket_;
  mutable std::atomic<std::uint64_t> copies_ = 0;
};

}  // namespace

core::Result<std::unique_ptr<Store>> open_s3_store(const std::string& folder, const s3::Settings& settings) {
  DTS_TRY_ASSIGN(auto bucket, s3::Bucket::open(settings));
  auto store = std::make_unique<S3Store>(folder, std::move(bucket));
  DTS_TRY(store->prepare());
  return store;
}

}  // namespace dts::fleet::hub
