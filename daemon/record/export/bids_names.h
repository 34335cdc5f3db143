// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "record/recording.h"

namespace dts::record {

/// Letters and digits only, at most 48: all that BIDS allows in a label. `otherwise` when nothing is left.
[[nodiscard]] std::string bids_label(std::string_view text, std::string_view otherwise);

/// Where the files of one recording stand in a dataset. Made of pseudonym, session, protocol, rig and streams, never of the label that
/// somebody typed.
///
///     sub-P017/ses-20261121T144525Zfloor1/motion/sub-P017_ses-20261121T144525Zfloor1_task-free_tracksys-floorcop[_run-2]_motion.tsv
class BidsNames {
 public:
  explicit BidsNames(const Recording& recording);

  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }  ///< "sub-P017"
  [[nodiscard]] const std::string& task() const noexcept { return task_; }        ///< "free"
  /// "floorcop" for the stream "floor/cop".
  [[nodiscard]] std::string tracking_system(const StreamInfo& stream) const;
  /// Path of a file of one tracking system below the dataset; `suffix`: "motion.tsv".
  [[nodiscard]] std::string path(const std::string& tracking_system, const std::string& suffix) const;
  /// The same as the table of scans names it: below the session's folder.
  [[nodiscard]] std::string path_in_session(const std::string& tracking_system, const std::string& suffix) const;
  [[nodiscard]] std::string scans_table() const;

 private:
  std::string rig_;
  std::string subject_;
  std::string session_;
  std::string task_;
  std::string run_;
};

}  // namespace dts::record
