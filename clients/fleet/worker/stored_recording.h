// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "core/result.h"
#include "fleet/s3/bucket.h"

namespace dts::fleet::worker {

/// Returns the file of a recording in a store that is a folder. Fails with DataDamaged if the key would lead out of the folder, and with
/// NotFound if it is empty.
[[nodiscard]] core::Result<std::string> stored_file(const std::string& directory, const std::string& key);

/// Reads the whole file. Calls `keeps_on` after each MiB. Fails with NotFound if there is no such file, DataDamaged if its SHA-256
/// (hexadecimal) is another one, and WrongState if `keeps_on` returned false.
[[nodiscard]] core::Status check_sha256(const std::string& file, const std::string& sha256, const std::function<bool()>& keeps_on);

/// A name that ends in .xdf for a recording, whose name in the store is its SHA-256: dtslab recognises recordings by their names. The name
/// is removed with this object.
class RecordingName {
 public:
  /// Fails if the folder of temporary files is not writable.
  [[nodiscard]] static core::Result<RecordingName> create(const std::string& file);
  /// The name is that of a copy, which is removed with it. Fails as `Bucket::get` does.
  [[nodiscard]] static core::Result<RecordingName> fetch(s3::Bucket& bucket, const std::string& key, const std::function<bool()>& keeps_on);
  ~RecordingName();
  RecordingName(const RecordingName&) = delete;
  RecordingName& operator=(const RecordingName&) = delete;
  RecordingName(RecordingName&& other) noexcept;
  RecordingName& operator=(RecordingName&&) = delete;

  [[nodiscard]] std::string path() const { return folder_ + "/recording.xdf"; }

 private:
  [[nodiscard]] static core::Result<RecordingName> in_new_folder();
  explicit RecordingName(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;  ///< Empty: none.
};

}  // namespace dts::fleet::worker
