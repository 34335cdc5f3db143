// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/force_stream.h"

#include <span>

namespace dts::pipeline {
namespace {

constexpr std::array<std::size_t, 6> kAll{0, 1, 2, 3, 4, 5};  // fx fy fz mx my mz
constexpr std::array<std::size_t, 3> kWithoutShear{2, 3, 4};  // fz mx my

constexpr std::span<const std::size_t> components(bool has_shear) {
  return has_shear ? std::span<const std::size_t>(kAll) : std::span<const std::size_t>(kWithoutShear);
}

}  // namespace

std::vector<core::ChannelFormat> force_channels(bool has_shear) {
  const std::array<core::ChannelFormat, 6> all{{{.name = "fx_n", .unit = "N"},
                                                {.name = "fy_n", .unit = "N"},
                                                {.name = "fz_n", .unit = "N"},
                                                {.name = "mx_nm", .unit = "N m"},
                                                {.name = "my_nm", .unit = "N m"},
                                                {.name = "mz_nm", .unit = "N m"}}};
  std::vector<core::ChannelFormat> channels;
  for (const std::size_t component : components(has_shear)) channels.push_back(all.at(component));
  return channels;
}

ForceStream::ForceStream(const core::Block& block) noexcept : has_shear_(block.channel_count() == kAll.size()) {}

void ForceStream::put(const physics::Wrench& wrench, std::uint8_t bits, core::Block& block, std::size_t scan) const noexcept {
  const auto& [f, m] = wrench;
  const std::array<double, 6> all{f[0], f[1], f[2], m[0], m[1], m[2]};
  std::size_t column = 0;
  for (const std::size_t component : components(has_shear_)) {
    block.column(column)[scan] = all[component];
    block.quality(column)[scan] = bits;
    ++column;
  }
}

physics::Wrench ForceStream::get(const core::Block& block, std::size_t scan) const noexcept {
  std::array<double, 6> all{};
  std::size_t column = 0;
  for (const std::size_t component : components(has_shear_)) all[component] = block.column(column++)[scan];
  return {.force_n = {all[0], all[1], all[2]}, .moment_nm = {all[3], all[4], all[5]}};
}

}  // namespace dts::pipeline
