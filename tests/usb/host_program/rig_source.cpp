// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/rig_source.h"

#include <algorithm>
#include <cmath>

#include "files/rig_model_file.h"

namespace dts::emulator {
namespace {

using core::ErrorCode;

constexpr double kSlackS = 1.0;  // the device's time and the machine's: more apart, and the device has begun to count anew
constexpr std::size_t kTruthValues = 3;

core::Result<physics::RigModel> read_rig(const std::string& file) {
  files::Problems problems;
  const auto table = files::parse_toml(file, problems);
  physics::RigModel rig;
  if (table) {
    files::TomlReader top(&*table, "", file, problems);
    rig = files::read_rig_model(top, problems).model;
  }
  if (!problems.empty()) return core::fail(ErrorCode::InvalidArgument, files::to_string(problems.front()));
  return rig;
}

}  // namespace

core::Result<std::unique_ptr<RigSource>> RigSource::create(const std::string& rig_file, const std::string& scene) {
  std::unique_ptr<RigSource> source(new RigSource);
  auto rig = read_rig(rig_file);
  if (!rig) return tl::make_unexpected(rig.error());
  source->rig_ = std::move(*rig);
  const auto uri = device::DeviceUri::parse(scene);
  if (!uri) return tl::make_unexpected(uri.error());
  for (device::sim::FloorScene* copy : {&source->seen_, &source->known_}) {
    auto made = device::sim::floor_scene(*uri, source->rig_);
    if (!made) return tl::make_unexpected(made.error());
    *copy = std::move(*made);
    if (auto loaded = copy->scene->load(); !loaded) return tl::make_unexpected(loaded.error());
    copy->scene->restart();
  }
  source->values_.resize(source->seen_.channels);
  source->start_ns_ = source->clock_.now_ns();
  return source;
}

Source RigSource::source() {
  return [this](double time_s, std::span<double> volts) { fill(time_s, volts); };
}

/// The device counts from its power-up or from the start of a scan; the story goes on all the same.
double RigSource::story_s(double time_s) {
  const double now_s = static_cast<double>(clock_.now_ns() - start_ns_) * 1e-9;
  if (time_s < device_s_ || std::abs(time_s + offset_s_ - now_s) > kSlackS) offset_s_ = now_s - time_s;
  device_s_ = time_s;
  latest_s_ = std::max(latest_s_, time_s + offset_s_);
  return latest_s_;
}

void RigSource::fill(double time_s, std::span<double> volts) {
  const std::lock_guard lock(mutex_);
  seen_.scene->evaluate(story_s(time_s), values_);
  for (std::size_t i = 0; i < volts.size(); ++i) volts[i] = i < seen_.sensors ? values_[i] + noise_v_(random_) : 0.0;
}

RigSource::Truth RigSource::truth_at(std::int64_t monotonic_ns) {
  const std::lock_guard lock(mutex_);
  const double time_s = std::max(static_cast<double>(monotonic_ns - start_ns_) * 1e-9, 0.0);
  if (time_s < latest_truth_s_) known_.scene->restart();
  latest_truth_s_ = time_s;
  std::vector<double> values(known_.channels);
  known_.scene->evaluate(time_s, values);
  if (known_.channels < known_.sensors + kTruthValues) return {std::nan(""), std::nan(""), std::nan("")};
  const std::size_t first = known_.channels - kTruthValues;
  return {values[first], values[first + 1], values[first + 2]};
}

}  // namespace dts::emulator
