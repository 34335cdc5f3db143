// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/clock.h"
#include "core/result.h"
#include "device/bytes/byte_link.h"

namespace dts::device::bytes {

struct HostPort {
  std::string host;  ///< Address in digits, without brackets.
  std::uint16_t port = 0;
};

/// Parses "ADDRESS:PORT" or "[IPv6]:PORT". Fails with InvalidArgument, also for a name: finding its address may take a minute.
[[nodiscard]] core::Result<HostPort> split_host_port(std::string_view text);

/// Creates a closed link to a board that listens at a TCP port. `open` connects within 3 s. `host`: address in digits.
/// A board that vanishes without a word counts as lost after 10 s. `clock` must outlive the link.
[[nodiscard]] std::unique_ptr<ByteLink> connect_tcp(std::string host, std::uint16_t port, core::Clock& clock);

}  // namespace dts::device::bytes
