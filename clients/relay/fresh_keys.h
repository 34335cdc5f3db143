// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <ctime>
#include <memory>
#include <mutex>
#include <string>

#include "access/key_store.h"
#include "core/log.h"

namespace dts::relay {

/// The keys of clients as their file has them now: dtsd and people change it. Thread: any.
class FreshKeys {
 public:
  /// Opens dtsd's folder of keys. Fails with NotFound if dtsd has not made its own key yet, and as KeyStore::open.
  [[nodiscard]] static core::Result<std::unique_ptr<FreshKeys>> open(const std::string& directory, core::Log log);

  /// Reads the keys again if the file has changed since the last look. A damaged file is logged once, changes nothing,
  /// and is tried again.
  void look();
  [[nodiscard]] access::KeyStore& store() noexcept { return *store_; }

 private:
  /// What changes whenever the file is replaced or written.
  struct Stamp {
    ino_t inode = 0;
    off_t bytes = -1;  ///< -1: there is no file.
    timespec modified{};
    [[nodiscard]] bool is_same(const Stamp& other) const noexcept;
  };
  FreshKeys(std::string file, std::unique_ptr<access::KeyStore> store, core::Log log)
      : file_(std::move(file)), store_(std::move(store)), log_(std::move(log)) {}
  [[nodiscard]] Stamp stamp() const;

  std::string file_;
  std::unique_ptr<access::KeyStore> store_;
  core::Log log_;
  std::mutex mutex_;
  Stamp seen_;
  Stamp failed_;  ///< Could not be read; is logged once.
};

}  // namespace dts::relay
