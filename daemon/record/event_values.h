// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "core/result.h"
#include "record/event.h"

namespace dts::record {

/// Takes values out of an event; remembers the first key that was not as it should be.
class EventValues {
 public:
  explicit EventValues(const RecordedEvent& event) : event_(event) {}

  [[nodiscard]] const EventValue* find(const std::string& key) const;
  /// NaN is allowed: what is not known. A whole number counts as a number.
  double number(const std::string& key);
  std::int64_t whole(const std::string& key, std::int64_t minimum, std::int64_t maximum);
  template <class Number>
  Number count(const std::string& key) {
    constexpr auto kLargest = std::min<std::uint64_t>(std::numeric_limits<Number>::max(), std::numeric_limits<std::int64_t>::max());
    return static_cast<Number>(whole(key, 0, static_cast<std::int64_t>(kLargest)));
  }
  std::string text(const std::string& key);
  /// A nested value, as it is written.
  std::string json(const std::string& key);
  void refuse(const std::string& key);
  /// DataDamaged, naming the first key that was refused.
  [[nodiscard]] core::Status check() const;

 private:
  const EventValue* needed(const std::string& key);

  const RecordedEvent& event_;
  std::string problem_;
};

}  // namespace dts::record
