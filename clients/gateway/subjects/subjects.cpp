// SPDX-License-Identifier: Apache-2.0
#include "gateway/subjects/subjects.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "gateway/http/json_answer.h"
#include "visits/document.h"

namespace dts::gateway {
namespace {

constexpr std::string_view kSubjectsBegin = "/api/subjects/";
constexpr std::size_t kLongestSubjectId = 64;

bool may_be_subject(std::string_view text) noexcept {
  return !text.empty() && text.size() <= kLongestSubjectId && std::ranges::all_of(text, [](char letter) {
    const bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9');
    return is_letter || letter == '.' || letter == '_' || letter == '-';
  });
}

/// Returns the error of an answer, or one for an answer to another command.
client::Error error_of(const client::Result<v1::Response>& answer) {
  if (!answer) return answer.error();
  if (answer->has_error()) {
    return {static_cast<client::ErrorCode>(answer->error().code()), answer->error().what(), answer->error().hint()};
  }
  return {client::ErrorCode::Internal, "the daemon answered something else", "compare the versions of gateway and daemon"};
}

}  // namespace

void Subjects::handle(const HttpRequest& request, const Respond& respond) {
  const std::string_view id = std::string_view(request.path).substr(std::min(kSubjectsBegin.size(), request.path.size()));
  if (!may_be_subject(id)) return respond(error_answer(404, "nothing with that name"));
  const auto wanted = request.query.find("language");
  const std::string language = wanted == request.query.end() ? "en" : wanted->second;
  v1::Request about;
  about.mutable_show_subject()->set_subject(std::string(id));
  about.mutable_show_subject()->set_with_results(true);
  const std::weak_ptr<bool> is_alive = is_alive_;
  ask_(std::move(about), [this, is_alive, language, respond](client::Result<v1::Response> subject) {
    if (is_alive.expired()) return;
    if (!subject || !subject->has_subject()) return respond(error_answer(error_of(subject)));
    v1::Request list;
    list.mutable_list_protocols();
    ask_(std::move(list), [this, is_alive, language, respond,
                           record = std::move(*subject->mutable_subject())](client::Result<v1::Response> protocols) mutable {
      if (is_alive.expired()) return;
      if (!protocols || !protocols->has_protocols()) return respond(error_answer(error_of(protocols)));
      make(std::move(record), std::move(*protocols->mutable_protocols()), language, respond);
    });
  });
}

void Subjects::make(v1::SubjectRecord subject, v1::ListProtocolsResponse protocols, const std::string& language, const Respond& respond) {
  auto work = [subject = std::move(subject), protocols = std::move(protocols), language, respond](const std::stop_token& /*stop*/) {
    return Worker::Answer([respond, document = visits::document_of(subject, protocols, visits::sentences_in(language))] {
      respond(json_answer(200, document));
    });
  };
  if (worker_.submit(std::move(work))) return;
  HttpResponse busy = error_answer(503, "too many subjects are being prepared", "try again in a moment");
  busy.headers.emplace_back("Retry-After", "5");
  respond(std::move(busy));
}

}  // namespace dts::gateway
