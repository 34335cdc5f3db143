// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/corrections.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::record {

struct Exported {
  std::vector<std::string> files;
  std::uint64_t rows = 0;
  std::uint64_t bytes = 0;
  std::uint64_t dropped_events = 0;  ///< Of C3D, which holds at most 255: the last ones are not in the file.
};

// `corrections`: of the recording's session, see `corrections_beside`. Exports have the corrected values, and beside them the recorded
// ones.

/// Writes one CSV file per stream, `<session>_<stream>.csv` (a second part: `<session>.2_<stream>.csv`), with the header
/// `t_s,segment,scan,<channels>`. Every channel name ends with its unit; undefined values are empty cells. Also writes
/// `<session>_events.csv` with `t_s,segment,scan,event,text,details`. t_s counts from the recording's first scan; numbers read back as
/// exactly the recorded values. Creates `folder`. Fails with WrongState instead of overwriting a file. If it fails, or `progress` stops it,
/// it leaves no files behind.
[[nodiscard]] core::Result<Exported> export_csv(Recording& recording, const std::string& folder, const Progress& progress = {},
                                                const Corrections& corrections = {});

/// Writes a BIDS dataset to `folder` (BIDS 1.9, motion): dataset_description.json, README, participants.tsv/.json, and in
/// `sub-<subject>/ses-<session>/motion/` for each regular stream `..._task-<protocol>_tracksys-<rig><stream>_motion.tsv`, its
/// `_channels.tsv` and `_motion.json`, and `_events.tsv/.json`. Reduces BIDS labels to letters and digits, as BIDS requires. A LATENCY
/// channel holds the time, so that gaps are visible. Never overwrites: adds to an existing dataset of ours if the subject or the session
/// is new.
[[nodiscard]] core::Result<Exported> export_bids(Recording& recording, const std::string& folder, const Progress& progress = {},
                                                 const Corrections& corrections = {});

/// Writes `<session>.c3d`: the streams `cop` and `force` as one force plate of type 1 (32-bit real numbers, Intel), with markers, trials
/// and triggers as events, at most 255 (see `dropped_events`). Axes of the subject: x to the right, y forward, z up; the force on the
/// person. Undefined values, and samples in gaps, are NaN; the vertical force without `force` is the load. Never overwrites. Fails with
/// Unsupported if the recording has neither stream, or if their rates differ, and with LimitExceeded if it has more than 8 million samples.
[[nodiscard]] core::Result<Exported> export_c3d(Recording& recording, const std::string& folder, const Progress& progress = {},
                                                const Corrections& corrections = {});

}  // namespace dts::record
