// SPDX-License-Identifier: Apache-2.0
#include "lab/force/column_names.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace dts::lab::force {
namespace {

enum class Quantity : std::uint8_t { Time, Force, Moment, Cop, FreeMoment };

/// A unit, of which quantity it is, and what its values are multiplied by: to s, N, N m or mm.
struct Unit {
  std::string_view text;
  Quantity quantity;
  double scale;
};
constexpr std::array<Unit, 10> kUnits{{{"s", Quantity::Time, 1.0},
                                       {"ms", Quantity::Time, 1e-3},
                                       {"n", Quantity::Force, 1.0},
                                       {"kn", Quantity::Force, 1e3},
                                       {"nm", Quantity::Moment, 1.0},
                                       {"ncm", Quantity::Moment, 1e-2},
                                       {"nmm", Quantity::Moment, 1e-3},
                                       {"m", Quantity::Cop, 1e3},
                                       {"cm", Quantity::Cop, 10.0},
                                       {"mm", Quantity::Cop, 1.0}}};

/// A name without its unit: small letters, no spaces and signs between words.
struct Name {
  std::string text;
  std::string unit;
};

/// What a name means.
struct Component {
  Quantity quantity = Quantity::Time;
  std::size_t axis = 0;
  bool has_prime = false;
  std::string plate;  ///< What distinguishes the plates: "", "1", "left".
};

bool is_letter_or_digit(char letter) { return std::isalnum(static_cast<unsigned char>(letter)) != 0; }

std::string small_letters(std::string_view text) {
  std::string small(text);
  std::ranges::transform(small, small.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return small;
}

std::string unit_text(std::string_view text) {
  std::string unit = small_letters(text);
  std::erase_if(unit, [](char letter) { return !is_letter_or_digit(letter); });
  return unit;
}

/// "CoPx (mm)" is copx in mm, "fx_n" is fx in N, "Force.Fx1" is forcefx1.
Name name_of(std::string_view given) {
  Name name;
  std::string text = small_letters(given);
  if (const std::size_t open = text.find_first_of("(["); open != std::string::npos) {
    name.unit = unit_text(std::string_view(text).substr(open));
    text.resize(open);
  } else if (const std::size_t line = text.rfind('_'); line != std::string::npos) {
    const std::string end = text.substr(line + 1);
    if (std::ranges::find(kUnits, end, &Unit::text) != kUnits.end()) {
      name.unit = end;
      text.resize(line);
    }
  }
  for (const char letter : text) {
    if (is_letter_or_digit(letter) || letter == '\'') name.text += letter;
  }
  return name;
}

struct Word {
  std::string_view text;
  Quantity quantity;
  std::size_t axis;
};
constexpr std::array<Word, 19> kWords{{{"copx", Quantity::Cop, 0},
                                       {"copy", Quantity::Cop, 1},
                                       {"copz", Quantity::Cop, 2},
                                       {"fx", Quantity::Force, 0},
                                       {"fy", Quantity::Force, 1},
                                       {"fz", Quantity::Force, 2},
                                       {"mx", Quantity::Moment, 0},
                                       {"my", Quantity::Moment, 1},
                                       {"mz", Quantity::Moment, 2},
                                       {"cx", Quantity::Cop, 0},
                                       {"cy", Quantity::Cop, 1},
                                       {"cz", Quantity::Cop, 2},
                                       {"ax", Quantity::Cop, 0},
                                       {"ay", Quantity::Cop, 1},
                                       {"tz", Quantity::FreeMoment, 2},
                                       {"abstime", Quantity::Time, 0},
                                       {"mocaptime", Quantity::Time, 0},
                                       {"timestamp", Quantity::Time, 0},
                                       {"time", Quantity::Time, 0}}};

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// Returns whether this may stand before the name of a component: nothing, or what distinguishes plates.
bool is_prefix(std::string_view text) {
  while (!text.empty() && is_digit(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_digit(text.front())) text.remove_prefix(1);
  constexpr std::array<std::string_view, 13> kPrefixes{"",       "fp",   "p",     "plate", "forceplate", "force", "moment",
                                                       "torque", "left", "right", "l",     "r",          "cop"};
  return std::ranges::find(kPrefixes, text) != kPrefixes.end();
}

/// "force" and "moment" before a name do not distinguish plates.
std::string plate_name(std::string_view prefix, std::string_view suffix) {
  for (const std::string_view common : {"forceplate", "force", "moment", "torque", "cop", "plate", "fp", "p"}) {
    if (prefix.starts_with(common)) {
      prefix.remove_prefix(common.size());
      break;
    }
  }
  return std::string(prefix) + std::string(suffix);
}

std::optional<Component> component_of(std::string_view name) {
  if (name == "t" || name == "ts") return Component{};
  std::string_view stem = name;
  std::size_t digits = 0;
  while (digits < stem.size() && is_digit(stem[stem.size() - 1 - digits])) ++digits;
  const std::string_view suffix = stem.substr(stem.size() - digits);
  stem.remove_suffix(digits);
  const bool has_prime = stem.ends_with('\'');
  if (has_prime) stem.remove_suffix(1);
  for (const Word& word : kWords) {
    if (!stem.ends_with(word.text)) continue;
    const std::string_view prefix = stem.substr(0, stem.size() - word.text.size());
    if (word.quantity == Quantity::Time && (!prefix.empty() || !suffix.empty())) continue;
    if (!is_prefix(prefix)) continue;
    return Component{.quantity = word.quantity, .axis = word.axis, .has_prime = has_prime, .plate = plate_name(prefix, suffix)};
  }
  return std::nullopt;
}

/// Returns what a value is to be multiplied by. A unit that is not known counts as the usual one.
double scale_of(Quantity quantity, const std::string& unit) {
  if (quantity == Quantity::FreeMoment) quantity = Quantity::Moment;
  const auto known = std::ranges::find_if(kUnits, [&](const Unit& one) { return one.quantity == quantity && one.text == unit; });
  if (known != kUnits.end()) return known->scale;
  return quantity == Quantity::Cop ? 1e3 : 1.0;
}

/// Collects the columns of plates that have names. A name that is repeated begins the next plate, as in BioWare.
class Plates {
 public:
  void add(const Component& component, const ColumnPlace& column) {
    std::optional<ColumnPlace>* target = &column_of(newest(component.plate), component);
    if (target->has_value()) target = &column_of(plates_.emplace_back(component.plate, PlateColumns{}).second, component);
    *target = column;
  }
  std::vector<PlateColumns> take() {
    std::vector<PlateColumns> plates;
    for (auto& [name, plate] : plates_) plates.push_back(plate);
    return plates;
  }

 private:
  static std::optional<ColumnPlace>& column_of(PlateColumns& plate, const Component& component) {
    switch (component.quantity) {
      case Quantity::Moment: return (component.has_prime ? plate.surface_moment : plate.moment).at(component.axis);
      case Quantity::Cop: return plate.cop.at(component.axis);
      case Quantity::FreeMoment: return plate.free_moment;
      case Quantity::Force:
      case Quantity::Time: break;
    }
    return plate.force.at(component.axis);
  }
  PlateColumns& newest(const std::string& name) {
    const auto found = std::ranges::find(plates_.rbegin(), plates_.rend(), name, [](const auto& plate) { return plate.first; });
    return found == plates_.rend() ? plates_.emplace_back(name, PlateColumns{}).second : found->second;
  }

  std::vector<std::pair<std::string, PlateColumns>> plates_;
};

}  // namespace

NamedColumns named_columns(const std::vector<TextCell>& names, const std::vector<TextCell>& units) {
  NamedColumns found;
  Plates plates;
  for (std::size_t place = 0; place < names.size(); ++place) {
    Name name = name_of(names[place].text);
    if (name.unit.empty() && place < units.size()) name.unit = unit_text(units[place].text);
    const auto component = component_of(name.text);
    if (!component) continue;
    const ColumnPlace column{.place = place, .scale = scale_of(component->quantity, name.unit)};
    if (component->quantity != Quantity::Time) {
      plates.add(*component, column);
    } else if (!found.time) {
      found.time = column;
    }
  }
  found.plates = plates.take();
  std::erase_if(found.plates, [](const PlateColumns& plate) { return !plate.force[2] && !plate.has_cop(); });
  return found;
}

NamedColumns opensim_columns(const std::vector<TextCell>& names) {
  NamedColumns found;
  std::vector<std::string> plates;
  for (std::size_t place = 0; place < names.size(); ++place) {
    const std::string name = small_letters(names[place].text);
    if (name == "time") found.time = ColumnPlace{.place = place};
    if (name.size() < 3) continue;
    const std::size_t axis = std::string_view("xyz").find(name.back());
    if (axis == std::string_view::npos) continue;
    std::string stem = name.substr(0, name.size() - 1);
    const bool is_torque = stem.find("torque") != std::string::npos || stem.find("moment") != std::string::npos;
    const bool is_force = !is_torque && stem.ends_with("v");
    if (!is_torque && !is_force && !stem.ends_with("p")) continue;
    if (stem.ends_with("v") || stem.ends_with("p") || stem.ends_with("m")) stem.pop_back();
    while (stem.ends_with("_")) stem.pop_back();
    for (const std::string_view word : {"torque", "moment"}) {
      if (const std::size_t at = stem.find(word); at != std::string::npos) stem.replace(at, word.size(), "force");
    }
    const auto known = std::ranges::find(plates, stem);
    const auto index = static_cast<std::size_t>(known - plates.begin());
    if (known == plates.end()) {
      plates.push_back(stem);
      found.plates.emplace_back();
    }
    PlateColumns& plate = found.plates[index];
    if (is_torque && axis == 1) plate.free_moment = ColumnPlace{.place = place};
    if (is_force) plate.force.at(axis) = ColumnPlace{.place = place};
    if (!is_torque && !is_force) plate.cop.at(axis) = ColumnPlace{.place = place, .scale = 1e3};
  }
  std::erase_if(found.plates, [](const PlateColumns& plate) { return !plate.force[1]; });
  return found;
}

}  // namespace dts::lab::force
