// SPDX-License-Identifier: Apache-2.0
// Files of force plates: C3D, text, or raw channels behind their plate file. What is read is written as C3D and read again: the same
// numbers in float32.
#include <cmath>

#include "fuzz/fuzz_support.h"
#include "lab/force/force_file.h"
#include "lab/force/plate_to_c3d.h"
#include "lab/force/plate_view.h"
#include "lab/force/sign_check.h"

namespace dts::fuzz::force {
namespace {

using namespace dts::lab::force;

constexpr std::size_t kMostSamples = 2000;
constexpr std::string_view kBetween = "\n----\n";  ///< Plate file and raw channels.

bool is_same(double written, double read) {
  const auto expected = static_cast<float>(written);
  return std::isfinite(expected) ? static_cast<float>(read) == expected : !std::isfinite(read);
}

void write_and_read(const ForceFile& file, const std::string& out) {
  std::vector<std::string> warnings;
  const auto written = write_c3d(file, kDefaultLeastForceN, out, warnings);
  const bool is_float = file.rate_hz > 1e-35 && file.rate_hz < 1e38;  // 100 samples in a frame divide it
  promise(written.has_value() || !is_float, "what was read can be written: 16 plates are not too many");
  if (!written) return;
  const auto again = read_force_file(out, {});
  promise(again.has_value(), "what was written can be read");
  promise(again->samples == file.samples && again->plates.size() == file.plates.size(), "all samples of all plates");
  if (file.axes == Axes::Laboratory) return;
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    const PlateView view(file, plate, Axes::Plate, kDefaultLeastForceN);
    for (std::size_t k = 0; k < std::min(file.samples, kMostSamples); ++k) {
      const ForceSample expected = view.at(k);
      const ForceSample found = again->sample_at(plate, k);
      for (std::size_t axis = 0; axis < 3; ++axis)
        promise(is_same(expected.force_n[axis], found.force_n[axis]), "the force is the one written");
      promise(is_same(expected.cop_mm[0], found.cop_mm[0]), "the point is the one written");
    }
  }
}

/// Everything that the command does with a file that was read.
void use(const ForceFile& file, const std::string& out) {
  if (file.samples > 100'000 || file.plates.size() > 16) return;
  promise(file.rate_hz > 0.0 && file.samples > 0 && !file.plates.empty(), "a rate, samples, plates");
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    for (const Axes axes : {Axes::Plate, Axes::Laboratory}) {
      const PlateView view(file, plate, axes, kDefaultLeastForceN);
      for (std::size_t k = 0; k < std::min(file.samples, kMostSamples); ++k) (void)view.at(k);
    }
  }
  ForceFile checked = file;
  add_sign_warnings(checked, kDefaultLeastForceN);
  write_and_read(file, out);
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const std::string text = text_of(bytes, size);
  const std::string name = folder.file("input");
  const std::size_t between = text.find(kBetween);
  const bool is_raw = between != std::string::npos;
  ReadOptions options{.is_zero_of_file = true, .is_polynomial_of_file = true};
  if (is_raw) options.plate_file = folder.file("plate.toml");
  if (is_raw) put_file(options.plate_file, text.substr(0, between));
  put_file(name, is_raw ? text.substr(between + kBetween.size()) : text);
  const auto file = read_force_file(name, options);
  promise(file.has_value() || file.error().what.find('\n') == std::string::npos, "a file, or one line of what is wrong");
  const bool has_positions = text.find("_mm") != std::string::npos;  // it may be a table of positions
  promise(!file || is_raw || has_positions || is_force_file(name), "what can be read is known as a file of force plates");
  if (file) use(*file, folder.file("output.c3d"));
}

}  // namespace dts::fuzz::force

DTS_FUZZ_TARGET(force)
