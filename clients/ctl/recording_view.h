// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/console.h"
#include "cli/table.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Texts for people about recordings, trials and the disk, one line each.

/// Returns the shortest exact text of a number: a limit of 0.5 is not shown as 0.
[[nodiscard]] std::string shortest(double value);
/// Returns "1 scan", "12 scans".
[[nodiscard]] std::string counted(std::uint64_t count, const std::string& thing);
/// Returns "12.3 MB".
[[nodiscard]] std::string bytes_text(std::uint64_t bytes);
/// Returns "2026-11-21 14:45:25"; "-" for 0.
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);
struct LossSum {
  std::uint64_t gaps = 0;
  std::uint64_t lost_scans = 0;
  bool is_unknown = false;  ///< The losses of at least one part are not known.
};
/// Return the losses of a part, or of all parts of a session.
[[nodiscard]] LossSum sum_of(const v1::SessionPart& part);
[[nodiscard]] LossSum sum_of(const v1::SessionRecord& session);
[[nodiscard]] std::uint64_t valid_trials(const v1::SessionRecord& session);
/// Returns "10560 scans lost in 1 gap", "losses not known" or "at least 10560 scans lost in 1 gap"; empty if there is no gap.
[[nodiscard]] std::string loss_text(const LossSum& sum);
/// Returns the same with the reasons: "10560 scans lost in 1 gap: ring_full 1".
[[nodiscard]] std::string losses_text(const v1::SessionPart& part);
/// Returns "3 of 4 trials valid"; empty if no trial is planned and none is valid.
[[nodiscard]] std::string trials_text(std::uint64_t valid, std::uint64_t planned);
/// Returns how the newest attempt that ended has ended: "rejected", "done, not valid: stepped off".
[[nodiscard]] std::string outcome_words(const v1::TrialStatus& trial);
/// Returns "trial 3 of 30, measuring, 12.0 s left: 120; next 150 at 85.2 cm"; when all trials have ended, how to end the session of `rig`.
[[nodiscard]] std::string trial_line(const v1::TrialStatus& trial, const std::string& rig);
/// Returns "12.3 GB free in /var/lib/dtsd, room for 3 d 2 h"; empty if the daemon reports no disk.
[[nodiscard]] std::string disk_line(const v1::DiskStatus& disk);
/// Returns a cell that highlights every state except "complete".
[[nodiscard]] cli::Cell state_cell(const std::string& word);

/// Prints "label   value" with all labels in one column; prints nothing if `value` is empty.
void print_field(cli::Console& console, const std::string& label, const std::string& value);
/// Prints where the session is recorded, and highlights problems.
void print_recording(cli::Console& console, const v1::SessionInfo& session);
/// Prints running recordings and trials, and the disk.
void print_recordings(cli::Console& console, const v1::StatusSnapshot& status);

}  // namespace dts::ctl
