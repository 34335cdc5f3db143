// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// The body of one answer, read in pieces. `FileBody::when_done` is called exactly once, whatever happens.
class BodySource {
 public:
  static constexpr std::size_t kPieceBytes = 64U << 10U;

  explicit BodySource(std::variant<std::string, FileBody> body);
  ~BodySource();
  BodySource(BodySource&&) = delete;

  /// Returns false if the file cannot be read or is not a regular file.
  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  /// Returns the size of the whole body, including pieces already read. For a file, its size at the start: this size is announced and sent.
  [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_bytes_; }
  /// Returns the next piece, valid until the next call; empty at the end. Returns nothing if the file is now shorter than announced.
  [[nodiscard]] std::optional<std::string_view> next();
  /// Ends the reading; the last piece stays valid.
  void give_up();

 private:
  std::string text_;
  std::function<void()> when_done_;
  int file_ = -1;
  bool is_good_ = true;
  std::uint64_t size_bytes_ = 0;
  std::uint64_t taken_bytes_ = 0;
};

}  // namespace dts::gateway
