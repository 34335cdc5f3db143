// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "fleet/s3/settings.h"

namespace dts::fleet::s3 {

class Connection;

/// One page of a listing.
struct Page {
  std::vector<std::string> keys{};
  std::string next{};  ///< The last key, for the next page; empty: there is none.
};

/// The objects of one bucket. A key has only characters that an address need not encode: a-z, 0-9, "-", "/". Errors: Unreachable, if the
/// server does not answer, does not answer wholly, or with another status than expected; the message has its reason. Thread: any; each call
/// waits for the server.
class Bucket {
 public:
  static constexpr std::uint64_t kMostWhole = 64ULL * 1024 * 1024;  ///< Larger files are sent in parts.
  static constexpr std::uint64_t kLeastPart = 16ULL * 1024 * 1024;
  static constexpr std::uint64_t kMostParts = 10'000;  ///< S3 accepts no more.

  /// Reads the credentials, and asks for the bucket. Fails as `read_credentials` does, with InvalidArgument if `settings.ca_file` cannot be
  /// read, and with NotFound if there is no such bucket. A server that does not answer is no failure.
  [[nodiscard]] static core::Result<std::unique_ptr<Bucket>> open(Settings settings);
  ~Bucket();
  Bucket(const Bucket&) = delete;
  Bucket& operator=(const Bucket&) = delete;
  Bucket(Bucket&&) = delete;
  Bucket& operator=(Bucket&&) = delete;

  /// Sends a file with this SHA-256 (32 bytes). The server checks the SHA-256 of each request, and this object that of all bytes sent.
  /// Then asks for the object, and compares size and ETag. Fails with DataDamaged if the bytes sent have another SHA-256: the object is
  /// then removed.
  [[nodiscard]] core::Status put(const std::string& key, const std::string& file, const std::string& sha256);
  /// Returns the size of an object; nothing if there is none.
  [[nodiscard]] core::Result<std::optional<std::uint64_t>> size(const std::string& key);
  /// Writes an object to a new file with mode 0600, without filling its disk. Removes the file if this fails. `keeps_on` is called for each
  /// piece; false ends it with WrongState. Fails with NotFound if there is no object, DataDamaged if the key is none, LimitExceeded if the
  /// object does not fit, and Failed if the file cannot be written.
  [[nodiscard]] core::Status get(const std::string& key, const std::string& file, const std::function<bool()>& keeps_on);
  /// Returns false if there was no object in the bucket.
  [[nodiscard]] core::Result<bool> remove(const std::string& key);
  /// Returns at most 1000 keys that begin with `prefix`. `next`: of the page before, empty for the first.
  [[nodiscard]] core::Result<Page> list(const std::string& prefix, const std::string& next);

 private:
  class Lent;
  struct Stored {
    std::uint64_t bytes = 0;
    std::string etag{};
  };
  struct Upload;

  Bucket(Settings settings, Credentials credentials);
  [[nodiscard]] std::string path_of(const std::string& key) const { return "/" + settings_.bucket + "/" + key; }
  /// Fails with NotFound if there is no such bucket.
  [[nodiscard]] core::Status look(Connection& connection) const;
  [[nodiscard]] core::Result<std::optional<Stored>> find(Connection& connection, const std::string& key) const;
  [[nodiscard]] core::Result<std::string> put_whole(Connection& connection, const Upload& upload) const;
  [[nodiscard]] core::Result<std::string> put_parts(Connection& connection, const Upload& upload) const;
  [[nodiscard]] core::Result<std::string> send_parts(Connection& connection, const Upload& upload, const std::string& id) const;
  [[nodiscard]] core::Result<std::string> complete(Connection& connection, const Upload& upload, const std::string& id,
                                                   const std::vector<std::string>& etags) const;

  Settings settings_;
  Credentials credentials_;
  std::mutex mutex_;                                 ///< Protects the next member.
  std::vector<std::unique_ptr<Connection>> idle_{};  ///< Open connections, for the next calls.
};

}  // namespace dts::fleet::s3
