// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/trial_pipeline.h"

#include <algorithm>
#include <cmath>

namespace dts::lab::reach {
namespace {

constexpr std::size_t kBlockScans = 64;
// 16 bit over +-5 V, which fits the recordings' resolution of 0.1 mV.
constexpr pipeline::StageContext::InputRange kConverter{.minimum_v = -5.0, .maximum_v = 5.0, .resolution_v = 10.0 / 65536.0};

std::vector<pipeline::StageConfig> stages() {
  return {{.id = "guard", .options = {}},
          {.id = "linearise", .options = {{"baseline", "nominal"}, {"tare_at_start", "no"}}},
          {.id = "transient", .options = {}},
          {.id = "reach", .options = {}}};
}

}  // namespace

core::Result<std::unique_ptr<TrialPipeline>> TrialPipeline::create(const physics::RigModel& rig, const core::Rate& rate) {
  std::unique_ptr<TrialPipeline> owner(new TrialPipeline);
  owner->rate_ = rate;
  pipeline::PipelineInput input{
      .rate = rate, .sensor_channels = {}, .aux_channels = {}, .aux_formats = {}, .trigger = std::nullopt, .max_block_scans = kBlockScans};
  for (std::size_t c = 0; c < rig.sensors.size(); ++c) input.sensor_channels.push_back(c);
  const pipeline::StageContext context{
      .rig = rig, .input_ranges = std::vector(rig.sensors.size(), kConverter), .tare = owner->tare_, .windows = owner->windows_};
  DTS_TRY_ASSIGN(owner->pipeline_, pipeline::Pipeline::create(stages(), input, context));
  owner->frame_ = owner->pipeline_->make_frame();
  owner->acquired_.block = core::Block(rig.sensors.size(), kBlockScans);
  const auto formats = owner->pipeline_->formats();
  owner->transient_ = static_cast<std::size_t>(std::ranges::find(formats, "transient", &core::StreamFormat::name) - formats.begin());
  return owner;
}

Watched TrialPipeline::watch(std::span<const std::array<double, 4>> volts) {
  Watched watched;
  ++segment_;
  next_scan_ = 0;
  for (std::size_t first = 0; first < volts.size(); first += kBlockScans) {
    process(volts.subspan(first, std::min(kBlockScans, volts.size() - first)), watched);
  }
  return watched;
}

void TrialPipeline::process(std::span<const std::array<double, 4>> volts, Watched& watched) {
  core::Block& block = acquired_.block;
  block.set_count(volts.size());
  block.segment = segment_;
  block.first_scan = core::ScanIndex{next_scan_};
  block.host_time_ns = rate_.time_ns(block.first_scan);
  for (std::size_t c = 0; c < block.channel_count(); ++c) {
    for (std::size_t i = 0; i < volts.size(); ++i) {
      block.column(c)[i] = volts[i][c];
      block.quality(c)[i] = 0;
    }
  }
  next_scan_ += volts.size();
  pipeline_->process(acquired_, frame_);
  const auto reaches = pipeline_->events().reaches.all_of();
  watched.events.insert(watched.events.end(), reaches.begin(), reaches.end());
  const core::Block& transient = frame_.streams[transient_];
  for (std::size_t i = 0; i < transient.count(); ++i) {
    const double mm = transient.column(0)[i];
    const double time_s = static_cast<double>(transient.first_scan.value + i) / rate_.hz();
    if (std::isfinite(mm)) watched.transient.emplace_back(time_s, mm);
  }
}

}  // namespace dts::lab::reach
