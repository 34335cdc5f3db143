// SPDX-License-Identifier: Apache-2.0
// Files of force plates, C3D or text. What is read is written as C3D and read again: the same numbers in float32.
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

bool is_same(double written, double read) {
  const auto expected = static_cast<float>(written);
  return std::isfinite(expected) ? static_cast<float>(read) == expected : !std::isfinite(read);
}

void write_and_read(const ForceFile& file, const std::string& out) {
  std::vector<std::string> warnings;
  const auto written = write_c3d(file, kDefaultLeastForceN, out, warnings);
  if (!written) return;  // too many plates
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

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const Folder folder;
  const std::string name = folder.file("input");
  put_file(name, text_of(bytes, size));
  const auto file = read_force_file(name, {.is_zero_of_file = true, .is_polynomial_of_file = true});
  promise(file.has_value() || file.error().what.find('\n') == std::string::npos, "a file, or one line of what is wrong");
  promise(!file.has_value() || is_force_file(name), "what can be read is known as a file of force plates");
  if (!file || file->samples > 100'000 || file->plates.size() > 16) return;
  promise(file->rate_hz > 0.0 && file->samples > 0 && !file->plates.empty(), "a rate, samples, plates");
  for (std::size_t plate = 0; plate < file->plates.size(); ++plate) {
    for (const Axes axes : {Axes::Plate, Axes::Laboratory}) {
      const PlateView view(*file, plate, axes, kDefaultLeastForceN);
      for (std::size_t k = 0; k < std::min(file->samples, kMostSamples); ++k) (void)view.at(k);
    }
  }
  ForceFile checked = *file;
  add_sign_warnings(checked, kDefaultLeastForceN);
  write_and_read(*file, folder.file("output.c3d"));
}

}  // namespace dts::fuzz::force

DTS_FUZZ_TARGET(force)
