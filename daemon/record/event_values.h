// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "core/result.h"
#include "record/event.h"

namespace dts::record {

/// Reads values of an event and remembers the first key whose value is missing or invalid.
class EventValues {
 public:
  explicit EventValues(const RecordedEvent& event) : event_(event) {}

  [[nodiscard]] const EventValue* find(const std::string& key) const;
  /// Returns a number; NaN means "not known". Accepts whole numbers too.
  double number(const std::string& key);
  std::int64_t whole(const std::string& key, std::int64_t minimum, std::int64_t maximum);
  template <class Number>
  Number count(const std::string& key) {
    constexpr auto kLargest = std::min<std::uint64_t>(std::numeric_limits<Number>::max(), std::numeric_limits<std::int64_t>::max());
    return static_cast<Number>(whole(key, 0, static_cast<std::int64_t>(kLargest)));
  }
  std::string text(const std::string& key);
  /// Returns the text of a nested JSON value.
  std::string json(const std::string& key);
  /// Remembers `key` as invalid, unless an earlier key is remembered.
  void refuse(const std::string& key);
  /// Fails with DataDamaged if a key was missing or invalid; the message names the first one.
  [[nodiscard]] core::Status check() const;

 private:
  const EventValue* needed(const std::string& key);

  const RecordedEvent& event_;
  std::string problem_;
};

}  // namespace dts::record
