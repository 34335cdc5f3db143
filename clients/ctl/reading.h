// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dts/stream.h"

namespace dts::ctl {

/// One scan for people: "ml 1.23 mm  ap -4.56 mm  load - N  [no_contact]". The unit at the end of a channel's name is not
/// said twice; undefined values are "-". All three have the channels of `format`.
[[nodiscard]] std::string reading(const client::StreamFormat& format, std::span<const float> scan, std::span<const std::uint8_t> quality);
/// The same, each channel and the doubts by themselves: {"ml 1.23 mm", "ap -4.56 mm", "[no_contact]"}.
[[nodiscard]] std::vector<std::string> reading_parts(const client::StreamFormat& format, std::span<const float> scan,
                                                     std::span<const std::uint8_t> quality);

/// The channels' values at one scan of a block.
void copy_scan(const client::Block& block, std::size_t scan, std::vector<float>& values);

/// An event for people: "gap: overrun, 12 scans missing before segment 3".
[[nodiscard]] std::string event_line(const client::Event& event);

}  // namespace dts::ctl
