// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::fleet::hub {

/// A recording of a clinic. The clinic's name and the sum are checked before: both become names of files.
struct RecordingName {
  std::string clinic;
  std::string sha256;  ///< 32 bytes.

  friend auto operator<=>(const RecordingName&, const RecordingName&) = default;
};

/// Where whole recordings are kept. Several hubs may share a store. Thread: any.
class Store {
 public:
  virtual ~Store() = default;

  /// Returns where a recording is kept: column store_key.
  [[nodiscard]] virtual std::string key(const RecordingName& name) const = 0;
  /// Moves a whole, synchronised file into the store. When this returns, it is durable. Replaces the same recording.
  [[nodiscard]] virtual core::Status put(const RecordingName& name, const std::string& file) = 0;
  /// Returns a local file with the content of the recording; nothing if the store does not have it.
  [[nodiscard]] virtual core::Result<std::optional<std::string>> file(const RecordingName& name) const = 0;
  /// Removes the recording durably. Returns false if there was none.
  [[nodiscard]] virtual core::Result<bool> remove(const RecordingName& name) = 0;
  [[nodiscard]] virtual core::Result<std::vector<RecordingName>> list() const = 0;

  /// How much of the store is used, 0..100.
  [[nodiscard]] virtual double used_percent() const = 0;
  [[nodiscard]] virtual std::uint64_t free_bytes() const = 0;
};

/// Keeps recordings in FOLDER/objects/CLINIC/SHA256.
[[nodiscard]] core::Result<std::unique_ptr<Store>> open_folder_store(const std::string& folder);

}  // namespace dts::fleet::hub
