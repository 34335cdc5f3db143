// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <algorithm>
#include <string>

#include "pipeline/fault.h"

namespace dts::pipeline {
namespace {

constexpr std::string_view kFirstStream = "raw";
constexpr std::string_view kAuxStream = "aux";

tl::unexpected<core::Error> refuse(std::string what) {
  return core::fail(core::ErrorCode::InvalidArgument, "pipeline: " + std::move(what));
}

core::Status check_channels(const PipelineInput& input, const physics::RigModel& rig) {
  const std::size_t inputs = physics::input_names(rig).size();
  if (input.sensor_channels.size() != inputs) {
    return refuse("the rig has " + std::to_string(inputs) + " sensors, but " + std::to_string(input.sensor_channels.size()) +
                  " device channels are given for them");
  }
  if (input.aux_channels.size() != input.aux_formats.size()) {
    return refuse(std::to_string(input.aux_channels.size()) + " aux channels, but " + std::to_string(input.aux_formats.size()) +
                  " formats");
  }
  std::vector<std::size_t> all = input.sensor_channels;
  all.insert(all.end(), input.aux_channels.begin(), input.aux_channels.end());
  std::ranges::sort(all);
  if (const auto twice = std::ranges::adjacent_find(all); twice != all.end()) {
    return refuse("device channel " + std::to_string(*twice) + " is used twice");
  }
  if (!all.empty() && all.back() >= core::kMaxChannels) {
    return refuse("device channel " + std::to_string(all.back()) + " is above the limit of " + std::to_string(core::kMaxChannels - 1));
  }
  return {};
}

/// Returns the input format of the first stage.
core::StreamFormat device_format(const PipelineInput& input, const physics::RigModel& rig) {
  core::StreamFormat format{.name = "device", .rate = input.rate, .channels = {}};
  for (const std::string& name : physics::input_names(rig)) format.channels.push_back({.name = name + "_v", .unit = "V"});
  format.channels.insert(format.channels.end(), input.aux_formats.begin(), input.aux_formats.end());
  return format;
}

void copy_column(const core::Block& from, std::size_t from_channel, core::Block& to, std::size_t to_channel) noexcept {
  std::ranges::copy(from.column(from_channel), to.column(to_channel).begin());
  std::ranges::copy(from.quality(from_channel), to.quality(to_channel).begin());
}

}  // namespace

core::Result<std::unique_ptr<Pipeline>> Pipeline::create(std::span<const StageConfig> stages, const PipelineInput& input,
                                                         const StageContext& context) {
  if (stages.empty()) return refuse("no stages; the first is usually 'guard'");
  DTS_TRY(check_channels(input, context.rig));

  std::unique_ptr<Pipeline> pipeline(new Pipeline);
  pipeline->max_block_scans_ = input.max_block_scans;
  core::StreamFormat format = device_format(input, context.rig);
  const std::size_t columns = format.channels.size();
  StageContext full_context = context;
  full_context.raw_rate = input.rate;
  for (const StageConfig& config : stages) {
    DTS_TRY_ASSIGN(format, pipeline->append(config, format, full_context));
  }
  if (!input.aux_channels.empty()) {
    pipeline->has_aux_ = true;
    pipeline->formats_.push_back({.name = std::string(kAuxStream), .rate = input.rate, .channels = input.aux_formats});
  }
  pipeline->sequences_.resize(pipeline->formats_.size());
  pipeline->channels_ = input.sensor_channels;
  pipeline->channels_.insert(pipeline->channels_.end(), input.aux_channels.begin(), input.aux_channels.end());
  pipeline->sensor_count_ = input.sensor_channels.size();
  DTS_TRY(pipeline->watch_trigger(input));
  pipeline->device_ = core::Block(columns, input.max_block_scans);
  return pipeline;
}

core::Status Pipeline::watch_trigger(const PipelineInput& input) {
  if (!input.trigger) return {};
  DTS_TRY(check(*input.trigger));
  const auto found = std::ranges::find(input.aux_channels, input.trigger->channel);
  if (found == input.aux_channels.end()) {
    return refuse("trigger channel " + std::to_string(input.trigger->channel) + " is not one of the device's channels beside the sensors");
  }
  const auto aux = static_cast<std::size_t>(found - input.aux_channels.begin());
  trigger_.emplace(*input.trigger, input.rate);
  trigger_column_ = input.sensor_channels.size() + aux;
  return {};
}

core::Result<core::StreamFormat> Pipeline::append(const StageConfig& config, const core::StreamFormat& input, const StageContext& context) {
  DTS_TRY_ASSIGN(auto stage, create_stage(config, context));
  const std::string_view stream = stage->describe().output_stream;
  const bool has_stream = !stream.empty();
  if (formats_.empty() && stream != kFirstStream) {
    return refuse("the first stage is '" + config.id + "', which makes stream '" + std::string(stream) +
                  "'; it must make 'raw', as 'guard' does");
  }
  if (has_stream && (stream == kAuxStream || std::ranges::find(formats_, stream, &core::StreamFormat::name) != formats_.end())) {
    return refuse("stage '" + config.id + "' makes stream '" + std::string(stream) + "', which exists already");
  }
  DTS_TRY_ASSIGN(auto output, stage->prepare(input, max_block_scans_));
  stages_.push_back({.stage = std::move(stage), .stream = std::nullopt});
  stage_texts_.push_back(stage_text(config));
  if (!has_stream) return input;
  output.name = stream;
  stages_.back().stream = formats_.size();
  formats_.push_back(output);
  return output;
}

core::Frame Pipeline::make_frame() const {
  core::Frame frame;
  for (const core::StreamFormat& format : formats_) frame.streams.emplace_back(format.channels.size(), max_block_scans_);
  return frame;
}

bool Pipeline::is_acceptable(const core::Block& block) const noexcept {
  const bool has_channels = std::ranges::all_of(channels_, [&](std::size_t channel) { return channel < block.channel_count(); });
  return has_channels && block.count() <= max_block_scans_;
}

void Pipeline::process(const core::Acquired& acquired, core::Frame& frame) noexcept {
  const core::Block& block = acquired.block;
  frame.gap_before = acquired.gap_before;
  frame.segment = block.segment;
  frame.host_time_ns = block.host_time_ns;
  frame.lost_scans_total = acquired.lost_scans_total;
  if (acquired.gap_before.reason != core::GapReason::None) reset_stages();
  events_.clear();
  copy_input(block);
  if (trigger_) trigger_->process(device_, trigger_column_, events_.triggers);
  run_stages(frame);
}

void Pipeline::copy_input(const core::Block& block) noexcept {
  device_.copy_position(block);
  if (block.count() == 0) return;
  if (!is_acceptable(block)) {
    device_.set_count(0);
    rejected_blocks_.store(rejected_blocks_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);  // one writer
    return;
  }
  if (block.segment != segment_ || block.first_scan != next_scan_) reset_stages();
  segment_ = block.segment;
  next_scan_ = block.first_scan + block.count();
  for (std::size_t c = 0; c < channels_.size(); ++c) copy_column(block, channels_[c], device_, c);
}

void Pipeline::reset_stages() noexcept {
  if (trigger_) trigger_->reset();
  for (const auto& [stage, stream] : stages_) stage->reset();
}

std::size_t Pipeline::state_size() const noexcept {
  std::size_t numbers = trigger_ ? EdgeDetector::kStateSize : 0;
  for (const auto& [stage, stream] : stages_) numbers += stage->state_size();
  return numbers;
}

void Pipeline::save(std::span<double> state) const noexcept {
  if (state.size() != state_size()) return;
  if (trigger_) {
    trigger_->save(state.first(EdgeDetector::kStateSize));
    state = state.subspan(EdgeDetector::kStateSize);
  }
  for (const auto& [stage, stream] : stages_) {
    stage->save(state.first(stage->state_size()));
    state = state.subspan(stage->state_size());
  }
}

core::Status Pipeline::restore(std::span<const double> state, std::uint32_t segment, core::ScanIndex next_scan) {
  const std::vector<double> completed = state.size() < state_size() ? state_of_0_1(state) : std::vector<double>();
  if (completed.size() == state_size()) state = completed;
  if (state.size() != state_size()) {
    return core::fail(core::ErrorCode::DataDamaged, "the recorded state of the stages has " + std::to_string(state.size()) +
                                                        " numbers; these stages have " + std::to_string(state_size()));
  }
  if (std::string refusing = restore_stages(state); !refusing.empty()) {
    return core::fail(core::ErrorCode::DataDamaged, "the recorded state of " + refusing + " is not valid");
  }
  segment_ = segment;
  next_scan_ = next_scan;
  return {};
}

/// Returns a state of dtsd 0.1 with zeros for the numbers that its stages did not have yet; empty for a state of another size.
std::vector<double> Pipeline::state_of_0_1(std::span<const double> state) const {
  std::vector<double> completed(state.begin(), state.end());
  std::size_t end = trigger_ ? EdgeDetector::kStateSize : 0;
  for (const auto& [stage, stream] : stages_) {
    end += stage->state_size();
    const std::size_t added = stage->state_added_since_0_1();
    if (end - added > completed.size()) return {};
    completed.insert(completed.begin() + static_cast<std::ptrdiff_t>(end - added), added, 0.0);
  }
  return completed;
}

/// Returns the stage that rejected its saved state; empty if none did. Otherwise resets everything: a partly restored pipeline is invalid.
std::string Pipeline::restore_stages(std::span<const double> state) {
  std::string refusing;
  if (trigger_) {
    if (!trigger_->restore(state.first(EdgeDetector::kStateSize))) refusing = "the trigger";
    state = state.subspan(EdgeDetector::kStateSize);
  }
  for (const auto& [stage, stream] : stages_) {
    const auto part = state.first(stage->state_size());
    state = state.subspan(part.size());
    if (!stage->restore(part)) refusing = "stage " + std::string(stage->describe().id);
  }
  if (refusing.empty()) return refusing;
  if (trigger_) trigger_->reset();
  for (const auto& [stage, stream] : stages_) (void)stage->restore({});
  return refusing;
}

void Pipeline::run_stages(core::Frame& frame) noexcept {
  const core::Block* in = &device_;
  for (const auto& [stage, stream] : stages_) {
    core::Block& out = stream ? frame.streams[*stream] : no_stream_;
    out.copy_position(*in);
    if (in->count() > 0) {
      stage->process(*in, out);
      stage->tell(events_);
    }
    if (stream) in = &out;
  }
  if (has_aux_) fill_aux(frame.streams.back());
  for (std::size_t s = 0; s < formats_.size(); ++s) {
    frame.streams[s].sequence = sequences_[s];
    if (frame.streams[s].count() > 0) ++sequences_[s];
  }
}

void Pipeline::fill_aux(core::Block& out) const noexcept {
  out.copy_position(device_);
  for (std::size_t c = 0; c < out.channel_count(); ++c) {
    copy_column(device_, sensor_count_ + c, out, c);
    const auto values = out.column(c);
    const auto bits = out.quality(c);
    for (std::size_t i = 0; i < values.size(); ++i) bits[i] = explained(values[i], bits[i]);
  }
}

}  // namespace dts::pipeline
