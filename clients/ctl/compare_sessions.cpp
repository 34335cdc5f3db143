// SPDX-License-Identifier: Apache-2.0
#include "ctl/compare_sessions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "cli/json.h"
#include "cli/table.h"
#include "cli/try.h"
#include "ctl/ask.h"
#include "ctl/recording_view.h"

namespace dts::ctl {
namespace {

constexpr std::uint32_t kMostCompared = 12;  // a wider table would not fit on a page

/// One result of all sessions: one value each, or none.
struct Row {
  std::string name;
  std::string unit;
  std::vector<std::optional<double>> values;

  [[nodiscard]] std::optional<double> difference(std::size_t session) const {
    if (!values[0] || !values[session]) return std::nullopt;
    return *values[session] - *values[0];
  }
  [[nodiscard]] std::optional<double> percent(std::size_t session) const {
    const auto change = difference(session);
    if (!change || !(*values[0] > 0.0) || unit == "deg") return std::nullopt;
    return 100.0 * *change / *values[0];
  }
};

struct Comparison {
  std::vector<v1::SessionRecord> sessions;  ///< Oldest first.
  std::vector<Row> rows;
  std::vector<std::string> warnings;
};

/// Keeps only a subject's sessions on one rig, the rig of the newest session with results: sessions on a chair and on a platform have no
/// common results. Returns how many were removed.
std::size_t keep_comparable(std::vector<v1::SessionRecord>& sessions) {
  const auto has_results = [](const v1::SessionRecord& session) { return session.results_size() > 0; };
  const auto newest = std::ranges::find_if(sessions, has_results);
  const std::string rig = newest == sessions.end() ? std::string() : newest->rig();
  return std::erase_if(sessions, [&](const v1::SessionRecord& session) { return !has_results(session) || session.rig() != rig; });
}

client::Result<std::vector<v1::SessionRecord>> ask_sessions(client::ControlClient& dts, const SessionArguments& wishes,
                                                            std::size_t& left_out) {
  std::vector<std::string> ids = wishes.ids;
  if (ids.empty()) {
    v1::ListSessionsRequest request;
    request.set_subject(wishes.subject);
    request.set_protocol(wishes.protocol);
    request.set_limit(kMostCompared);
    DTS_TRY_ASSIGN(const auto listed, dts.list_sessions(request));
    for (const v1::SessionRecord& session : listed.sessions()) ids.push_back(session.session_id());
  }
  std::vector<v1::SessionRecord> sessions;
  for (const std::string& id : ids) {
    DTS_TRY_ASSIGN(auto session, dts.show_session(id));
    sessions.push_back(std::move(session));
  }
  if (wishes.ids.empty()) left_out = keep_comparable(sessions);
  std::ranges::stable_sort(sessions, {}, [](const v1::SessionRecord& session) { return session.started_utc_ns(); });
  return sessions;
}

/// Returns the value of `key` in the details of a result. Accepts only numbers and short texts.
cli::Json detail_of(const cli::Json& details, const std::string& key) {
  const auto found = details.find(key);
  const bool is_plain =
      found != details.end() && (found->is_number() || (found->is_string() && found->get_ref<const std::string&>().size() <= 32));
  return is_plain ? *found : cli::Json();
}

/// Adds warnings about details that must be equal for comparable values.
void warn_of_differences(const v1::SessionResult& first, const v1::SessionResult& other, std::set<std::string>& warnings) {
  if (first.unit() != other.unit()) warnings.insert(other.name() + ": the unit differs between sessions; do not compare these values");
  const cli::Json one = cli::Json::parse(first.details(), nullptr, false);
  const cli::Json two = cli::Json::parse(other.details(), nullptr, false);
  if (!one.is_object() || !two.is_object()) return;
  const std::string what = first.name().substr(0, first.name().rfind('/'));
  for (const auto& [key, words] : {std::pair{"duration_s", "have the duration (s)"}, std::pair{"profile", "have the profile"},
                                   std::pair{"rate_hz", "have the rate (Hz)"}}) {
    const cli::Json in_one = detail_of(one, key);
    const cli::Json in_two = detail_of(two, key);
    if (in_one.is_null() != in_two.is_null() && std::string_view(key) == "duration_s") {  // a mean over unequal trials has none
      warnings.insert(what +
                      ": the trials have equal durations in one session and different durations in another; do not compare these values");
    }
    if (in_one.is_null() || in_two.is_null() || in_one == in_two) continue;
    const bool is_near = in_one.is_number() && in_two.is_number() && std::abs(in_one.get<double>() - in_two.get<double>()) < 0.1;
    if (is_near) continue;
    warnings.insert(what + ": trials " + words + " " + in_one.dump() + " in one session and " + in_two.dump() +
                    " in another; do not compare these values");
  }
}

Comparison compare(std::vector<v1::SessionRecord> sessions) {
  Comparison comparison{.sessions = std::move(sessions), .rows = {}, .warnings = {}};
  std::set<std::string> warnings;
  std::vector<const v1::SessionResult*> firsts;
  for (std::size_t s = 0; s < comparison.sessions.size(); ++s) {
    const v1::SessionRecord& session = comparison.sessions[s];
    if (session.subject() != comparison.sessions[0].subject()) warnings.insert("the sessions are from different subjects");
    if (const std::string lost = loss_text(sum_of(session)); !lost.empty()) {
      warnings.insert("session " + session.session_id() + ": " + lost + "; the results of its trials may cover less time");
    }
    for (const v1::SessionResult& result : session.results()) {
      const auto known = std::ranges::find(comparison.rows, result.name(), &Row::name);
      const auto index = static_cast<std::size_t>(known - comparison.rows.begin());
      if (known == comparison.rows.end()) {
        comparison.rows.push_back(
            {.name = result.name(), .unit = result.unit(), .values = std::vector<std::optional<double>>(comparison.sessions.size())});
        firsts.push_back(&result);
      } else {
        warn_of_differences(*firsts[index], result, warnings);
      }
      if (std::isfinite(result.value())) comparison.rows[index].values[s] = result.value();
    }
  }
  const auto is_common = [](const Row& row) {
    return std::ranges::count_if(row.values, [](const auto& value) { return value.has_value(); }) > 1;
  };
  if (!comparison.rows.empty() && std::ranges::none_of(comparison.rows, is_common)) {
    warnings.insert("the sessions have no common results: they examined different conditions");
  }
  comparison.warnings.assign(warnings.begin(), warnings.end());
  return comparison;
}

cli::Json number_or_null(const std::optional<double>& value) { return value ? cli::Json(*value) : cli::Json(nullptr); }

void print_json(const Comparison& comparison, cli::Console& console) {
  cli::Json json{{"sessions", cli::Json::array()}, {"figures", cli::Json::array()}, {"warnings", comparison.warnings}};
  for (const v1::SessionRecord& session : comparison.sessions) {
    json["sessions"].push_back(
        {{"session_id", session.session_id()}, {"subject", session.subject()}, {"started_utc_ns", session.started_utc_ns()}});
  }
  for (const Row& row : comparison.rows) {
    cli::Json entry{{"name", row.name},
                    {"unit", row.unit},
                    {"values", cli::Json::array()},
                    {"differences", cli::Json::array()},
                    {"percent", cli::Json::array()}};
    for (std::size_t s = 0; s < row.values.size(); ++s) {
      entry["values"].push_back(number_or_null(row.values[s]));
      if (s == 0) continue;
      entry["differences"].push_back(number_or_null(row.difference(s)));
      entry["percent"].push_back(number_or_null(row.percent(s)));
    }
    json["figures"].push_back(std::move(entry));
  }
  console.out << cli::document(json);
}

std::string change_text(const Row& row, std::size_t session) {
  const auto change = row.difference(session);
  if (!change) return "";
  const auto percent = row.percent(session);
  const auto with_sign = [](double value, int decimals) { return (value < 0.0 ? "" : "+") + cli::decimal(value, decimals); };
  return with_sign(*change, 2) + (percent ? " (" + with_sign(*percent, 0) + " %)" : "");
}

void print_table(const Comparison& comparison, cli::Console& console) {
  std::vector<std::string> headers{"FIGURE", "UNIT"};
  for (const v1::SessionRecord& session : comparison.sessions) headers.push_back(">" + utc_text(session.started_utc_ns()));
  const bool is_pair = comparison.sessions.size() == 2;
  if (is_pair) headers.push_back(">CHANGE");
  cli::Table table(headers);
  for (const Row& row : comparison.rows) {
    std::vector<cli::Cell> cells{{row.name}, {row.unit == "1" ? "" : row.unit}};
    for (const auto& value : row.values) cells.push_back({value ? cli::decimal(*value, 3) : "-"});
    if (is_pair) cells.push_back({change_text(row, 1)});
    table.add(std::move(cells));
  }
  for (const v1::SessionRecord& session : comparison.sessions) {
    console.out << cli::printable(session.session_id() + "  " + session.subject() + "  " + session.protocol()) << '\n';
  }
  if (comparison.rows.empty()) console.out << "no results: these sessions have no valid trials\n";
  table.print(console);
}

}  // namespace

int run_session_compare(const Arguments& arguments, cli::Console& console) {
  const SessionArguments& wishes = arguments.session;
  if (wishes.ids.empty() && wishes.subject.empty()) {
    cli::print_error(console, "no sessions given", "dtsctl session compare ID ID, or --subject SUBJECT-ID");
    return cli::kUsage;
  }
  auto dts = connect(arguments);
  if (!dts) return cli::fail_with(console, dts.error());
  std::size_t left_out = 0;
  auto sessions = ask_sessions(*dts, wishes, left_out);
  if (!sessions) return cli::fail_with(console, sessions.error());
  if (left_out > 0) {
    console.talk << "dtsctl: " << counted(left_out, "session") << (left_out == 1 ? " is" : " are")
                 << " left out: no results, or another rig than the newest session with results\n";
  }
  if (sessions->size() < 2) {
    return cli::fail_with(
        console, client::Error{client::ErrorCode::NotFound, counted(sessions->size(), "session") + " found; a comparison needs two",
                               "dtsctl session list"});
  }
  const Comparison comparison = compare(std::move(*sessions));
  for (const std::string& warning : comparison.warnings) console.talk << "dtsctl: warning: " << cli::printable(warning) << '\n';
  if (arguments.is_json) {
    print_json(comparison, console);
  } else {
    print_table(comparison, console);
  }
  console.out.flush();
  return cli::kOk;
}

}  // namespace dts::ctl
