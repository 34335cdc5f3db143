// SPDX-License-Identifier: Apache-2.0
#include "lab/force/raw_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "core/suggest.h"
#include "files/force_plate_file.h"
#include "lab/force/number_table.h"

namespace dts::lab::force {
namespace {

struct Channels {
  files::ForcePlateFile plate;
  std::vector<std::vector<double>> volts;  ///< One column for each channel.
};

ForceSample raw_sample(const Channels& channels, std::size_t sample) {
  std::array<double, physics::kKistlerChannels> values{};
  for (std::size_t k = 0; k < channels.volts.size(); ++k) values[k] = channels.volts[k][sample] - channels.plate.tare_volts[k];
  const physics::ForcePlate& plate = channels.plate.plate;
  ForceSample seen = sample_of(plate.wrench(std::span(values).first(channels.volts.size())), channels.plate.polynomial);
  if (plate.measures_shear()) return seen;
  seen.force_n[0] = seen.force_n[1] = seen.moment_nm[2] = seen.free_moment_nm = core::kNaN;
  return seen;
}

/// Returns the problem to show: one with the name of a similar key explains the others.
std::string first_problem(const files::Problems& problems) {
  const auto near =
      std::ranges::find_if(problems, [](const files::Problem& one) { return one.text.find("did you mean") != std::string::npos; });
  return files::to_string(near == problems.end() ? problems.front() : *near);
}

/// Returns the places of t_s,c1,..,cN in the first line.
core::Result<std::vector<std::size_t>> places_of(const std::string& file, const Beginning& beginning, std::size_t count) {
  if (beginning.lines.empty()) return unreadable(file, "is empty", "give a CSV file with t_s,c1,..");
  std::vector<std::string_view> names;
  for (const TextCell& cell : cells_of(beginning.lines.front(), ',')) names.push_back(cell.text);
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k <= count; ++k) {
    const std::string name = k == 0 ? "t_s" : "c" + std::to_string(k);
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      const std::string near = core::suggest(name, names);
      return unreadable(file, "line 1: column '" + name + "' is missing",
                        near.empty() ? "the plate needs t_s and c1 to c" + std::to_string(count) : "did you mean '" + near + "'?");
    }
    places.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  return places;
}

}  // namespace

bool has_raw_channels(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;  // reading a pipe would block
  const auto beginning = read_beginning(file);
  return beginning && places_of(file, *beginning, 1).has_value();
}

core::Result<ForceFile> read_raw_channels(const std::string& file, const std::string& plate_file) {
  files::Problems problems;
  auto plate = files::read_force_plate(plate_file, problems);
  if (!plate) return core::fail(core::ErrorCode::Failed, first_problem(problems));
  const std::size_t count = plate->plate.channel_count();
  DTS_TRY_ASSIGN(const auto beginning, read_beginning(file));
  DTS_TRY_ASSIGN(const auto places, places_of(file, beginning, count));
  DTS_TRY_ASSIGN(auto read, read_columns(file, 2, ',', places));
  ForceFile facts{.format = "raw", .samples = read.columns.front().size()};
  facts.t_s = std::move(read.columns.front());
  facts.warnings = std::move(read.warnings);
  for (std::size_t row = 0; row < facts.samples; ++row) {
    if (row == 0 ? std::isfinite(facts.t_s[0]) : facts.t_s[row] > facts.t_s[row - 1]) continue;
    return unreadable(file, "line " + std::to_string(row + 2) + ": t_s does not increase", "correct the times");
  }
  if (facts.samples < 2) return unreadable(file, "has one row: there is no rate", "give at least two rows");
  facts.rate_hz = static_cast<double>(facts.samples - 1) / (facts.t_s.back() - facts.t_s.front());
  facts.is_z_down = plate->is_z_down;
  facts.plates.emplace_back().polynomial = plate->polynomial;
  facts.plates.front().is_polynomial_applied = plate->polynomial.has_value();
  read.columns.erase(read.columns.begin());
  const auto channels = std::make_shared<Channels>(Channels{.plate = std::move(*plate), .volts = std::move(read.columns)});
  facts.sample_at = [channels](std::size_t /*plate*/, std::size_t sample) { return raw_sample(*channels, sample); };
  return facts;
}

}  // namespace dts::lab::force
