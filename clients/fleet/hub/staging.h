// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "dts/v1/fleet.pb.h"
#include "fleet/hub/store.h"

namespace dts::fleet::hub {

/// The files of uploads that are not whole yet: FOLDER/CLINIC/SHA256.part, and the offer beside it in SHA256.offer, so that uploads
/// continue after a restart. Nothing here is synchronised before the commit: what a power failure tears, the SHA-256 finds. Thread: one at
/// a time.
class Staging {
 public:
  struct Upload {
    RecordingName name;
    v1::UploadOffer offer;
    std::uint64_t have = 0;  ///< Bytes from the start of the file.
    std::int64_t changed_utc_ns = 0;
  };

  /// Fails with WrongState if another process uses the folder: two hubs have the same name.
  [[nodiscard]] static core::Result<std::unique_ptr<Staging>> open(const std::string& folder);
  ~Staging();
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  Staging(Staging&&) = delete;
  Staging& operator=(Staging&&) = delete;

  /// Returns the uploads that an earlier process left; removes files without a readable offer.
  [[nodiscard]] core::Result<std::vector<Upload>> load();
  [[nodiscard]] core::Status begin(const RecordingName& name, const v1::UploadOffer& offer);
  /// Writes `data` at `offset`, which is the number of bytes that the file has. If this fails, the file keeps that length.
  [[nodiscard]] core::Status write(const RecordingName& name, std::uint64_t offset, std::string_view data);
  /// Empties the file: its content is not what was offered.
  [[nodiscard]] core::Status restart(const RecordingName& name);
  /// Removes file and offer.
  void remove(const RecordingName& name);

  [[nodiscard]] std::string file(const RecordingName& name) const;

 private:
  Staging(std::string folder, int lock) : folder_(std::move(folder)), lock_(lock) {}
  [[nodiscard]] std::string offer_file(const RecordingName& name) const;

  std::string folder_;
  int lock_;
};

}  // namespace dts::fleet::hub
