// SPDX-License-Identifier: Apache-2.0
#include "c3d/force_platform.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace dts::c3d {
namespace {

constexpr std::string_view kGroup = "FORCE_PLATFORM";
constexpr double kMostListed = 255.0;
constexpr std::size_t kMatrixSide = 6;

/// Returns the `count` numbers of a plate in a parameter that has so many for each; empty if they are missing or not finite.
std::span<const double> numbers_of(const Parameters& parameters, std::string_view name, std::size_t plate, std::size_t count) {
  const Parameter* const found = parameters.find(kGroup, name);
  if (found == nullptr || found->numbers.size() < (plate + 1) * count) return {};
  const auto numbers = std::span(found->numbers).subspan(plate * count, count);
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }) ? numbers : std::span<const double>();
}

std::vector<std::size_t> channels_of(const Parameters& parameters, std::size_t plate) {
  std::vector<std::size_t> channels;
  const Parameter* const found = parameters.find(kGroup, "CHANNEL");
  const std::size_t rows = found == nullptr ? 0 : found->dimension(0);
  for (std::size_t k = plate * rows; k < (plate + 1) * rows; ++k) {
    const double number = parameters.count(kGroup, "CHANNEL", k).value_or(0.0);
    channels.push_back(number >= 1.0 && number <= 65535.0 ? static_cast<std::size_t>(number) : 0);
  }
  return channels;
}

}  // namespace

ForcePlatforms force_platforms(const Parameters& parameters) {
  ForcePlatforms all;
  const Parameter* const types = parameters.find(kGroup, "TYPE");
  const double listed = types == nullptr ? 0.0 : static_cast<double>(types->numbers.size());
  const double used = parameters.count(kGroup, "USED").value_or(listed);
  const auto count = used >= 0.0 ? static_cast<std::size_t>(std::min(used, kMostListed)) : 0;
  const auto whole = [](double number) { return static_cast<int>(std::clamp(number, -65536.0, 65536.0)); };
  if (const auto zero = numbers_of(parameters, "ZERO", 0, 2); !zero.empty()) all.zero_frames = {whole(zero[0]), whole(zero[1])};
  const Parameter* const matrix = parameters.find(kGroup, "CAL_MATRIX");
  for (std::size_t plate = 0; plate < count; ++plate) {
    ForcePlatform& one = all.plates.emplace_back();
    if (const auto type = numbers_of(parameters, "TYPE", plate, 1); !type.empty()) one.type = whole(type[0]);
    if (const auto origin = numbers_of(parameters, "ORIGIN", plate, 3); !origin.empty()) {
      one.origin.emplace();
      std::ranges::copy(origin, one.origin->begin());
    }
    if (const auto corners = numbers_of(parameters, "CORNERS", plate, 12); !corners.empty()) {
      one.corners.emplace();
      for (std::size_t corner = 0; corner < 4; ++corner) std::ranges::copy(corners.subspan(3 * corner, 3), one.corners->at(corner).begin());
    }
    one.channels = channels_of(parameters, plate);
    if (matrix != nullptr && matrix->dimension(0) == kMatrixSide && matrix->dimension(1) == kMatrixSide) {
      const auto numbers = numbers_of(parameters, "CAL_MATRIX", plate, kMatrixSide * kMatrixSide);
      if (!numbers.empty()) one.matrix.emplace(numbers.begin(), numbers.end());
    }
    if (const auto polynomial = numbers_of(parameters, "FPCOPPOLY", plate, 12); !polynomial.empty()) {
      one.polynomial.emplace();
      std::ranges::copy(polynomial, one.polynomial->begin());
    }
  }
  return all;
}

}  // namespace dts::c3d
