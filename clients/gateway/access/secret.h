// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::gateway {

/// Overwrites a text, so that its content cannot be found in memory later. Afterwards the text is empty.
void wipe(std::string& text) noexcept;

/// A password in memory: never copied, wiped in the destructor.
class Secret {
 public:
  /// Copies the content of `text` and wipes `text`.
  explicit Secret(std::string&& text) : text_(text) { wipe(text); }
  Secret(Secret&& other) : Secret(std::move(other.text_)) {}  // a moved std::string may leave its text in memory
  Secret& operator=(Secret&&) = delete;
  Secret(const Secret&) = delete;
  Secret& operator=(const Secret&) = delete;
  ~Secret() { wipe(text_); }

  [[nodiscard]] std::string_view text() const noexcept { return text_; }

 private:
  std::string text_;
};

}  // namespace dts::gateway
