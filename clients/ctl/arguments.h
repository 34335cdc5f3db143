// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ctl/calibrate/arguments.h"
#include "ctl/session_arguments.h"

namespace dts::ctl {

/// Options of `dtsctl key` only.
struct KeyArguments {
  std::string name;
  std::string role;
  std::string out;   ///< Empty: NAME.key
  std::string host;  ///< The name by which other machines reach this one; empty: its host name.
};

/// All values of the command line, checked for syntax and range.
struct Arguments {
  // For every command.
  std::string endpoint;             ///< Empty: search for the daemon.
  std::string data;                 ///< Empty: in the same folder as the control socket.
  std::string key_file;             ///< Empty: DTSD_KEY, otherwise none.
  std::optional<double> timeout_s;  ///< Absent: each command's default.
  bool is_json = false;

  std::string rig;
  std::string text;  ///< For a marker.
  std::vector<std::string> topics;
  std::optional<std::uint64_t> count;
  bool is_jsonl = false;
  bool is_csv = false;
  bool is_latest = false;
  KeyArguments key;
  SessionArguments session;
  EditArguments edit;
  SubjectArguments subject{};
  CalibrateArguments calibrate;
};

}  // namespace dts::ctl
