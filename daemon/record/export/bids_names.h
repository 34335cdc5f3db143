// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "record/recording.h"

namespace dts::record {

/// Returns at most 48 letters and digits of the text, because BIDS allows nothing else in a label. Returns `otherwise` if none is left.
[[nodiscard]] std::string bids_label(std::string_view text, std::string_view otherwise);

/// File names of one recording in a dataset. Uses subject ID, session, protocol, rig and streams, but never the label, which is free text
/// and may identify a person.
///
///     sub-P017/ses-20261121T144525Zfloor1/motion/sub-P017_ses-20261121T144525Zfloor1_task-free_tracksys-floorcop[_run-2]_motion.tsv
class BidsNames {
 public:
  /// `subject`: of the session, after corrections.
  BidsNames(const Recording& recording, const std::string& subject);

  [[nodiscard]] const std::string& subject() const noexcept { return subject_; }  ///< "sub-P017"
  [[nodiscard]] const std::string& task() const noexcept { return task_; }        ///< "free"
  /// Returns "floorcop" for the stream "floor/cop".
  [[nodiscard]] std::string tracking_system(const StreamInfo& stream) const;
  /// Returns the path of a file of one tracking system, relative to the dataset; `suffix`: "motion.tsv".
  [[nodiscard]] std::string path(const std::string& tracking_system, const std::string& suffix) const;
  /// Returns the path relative to the session's folder, as in the table of scans.
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
