// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/language.h"
#include "report/page_content.h"
#include "session/protocol.h"

namespace dts::report {

/// An English text and its translation. "{}" stands for any text, which is translated too; "{!}" for a text of a person or a device, which
/// stays as it is; "{#}" for a number. A translation has as many "{}", in the same order.
using Translated = std::pair<std::string_view, std::string_view>;

/// The German of every text of the pages.
[[nodiscard]] std::span<const Translated> german_texts() noexcept;

/// Translates the texts of pages. Numbers get the decimal sign of the language. A text that the catalogue lacks stays English.
class Translation {
 public:
  /// `protocol`: the recorded one; the names that it has in the language are used.
  Translation(Language language, const session::Protocol& protocol);

  [[nodiscard]] Language language() const noexcept { return language_; }
  [[nodiscard]] std::string operator()(std::string_view english) const;
  /// Translates a page. The content of facts that people type (label, notes, subject ID) stays as it is.
  [[nodiscard]] PageContent operator()(PageContent page) const;

 private:
  struct Entry {
    std::vector<std::string> literals;  ///< Of the English text, around each place.
    std::string places;                 ///< The kind of each place: '}' any, '!' verbatim, '#' a number.
    std::string translated;
    std::size_t letters = 0;
  };
  void add(std::string_view english, std::string_view translated);
  [[nodiscard]] std::string text(std::string_view english, int depth) const;

  Language language_;
  std::vector<std::pair<std::string, std::string>> whole_;  ///< Sorted texts without "{}".
  std::vector<Entry> entries_;                              ///< The text with the most letters first, so that the closest one is found.
};

}  // namespace dts::report
