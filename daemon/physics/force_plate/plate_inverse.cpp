// SPDX-License-Identifier: Apache-2.0
#include "physics/force_plate/plate_inverse.h"

#include <Eigen/Dense>

namespace dts::physics {
namespace {

std::array<double, kSixComponents> components(const Wrench& wrench) {
  const auto& [f, m] = wrench;
  return {f[0], f[1], f[2], m[0], m[1], m[2]};
}

/// Returns, by row, the components of the reaction that one unit of each channel means.
Eigen::MatrixXd reaction_of_channels(const ForcePlate& plate, const Mounting& mounting) {
  Eigen::MatrixXd matrix(kSixComponents, plate.channel_count());
  std::vector<double> channels(plate.channel_count());
  for (std::size_t channel = 0; channel < channels.size(); ++channel) {
    channels[channel] = 1.0;
    const auto column = components(in_subject_frame(plate.wrench(channels), mounting));
    channels[channel] = 0.0;
    for (std::size_t row = 0; row < kSixComponents; ++row) {
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(channel)) = column.at(row);
    }
  }
  return matrix;
}

}  // namespace

PlateInverse::PlateInverse(const ForcePlate& plate, const Mounting& mounting) : rows_(plate.channel_count()) {
  // The rows of shear and Mz of load cells are 0, and so are the columns of their pseudoinverse.
  const Eigen::MatrixXd inverse = reaction_of_channels(plate, mounting).completeOrthogonalDecomposition().pseudoInverse();
  for (std::size_t channel = 0; channel < rows_.size(); ++channel) {
    for (std::size_t component = 0; component < kSixComponents; ++component) {
      rows_[channel].at(component) = inverse(static_cast<Eigen::Index>(channel), static_cast<Eigen::Index>(component));
    }
  }
}

void PlateInverse::write_channels(const Wrench& reaction, std::span<double> channels) const noexcept {
  const auto wanted = components(reaction);
  for (std::size_t channel = 0; channel < rows_.size(); ++channel) {
    channels[channel] = 0.0;
    for (std::size_t component = 0; component < kSixComponents; ++component) {
      channels[channel] += rows_[channel][component] * wanted[component];
    }
  }
}

}  // namespace dts::physics
