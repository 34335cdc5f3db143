// SPDX-License-Identifier: Apache-2.0
#include "lab/force/sign_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "cli/table.h"
#include "lab/force/plate_view.h"
#include "posturography/butterworth.h"

namespace dts::lab::force {
namespace {

constexpr double kStandingN = 100.0;
constexpr double kShortestS = 20.0;
constexpr double kLongestS = 1200.0;
constexpr double kMarginS = 3.0;  ///< The filters are not settled there.
constexpr double kMostLoadChange = 0.1;
constexpr double kBinHz = 40.0;
constexpr double kLowestRateHz = 10.0;
constexpr double kLowHz = 0.2;
constexpr double kHighHz = 1.0;
constexpr double kLeastCorrelation = 0.5;

/// Means over short bins: vertical, two horizontal forces, two coordinates of the COP.
using Bin = std::array<double, 5>;

struct Bins {
  std::vector<Bin> all;
  double rate_hz = 0.0;
};

std::array<std::size_t, 2> horizontal(const ForceFile& file) {
  return file.vertical == 1 ? std::array<std::size_t, 2>{0, 2} : std::array<std::size_t, 2>{0, 1};
}

/// A bin with an undefined value is NaN.
Bins bins_of(const ForceFile& file, std::size_t plate, double least_force_n) {
  const double most_each = std::min(1e6, static_cast<double>(file.samples));
  const auto each = static_cast<std::size_t>(std::clamp(std::floor(file.rate_hz / kBinHz), 1.0, most_each));
  Bins bins{.all = {}, .rate_hz = file.rate_hz / static_cast<double>(each)};
  const auto most = static_cast<std::size_t>(std::min(kLongestS * bins.rate_hz, 1e6));
  const PlateView view(file, plate, file.axes, least_force_n);
  const auto [x, y] = horizontal(file);
  for (std::size_t begin = 0; begin + each <= file.samples && bins.all.size() < most; begin += each) {
    Bin bin{};
    for (std::size_t k = begin; k < begin + each; ++k) {
      const ForceSample sample = view.at(k);
      const Bin values{sample.force_n[file.vertical], sample.force_n[x], sample.force_n[y], sample.cop_mm[x], sample.cop_mm[y]};
      for (std::size_t v = 0; v < bin.size(); ++v) bin[v] += values[v] / static_cast<double>(each);
    }
    bins.all.push_back(bin);
  }
  return bins;
}

bool is_standing(const Bin& bin) {
  return std::abs(bin[0]) >= kStandingN && std::ranges::all_of(bin, [](double value) { return std::isfinite(value); });
}

/// Returns the longest stretch in which the subject stands.
std::span<const Bin> longest_stance(const Bins& bins) {
  std::span<const Bin> longest;
  for (std::size_t begin = 0; begin < bins.all.size();) {
    std::size_t end = begin;
    while (end < bins.all.size() && is_standing(bins.all[end])) ++end;
    if (end - begin > longest.size()) longest = std::span(bins.all).subspan(begin, end - begin);
    begin = end + 1;
  }
  return longest;
}

std::vector<double> band_of(std::span<const Bin> stance, std::size_t value, double rate_hz) {
  std::vector<double> high;
  for (const Bin& bin : stance) high.push_back(bin[value] - stance.front()[value]);
  std::vector<double> low = high;
  posturography::filter_zero_phase(posturography::butterworth4(kHighHz, rate_hz), high);
  posturography::filter_zero_phase(posturography::butterworth4(kLowHz, rate_hz), low);
  for (std::size_t k = 0; k < high.size(); ++k) high[k] -= low[k];
  return high;
}

/// Returns the correlation of a force with the acceleration of the COP; nothing if one of them does not move.
std::optional<double> correlation(const std::vector<double>& force, const std::vector<double>& position, std::size_t margin) {
  double products = 0.0;
  double forces = 0.0;
  double bends = 0.0;
  for (std::size_t k = margin; k + margin < force.size(); ++k) {
    const double bend = position[k + 1] - 2.0 * position[k] + position[k - 1];
    products += force[k] * bend;
    forces += force[k] * force[k];
    bends += bend * bend;
  }
  const double scale = std::sqrt(forces * bends);
  return scale > 0.0 ? std::optional(products / scale) : std::nullopt;
}

double mean_vertical(const Bins& bins) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Bin& bin : bins.all) {
    if (!(std::abs(bin[0]) >= kStandingN)) continue;
    sum += bin[0];
    ++count;
  }
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

/// Returns 1 if a positive vertical force points up, -1 if down; nothing if the file does not say.
std::optional<double> up_of(const ForceFile& file, std::size_t plate) {
  if (file.format == "opensim") return 1.0;
  if (file.is_z_down) return *file.is_z_down ? -1.0 : 1.0;
  const auto place = place_of(file.plates[plate]);
  if (!place) return std::nullopt;
  const Vector& normal = place->axes[2];
  const std::size_t axis = std::abs(normal[1]) > std::abs(normal[2]) ? 1 : 2;
  if (std::abs(normal[axis]) < std::abs(normal[0])) return std::nullopt;  // a laboratory whose x points up is unknown to us
  return normal[axis] > 0.0 ? 1.0 : -1.0;
}

bool is_quiet(std::span<const Bin> stance) {
  double mean = 0.0;
  for (const Bin& bin : stance) mean += bin[0] / static_cast<double>(stance.size());
  double squares = 0.0;
  for (const Bin& bin : stance) squares += (bin[0] - mean) * (bin[0] - mean) / static_cast<double>(stance.size());
  return std::sqrt(squares) <= kMostLoadChange * std::abs(mean);
}

/// Returns the correlations of both horizontal axes; nothing if this is not quiet standing.
std::optional<std::array<double, 2>> correlations(const Bins& bins) {
  const auto stance = longest_stance(bins);
  const double length_s = static_cast<double>(stance.size()) / bins.rate_hz;
  if (bins.rate_hz < kLowestRateHz || length_s < kShortestS || !is_quiet(stance)) return std::nullopt;
  const auto margin = static_cast<std::size_t>(std::ceil(kMarginS * bins.rate_hz));
  const auto along = [&](std::size_t axis) {
    return correlation(band_of(stance, 1 + axis, bins.rate_hz), band_of(stance, 3 + axis, bins.rate_hz), margin);
  };
  const auto x = along(0);
  const auto y = along(1);
  return x && y ? std::optional(std::array{*x, *y}) : std::nullopt;
}

std::optional<std::string> shear_warning(const Bins& bins, std::optional<double> is_reaction) {
  const auto found = correlations(bins);
  if (!found) return std::nullopt;
  const auto& r = *found;
  const std::string values = "correlation of the shear with the acceleration of the COP: " + cli::decimal(r[0], 2) +
                             " along the first horizontal axis, " + cli::decimal(r[1], 2) + " along the second";
  if (std::abs(r[0]) < kLeastCorrelation || std::abs(r[1]) < kLeastCorrelation) {
    return "shear and COP contradict each other (" + values + "): axes may be exchanged, or plates mixed";
  }
  if (r[0] * r[1] < 0.0) return "shear and COP contradict each other (" + values + "): one horizontal axis is mirrored";
  if (is_reaction && *is_reaction * r[0] < 0.0) {
    return "shear and vertical force contradict each other (" + values + "): one is the action, the other the reaction";
  }
  return std::nullopt;
}

}  // namespace

void add_sign_warnings(ForceFile& file, double least_force_n) {
  std::vector<double> means_n;
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    means_n.push_back(file.plates[plate].is_usable ? mean_vertical(bins_of(file, plate, least_force_n)) : 0.0);
  }
  const auto loaded = std::ranges::count_if(means_n, [](double mean_n) { return mean_n != 0.0; });
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    if (means_n[plate] == 0.0) continue;
    std::vector<std::string>& warnings = file.plates[plate].warnings;
    const auto up = up_of(file, plate);
    if (up && *up * means_n[plate] < 0.0) {
      warnings.emplace_back("the vertical force points down while the plate is loaded: it is the action, or the axes are turned");
    } else if (!up && means_n[plate] < 0.0) {
      warnings.emplace_back("the vertical force is negative while the plate is loaded: it points down if z points up");
    }
    if (loaded > 1) continue;  // each foot pushes against the other
    const auto is_reaction = up ? std::optional(*up * means_n[plate]) : std::nullopt;
    if (auto warning = shear_warning(bins_of(file, plate, least_force_n), is_reaction)) warnings.push_back(std::move(*warning));
  }
}

}  // namespace dts::lab::force
