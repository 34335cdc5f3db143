// SPDX-License-Identifier: Apache-2.0
#include "accuracy/cases.h"

#include <algorithm>
#include <cmath>

namespace dts::accuracy {
namespace {

constexpr const char* kDemoRig = "floor";

/// Rig names are lower-case letters, digits, '_' and '-': "60_m40" for (60, -40).
std::string word(const Place& place) {
  const auto whole = [](double value) { return (value < 0 ? "m" : "") + std::to_string(std::lround(std::abs(value))); };
  return whole(place.ml_mm) + "_" + whole(place.ap_mm);
}

std::string device_uri(const Case& wanted) {
  std::string uri = "sim:floor?seed=7" + wanted.daq.device_options + "&x_mm=" + std::to_string(wanted.place.ml_mm) +
                    "&y_mm=" + std::to_string(wanted.place.ap_mm);
  if (wanted.kind == LoadKind::Point) uri += "&contact=point&load_n=490";
  if (wanted.kind == LoadKind::Recording) uri += "&cop=" + wanted.recording;
  return uri;
}

std::string stages(const Case& wanted) {
  return std::string("[[stage]]\nid = \"guard\"\n") + (wanted.daq.is_noise_free ? "stuck_ms = 0.0\n" : "") +
         "[[stage]]\nid = \"window_filter\"\n" + wanted.daq.window + "\n[[stage]]\nid = \"linearise\"\n[[stage]]\nid = \"cop\"\n" +
         "estimator = \"" + wanted.estimator + "\"\n";
}

Case make_case(const DaqSetting& daq, const std::string& estimator, double seconds) {
  return {.rig = {}, .estimator = estimator, .daq = daq, .recording = {}, .first_s = kStandingFromS, .last_s = kStandingFromS + seconds};
}

}  // namespace

const DaqSetting& thesis_daq() {
  static const DaqSetting kDaq{.slug = "thesis-daq",
                               .text = "100 Hz, 11 bit ±5 V, 3 mV; window 3",
                               .device_options = "",
                               .rate_hz = 100.0,
                               .window = "window_scans = 3"};
  return kDaq;
}

const DaqSetting& modern_daq() {
  static const DaqSetting kDaq{.slug = "modern-daq",
                               .text = "1500 Hz, 16 bit ±10 V, 3 mV; window 20 ms",
                               .device_options = "&bits=16&range_v=10",
                               .rate_hz = 1500.0,
                               .window = "window_ms = 20.0"};
  return kDaq;
}

const DaqSetting& noise_free_daq() {
  static const DaqSetting kDaq{.slug = "noise-free",
                               .text = "100 Hz, 16 bit ±5 V, no noise; window 3",
                               .device_options = "&bits=16&noise_mv=0",
                               .rate_hz = 100.0,
                               .window = "window_scans = 3",
                               .is_noise_free = true};
  return kDaq;
}

Case stance_case(const DaqSetting& daq, const std::string& estimator, const Place& place, double seconds) {
  Case made = make_case(daq, estimator, seconds);
  made.place = place;
  const bool is_demo = estimator == "poly3" && daq.slug == thesis_daq().slug && place.ml_mm == 0.0 && place.ap_mm == 0.0;
  made.rig = is_demo ? kDemoRig : "s" + word(place) + "_" + estimator + "_" + daq.slug;
  return made;
}

Case point_case(const DaqSetting& daq, const std::string& estimator, const Place& place, double seconds) {
  Case made = make_case(daq, estimator, seconds);
  made.kind = LoadKind::Point;
  made.place = place;
  made.rig = "p" + word(place) + "_" + estimator + "_" + daq.slug;
  return made;
}

Case recording_case(const DaqSetting& daq, const std::string& estimator, const std::string& name, const std::string& path,
                    double recording_seconds, double seconds) {
  Case made = make_case(daq, estimator, std::min(recording_seconds, seconds));
  made.kind = LoadKind::Recording;
  made.recording = path;
  made.rig = name + "_" + estimator + "_" + daq.slug;
  return made;
}

test::DaemonProcess::Options daemon_options(const std::vector<Case>& cases) {
  test::DaemonProcess::Options options;
  for (const Case& wanted : cases) {
    if (wanted.rig == kDemoRig) continue;  // what `Options` gives by default
    const std::string acquire = "rate_hz = " + std::to_string(wanted.daq.rate_hz);
    options.further_rigs.push_back({.name = wanted.rig, .device = device_uri(wanted), .acquire = acquire, .stages = stages(wanted)});
  }
  return options;
}

}  // namespace dts::accuracy
