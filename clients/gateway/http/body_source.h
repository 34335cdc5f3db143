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

/// The body of one answer, in pieces. Whatever becomes of it, `FileBody::when_done` is called once.
class BodySource {
 public:
  static constexpr std::size_t kPieceBytes = 64U << 10U;

  explicit BodySource(std::variant<std::string, FileBody> body);
  ~BodySource();
  BodySource(BodySource&&) = delete;

  /// False: the file cannot be read, or is none.
  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  /// All of it, also what was already taken. A file's size at the start is what is promised, and what is sent.
  [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_bytes_; }
  /// The next piece, valid until the next call; empty at the end; nothing when the file turned out shorter than promised.
  [[nodiscard]] std::optional<std::string_view> next();
  /// Nothing more will be taken; the last piece stays valid.
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
