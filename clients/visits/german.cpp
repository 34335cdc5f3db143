// SPDX-License-Identifier: Apache-2.0
#include "visits/sentences.h"

namespace dts::visits {
namespace {

std::string de(double value, int decimals) { return figure(value, decimals, ','); }

/// "2026-11-21" becomes "21.11.2026".
std::string de_day(const std::string& day) {
  if (day.size() != 10) return day;
  return day.substr(8, 2) + "." + day.substr(5, 2) + "." + day.substr(0, 4);
}

class German final : public Sentences {
 public:
  [[nodiscard]] std::string language() const override { return "de"; }
  [[nodiscard]] std::string condition(const std::string& name, const std::string& title) const override {
    if (name == "eyes-open") return "Augen offen";
    if (name == "eyes-closed") return "Augen geschlossen";
    return title.empty() ? spoken_condition(name) : title;
  }

  [[nodiscard]] std::string label(const std::string& name, const std::string& value) const override {
    if (name == "feet" && value == "one") return "ein Fuß";
    if (name == "feet" && value == "two") return "zwei Füße";
    if (name == "surface" && value == "firm") return "fester Untergrund";
    if (name == "surface" && value == "foam") return "Schaumstoff";
    return {};
  }

  [[nodiscard]] std::string ellipse_eyes_closed(const std::string& stance, const Change& mm2) const override {
    const std::string begin = stance.empty() ? "Mit" : stance + ": Mit";
    const std::string values = " (" + de(mm2.to, 0) + " gegenüber " + de(mm2.from, 0) + " mm²).";
    if (mm2.is_same()) return begin + " geschlossenen Augen ist die Ellipse so groß wie mit offenen" + values;
    return begin + " geschlossenen Augen ist die Ellipse " + std::to_string(mm2.percent()) + " % " +
           (mm2.is_rise() ? "größer" : "kleiner") + " als mit offenen" + values;
  }
  [[nodiscard]] std::string velocity_eyes_closed(const std::string& stance, const Change& mm_s) const override {
    const std::string begin = stance.empty() ? "Mit" : stance + ": Mit";
    const std::string values = " (" + de(mm_s.to, 1) + " gegenüber " + de(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return begin + " geschlossenen Augen ist die mittlere Geschwindigkeit so hoch wie mit offenen" + values;
    return begin + " geschlossenen Augen ist die mittlere Geschwindigkeit " + std::to_string(mm_s.percent()) + " % " +
           (mm_s.is_rise() ? "höher" : "niedriger") + " als mit offenen" + values;
  }

  [[nodiscard]] std::string trunk_at_target(const std::string& condition, double mean_deg, std::uint32_t angles) const override {
    const std::string mean = condition + ": Der Rumpf beugte sich im Mittel um " + de(mean_deg, 1) + "°";
    if (angles == 0) return mean + ".";
    return mean + ", bei " + std::to_string(angles) + (angles == 1 ? " Reichbewegung." : " Reichbewegungen.");
  }
  [[nodiscard]] std::string classes_as_expected(std::uint32_t agreed, std::uint32_t compared) const override {
    return "Die Rumpfklasse war in " + std::to_string(agreed) + " von " + std::to_string(compared) +
           (compared == 1 ? " Durchgang" : " Durchgängen") +
           " wie bei diesem Ziel erwartet. Ein Durchgang ohne Reichbewegung zählt mit, wenn für sein Ziel keine Rumpfbewegung nötig ist.";
  }
  [[nodiscard]] std::string reaches_without_class(std::uint32_t rejected, std::uint32_t classified) const override {
    return "Bei " + std::to_string(rejected) + " von " + std::to_string(classified) +
           (classified == 1 ? " Reichbewegung" : " Reichbewegungen") + " fehlt die Rumpfklasse.";
  }
  [[nodiscard]] std::string trunk_consistency(double sd_deg) const override {
    return "Am selben Ziel streute der Rumpfwinkel von Mal zu Mal um " + de(sd_deg, 1) + "° (Standardabweichung).";
  }

  [[nodiscard]] std::string ellipse_since(const std::string& condition, const Change& mm2, const std::string& day) const override {
    const std::string values = " am " + de_day(day) + " (" + de(mm2.to, 0) + " gegenüber " + de(mm2.from, 0) + " mm²).";
    if (mm2.is_same()) return condition + ": Die Ellipse ist so groß wie" + values;
    return condition + ": Die Ellipse ist " + std::to_string(mm2.percent()) + " % " + (mm2.is_rise() ? "größer" : "kleiner") + " als" +
           values;
  }
  [[nodiscard]] std::string velocity_since(const std::string& condition, const Change& mm_s, const std::string& day) const override {
    const std::string values = " am " + de_day(day) + " (" + de(mm_s.to, 1) + " gegenüber " + de(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return condition + ": Die mittlere Geschwindigkeit ist so hoch wie" + values;
    return condition + ": Die mittlere Geschwindigkeit ist " + std::to_string(mm_s.percent()) + " % " +
           (mm_s.is_rise() ? "höher" : "niedriger") + " als" + values;
  }
  [[nodiscard]] std::string velocity_ml_since(const std::string& condition, const Change& mm_s, const std::string& day) const override {
    const std::string values = " am " + de_day(day) + " (" + de(mm_s.to, 1) + " gegenüber " + de(mm_s.from, 1) + " mm/s).";
    if (mm_s.is_same()) return condition + ": Die mittlere Geschwindigkeit in seitlicher Richtung ist so hoch wie" + values;
    return condition + ": Die mittlere Geschwindigkeit in seitlicher Richtung ist " + std::to_string(mm_s.percent()) + " % " +
           (mm_s.is_rise() ? "höher" : "niedriger") + " als" + values;
  }
  [[nodiscard]] std::string trunk_since(const std::string& condition, double from_deg, double to_deg,
                                        const std::string& day) const override {
    const std::string values = " am " + de_day(day) + " (" + de(to_deg, 1) + "° gegenüber " + de(from_deg, 1) + "°).";
    const std::string amount = de(to_deg > from_deg ? to_deg - from_deg : from_deg - to_deg, 1);
    if (amount == "0,0") return condition + ": Der Rumpf beugte sich so stark wie" + values;
    return condition + ": Der Rumpf beugte sich um " + amount + "° " + (to_deg > from_deg ? "mehr" : "weniger") + " als" + values;
  }
  [[nodiscard]] std::string trunk_spread_since(const std::string& condition, double from_deg, double to_deg,
                                               const std::string& day) const override {
    const std::string values = " am " + de_day(day) + " (Standardabweichung " + de(to_deg, 1) + "° gegenüber " + de(from_deg, 1) + "°).";
    if (de(from_deg, 1) == de(to_deg, 1)) return condition + ": Der Rumpfwinkel streute so stark wie" + values;
    return condition + ": Der Rumpfwinkel streute " + (to_deg > from_deg ? "stärker" : "weniger") + " als" + values;
  }
  [[nodiscard]] std::string within_retest(double percent) const override {
    return "Das liegt innerhalb der Streuung von Tag zu Tag, die für Menschen über 65 und Durchgänge von 45 s bekannt ist (" +
           de(percent, 0) + " % des Mittels beider Werte).";
  }
  [[nodiscard]] std::string beyond_retest(double percent) const override {
    return "Das ist mehr als die Streuung von Tag zu Tag, die für Menschen über 65 und Durchgänge von 45 s bekannt ist (" + de(percent, 0) +
           " % des Mittels beider Werte).";
  }
  [[nodiscard]] std::string no_retest_known() const override {
    return "Für Kenngrößen ohne diesen Hinweis ist hier keine veröffentlichte Streuung von Tag zu Tag bekannt: Der Unterschied kann Zufall "
           "sein.";
  }
};

}  // namespace

const Sentences& german() noexcept {
  static const German only;
  return only;
}

}  // namespace dts::visits
