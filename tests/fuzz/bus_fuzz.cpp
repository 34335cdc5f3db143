// SPDX-License-Identifier: Apache-2.0
// What a daemon sends, from the view of a client that does not trust it: answers, and the messages of the bus. What is handed out makes
// sense in itself, and every message is counted once.
//
// Input: [topic][length, 2 bytes][message] ... , see Pieces; the first topic is that of an answer.
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "../clients/libdts/inbox.h"
#include "../clients/libdts/topic_name.h"
#include "../clients/libdts/wire_check.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::bus {
namespace {


constexpr std::int64_t kNowNs = 1'000'000'000'000;
constexpr std::array<std::string_view, 12> kTopics{
    "",           "dtsd/status",     "floor/cop",    "floor/raw", "floor/session", "floor/gap", "floor/trial", "floor/reach", "floor/class",
    "floor/sway", "chair/transient", "floor/unknown"};

void take_answer(std::string_view bytes) {
  v1::Response response;
  if (!response.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) || !client::check(response)) return;
  for (const v1::ListSessionsResponse* sessions = &response.sessions(); const v1::SessionRecord& session : sessions->sessions()) {
    promise(!session.session_id().empty(), "a session has an id");
    for (const v1::SessionPart& part : session.parts())
      promise(std::isfinite(part.duration_s()) && part.duration_s() >= 0.0, "a part has a length");
  }
  for (const v1::ListRigsResponse* rigs = &response.rigs(); const v1::RigInfo& rig : rigs->rigs()) {
    for (const v1::StreamFormat& stream : rig.streams()) promise(stream.rate().denominator() > 0, "a rate is one");
  }
}

void look_at(const client::Block& block) {
  promise(block.format != nullptr && block.body != nullptr, "a block has a format");
  promise(block.scan_count > 0 && !block.format->channels.empty(), "a block has scans and channels");
  promise(block.values.size() == block.scan_count * block.format->channels.size(), "all values of all scans");
  promise(block.quality.size() == block.format->channels.size(), "a quality for each channel");
  promise(block.first_scan + block.scan_count > block.first_scan, "scans are counted up");
}

void hand_out(client::Inbox& inbox) {
  (void)inbox.is_behind();
  while (const auto message = inbox.next(kNowNs)) {
    if (const auto* block = std::get_if<client::Block>(&*message)) look_at(*block);
    if (const auto* event = std::get_if<client::Event>(&*message)) promise(event->body->instance_id() != 0, "an event is somebody's");
    if (const auto* status = std::get_if<client::Status>(&*message))
      promise(client::check(*status->snapshot).has_value(), "a status is checked");
  }
  inbox.accept_delays();
}

bool is_stream(std::string_view topic) {
  const auto name = client::parse_topic(topic);
  return name && name->kind == client::TopicKind::Stream;
}

/// Each message is counted once, as taken, malformed or unknown, when it comes. Until a daemon's first status says what its streams are,
/// some are not done with then; they are void when another daemon speaks:
///     All: blocks, and events behind them, wait uncounted, and are counted when it comes. No input is so long that some would be dropped.
///     Latest: the newest block of each stream is counted as taken, and once more when it does not fit the status.
class Account {
 public:
  explicit Account(client::Mode mode) : mode_(mode) {}

  /// After every message, with what it brought handed out in mode All.
  void enter(std::string_view topic, const client::Inbox& inbox) {
    const client::SubscriberStatistics& now = inbox.statistics();
    const std::uint64_t counted = now.messages + now.malformed + now.unknown_topics;
    const std::uint64_t newly = counted - std::exchange(counted_, counted);
    if (std::exchange(restarts_, now.restarts) != now.restarts) open_.clear();
    if (mode_ == client::Mode::All) {
      const bool may_wait = is_stream(topic) || !open_.empty();
      open_.emplace_back(topic);
      promise(newly <= open_.size(), "what came is counted once");
      open_.resize(open_.size() - newly);
      promise(open_.empty() || (may_wait && inbox.status() == nullptr), "what came is counted, unless it waits");
    } else {
      promise(newly >= 1 && newly <= 1 + open_.size(), "what came is counted once, what does not fit once more");
      const bool is_new = std::ranges::find(open_, topic) == open_.end();
      if (inbox.status() != nullptr) open_.clear();
      if (inbox.status() == nullptr && is_stream(topic) && is_new) open_.push_back(topic);
    }
  }

 private:
  client::Mode mode_;
  std::vector<std::string_view> open_;  ///< Topics of what is not done with.
  std::uint64_t counted_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  google::protobuf::SetLogHandler(nullptr);  // what is no UTF-8 is no news here
  const std::string input = fuzz::text_of(bytes, size);
  for (const client::Mode mode : {client::Mode::All, client::Mode::Latest}) {
    client::Inbox inbox(mode, true, "this-boot");
    Account account(mode);
    fuzz::Pieces pieces(input);
    while (!pieces.is_over()) {
      const std::string_view topic = kTopics[pieces.byte() % kTopics.size()];
      const std::string_view message = pieces.piece();
      if (topic.empty()) {
        take_answer(message);
      } else {
        inbox.accept(topic, std::as_bytes(std::span(message)), kNowNs);
        if (mode == client::Mode::All) hand_out(inbox);
        account.enter(topic, inbox);
      }
    }
    hand_out(inbox);
  }
}

}  // namespace dts::fuzz::bus

DTS_FUZZ_TARGET(bus)
