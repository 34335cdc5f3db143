// SPDX-License-Identifier: Apache-2.0
// C3D files. What is read stays within the file: every sample of every channel, every parameter, and the force platforms.
#include <cmath>

#include "c3d/c3d_file.h"
#include "c3d/force_platform.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::c3d {
namespace {

constexpr std::size_t kMostReads = 20'000;

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const auto file = dts::c3d::C3dFile::read(text_of(bytes, size));
  if (!file) {
    promise(!file.error().what.empty(), "a file, or what is wrong with it");
    return;
  }
  promise(file->frames() > 0 && file->frames() <= size, "no more frames than bytes");
  promise(file->point_rate_hz() > 0.0 && std::isfinite(file->point_rate_hz()), "a rate above 0");
  std::size_t parameter_bytes = 0;
  for (const auto& parameter : file->parameters().all()) parameter_bytes += parameter.numbers.size() + parameter.texts.size();
  promise(parameter_bytes <= size, "no more parameters than bytes");
  std::size_t reads = 0;
  for (std::size_t sample = 0; sample < file->samples() && reads < kMostReads; ++sample) {
    for (std::size_t channel = 0; channel < file->channels() && reads < kMostReads; ++channel, ++reads)
      (void)file->analogue(sample, channel);
  }
  if (file->channels() > 0) (void)file->analogue(file->samples() - 1, file->channels() - 1);
  promise(force_platforms(file->parameters()).plates.size() <= 255, "at most 255 plates");
}

}  // namespace dts::fuzz::c3d

DTS_FUZZ_TARGET(c3d)
