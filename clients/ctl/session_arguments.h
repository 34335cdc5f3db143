// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dts::ctl {

/// What the commands about sessions and their recordings can be told.
struct SessionArguments {
  std::string protocol;
  std::string subject;
  std::string label;
  std::vector<std::string> fields;  ///< KEY=VALUE
  double duration_s = 0.0;          ///< 0: until stopped.
  double settle_s = 0.0;
  std::string reason;            ///< Of an abort.
  std::string id;                ///< Of a session, or a file where one may be named.
  std::vector<std::string> ids;  ///< Of sessions that are compared.
  std::string action;            ///< Of a trial: next, redo, reject.
  std::string format;            ///< Of an export: csv, bids.
  std::string out;               ///< File or folder; empty: the command's default.
  std::uint32_t limit = 0;       ///< Of a list; 0: the daemon's default.
};

}  // namespace dts::ctl
