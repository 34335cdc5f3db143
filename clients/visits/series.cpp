// SPDX-License-Identifier: Apache-2.0
#include "visits/series.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "session/figure.h"
#include "visits/details.h"

namespace dts::visits {
namespace {

using Json = nlohmann::json;
using Key = std::tuple<std::string, std::string, std::string, std::string>;

constexpr std::size_t kMostTargets = 100;
constexpr double kSameDurationS = 0.1;
constexpr double kSameTargetCm = 1.0;
constexpr const char* kMixed = "mixed";  // scales
/// Results of a whole session that depend on the scale.
constexpr std::array<std::string_view, 4> kOnScale{"trunk_at_critical_boundary_deg", "trunk_sd_deg", "class_agreement_share",
                                                   "rejected_share"};

/// How a result was computed, as far as its details say.
struct Analysis {
  std::string profile;
  std::string side;   ///< Of the reaching arm.
  std::string scale;  ///< Of trunk angles: general, or the subject's own; empty: not known, or another measure.
  std::optional<double> rate_hz{};
  std::optional<double> duration_s{};
  std::optional<double> target_cm{};
};

struct Found {
  Point point;
  std::string unit;
  Analysis analysis;
};

bool is_near(const std::optional<double>& one, const std::optional<double>& other, double tolerance) {
  return one.has_value() == other.has_value() && (!one || std::abs(*one - *other) <= tolerance);
}

/// Returns which arm reached; empty: not known, or a session of standing.
std::string side_of(const v1::SessionRecord& session) {
  const auto found = session.fields().find("side");
  return found == session.fields().end() ? std::string() : found->second;
}

/// Measures of standing depend on the duration, so that an unknown one is like no other.
bool is_same(const Analysis& one, const Analysis& other) {
  if (!one.profile.empty() && (!one.duration_s || !other.duration_s)) return false;
  if (one.scale == kMixed) return false;
  return one.profile == other.profile && one.side == other.side && one.scale == other.scale && is_near(one.rate_hz, other.rate_hz, 1e-6) &&
         is_near(one.duration_s, other.duration_s, kSameDurationS) && is_near(one.target_cm, other.target_cm, kSameTargetCm);
}

/// A value with what its details say about it.
struct Value {
  double value = 0.0;
  std::optional<double> spread{};
  std::optional<std::uint32_t> count{};  ///< Trials or reaches that it is computed from.
  std::string scale{};                   ///< As in Analysis.
};

/// Returns the scale of the trunk angles and classes of a target: daemon/classifier.
std::string scale_of(const Json& target) {
  const auto own = count_in(target, "angles_on_own_scale");
  if (!own) return {};
  return *own == 0 ? "general" : own == count_in(target, "angles") ? "own" : kMixed;
}

/// Returns the targets of a session on the chair.
Json targets_in(const Json& details) {
  const auto targets = details.find("targets");
  return targets != details.end() && targets->is_array() ? *targets : Json::array();
}

/// Returns the scale of the results of a whole session.
std::string scale_of(const v1::SessionRecord& session) {
  std::set<std::string> scales;
  for (const v1::SessionResult& result : session.results()) {
    if (result.name() != "targets") continue;
    for (const Json& target : targets_in(details_of(result))) {
      if (target.is_object() && count_in(target, "angles").value_or(0) > 0) scales.insert(scale_of(target));
    }
  }
  return scales.empty() ? std::string() : scales.size() == 1 ? *scales.begin() : kMixed;
}

/// Returns the median class of the classified reaches; nothing without one.
std::optional<Value> median_class(const Json& target) {
  const auto classes = target.find("classes");
  if (classes == target.end() || !classes->is_object()) return std::nullopt;
  constexpr std::array kNames{"none", "minor", "moderate", "maximum"};
  std::array<std::uint32_t, kNames.size()> counts{};
  std::uint32_t all = 0;
  for (std::size_t index = 0; index < kNames.size(); ++index) all += counts[index] = count_in(*classes, kNames[index]).value_or(0);
  if (all == 0) return std::nullopt;
  const auto class_at = [&counts](std::uint32_t rank) {
    std::size_t found = 0;
    for (std::uint32_t sum = counts[0]; sum <= rank; sum += counts[found]) ++found;
    return static_cast<double>(found);
  };
  return Value{.value = (class_at((all - 1) / 2) + class_at(all / 2)) / 2.0, .count = all, .scale = scale_of(target)};
}

/// Returns the member `name` of a target; nothing without it.
std::optional<Value> value_in(const Json& target, const char* name, const char* spread, const char* count) {
  const auto value = number_in(target, name);
  return value ? std::optional(Value{.value = *value, .spread = number_in(target, spread), .count = count_in(target, count)})
               : std::nullopt;
}

std::optional<Value> angle_in(const Json& target, const char* name, const char* spread) {
  auto angle = value_in(target, name, spread, "angles");
  if (angle) angle->scale = scale_of(target);
  return angle;
}

class Collector {
 public:
  void add(const v1::SessionRecord& session) {
    if (session.is_deleted() || session.state() == "running") return;
    const std::string scale = scale_of(session);
    for (const v1::SessionResult& result : session.results()) {
      const std::string& name = result.name();
      if (!std::isfinite(result.value())) continue;
      const Json details = details_of(result);
      if (name == "targets") {
        add_targets(session, details);
        continue;
      }
      const std::size_t slash = name.rfind('/');
      const bool has_condition = slash != std::string::npos;
      add_point(session, has_condition ? name.substr(0, slash) : "", has_condition ? name.substr(slash + 1) : name, result.unit(), details,
                {.value = result.value(),
                 .spread = number_in(details, "sd"),
                 .count = count_in(details, "trials"),
                 .scale = std::ranges::find(kOnScale, name) == kOnScale.end() ? std::string() : scale});
    }
  }

