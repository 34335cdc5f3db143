// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/feed.h"

#include <algorithm>

#include "cli/try.h"
#include "ctl/silence.h"
#include "dts/endpoints.h"

namespace dts::ctl {
namespace {

using client::ErrorCode;
using client::Result;

constexpr std::chrono::milliseconds kFeedLook{100};
constexpr std::chrono::seconds kFeedSilence{10};

tl::unexpected<client::Error> restarted() {
  return client::fail(ErrorCode::WrongState, "the daemon was restarted during the calibration: the plate has lost its tare",
                      "continue with --resume; the recorded points are kept");
}

}  // namespace

Result<LiveFeed> LiveFeed::open(const Target& where, const std::string& rig, const std::string& stream, std::vector<std::string> channels) {
  const std::string& endpoint = where.endpoints.data;
  DTS_TRY(client::probe(endpoint));
  const std::string topic = rig + "/" + stream;
  DTS_TRY_ASSIGN(auto subscriber,
                 client::Subscriber::open({.endpoint = endpoint, .topics = {topic, rig + "/gap", rig + "/device"}, .key = where.key}));
  return LiveFeed(std::move(subscriber), endpoint, topic, std::move(channels));
}

Result<std::optional<FeedBlock>> LiveFeed::next() {
  auto block = receive(kFeedLook);
  if (!block || *block) return block;
  DTS_TRY(check_silence());
  return std::nullopt;
}

/// Ignores messages of other kinds; a restart is a failure, an event marks a loss.
Result<std::optional<FeedBlock>> LiveFeed::receive(std::chrono::milliseconds timeout) {
  DTS_TRY_ASSIGN(const auto message, subscriber_.receive(timeout));
  if (!message) return std::nullopt;
  if (std::holds_alternative<client::Restart>(*message)) return restarted();
  if (std::holds_alternative<client::Event>(*message)) is_broken_ = true;
  const auto* block = std::get_if<client::Block>(&*message);
  if (block == nullptr || block->topic != topic_) return std::nullopt;
  DTS_TRY_ASSIGN(auto taken, convert(*block));
  return std::optional<FeedBlock>(std::move(taken));
}

Result<FeedBlock> LiveFeed::convert(const client::Block& block) {
  received_at_ = std::chrono::steady_clock::now();
  FeedBlock taken;
  for (const std::string& name : channels_) {
    const auto& channels = block.format->channels;
    const auto found = std::ranges::find(channels, name, &client::ChannelFormat::name);
    if (found == channels.end()) {
      return client::fail(ErrorCode::DataDamaged, "stream " + topic_ + " has no channel '" + name + "'", "dtsctl rig show");
    }
    const auto index = static_cast<std::size_t>(found - channels.begin());
    const auto column = block.column(index);
    taken.columns.emplace_back(column.begin(), column.end());
    taken.quality.push_back(block.quality[index]);
  }
  taken.follows_loss = is_broken_ || (has_begun_ && (block.lost_scans > 0 || block.segment != segment_));
  is_broken_ = false;
  has_begun_ = true;
  segment_ = block.segment;
  return taken;
}

Result<void> LiveFeed::check_silence() const {
  if (std::chrono::steady_clock::now() - received_at_ < kFeedSilence) return {};
  return tl::make_unexpected(explain_silence(subscriber_.status(), {topic_}, endpoint_));
}

Result<void> LiveFeed::discard() {
  while (true) {
    DTS_TRY_ASSIGN(const auto message, subscriber_.receive(std::chrono::milliseconds(0)));
    if (!message) break;
    if (std::holds_alternative<client::Restart>(*message)) return restarted();
  }
  has_begun_ = false;
  is_broken_ = false;
  received_at_ = std::chrono::steady_clock::now();
  return {};
}

}  // namespace dts::ctl
