// SPDX-License-Identifier: Apache-2.0
#include "record/sway_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace dts::record {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLabels = 32;

auto damaged(const std::string& what) { return core::fail(core::ErrorCode::DataDamaged, what); }

}  // namespace

JsonText to_json(const posturography::Measures& measures) {
  Json object = Json::object();
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<posturography::Measure>(index);
    const auto value = measures.get(measure);
    if (!value) continue;
    const posturography::MeasureInfo& about = posturography::info(measure);
    object[std::string(about.symbol)] = {{"value", *value}, {"unit", about.unit}};
  }
  return {object.dump()};
}

core::Result<posturography::Measures> measures_of_json(const std::string& text) {
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return damaged("measures that are no JSON object");
  posturography::Measures measures;
  for (const auto& [symbol, entry] : object.items()) {
    if (!entry.is_object()) return damaged("measure \"" + symbol + "\" is no object of value and unit");
    const auto value = entry.find("value");
    const auto unit = entry.find("unit");
    const bool is_readable = value != entry.end() && value->is_number() && unit != entry.end() && unit->is_string();
    if (!is_readable || !std::isfinite(value->get<double>())) return damaged("measure \"" + symbol + "\" has no value or no unit");
    const auto measure = posturography::measure_named(symbol);
    if (measure && posturography::info(*measure).unit == unit->get<std::string>()) measures.set(*measure, value->get<double>());
  }
  return measures;
}

JsonText to_json(const Labels& labels) {
  Json object = Json::object();
  for (const auto& [name, word] : labels) object[name] = word;
  return {object.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

core::Result<Labels> labels_of_json(const std::string& text) {
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object() || object.size() > kMostLabels) return damaged("labels that are no JSON object, or too many");
  Labels labels;
  for (const auto& [name, word] : object.items()) {
    if (!word.is_string()) return damaged("label \"" + name + "\" is no text");
    labels.emplace_back(name, word.get<std::string>());
  }
  return labels;
}

}  // namespace dts::record
