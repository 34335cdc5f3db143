// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace dts::visits {

/// Two values of the same measure. `from` is greater than 0.
struct Change {
  double from = 0.0;
  double to = 0.0;

  /// Returns the whole percent of `from` by which the values differ, without sign.
  [[nodiscard]] long percent() const;
  [[nodiscard]] bool is_same() const { return percent() == 0; }
  [[nodiscard]] bool is_rise() const noexcept { return to > from; }
};

/// All sentences about results in one language. Each is a function with the figures as arguments, because languages order words
/// differently: no sentence is put together from fragments. A sentence says what was measured. It never judges a person.
class Sentences {
 public:
  [[nodiscard]] virtual std::string language() const = 0;  ///< "en", "de"
  virtual ~Sentences() = default;
  Sentences(const Sentences&) = delete;
  Sentences& operator=(const Sentences&) = delete;

  /// Returns the name of a condition for the start of a sentence. `title`: from the protocol; empty: not known.
  [[nodiscard]] virtual std::string condition(const std::string& name, const std::string& title) const = 0;

  /// Returns the words of one label of a condition ("feet", "one"); empty: not known.
  [[nodiscard]] virtual std::string label(const std::string& name, const std::string& value) const = 0;

  // One session: eyes closed (`to`) against eyes open (`from`), same stance and duration. `stance`: see stance_words; empty: not known.
  [[nodiscard]] virtual std::string ellipse_eyes_closed(const std::string& stance, const Change& mm2) const = 0;
  [[nodiscard]] virtual std::string velocity_eyes_closed(const std::string& stance, const Change& mm_s) const = 0;

  // One session of reaches. `angles`: how many are averaged; 0: not known.
  [[nodiscard]] virtual std::string trunk_at_target(const std::string& condition, double mean_deg, std::uint32_t angles) const = 0;
  [[nodiscard]] virtual std::string classes_as_expected(std::uint32_t agreed, std::uint32_t compared) const = 0;
  [[nodiscard]] virtual std::string reaches_without_class(std::uint32_t rejected, std::uint32_t classified) const = 0;
  [[nodiscard]] virtual std::string trunk_consistency(double sd_deg) const = 0;

  // The newest visit (`to`) against an earlier one (`from`), which was on `day` ("2026-11-21", UTC).
  [[nodiscard]] virtual std::string ellipse_since(const std::string& condition, const Change& mm2, const std::string& day) const = 0;
  [[nodiscard]] virtual std::string velocity_since(const std::string& condition, const Change& mm_s, const std::string& day) const = 0;
  [[nodiscard]] virtual std::string velocity_ml_since(const std::string& condition, const Change& mm_s, const std::string& day) const = 0;
  [[nodiscard]] virtual std::string trunk_since(const std::string& condition, double from_deg, double to_deg,
                                                const std::string& day) const = 0;
  [[nodiscard]] virtual std::string trunk_spread_since(const std::string& condition, double from_deg, double to_deg,
                                                       const std::string& day) const = 0;
  // Behind a sentence of a change. Two days, 45 s: the study is that of retest.cpp.
  [[nodiscard]] virtual std::string within_retest(double percent) const = 0;
  [[nodiscard]] virtual std::string beyond_retest(double percent) const = 0;
  /// Stands once below changes without a known variation.
  [[nodiscard]] virtual std::string no_retest_known() const = 0;

 protected:
  Sentences() = default;
};

[[nodiscard]] const Sentences& english() noexcept;
[[nodiscard]] const Sentences& german() noexcept;
/// Returns German for "de", "de-AT", ...; else English.
[[nodiscard]] const Sentences& sentences_in(std::string_view language) noexcept;

/// Returns a number with fixed decimals and this decimal sign; for the languages.
[[nodiscard]] std::string figure(double value, int decimals, char decimal_sign);
/// Returns a condition's name as words: "eyes-open" becomes "Eyes open".
[[nodiscard]] std::string spoken_condition(const std::string& name);
/// Returns labels as words: "feet=one,surface=firm" becomes "One foot, firm surface".
[[nodiscard]] std::string stance_words(const std::string& labels, const Sentences& sentences);

}  // namespace dts::visits
