// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Words of the daemon's notices by which `dtsctl doctor` finds them. The sentences are where the daemon writes them; its tests compare
/// each with these words, so that a changed sentence cannot make a finding of doctor "ok".
namespace dts::core::notice_words {

inline constexpr std::string_view kClockBehindBegin = "the clock of this machine says";
inline constexpr std::string_view kCalibrationAfterRig = "the calibration ";  ///< After "rig 'floor': ".
inline constexpr std::string_view kSensorCurvesAfterRig = "sensor curves (";
inline constexpr std::string_view kOtherUnit = "another unit of the same model";
inline constexpr std::string_view kOldCalibration = "days old";
inline constexpr std::string_view kNoDaq = "names no DAQ";
inline constexpr std::string_view kNoFifo = "SCHED_FIFO";
inline constexpr std::string_view kNotLocked = "memory is not locked";

}  // namespace dts::core::notice_words
