// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// A recording of a clinic. The clinic's name and the sum are checked before: both become names of files.
struct RecordingName {
  std::string clinic;
  std::string sha256;  ///< 32 bytes.

  friend auto operator<=>(const RecordingName&, const RecordingName&) = default;
};

/// A file with the content of a recording. A copy is removed with this object.
class LocalFile {
 public:
  static LocalFile of_store(std::string path) { return {std::move(path), false}; }
  static LocalFile copy(std::string path) { return {std::move(path), true}; }
  ~LocalFile();
  LocalFile(const LocalFile&) = delete;
  LocalFile& operator=(const LocalFile&) = delete;
  LocalFile(LocalFile&& other) noexcept;
  LocalFile& operator=(LocalFile&&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  LocalFile(std::string path, bool is_copy) : path_(std::move(path)), is_copy_(is_copy) {}

  std::string path_;
  bool is_copy_;
};

/// Where whole recordings are kept. Several hubs may share a store. Errors: Unreachable if the store is another machine that does not
/// answer; nothing is then known, and the caller tries again. Else as the disk. Thread: any.
class Store {
 public:
  virtual ~Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;
  Store(Store&&) = delete;
  Store& operator=(Store&&) = delete;

  /// Moves a whole, synchronised file into the store. When this returns, it is durable. Replaces the same recording. Fails with
  /// DataDamaged if the file has changed: its bytes have another SHA-256 now.
  [[nodiscard]] virtual core::Status put(const RecordingName& name, const std::string& file) = 0;
  [[nodiscard]] virtual core::Result<bool> has(const RecordingName& name) const = 0;
  /// Returns a file with the content of the recording; nothing if the store does not have it. May take as long as receiving all of it.
  [[nodiscard]] virtual core::Result<std::optional<LocalFile>> file(const RecordingName& name) const = 0;
  /// Removes the recording durably. Returns false if there was none.
  [[nodiscard]] virtual core::Result<bool> remove(const RecordingName& name) = 0;
  [[nodiscard]] virtual core::Result<std::vector<RecordingName>> list() const = 0;

  /// How much of the disk with the staged files is used, 0..100: 100 if that is not known. A store that is a folder is on the same disk.
  [[nodiscard]] double used_percent() const;
  [[nodiscard]] std::uint64_t free_bytes() const;

 protected:
  explicit Store(std::string folder) : folder_(std::move(folder)) {}
  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }

 private:
  std::string folder_;
};

/// Returns where a recording is kept in each store, "objects/CLINIC/SHA256": column store_key.
[[nodiscard]] std::string key_of(const RecordingName& name);
/// Returns the recording with this key; nothing if it is not that of a recording.
[[nodiscard]] std::optional<RecordingName> name_of(const std::string& key);

/// Opens the store of [store]: the bucket, if one is configured, else the folder. Fails as both do.
[[nodiscard]] core::Result<std::unique_ptr<Store>> open_store(const Settings& settings);

/// Keeps recordings in FOLDER/objects/CLINIC/SHA256.
[[nodiscard]] core::Result<std::unique_ptr<Store>> open_folder_store(const std::string& folder);
/// Keeps recordings in a bucket, and copies that are needed for a moment in FOLDER/fetched. One store of a folder in each process: it
/// removes what earlier processes have left there.
[[nodiscard]] core::Result<std::unique_ptr<Store>> open_s3_store(const std::string& folder, const s3::Settings& settings);

}  // namespace dts::fleet::hub
