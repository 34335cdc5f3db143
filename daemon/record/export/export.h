// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::record {

struct Exported {
  std::vector<std::string> files;
  std::uint64_t rows = 0;
  std::uint64_t bytes = 0;
};

/// One CSV file per stream, `<session>_<stream>.csv` (a second part: `<session>.2_<stream>.csv`): header `t_s,segment,scan,<channels>`,
/// every channel name ending in its unit; undefined values are empty cells; and `<session>_events.csv` with
/// `t_s,segment,scan,event,text,details`. t_s counts from the recording's first scan; numbers read back as exactly the recorded values.
/// `folder` is made; a file that exists is never overwritten (WrongState). Stopped by `progress`, or failed: nothing is left behind.
[[nodiscard]] core::Result<Exported> export_csv(Recording& recording, const std::string& folder, const Progress& progress = {});

/// A BIDS dataset in `folder` (BIDS 1.9, motion): dataset_description.json, README, participants.tsv/.json, and below
/// `sub-<subject>/ses-<session>/motion/` for each regular stream `..._task-<protocol>_tracksys-<rig><stream>_motion.tsv`, its
/// `_channels.tsv` and `_motion.json`, and `_events.tsv/.json`. Labels are stripped to letters and digits, as BIDS asks. A LATENCY channel
/// carries the time, so that gaps are not hidden. Never overwrites: an existing dataset of ours is added to when subject or session differ.
[[nodiscard]] core::Result<Exported> export_bids(Recording& recording, const std::string& folder, const Progress& progress = {});

}  // namespace dts::record
