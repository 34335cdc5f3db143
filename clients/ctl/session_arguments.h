// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dts::ctl {

/// Options of the commands about sessions and their recordings.
struct SessionArguments {
  std::string protocol;
  std::string subject;
  std::string label;
  std::vector<std::string> fields;  ///< KEY=VALUE
  double duration_s = 0.0;          ///< 0: until stopped.
  double settle_s = 0.0;
  std::string reason;            ///< For an abort.
  std::string id;                ///< A session, or a file where a file is allowed.
  std::vector<std::string> ids;  ///< Sessions to compare.
  std::string action;            ///< For a trial: next, redo, reject.
  std::string format;            ///< For an export: csv, bids.
  std::string out;               ///< File or folder; empty: the command's default.
  std::uint32_t limit = 0;       ///< For a list; 0: the daemon's default.
};

}  // namespace dts::ctl
