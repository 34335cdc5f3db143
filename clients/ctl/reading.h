// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dts/stream.h"

namespace dts::ctl {

/// Returns one scan for people: "ml 1.23 mm  ap -4.56 mm  load - N  [no_contact]". A unit at the end of a channel's name is not repeated;
/// undefined values are "-". All three arguments have the channels of `format`.
[[nodiscard]] std::string reading(const client::StreamFormat& format, std::span<const float> scan, std::span<const std::uint8_t> quality);
/// Returns the same as separate parts: {"ml 1.23 mm", "ap -4.56 mm", "[no_contact]"}.
[[nodiscard]] std::vector<std::string> reading_parts(const client::StreamFormat& format, std::span<const float> scan,
                                                     std::span<const std::uint8_t> quality);

/// Copies the channels' values at one scan of a block to `values`.
void copy_scan(const client::Block& block, std::size_t scan, std::vector<float>& values);

/// Returns an event for people: "gap: overrun, 12 scans missing before segment 3".
[[nodiscard]] std::string event_line(const client::Event& event);

}  // namespace dts::ctl
