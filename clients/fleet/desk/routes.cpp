// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/routes.h"

#include <charconv>
#include <string_view>

#include "fleet/wire/subjects.h"
#include "gateway/http/json_answer.h"

namespace dts::fleet::desk {
namespace {

using gateway::error_answer;
using gateway::HttpRequest;
using gateway::HttpResponse;
using gateway::Query;
using gateway::Respond;

constexpr std::size_t kLongestValue = 200;
constexpr std::int64_t kLargest_ms = 4'000'000'000'000;  // UTC; PostgreSQL's time has no value for much larger numbers
constexpr std::chrono::minutes kMeasuresLife{10};
constexpr std::chrono::seconds kFailureLife{10};  // a count that took too long must not be repeated at once

core::Result<std::string> text_of(const Query& query, const std::string& name) {
  const auto found = query.find(name);
  if (found == query.end()) return std::string();
  if (found->second.size() <= kLongestValue) return found->second;
  return core::fail(core::ErrorCode::InvalidArgument, "'" + name + "' is too long",
                    "shorten it to " + std::to_string(kLongestValue) + " bytes");
}

core::Result<std::string> clinic_of(const Query& query) {
  DTS_TRY_ASSIGN(auto clinic, text_of(query, "clinic"));
  if (clinic.empty() || wire::is_clinic_name(clinic)) return clinic;
  return core::fail(core::ErrorCode::InvalidArgument, "'clinic' is not the name of a clinic", "choose a clinic on the page Clinics");
}

core::Result<std::optional<std::int64_t>> number_of(const Query& query, const std::string& name, std::int64_t least, std::int64_t most) {
  DTS_TRY_ASSIGN(const auto text, text_of(query, name));
  if (text.empty()) return std::optional<std::int64_t>();
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && rest == text.data() + text.size() && value >= least && value <= most) return std::optional(value);
  return core::fail(core::ErrorCode::InvalidArgument, "'" + name + "' is not a number that is allowed",
                    "use " + std::to_string(least) + " to " + std::to_string(most));
}

/// Sends the document of PostgreSQL, or why there is none.
HttpResponse answer_of(core::Result<std::string> document) {
  if (!document) return error_answer(document.error());
  return {.content_type = "application/json", .body = std::move(*document), .headers = {{"Cache-Control", "no-store"}}};
}

}  // namespace

core::Result<SessionFilter> session_filter(const Query& query) {
  SessionFilter filter;
  DTS_TRY_ASSIGN(filter.clinic, clinic_of(query));
  DTS_TRY_ASSIGN(filter.rig, text_of(query, "rig"));
  DTS_TRY_ASSIGN(filter.protocol, text_of(query, "protocol"));
  DTS_TRY_ASSIGN(filter.subject, text_of(query, "subject"));
  DTS_TRY_ASSIGN(filter.since_ms, number_of(query, "since", 0, kLargest_ms));
  DTS_TRY_ASSIGN(const auto limit, number_of(query, "limit", 1, kMostSessions));
  filter.limit = static_cast<int>(limit.value_or(filter.limit));
  DTS_TRY_ASSIGN(const auto before, text_of(query, "before"));
  if (before.empty()) return filter;
  filter.before = parse_session_key(before);
  if (filter.before) return filter;
  return core::fail(core::ErrorCode::InvalidArgument, "'before' is not the 'next' of a page", "load the first page again");
}

core::Result<TrendFilter> trend_filter(const Query& query) {
  TrendFilter filter;
  DTS_TRY_ASSIGN(filter.measure, text_of(query, "measure"));
  if (filter.measure.empty()) return core::fail(core::ErrorCode::InvalidArgument, "'measure' is missing", "choose a measure");
  DTS_TRY_ASSIGN(const auto analysis, text_of(query, "analysis"));
  if (!analysis.empty()) filter.analysis = analysis;
  DTS_TRY_ASSIGN(filter.protocol, text_of(query, "protocol"));
  DTS_TRY_ASSIGN(filter.clinic, clinic_of(query));
  DTS_TRY_ASSIGN(filter.since_ms, number_of(query, "since", 0, kLargest_ms));
  return filter;
}

void Routes::handle(HttpRequest request, Respond respond) {
  const bool is_post = request.method == "POST";
  if (request.path == "/api/login" && is_post) return access_.log_in(std::move(request), std::move(respond));
  if (request.path == "/api/logout" && is_post) return access_.log_out(request, respond);
  if (request.method != "GET" && request.method != "HEAD") {
    HttpResponse refusal = error_answer(405, "this path accepts only GET and HEAD");
    refusal.headers.emplace_back("Allow", "GET, HEAD");
    return respond(std::move(refusal));
  }
  if (request.path == "/api/me") return access_.describe_user(request, respond);
  if (!request.path.starts_with("/api/")) return files_.serve(request, respond);
  const auto identity = access_.identify(request);
  if (!identity || !gateway::may(*identity, v1::ROLE_VIEWER)) return respond(error_answer(401, "not logged in", "log in first"));
  serve_fleet(request, std::move(respond));
}

void Routes::serve_fleet(const HttpRequest& request, Respond respond) {
  constexpr std::string_view kClinic = "/api/fleet/clinics/";
  const auto send = [respond](core::Result<std::string> document) { respond(answer_of(std::move(document))); };
  const std::string& path = request.path;
  if (path == "/api/fleet/clinics") {
    return queries_.submit([version = version_](database::Database& database) { return clinics_page(database, version); }, send);
  }
  if (path.starts_with(kClinic) && wire::is_clinic_name(path.substr(kClinic.size()))) {
    return queries_.submit([version = version_, clinic = path.substr(kClinic.size())](
                               database::Database& database) { return clinic_page(database, version, clinic); },
                           send);
  }
  if (path == "/api/fleet/sessions") {
    auto filter = session_filter(request.query);
    if (!filter) return respond(error_answer(filter.error()));
    return queries_.submit([filter = std::move(*filter)](database::Database& database) { return sessions_page(database, filter); }, send);
  }
  if (path == "/api/fleet/trend") {
    auto filter = trend_filter(request.query);
    if (!filter) return respond(error_answer(filter.error()));
    return queries_.submit([filter = std::move(*filter)](database::Database& database) { return trend_page(database, filter); }, send);
  }
  if (path == "/api/fleet/measures") return serve_measures(std::move(respond));
  respond(error_answer(404, "nothing at this path"));
}

void Routes::serve_measures(Respond respond) {
  const auto life = measures_ && *measures_ ? std::chrono::steady_clock::duration(kMeasuresLife) : kFailureLife;
  if (measures_ && std::chrono::steady_clock::now() - measured_at_ < life) return respond(answer_of(*measures_));
  await_measures_.push_back(std::move(respond));
  if (await_measures_.size() > 1) return;
  queries_.submit([](database::Database& database) { return measures_page(database); },
                  [this](const core::Result<std::string>& document) {
                    measures_ = document;
                    measured_at_ = std::chrono::steady_clock::now();
                    for (const Respond& waiting : std::exchange(await_measures_, {})) waiting(answer_of(document));
                  });
}

}  // namespace dts::fleet::desk
