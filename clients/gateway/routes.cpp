// SPDX-License-Identifier: Apache-2.0
#include "gateway/routes.h"

#include <utility>

#include "gateway/access/visitor.h"
#include "gateway/http/json_answer.h"

namespace dts::gateway {

void Routes::handle(HttpRequest request, Respond respond) const {
  const bool is_read = request.method == "GET" || request.method == "HEAD";
  const bool is_post = request.method == "POST";
  if (request.path == "/api/login" && is_post) return access_.log_in(std::move(request), std::move(respond));
  if (request.path == "/api/logout" && is_post) return access_.log_out(request, respond);
  if (!is_read) {
    HttpResponse refusal = error_answer(405, "this path accepts only GET and HEAD");
    refusal.headers.emplace_back("Allow", "GET, HEAD");
    return respond(std::move(refusal));
  }
  if (request.path == "/api/me") return access_.describe_user(request, respond);
  if (request.path == "/metrics" && metrics_) return serve_metrics(request, respond);
  if (!request.path.starts_with("/api/")) return files_.serve(request, respond);
  if (request.path.starts_with("/api/subjects/")) return serve_subject(request, respond);
  if (!request.path.starts_with("/api/sessions/")) return respond(error_answer(404, "nothing at this path"));
  if (!may_view(request)) return respond(error_answer(401, "not logged in", "log in first"));
  archive_.handle(std::move(request), std::move(respond));
}

bool Routes::may_view(const HttpRequest& request) const {
  const auto identity = access_.identify(request);
  return identity && may(*identity, v1::ROLE_VIEWER);
}

void Routes::serve_subject(const HttpRequest& request, const Respond& respond) const {
  const auto identity = access_.identify(request);
  if (!identity) return respond(error_answer(401, "not logged in", "log in first"));
  if (!may(*identity, v1::ROLE_OPERATOR)) return respond(error_answer(403, "subjects need the role operator", "log in as an operator"));
  subjects_.handle(request, respond);
}

void Routes::serve_metrics(const HttpRequest& request, const Respond& respond) const {
  if (!is_same_machine(request) && !may_view(request)) {
    return respond(error_answer(401, "not logged in", "log in, or read the metrics from the gateway's own machine"));
  }
  respond({.content_type = "text/plain; version=0.0.4; charset=utf-8", .body = metrics_(), .headers = {{"Cache-Control", "no-store"}}});
}

}  // namespace dts::gateway
