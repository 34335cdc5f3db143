// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// Answers the requests that every USB device must answer (USB 2.0
/// specification, table 9-3) from its descriptors; nullopt: it is no standard
/// request, ask the device.
[[nodiscard]] std::optional<ControlReply> standard_reply(const Descriptors& descriptors, const Setup& setup);

/// The endpoint whose halt a request clears (CLEAR_FEATURE, ENDPOINT_HALT), or
/// nullopt.
[[nodiscard]] std::optional<std::uint8_t> halt_cleared_by(const Setup& setup);

/// wMaxPacketSize of an endpoint; 64 when the configuration does not name it.
[[nodiscard]] std::size_t packet_bytes_of(const Descriptors& descriptors, std::uint8_t endpoint);

}  // namespace dts::emulator
