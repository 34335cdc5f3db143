// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/board/board_facts.h"
#include "device/board/line_source.h"
#include "device/device.h"
#include "device/uri_options.h"

namespace dts::device::board {

/// What the address says about a board, before it was seen.
struct BoardOptions {
  DeviceDescription description;
  bool speaks_lines = false;
  LineShape lines;                    ///< For lines only.
  std::string serial;                 ///< Serial number of the board or of its USB adapter; empty: any.
  std::optional<std::size_t> marker;  ///< Position of the channel with the constant code.
  std::uint32_t baud = 115'200;       ///< For serial ports only.
};

/// Returns the options of a board; `is_serial_port` adds baud.
[[nodiscard]] std::vector<UriOption> board_options(bool is_serial_port);

/// Reads them. Fails with InvalidArgument, naming the option and what is allowed.
[[nodiscard]] core::Result<BoardOptions> read_board_options(const DeviceUri& uri, bool is_serial_port);

/// Compares what the board says with what the address says. Fails with InvalidArgument, naming both.
[[nodiscard]] core::Status check_agreement(const BoardOptions& options, const BoardFacts& facts);

}  // namespace dts::device::board
