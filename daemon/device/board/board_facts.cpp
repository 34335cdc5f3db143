// SPDX-License-Identifier: Apache-2.0
#include "device/board/board_facts.h"

#include <algorithm>
#include <limits>

namespace dts::device::board {
namespace {

/// Compares what does not change while a board runs: not its rate and not its state.
bool describe_the_same_board(const Descriptor& a, const Descriptor& b) noexcept {
  return a.channels == b.channels && a.converter_bits == b.converter_bits && a.ticks_per_second == b.ticks_per_second &&
         a.carries_time == b.carries_time && a.starts_on_command == b.starts_on_command && a.serial == b.serial && a.model == b.model &&
         a.firmware == b.firmware;
}

}  // namespace

BoardFacts::Change BoardFacts::add(const Descriptor& descriptor) noexcept {
  const bool is_new = !descriptor_.has_value();
  const bool is_same = !is_new && describe_the_same_board(*descriptor_, descriptor);
  if (!is_same) is_agreed_ = false;
  if (!is_new && !is_same) is_known_ = {};
  descriptor_ = descriptor;
  if (is_new) return Change::Learned;
  return is_same ? Change::None : Change::Another;
}

Parsed<BoardFacts::Change> BoardFacts::add(const Channel& channel) noexcept {
  // Names of channels beyond the board's number of channels are of an earlier board.
  const std::size_t count = descriptor_ ? descriptor_->channels : channels_.size();
  if (channel.index >= count) {
    return tl::make_unexpected(Refusal{.frame = "CHANNEL",
                                       .field = "index",
                                       .value = static_cast<double>(channel.index),
                                       .rule = "is not below the number of channels",
                                       .is_malformed = true});
  }
  Channel& known = channels_[channel.index];
  const bool was_known = is_known_[channel.index];
  if (was_known && known == channel) return Change::None;
  const bool is_another = was_known;
  is_agreed_ = false;
  if (is_another) is_known_ = {};
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_known_[i] || i == channel.index || channels_[i].name != channel.name) continue;
    return tl::make_unexpected(
        Refusal{"CHANNEL", static_cast<int>(channel.index), "name", std::numeric_limits<double>::quiet_NaN(), "occurs twice"});
  }
  known = channel;
  is_known_[channel.index] = true;
  return is_another ? Change::Another : Change::Learned;
}

bool BoardFacts::is_complete() const noexcept {
  return descriptor_ && std::all_of(is_known_.begin(), is_known_.begin() + static_cast<std::ptrdiff_t>(descriptor_->channels),
                                    [](bool is_known) { return is_known; });
}

}  // namespace dts::device::board
