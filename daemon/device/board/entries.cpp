// SPDX-License-Identifier: Apache-2.0
#include "device/board/entries.h"

#include <memory>
#include <utility>

#include "device/board/board_device.h"
#include "device/bytes/command_line.h"
#include "device/bytes/program.h"
#include "device/bytes/serial_port.h"
#include "device/bytes/tcp_link.h"

namespace dts::device::board {
namespace {

using Created = core::Result<std::unique_ptr<Device>>;

Created create_serial(const DeviceUri& uri, const DeviceContext& context) {
  if (uri.name.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, "device \"" + uri.text + "\": the port is missing",
                      "write serial:/dev/ttyACM0?channels=4; `dtsctl device list` shows the ports");
  }
  DTS_TRY_ASSIGN(auto options, read_board_options(uri, true));
  auto link = bytes::create_serial_port(uri.name, options.serial, options.baud, context.clock);
  return std::make_unique<BoardDevice>(std::move(options), std::move(link), context.clock);
}

Created create_tcp(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(auto options, read_board_options(uri, false));
  DTS_TRY_ASSIGN(auto where, bytes::split_host_port(uri.name));
  auto link = bytes::connect_tcp(std::move(where.host), where.port, context.clock);
  return std::make_unique<BoardDevice>(std::move(options), std::move(link), context.clock);
}

Created create_exec(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY(context.programs.check(uri.text));
  DTS_TRY_ASSIGN(auto options, read_board_options(uri, false));
  DTS_TRY_ASSIGN(auto command, bytes::split_command(uri.name));
  auto link = bytes::run_program(std::move(command), context.clock, context.programs.log);
  return std::make_unique<BoardDevice>(std::move(options), std::move(link), context.clock);
}

}  // namespace

std::vector<RegistryEntry> registry_entries() {
  return {
      {"serial:", "A microcontroller at a serial port: serial:/dev/ttyACM0?channels=4.", create_serial},
      {"tcp:", "A board that listens at a TCP port: tcp:HOST:PORT?channels=4.", create_tcp},
      {"exec:", "A program that dtsd starts; the configuration must allow it: exec:COMMAND?channels=4.", create_exec},
  };
}

}  // namespace dts::device::board
