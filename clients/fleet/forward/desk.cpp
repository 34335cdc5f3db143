// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/desk.h"

#include <algorithm>
#include <utility>

#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::forward {
namespace {

constexpr std::chrono::milliseconds kAnswerTimeout{5000};

}  // namespace

Desk::Desk(std::string clinic, Uplink& uplink, Store& store, core::Log log)
    : clinic_(std::move(clinic)), uplink_(uplink), store_(store), log_(std::move(log)), backoff_(random_seed()) {}

void Desk::serve(std::chrono::steady_clock::time_point now, const std::stop_token& stop) {
  if (const std::uint64_t connections = uplink_.connections(); connections != connections_) {
    connections_ = connections;
    retry();
  }
  if (!uplink_.is_connected() || now < not_before_) return;
  pause_ = std::chrono::milliseconds(0);
  problem_.clear();
  bool continues = true;
  while (continues && !stop.stop_requested()) {
    const auto erased = store_.next_erased();
    const auto facts = store_.next_facts();
    if (!erased || !facts) {
      fail(core::to_string(erased ? facts.error() : erased.error()));
      break;
    }
    if (!*erased && !*facts) break;
    continues = *erased ? send_erasure(**erased, stop) : send_facts(**facts, stop);
    if (continues) backoff_.reset();
  }
  not_before_ = now + pause_;
}

void Desk::retry() noexcept {
  backoff_.reset();
  not_before_ = {};
}

bool Desk::fail(const std::string& problem) {
  pause_ = backoff_.next();
  problem_ = problem;
  return false;
}

bool Desk::wait(const v1::Later& later) {
  pause_ = std::chrono::seconds(std::clamp(later.wait_s(), 1U, 300U));
  problem_ = "the centre cannot take it now: " + later.reason();
  return false;
}

bool Desk::send_facts(const v1::FleetSession& facts, const std::stop_token& stop) {
  const auto answered =
      ask(uplink_, wire::to_text({.clinic = clinic_, .matter = wire::Matter::Facts}), facts.SerializeAsString(), kAnswerTimeout, stop);
  if (!answered) return fail(answered.error().what);
  const auto answer = wire::decode_facts_answer(*answered);
  if (!answer) return fail(core::to_string(answer.error()));
  if (answer->has_later()) return wait(answer->later());
  if (answer->has_refusal())
    log_.warning("the centre rejected the facts of session " + facts.session_id() + ": " + answer->refusal().reason());
  if (!answer->has_refusal() && answer->revision() < facts.revision()) return fail("the centre has not stored the facts");
  const auto noted =
      answer->has_refusal() ? store_.facts_rejected(facts, answer->refusal().reason()) : store_.facts_answered(facts, answer->revision());
  return noted ? true : fail(core::to_string(noted.error()));
}

bool Desk::send_erasure(const std::string& session, const std::stop_token& stop) {
  v1::EraseSession request;
  request.set_session_id(session);
  const auto answered =
      ask(uplink_, wire::to_text({.clinic = clinic_, .matter = wire::Matter::Erase}), request.SerializeAsString(), kAnswerTimeout, stop);
  if (!answered) return fail(answered.error().what);
  const auto answer = wire::decode_erase_answer(*answered);
  if (!answer) return fail(core::to_string(answer.error()));
  if (answer->has_later()) return wait(answer->later());
  if (answer->has_refusal()) {  // sent again: an erasure must not be forgotten
    log_.error("the centre rejected the erasure of session " + session + ": " + answer->refusal().reason() +
               ". Ask the centre to erase it");
    return fail("the centre rejected the erasure of session " + session);
  }
  log_.info("the centre has erased session " + session + " (" + std::to_string(answer->files()) + " files)");
  const auto forgotten = store_.forget(session);
  return forgotten ? true : fail(core::to_string(forgotten.error()));
}

}  // namespace dts::fleet::forward
