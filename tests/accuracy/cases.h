// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "system/daemon_process.h"

namespace dts::accuracy {

/// A converter and the window that suits it.
struct DaqSetting {
  std::string slug;            ///< For rig names.
  std::string text;            ///< For people.
  std::string device_options;  ///< Of `sim:floor`.
  double rate_hz = 100.0;
  std::string window;          ///< Option line of the window filter.
  bool is_noise_free = false;  ///< An idle channel then stands still, which the guard must not take for a fault.
};

/// 100 Hz, 11 bit, +-5 V, 3 mV, window 3: thesis 4.5, and what `sim:floor` and the shipped rig do by themselves.
[[nodiscard]] const DaqSetting& thesis_daq();
/// 1500 Hz, 16 bit, +-10 V, the same 3 mV per sample; a window of 20 ms averages 30 of them.
[[nodiscard]] const DaqSetting& modern_daq();
/// The thesis's rate and window without noise and with 16 bit: what is left is not the sensors' fault.
[[nodiscard]] const DaqSetting& noise_free_daq();

/// From the plate's centre: ML to the right, AP forward.
struct Place {
  double ml_mm = 0.0;
  double ap_mm = 0.0;
};

enum class LoadKind { Stance, Point, Recording };

/// One simulated rig and what of its data counts.
struct Case {
  std::string rig;
  LoadKind kind = LoadKind::Stance;
  std::string estimator = "poly3";
  DaqSetting daq;
  Place place;            ///< Of the weight, or of the middle of the stance.
  std::string recording;  ///< Path; Recording only.
  double first_s = 0.0;   ///< Device time of the first and the last instant compared.
  double last_s = 0.0;
};

/// From this time on a person stands as quietly as ever: 2.5 s empty, 1.5 s stepping on, 0.5 s settling. A recording starts here.
inline constexpr double kStandingFromS = 4.5;

/// A person of 686 N on two feet with synthetic sway.
[[nodiscard]] Case stance_case(const DaqSetting& daq, const std::string& estimator, const Place& place, double seconds);
/// A weight of 490 N (thesis 4.5).
[[nodiscard]] Case point_case(const DaqSetting& daq, const std::string& estimator, const Place& place, double seconds);
/// The same person in the centre, swaying as the recording says. `recording_seconds` is cut to `seconds`; `name` appears in the rig's name.
[[nodiscard]] Case recording_case(const DaqSetting& daq, const std::string& estimator, const std::string& name, const std::string& path,
                                  double recording_seconds, double seconds);

/// One daemon that serves all of them. The stance in the centre with `thesis_daq` and poly3 is the shipped demonstration, rig "floor".
[[nodiscard]] test::DaemonProcess::Options daemon_options(const std::vector<Case>& cases);

}  // namespace dts::accuracy
