// SPDX-License-Identifier: Apache-2.0
#include "visits/plain_words.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "visits/details.h"
#include "visits/retest.h"

namespace dts::visits {
namespace {

using Json = nlohmann::json;

/// Returns "2026-11-21".
std::string day_of(std::int64_t utc_ns) {
  const std::chrono::sys_days day =
      std::chrono::floor<std::chrono::days>(std::chrono::sys_time<std::chrono::nanoseconds>(std::chrono::nanoseconds(utc_ns)));
  const std::chrono::year_month_day date(day);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02u", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()));
  return text.data();
}

const v1::SessionResult* result_named(const v1::SessionRecord& session, const std::string& name) {
  const auto found = std::ranges::find(session.results(), name, &v1::SessionResult::name);
  return found == session.results().end() ? nullptr : &*found;
}

/// Returns the details of a result by its name; an empty object without one.
Json details_named(const v1::SessionRecord& session, const std::string& name) {
  const v1::SessionResult* const result = result_named(session, name);
  return result == nullptr ? Json::object() : details_of(*result);
}

std::string name_of(const std::string& protocol, const std::string& condition, const Sentences& sentences, const Titles& titles) {
  const auto title = titles.find({protocol, condition});
  return sentences.condition(condition, title == titles.end() ? "" : title->second);
}

constexpr std::string_view kRomberg = "romberg/";

/// Returns the stance of a Romberg quotient of `measure`, "feet=two,surface=firm"; nothing for another result.
std::optional<std::string> stance_of(const std::string& name, std::string_view measure) {
  if (!name.starts_with(kRomberg)) return std::nullopt;
  const std::size_t slash = name.rfind('/');
  if (name.compare(slash + 1, std::string::npos, measure) != 0) return std::nullopt;
  return slash < kRomberg.size() ? std::string() : name.substr(kRomberg.size(), slash - kRomberg.size());
}

/// Calls `say(stance, change)` for the Romberg quotient of each stance.
template <class Say>
void add_quotients(const v1::SessionRecord& session, std::string_view measure, const Sentences& sentences, Say say) {
  for (const v1::SessionResult& result : session.results()) {
    const auto stance = stance_of(result.name(), measure);
    if (!stance) continue;
    const Json details = details_of(result);
    const auto open = number_in(details, "open");
    const auto closed = number_in(details, "closed");
    if (open && closed && *open > 0.0 && *closed > 0.0) say(stance_words(*stance, sentences), Change{.from = *open, .to = *closed});
  }
}

void add_standing(const v1::SessionRecord& session, const Sentences& sentences, std::vector<std::string>& words) {
  add_quotients(session, "PEA95_F", sentences,
                [&](const std::string& stance, const Change& mm2) { words.push_back(sentences.ellipse_eyes_closed(stance, mm2)); });
  add_quotients(session, "MVELO", sentences,
                [&](const std::string& stance, const Change& mm_s) { words.push_back(sentences.velocity_eyes_closed(stance, mm_s)); });
}

void add_reaching(const v1::SessionRecord& session, const Sentences& sentences, const Titles& titles, std::vector<std::string>& words) {
  v1::SubjectRecord alone;
  *alone.add_sessions() = session;
  for (const Series& series : series_of(alone)) {
    if (series.measure != "trunk_mean_deg" || series.points.empty()) continue;
    const Point& point = series.points.back();
    words.push_back(sentences.trunk_at_target(name_of(series.protocol, series.condition, sentences, titles), point.value, point.trials));
  }
  const Json agreement = details_named(session, "class_agreement_share");
  const auto agreed = count_in(agreement, "agreed");
  const auto compared = count_in(agreement, "compared");
  if (agreed && compared && *compared > 0) words.push_back(sentences.classes_as_expected(*agreed, *compared));
  const Json rejection = details_named(session, "rejected_share");
  const auto rejected = count_in(rejection, "rejected");
  const auto classified = count_in(rejection, "classified");
  if (rejected && classified && *rejected > 0) words.push_back(sentences.reaches_without_class(*rejected, *classified));
  const v1::SessionResult* const spread = result_named(session, "trunk_sd_deg");
  if (spread != nullptr && std::isfinite(spread->value())) words.push_back(sentences.trunk_consistency(spread->value()));
}

/// Says how one series changed between two of its points; nothing for a measure without a sentence.
std::optional<std::string> change_words(const Series& series, const Point& from, const Point& to, const Sentences& sentences,
                                        const std::string& condition) {
  const std::string day = day_of(from.utc_ns);
  const Change change{.from = from.value, .to = to.value};
  if (series.measure == "trunk_mean_deg") return sentences.trunk_since(condition, from.value, to.value, day);
  if (series.measure == "trunk_sd_deg" && !series.condition.empty()) {
    return sentences.trunk_spread_since(condition, from.value, to.value, day);
  }
  if (!(from.value > 0.0)) return std::nullopt;  // a share of nothing
  if (series.measure == "PEA95_F") return sentences.ellipse_since(condition, change, day);
  if (series.measure == "MVELO") return sentences.velocity_since(condition, change, day);
  if (series.measure == "MVELO_ML") return sentences.velocity_ml_since(condition, change, day);
  return std::nullopt;
}

}  // namespace

Titles titles_of(const v1::ListProtocolsResponse& protocols, const Sentences& sentences) {
  Titles titles;
  for (const v1::ProtocolInfo& protocol : protocols.protocols()) {
    for (const v1::ProtocolCondition& condition : protocol.conditions()) {
      std::string& title = titles[{protocol.name(), condition.name()}] = condition.title();
      for (const v1::Translation& translation : condition.translations()) {
        if (translation.language() == sentences.language() && !translation.title().empty()) title = translation.title();
      }
    }
  }
  return titles;
}

std::vector<std::string> words_of_session(const v1::SessionRecord& session, const Sentences& sentences, const Titles& titles) {
  std::vector<std::string> words;
  const v1::SessionRecord alone = session_of_one_part(session);
  add_standing(alone, sentences, words);
  add_reaching(alone, sentences, titles, words);
  return words;
}

std::vector<std::string> words_of_changes(std::span<const Series> series, const Sentences& sentences, const Titles& titles) {
  std::vector<std::string> words;
  bool is_retest_missing = false;
  for (const Series& one : series) {
    if (one.condition.starts_with("romberg")) continue;
    const std::vector<Point> points = comparable_points(one);
    if (points.size() < 2) continue;
    const std::string condition = name_of(one.protocol, one.condition, sentences, titles);
    const auto add = [&](const Point& from) {
      auto said = change_words(one, from, points.back(), sentences, condition);
      if (!said) return;
      const Retest* const retest = retest_of(one);
      is_retest_missing = is_retest_missing || retest == nullptr;
      if (retest != nullptr) {
        const bool is_within = retest->is_within(from.value, points.back().value);
        *said += " " + (is_within ? sentences.within_retest(retest->percent) : sentences.beyond_retest(retest->percent));
      }
      words.push_back(std::move(*said));
    };
    add(points[points.size() - 2]);
    if (points.size() > 2) add(points.front());
  }
  if (is_retest_missing) words.push_back(sentences.no_retest_known());
  return words;
}

}  // namespace dts::visits
