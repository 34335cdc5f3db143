// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/desk.h"

#include <chrono>
#include <exception>

#include "core/thread.h"
#include "dts/v1/fleet.pb.h"

namespace dts::fleet::hub {
namespace {

constexpr auto kLongestWait = std::chrono::milliseconds(200);  // until a stop is noticed
constexpr const char* kQueue = "hub";
constexpr std::uint32_t kSlowedWaitS = 1;

template <class Answer>
std::string too_many() {
  Answer answer;
  answer.mutable_later()->set_reason("this clinic sends more messages than the centre accepts");
  answer.mutable_later()->set_wait_s(kSlowedWaitS);
  return answer.SerializeAsString();
}

}  // namespace

core::Result<std::unique_ptr<Desk>> Desk::open(const Surroundings& around, wire::Matter matter, const std::string& worker,
                                               const std::string& thread_name, Handler handler) {
  DTS_TRY_ASSIGN(auto letters, around.link.subscribe(wire::of_all_clinics(matter, worker), worker.empty() ? kQueue : ""));
  std::unique_ptr<Desk> desk(new Desk(around, matter, std::move(letters), std::move(handler)));
  desk->thread_ = std::jthread([raw = desk.get(), thread_name](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread(thread_name, {}));
    raw->serve(stop);
  });
  return desk;
}

Desk::Desk(const Surroundings& around, wire::Matter matter, std::unique_ptr<link::Subscription> letters, Handler handler)
    : around_(around), matter_(matter), letters_(std::move(letters)), handler_(std::move(handler)) {}

void Desk::serve(const std::stop_token& stop) {
  std::uint64_t dropped = 0;
  while (!stop.stop_requested()) {
    const auto letter = letters_->next(kLongestWait);
    if (letter) {
      try {
        answer(*letter, stop);
      } catch (const std::exception& exception) {  // no memory left; the clinic asks again
        around_.log.error("a message of subject " + letter->subject + " was dropped: " + exception.what());
      }
    }
    const std::uint64_t now_dropped = letters_->dropped();
    around_.counts.dropped_total += now_dropped - dropped;
    dropped = now_dropped;
  }
}

void Desk::answer(const link::Letter& letter, const std::stop_token& stop) {
  ++around_.counts.letters_total;
  const auto subject = wire::parse_subject(letter.subject);
  if (!subject || subject->matter != matter_ || !wire::is_inbox_of(subject->clinic, letter.reply) ||
      !around_.clinics.is_allowed(subject->clinic)) {
    ++around_.counts.rejected_total;
    const bool is_foreign = subject && !letter.reply.empty() && !wire::is_inbox_of(subject->clinic, letter.reply);
    if (is_foreign && warnings_.take(std::chrono::steady_clock::now())) {
      around_.log.warning("clinic " + subject->clinic +
                          " asked for an answer to a subject that is not its own: there is none. If this "
                          "continues, its key is in wrong hands: dts-fleet clinic revoke " +
                          subject->clinic);
    }
    return;
  }
  const bool is_within = around_.quota.take(subject->clinic, matter_, letter.data.size(), std::chrono::steady_clock::now());
  auto reply = is_within ? handler_(subject->clinic, letter.data, stop) : slow_down(subject->clinic);
  if (!reply) return;
  // An answer that is lost is asked for again.
  if (const auto sent = around_.link.publish({.subject = letter.reply, .data = *std::move(reply)}); !sent) {
    around_.log.debug("no answer to " + subject->clinic + ": " + core::to_string(sent.error()));
  }
}

std::optional<std::string> Desk::slow_down(const std::string& clinic) {
  if (quota_warnings_.take(std::chrono::steady_clock::now())) {
    around_.log.warning(
        "clinic " + clinic +
        " sends more messages than [quota] messages_per_s allows: they are answered with \"later\". If this continues, look at "
        "dts-forward there, or revoke the clinic: dts-fleet clinic revoke " +
        clinic);
  }
  switch (matter_) {
    case wire::Matter::Open:
    case wire::Matter::Chunk:
    case wire::Matter::Commit: return too_many<v1::UploadAnswer>();
    case wire::Matter::Facts: return too_many<v1::FactsAnswer>();
    case wire::Matter::Erase: return too_many<v1::EraseAnswer>();
    case wire::Matter::Beat:
    case wire::Matter::Live:
    case wire::Matter::DownLive: break;  // a heartbeat is dropped: the next one replaces it
  }
  return std::nullopt;
}

}  // namespace dts::fleet::hub
