// SPDX-License-Identifier: Apache-2.0
#include "lab/study/angle_windows.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "lab/reach/trial_set.h"
#include "lab/study/volunteers.h"

namespace dts::lab::study {
namespace {

constexpr std::array<std::string_view, 3> kConditions = {"120", "150", "max"};

Window window_of(const std::array<double, 10>& angles_deg) {
  const auto [least, most] = std::ranges::minmax(angles_deg);
  return {.least_deg = least,
          .mean_deg = std::accumulate(angles_deg.begin(), angles_deg.end(), 0.0) / static_cast<double>(angles_deg.size()),
          .most_deg = most};
}

AngleWindow window_at(std::size_t condition) {
  AngleWindow window{.condition = kConditions[condition]};
  double squares = 0.0;
  for (std::size_t k = 0; k < window.measured_deg.size(); ++k) {
    const Volunteer& volunteer = healthy()[k];
    const auto target = reach::target_cm(volunteer.person, std::string(window.condition));
    window.measured_deg[k] = (*volunteer.measured_deg)[condition];
    window.geometry_deg[k] = physics::trunk_flexion_deg(volunteer.person, *target);
    const double off_deg = window.geometry_deg[k] - window.measured_deg[k];
    window.bias_deg += off_deg / static_cast<double>(window.measured_deg.size());
    squares += off_deg * off_deg;
  }
  window.rms_deg = std::sqrt(squares / static_cast<double>(window.measured_deg.size()));
  window.measured = window_of(window.measured_deg);
  window.geometry = window_of(window.geometry_deg);
  return window;
}

}  // namespace

std::array<AngleWindow, 3> angle_windows() { return {window_at(0), window_at(1), window_at(2)}; }

}  // namespace dts::lab::study
