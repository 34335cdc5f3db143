// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ctl/calibrate/arguments.h"
#include "ctl/session_arguments.h"

namespace dts::ctl {

/// What only `dtsctl key` says.
struct KeyArguments {
  std::string name;
  std::string role;
  std::string out;   ///< Empty: NAME.key
  std::string host;  ///< By which other machines reach this one; empty: its host name.
};

/// Everything that the command line can say, checked for syntax and range.
struct Arguments {
  // Of every command.
  std::string endpoint;             ///< Empty: find the daemon.
  std::string data;                 ///< Empty: beside the control socket.
  std::string key_file;             ///< Empty: DTSD_KEY, else none.
  std::optional<double> timeout_s;  ///< Absent: each command's default.
  bool is_json = false;

  std::string rig;
  std::string text;  ///< Of a marker.
  std::vector<std::string> topics;
  std::optional<std::uint64_t> count;
  bool is_jsonl = false;
  bool is_csv = false;
  bool is_latest = false;
  KeyArguments key;
  SessionArguments session;
  CalibrateArguments calibrate;
};

}  // namespace dts::ctl
