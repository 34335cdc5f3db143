// SPDX-License-Identifier: Apache-2.0
#include "visits/document.h"

#include <string>
#include <utility>
#include <vector>

#include "visits/plain_words.h"
#include "visits/retest.h"
#include "visits/series.h"

namespace dts::visits {
namespace {

using Document = nlohmann::ordered_json;

Document json_of_point(const Point& point) {
  Document json{{"session", point.session_id}, {"utc_ns", std::to_string(point.utc_ns)}, {"value", point.value}};
  if (point.spread) json["sd"] = *point.spread;
  if (point.trials > 0) json["trials"] = point.trials;
  json["is_comparable"] = point.is_comparable;
  return json;
}

Document json_of_series(const Series& series) {
  Document json{{"rig", series.rig},
                {"protocol", series.protocol},
                {"condition", series.condition},
                {"measure", series.measure},
                {"unit", series.unit}};
  if (const Retest* const retest = retest_of(series)) json["retest"] = {{"percent", retest->percent}, {"source", retest->source}};
  Document points = Document::array();
  for (const Point& point : series.points) points.push_back(json_of_point(point));
  json["points"] = std::move(points);
  return json;
}

}  // namespace

Document document_of(const v1::SubjectRecord& subject, const v1::ListProtocolsResponse& protocols, const Sentences& sentences,
                     const std::string& measure) {
  const Titles titles = titles_of(protocols, sentences);
  const std::vector<Series> all = series_of(subject);
  Document series = Document::array();
  for (const Series& one : all) {
    if (measure.empty() || one.measure == measure) series.push_back(json_of_series(one));
  }
  Document sessions = Document::array();
  for (const v1::SessionRecord& session : subject.sessions()) {
    if (session.is_deleted() || session.state() == "running") continue;
    auto said = words_of_session(session, sentences, titles);
    if (!said.empty()) sessions.push_back({{"session", session.session_id()}, {"sentences", std::move(said)}});
  }
  return {{"subject", subject.about().subject()},
          {"language", sentences.language()},
          {"series", std::move(series)},
          {"words", {{"changes", words_of_changes(all, sentences, titles)}, {"sessions", std::move(sessions)}}}};
}

}  // namespace dts::visits
