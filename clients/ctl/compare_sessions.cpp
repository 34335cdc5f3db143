// SPDX-License-Identifier: Apache-2.0
#include "ctl/compare_sessions.h"

#include <algorithm>
#include <cmath>
#include <map>
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
#include "report/result_names.h"

namespace dts::ctl {
namespace {

constexpr std::size_t kMostCompared = 12;  // a wider table would not fit on a page

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

/// Asks for a subject's newest sessions with results, on the rig of the newest of them: a chair and a platform have no results in common.
/// Adds to `left_out` the sessions between them that are none of these.
client::Result<std::vector<v1::SessionRecord>> ask_comparable(client::ControlClient& dts, const SessionArguments& wishes,
                                                              std::size_t& left_out) {
  v1::ListSessionsRequest request;  // without a limit: the newest 100
  request.set_subject(wishes.subject);
  request.set_protocol(wishes.protocol);
  DTS_TRY_ASSIGN(const auto listed, dts.list_sessions(request));
  std::vector<v1::SessionRecord> comparable;
  for (const v1::SessionRecord& listed_session : listed.sessions()) {
    if (comparable.size() == kMostCompared) break;
    DTS_TRY_ASSIGN(auto session, dts.show_session(listed_session.session_id()));
    const bool is_comparable = session.results_size() > 0 && (comparable.empty() || session.rig() == comparable[0].rig());
    if (is_comparable) {
      comparable.push_back(std::move(session));
    } else {
      ++left_out;
    }
  }
  return comparable;
}

client::Result<std::vector<v1::SessionRecord>> ask_sessions(client::ControlClient& dts, const SessionArguments& wishes,
                                                            std::size_t& left_out) {
  std::vector<v1::SessionRecord> sessions;
  if (wishes.ids.empty()) {
    DTS_TRY_ASSIGN(sessions, ask_comparable(dts, wishes, left_out));
  }
  for (const std::string& id : wishes.ids) {
    DTS_TRY_ASSIGN(auto session, dts.show_session(id));
    sessions.push_back(std::move(session));
  }
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

/// A result and its session.
struct Source {
  const v1::SessionRecord* session = nullptr;
  const v1::SessionResult* result = nullptr;
};

/// What makes values not comparable, and for which conditions: one warning each.
using Differences = std::map<std::string, std::set<std::string>>;

/// Adds details that must be equal for comparable values.
void add_differences(const Source& first, const Source& other, Differences& differences) {
  const std::string condition = report::parts_of(first.result->name()).group;
  if (first.result->unit() != other.result->unit()) {
    differences["the unit of '" + report::result_label(first.result->name()) + "' differs between sessions"].insert("");
  }
  const cli::Json one = cli::Json::parse(first.result->details(), nullptr, false);
  const cli::Json two = cli::Json::parse(other.result->details(), nullptr, false);
  if (!one.is_object() || !two.is_object()) return;
  for (const auto& [key, words, unit] : {std::tuple{"duration_s", "the duration", " s"}, std::tuple{"profile", "the profile", ""},
                                         std::tuple{"rate_hz", "the rate", " Hz"}}) {
    const cli::Json in_one = detail_of(one, key);
    const cli::Json in_two = detail_of(two, key);
    const bool is_duration = std::string_view(key) == "duration_s";  // a mean over unequal trials has none
    if (in_one == in_two || ((in_one.is_null() || in_two.is_null()) && !is_duration)) continue;
    const bool is_near = in_one.is_number() && in_two.is_number() && std::abs(in_one.get<double>() - in_two.get<double>()) < 0.1;
    if (is_near) continue;
    const auto value = [unit = unit](const cli::Json& detail) {
      return detail.is_null() ? "different durations" : (detail.is_string() ? detail.get<std::string>() : detail.dump()) + unit;
    };
    differences["the trials differ in " + std::string(words) + ": " + value(in_one) + " in session " + first.session->session_id() + ", " +
                value(in_two) + " in session " + other.session->session_id()]
        .insert(condition);
  }
}

/// Adds a warning if the sessions have different protocols: names each protocol with its sessions.
void warn_of_protocols(const std::vector<v1::SessionRecord>& sessions, std::set<std::string>& warnings) {
  std::map<std::string, std::vector<std::string>> ids;
  for (const v1::SessionRecord& session : sessions) ids[session.protocol()].push_back(session.session_id());
  if (ids.size() < 2) return;
  std::vector<std::string> texts;
  for (const auto& [protocol, of_protocol] : ids) texts.push_back("'" + protocol + "' in " + cli::join(of_protocol, " and "));
  warnings.insert("the sessions have different protocols: " + cli::join(texts, ", ") + "; trials and instructions may differ");
}

/// Adds a warning if the sessions have reaches of both arms.
void warn_of_arms(const std::vector<v1::SessionRecord>& sessions, std::set<std::string>& warnings) {
  std::map<std::string, std::vector<std::string>> ids;
  for (const v1::SessionRecord& session : sessions) {
    const auto is_of_reaches = [](const auto& result) { return report::parts_of(result.name()).symbol == "targets"; };
    const bool has_reaches = std::ranges::any_of(session.results(), is_of_reaches);
    const auto side = session.fields().find("side");
    if (has_reaches && side != session.fields().end()) ids[side->second].push_back(session.session_id());
  }
  if (ids.size() < 2) return;
  std::vector<std::string> texts;
  for (const auto& [side, of_side] : ids) texts.push_back(side + " in " + cli::join(of_side, " and "));
  warnings.insert("the reaching arm differs: " + cli::join(texts, ", "));
}

/// Returns the name under which a result is compared. Each part of a resumed session has its own results: if only one part has this result,
/// it is that of the session.
std::string compared_name(const v1::SessionRecord& session, const v1::SessionResult& result) {
  const report::ResultName name = report::parts_of(result.name());
  const auto is_same = [&name](const v1::SessionResult& other) {
    const report::ResultName its = report::parts_of(other.name());
    return its.group == name.group && its.symbol == name.symbol;
  };
  if (std::ranges::count_if(session.results(), is_same) > 1) return result.name();
  return (name.group.empty() ? "" : name.group + "/") + name.symbol;
}

Comparison compare(std::vector<v1::SessionRecord> sessions) {
  Comparison comparison{.sessions = std::move(sessions), .rows = {}, .warnings = {}};
  std::set<std::string> warnings;
  Differences differences;
  std::vector<Source> firsts;
  warn_of_protocols(comparison.sessions, warnings);
  warn_of_arms(comparison.sessions, warnings);
  for (std::size_t s = 0; s < comparison.sessions.size(); ++s) {
    const v1::SessionRecord& session = comparison.sessions[s];
    if (session.subject() != comparison.sessions[0].subject()) warnings.insert("the sessions are from different subjects");
    if (session.rig() != comparison.sessions[0].rig()) warnings.insert("the sessions are from different rigs");
    if (const std::string lost = loss_text(sum_of(session)); !lost.empty()) {
      warnings.insert("session " + session.session_id() + ": " + lost + "; the results of its trials may cover less time");
    }
    bool has_parts = false;
    for (const v1::SessionResult& result : session.results()) {
      const std::string name = compared_name(session, result);
      has_parts = has_parts || report::parts_of(name).part > 1;
      const auto known = std::ranges::find(comparison.rows, name, &Row::name);
      const auto index = static_cast<std::size_t>(known - comparison.rows.begin());
      if (known == comparison.rows.end()) {
        comparison.rows.push_back(
            {.name = name, .unit = result.unit(), .values = std::vector<std::optional<double>>(comparison.sessions.size())});
        firsts.push_back({&session, &result});
      } else {
        add_differences(firsts[index], {&session, &result}, differences);
      }
      if (std::isfinite(result.value())) comparison.rows[index].values[s] = result.value();
    }
    if (has_parts) {
      warnings.insert("session " + session.session_id() +
                      " was resumed: some of its results exist for each part, from the trials of this part only, in a row of its own");
    }
  }
  for (const auto& [text, conditions] : differences) {
    std::vector<std::string> named(conditions.begin(), conditions.end());
    std::erase(named, "");
    warnings.insert(text + (named.empty() ? "" : " (" + cli::join(named, ", ") + ")") + "; do not compare these values");
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
  std::vector<std::string> headers{"RESULT", "UNIT"};
  for (const v1::SessionRecord& session : comparison.sessions) headers.push_back(">" + utc_text(session.started_utc_ns()));
  const bool is_pair = comparison.sessions.size() == 2;
  if (is_pair) headers.push_back(">CHANGE");
  cli::Table table(headers);
  for (const Row& row : comparison.rows) {
    std::vector<cli::Cell> cells{{report::result_label(row.name)}, {row.unit == "1" ? "" : row.unit}};
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
