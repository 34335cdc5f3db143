// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/desk.h"

#include <algorithm>
#include <utility>

#include "fleet/wire/messages.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::forward {
namespace {

constexpr std::chrono::milliseconds kAnswerTimeout{5000};
constexpr std::uint64_t kLargestRevision = std::uint64_t{1} << 62U;  // far from the end of SQLite's numbers

}  // namespace

Desk::Desk(std::string clinic, Uplink& uplink, Store& store, core::Log log)
    : clinic_(std::move(clinic)), uplink_(uplink), store_(store), log_(std::move(log)), backoff_(random_seed()) {}

void Desk::serve(std::chrono::steady_clock::time_point now, const std::stop_token& stop) {
  if (const std::uint64_t connections = uplink_.connections(); connections != connections_) {
    connections_ = connections;
    retry();
  }
  if (!uplink_.is_connected() || now < not_before_) return;
  now_ = now;
  pause_ = std::chrono::milliseconds(0);
  problem_.clear();
  bool continues = true;
  while (continues && !stop.stop_requested()) {
    auto waiting = next(sessions_put_off(false));
    if (waiting && !waiting->erased && !waiting->facts) waiting = next(sessions_put_off(true));
    if (!waiting) {
      fail(core::to_string(waiting.error()));
      break;
    }
    if (!waiting->erased && !waiting->facts) break;
    continues = waiting->erased ? send_erasure(*waiting->erased, stop) : send_facts(*waiting->facts, stop);
    if (continues) backoff_.reset();
  }
  not_before_ = now + pause_;
  if (problem_.empty() && !put_off_.empty()) problem_ = put_off_.begin()->second.problem;
}

void Desk::retry() noexcept {
  backoff_.reset();
  not_before_ = {};
  for (auto& [session, put_off] : put_off_) put_off.until = {};
}

core::Result<Desk::Waiting> Desk::next(const std::set<std::string>& without) const {
  Waiting waiting;
  DTS_TRY_ASSIGN(waiting.erased, store_.next_erased(without));
  DTS_TRY_ASSIGN(waiting.facts, store_.next_facts(without));
  return waiting;
}

std::set<std::string> Desk::sessions_put_off(bool without_due) const {
  std::set<std::string> sessions;
  for (const auto& [session, put_off] : put_off_) {
    if (!without_due || put_off.until > now_) sessions.insert(session);
  }
  return sessions;
}

void Desk::put_off(const std::string& session, const std::string& problem) {
  PutOff& put_off = put_off_.try_emplace(session, PutOff{.backoff = Backoff(random_seed())}).first->second;
  put_off.until = now_ + put_off.backoff.next();
  put_off.problem = "session " + session + ": " + problem;
}

bool Desk::fail(const std::string& problem) {
  pause_ = backoff_.next();
  problem_ = problem;
  return false;
}

/// Puts the session off. The others pause, too, since the centre may not answer at all.
bool Desk::fail(const std::string& session, const core::Error& why) {
  if (why.code == core::ErrorCode::Unreachable) return fail(why.what);
  put_off(session, why.what);
  return fail(put_off_.at(session).problem);
}

bool Desk::wait(const std::string& session, const v1::Later& later) {
  put_off(session, later.reason());
  pause_ = std::chrono::seconds(std::clamp(later.wait_s(), 1U, 300U));
  problem_ = "the centre cannot take it now: " + later.reason();
  return false;
}

bool Desk::send_facts(const v1::FleetSession& facts, const std::stop_token& stop) {
  const auto answered =
      ask(uplink_, wire::to_text({.clinic = clinic_, .matter = wire::Matter::Facts}), facts.SerializeAsString(), kAnswerTimeout, stop);
  const std::string& session = facts.session_id();
  if (!answered && answered.error().code == core::ErrorCode::LimitExceeded) return reject(facts, answered.error().what);
  if (!answered) return fail(session, answered.error());
  const auto answer = wire::decode_facts_answer(*answered);
  if (!answer) return fail(session, answer.error());
  if (answer->has_later()) return wait(session, answer->later());
  if (answer->has_refusal()) return reject(facts, answer->refusal().reason());
  if (answer->revision() > kLargestRevision) return reject(facts, "the centre has an impossible revision of it");
  if (answer->revision() < facts.revision()) {
    return fail(session, {.code = core::ErrorCode::Failed, .what = "the centre has not stored the facts", .hint = {}});
  }
  if (answer->revision() > facts.revision()) {
    put_off(session, "the centre has a later revision");  // so that no centre makes a loop without a pause
  } else {
    put_off_.erase(session);
  }
  const auto noted = store_.facts_answered(facts, answer->revision());
  return noted ? true : fail(core::to_string(noted.error()));
}

bool Desk::reject(const v1::FleetSession& facts, const std::string& reason) {
  log_.warning("the facts of session " + facts.session_id() + " are not at the centre: " + reason);
  put_off_.erase(facts.session_id());
  const auto noted = store_.facts_rejected(facts, reason);
  return noted ? true : fail(core::to_string(noted.error()));
}

bool Desk::send_erasure(const std::string& session, const std::stop_token& stop) {
  v1::EraseSession request;
  request.set_session_id(session);
  const auto answered =
      ask(uplink_, wire::to_text({.clinic = clinic_, .matter = wire::Matter::Erase}), request.SerializeAsString(), kAnswerTimeout, stop);
  if (!answered) return fail(session, answered.error());
  const auto answer = wire::decode_erase_answer(*answered);
  if (!answer) return fail(session, answer.error());
  if (answer->has_later()) return wait(session, answer->later());
  if (answer->has_refusal()) {  // sent again: an erasure must not be forgotten
    log_.error("the centre rejected the erasure of session " + session + ": " + answer->refusal().reason() +
               ". Ask the centre to erase it");
    put_off(session, "the centre rejected its erasure");
    return true;
  }
  put_off_.erase(session);
  log_.info("the centre has erased session " + session + " (" + std::to_string(answer->files()) + " files)");
  const auto noted = store_.erasure_answered(session);
  return noted ? true : fail(core::to_string(noted.error()));
}

}  // namespace dts::fleet::forward
