// SPDX-License-Identifier: Apache-2.0
// The table [force_plate]. A plate that is accepted gives finite numbers for finite volts.
#include <array>
#include <cmath>
#include <span>

#include "files/force_plate_file.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::force_plate {

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = text_of(bytes, size);
  files::Problems problems;
  const auto table = files::parse_toml_text(text, "plate.toml", problems);
  if (!table) return;
  const auto plate = files::read_force_plate(files::TomlReader(&*table, "", "plate.toml", problems).table("force_plate"), problems);
  promise(plate.has_value() == problems.empty(), "a plate, or what is wrong with it");
  if (!plate) return;
  promise(plate->tare_volts.size() == plate->plate.channel_count(), "a tare for each channel");
  std::array<double, physics::kKistlerChannels> volts{1, -2, 3, -4, 5, -6, 7, -8};
  const auto wrench = plate->plate.wrench(std::span(volts).first(plate->plate.channel_count()));
  for (const double value : wrench.force_n) promise(std::isfinite(value), "forces are finite");
  for (const double value : wrench.moment_nm) promise(std::isfinite(value), "moments are finite");
}

}  // namespace dts::fuzz::force_plate

DTS_FUZZ_TARGET(force_plate)