  [[nodiscard]] std::vector<Series> take() {
    std::vector<Series> all;
    for (auto& [key, found] : found_) {
      std::ranges::sort(found, {}, [](const Found& one) { return std::pair(one.point.utc_ns, one.point.session_id); });
      const Found& newest = found.back();
      Series series{.rig = std::get<0>(key),
                    .protocol = std::get<1>(key),
                    .condition = std::get<2>(key),
                    .measure = std::get<3>(key),
                    .unit = newest.unit};
      for (const Found& one : found) {
        series.points.push_back(one.point);
        series.points.back().is_comparable = &one == &newest || (one.unit == newest.unit && is_same(one.analysis, newest.analysis));
      }
      all.push_back(std::move(series));
    }
    return all;
  }

 private:
  void add_targets(const v1::SessionRecord& session, const Json& details) {
    const Json targets = targets_in(details);
    for (std::size_t index = 0; index < std::min(targets.size(), kMostTargets); ++index) {
      const Json& target = targets[index];
      const auto condition = target.is_object() ? target.find("condition") : target.end();
      if (!target.is_object() || condition == target.end() || !condition->is_string()) continue;
      const auto name = condition->get<std::string>();
      const auto add = [&](const char* measure, const char* unit, const std::optional<Value>& value) {
        if (value) add_point(session, name, measure, unit, target, *value);
      };
      add("trunk_mean_deg", "deg", angle_in(target, "trunk_mean_deg", "trunk_sd_deg"));
      add("trunk_sd_deg", "deg", angle_in(target, "trunk_sd_deg", ""));
      add("d2_mean_mm", "mm", value_in(target, "d2_mean_mm", "d2_sd_mm", "reaches_detected"));
      add("trunk_class", "1", median_class(target));
    }
  }

  void add_point(const v1::SessionRecord& session, const std::string& condition, const std::string& measure, const std::string& unit,
                 const Json& details, const Value& value) {
    Analysis analysis{.profile = text_in(details, "profile"),
                      .side = side_of(session),
                      .scale = value.scale,
                      .rate_hz = number_in(details, "rate_hz"),
                      .duration_s = number_in(details, "duration_s"),
                      .target_cm = number_in(details, "target_cm")};
    Point point{.session_id = session.session_id(),
                .utc_ns = session.started_utc_ns(),
                .value = value.value,
                .spread = value.spread,
                .trials = value.count.value_or(0),
                .duration_s = analysis.duration_s};
    found_[{session.rig(), session.protocol(), condition, measure}].push_back(
        {.point = std::move(point), .unit = unit, .analysis = std::move(analysis)});
  }

  std::map<Key, std::vector<Found>> found_;
};

}  // namespace

std::vector<Series> series_of(const v1::SubjectRecord& subject) {
  Collector collector;
  for (const v1::SessionRecord& session : subject.sessions()) collector.add(session_of_one_part(session));
  return collector.take();
}

v1::SessionRecord session_of_one_part(const v1::SessionRecord& session) {
  std::map<std::uint32_t, std::uint64_t> trials;  // by part
  for (const v1::SessionResult& result : session.results())
    trials[session::without_part_suffix(result.name()).second] += count_in(details_of(result), "trials").value_or(0);
  const auto fewer = [](const auto& one, const auto& other) {
    return std::pair(one.second, one.first) < std::pair(other.second, other.first);
  };
  const auto chosen = std::ranges::max_element(trials, fewer);
  v1::SessionRecord alone = session;
  alone.clear_results();
  for (const v1::SessionResult& result : session.results()) {
    const auto [name, part] = session::without_part_suffix(result.name());
    if (part != chosen->first) continue;
    *alone.add_results() = result;
    alone.mutable_results(alone.results_size() - 1)->set_name(std::string(name));
  }
  return alone;
}

std::vector<Point> comparable_points(const Series& series) {
  std::vector<Point> points;
  std::ranges::copy_if(series.points, std::back_inserter(points), &Point::is_comparable);
  return points;
}

}  // namespace dts::visits
