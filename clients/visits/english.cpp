// SPDX-License-Identifier: Apache-2.0
#include "visits/sentences.h"

namespace dts::visits {
namespace {

std::string en(double value, int decimals) { return figure(value, decimals, '.'); }

class English final : public Sentences {
 public:
  [[nodiscard]] std::string language() const override { return "en"; }
  [[nodiscard]] std::string condition(const std::string& name, const std::string& title) const override {
    return title.empty() ? spoken_condition(name) : title;
  }

  [[nodiscard]] std::string label(const std::string& name, const std::string& value) const override {
    if (name == "feet" && value == "one") return "one foot";
    if (name == "feet" && value == "two") return "two feet";
    if (name == "surface" && value == "firm") return "firm surface";
    if (name == "surface" && value == "foam") return "foam";
    return {};
  }

  [[nodiscard]] std::string ellipse_eyes_closed(const std::string& stance, const Change& mm2) const override {
    const std::string begin = stance.empty() ? "With" : stance + ": with";
    const std::string values = " (" + en(mm2.to, 0) + " against " + en(mm2.from, 0) + " mm²).";
    if (mm2.is_same()) return begin + " eyes closed the ellipse is as large as with eyes open" + values;
    return begin + " eyes closed the ellipse is " + std::to_string(mm2.percent()) + " % " + (mm2.is_rise() ? "larger" : "smaller") +
           " than with eyes open" + values;
  }
  [[nodiscard]] std::string velocity_eyes_closed(const std::string& stance, const Change& mm_s) const override {
    const std::string begin = stance.empty() ? "With" : stance + ": with";
    const std::string values = " (" + en(mm_s.to, 1) + " against " + en(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return begin + " eyes closed the mean velocity is the same as with eyes open" + values;
    return begin + " eyes closed the mean velocity is " + std::to_string(mm_s.percent()) + " % " + (mm_s.is_rise() ? "higher" : "lower") +
           " than with eyes open" + values;
  }

  [[nodiscard]] std::string trunk_at_target(const std::string& condition, double mean_deg, std::uint32_t angles) const override {
    const std::string mean = condition + ": the trunk bent " + en(mean_deg, 1) + "° on average";
    if (angles == 0) return mean + ".";
    return mean + ", in " + std::to_string(angles) + (angles == 1 ? " reach." : " reaches.");
  }
  [[nodiscard]] std::string classes_as_expected(std::uint32_t agreed, std::uint32_t compared) const override {
    return "The trunk class was as expected for the target in " + std::to_string(agreed) + " of " + std::to_string(compared) +
           (compared == 1 ? " trial." : " trials.") + " A trial without a reach counts if its target needs no trunk movement.";
  }
  [[nodiscard]] std::string reaches_without_class(std::uint32_t rejected, std::uint32_t classified) const override {
    return "The trunk class is missing for " + std::to_string(rejected) + " of " + std::to_string(classified) +
           (classified == 1 ? " reach." : " reaches.");
  }
  [[nodiscard]] std::string trunk_consistency(double sd_deg) const override {
    return "At the same target the trunk angle varied by " + en(sd_deg, 1) + "° from reach to reach (standard deviation).";
  }

  [[nodiscard]] std::string ellipse_since(const std::string& condition, const Change& mm2, const std::string& day) const override {
    const std::string values = " on " + day + " (" + en(mm2.to, 0) + " against " + en(mm2.from, 0) + " mm²).";
    if (mm2.is_same()) return condition + ": the ellipse is as large as" + values;
    return condition + ": the ellipse is " + std::to_string(mm2.percent()) + " % " + (mm2.is_rise() ? "larger" : "smaller") + " than" +
           values;
  }
  [[nodiscard]] std::string velocity_since(const std::string& condition, const Change& mm_s, const std::string& day) const override {
    const std::string values = " on " + day + " (" + en(mm_s.to, 1) + " against " + en(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return condition + ": the mean velocity is the same as" + values;
    return condition + ": the mean velocity is " + std::to_string(mm_s.percent()) + " % " + (mm_s.is_rise() ? "higher" : "lower") +
           " than" + values;
  }
  [[nodiscard]] std::string velocity_ml_since(const std::string& condition, const Change& mm_s, const std::string& day) const override {
    const std::string values = " on " + day + " (" + en(mm_s.to, 1) + " against " + en(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return condition + ": the mean velocity to the sides is the same as" + values;
    return condition + ": the mean velocity to the sides is " + std::to_string(mm_s.percent()) + " % " +
           (mm_s.is_rise() ? "higher" : "lower") + " than" + values;
  }
  [[nodiscard]] std::string trunk_since(const std::string& condition, double from_deg, double to_deg,
                                        const std::string& day) const override {
    const std::string values = " on " + day + " (" + en(to_deg, 1) + "° against " + en(from_deg, 1) + "°).";
    const std::string amount = en(to_deg > from_deg ? to_deg - from_deg : from_deg - to_deg, 1);
    if (amount == "0.0") return condition + ": the trunk bent as much as" + values;
    return condition + ": the trunk bent " + amount + "° " + (to_deg > from_deg ? "more" : "less") + " than" + values;
  }
  [[nodiscard]] std::string trunk_spread_since(const std::string& condition, double from_deg, double to_deg,
                                               const std::string& day) const override {
    const std::string values = " on " + day + " (standard deviation " + en(to_deg, 1) + "° against " + en(from_deg, 1) + "°).";
    if (en(from_deg, 1) == en(to_deg, 1)) return condition + ": the trunk angle varied as much as" + values;
    return condition + ": the trunk angle varied " + (to_deg > from_deg ? "more" : "less") + " than" + values;
  }
  [[nodiscard]] std::string within_retest(double percent) const override {
    return "This is within the variation between two days that is known of people above 65 and trials of 45 s (" + en(percent, 0) +
           " % of the mean of both).";
  }
  [[nodiscard]] std::string beyond_retest(double percent) const override {
    return "This is more than the variation between two days that is known of people above 65 and trials of 45 s (" + en(percent, 0) +
           " % of the mean of both).";
  }
  [[nodiscard]] std::string no_retest_known() const override {
    return "For measures without this remark no published variation is known here: the difference may be chance.";
  }
};

}  // namespace

const Sentences& english() noexcept {
  static const English only;
  return only;
}

}  // namespace dts::visits
