// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate/simulated_cop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/clock.h"
#include "device/registry.h"
#include "files/rig_file.h"
#include "session/rig_pipeline.h"

namespace dts::lab::simulate {
namespace {

constexpr std::size_t kCopBlockScans = 64;
constexpr std::int64_t kCopStartNs = 1'000'000'000;  // of the virtual clock
constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// Where the pipeline has the centre of pressure.
struct CopStream {
  std::size_t stream = 0;
  std::size_t ml = 0;
  std::size_t ap = 0;
  std::uint64_t delay_scans = 0;
};

core::Result<CopStream> find_cop(const pipeline::Pipeline& pipeline, const std::string& name) {
  const auto formats = pipeline.formats();
  const auto cop = std::ranges::find(formats, "cop", &core::StreamFormat::name);
  if (cop == formats.end()) return core::fail(core::ErrorCode::InvalidArgument, name + " makes no stream \"cop\"");
  const auto index = [&](const char* channel) {
    return static_cast<std::size_t>(std::ranges::find(cop->channels, channel, &core::ChannelFormat::name) - cop->channels.begin());
  };
  return CopStream{.stream = static_cast<std::size_t>(cop - formats.begin()),
                   .ml = index("ml_mm"),
                   .ap = index("ap_mm"),
                   .delay_scans = cop->rate.scans_in_ms(static_cast<double>(cop->delay_ns) * 1e-6)};
}

void append(const core::Block& block, const CopStream& from, SimulatedCop& to) {
  for (std::size_t i = 0; i < block.count(); ++i) {
    const std::uint64_t scan = block.first_scan.value + i;
    if (scan < from.delay_scans || scan - from.delay_scans >= to.ml_mm.size()) continue;
    to.ml_mm[scan - from.delay_scans] = block.column(from.ml)[i];
    to.ap_mm[scan - from.delay_scans] = block.column(from.ap)[i];
  }
}

core::Result<pipeline::RigConfig> read_definition(const std::string& definition, const std::string& name) {
  files::Problems problems;
  pipeline::RigConfig config = files::read_rig_text(definition, name, problems);
  if (!problems.empty()) return core::fail(core::ErrorCode::InvalidArgument, files::to_string(problems.front()));
  config.name = "simulated";
  config.block_scans = kCopBlockScans;
  return config;
}

}  // namespace

core::Result<SimulatedCop> simulate_cop(const std::string& definition, const std::string& name, const std::string& device_uri,
                                        double duration_s) {
  DTS_TRY_ASSIGN(auto config, read_definition(definition, name));
  config.device_uri = device_uri;
  core::VirtualClock clock(kCopStartNs);
  DTS_TRY_ASSIGN(const auto device, device::create_device(device_uri, {.clock = clock, .rig = config.model}));
  DTS_TRY(device->open());
  DTS_TRY_ASSIGN(config.rate, device->start({.rate = config.rate, .max_block_scans = kCopBlockScans}));
  DTS_TRY_ASSIGN(auto rig, session::make_rig_pipeline(config, device->describe()));
  DTS_TRY_ASSIGN(const auto cop, find_cop(*rig.pipeline, name));

  const std::uint64_t wanted = config.rate.scans_in_ms(duration_s * 1000.0);
  SimulatedCop result{std::vector<double>(wanted, kNoValue), std::vector<double>(wanted, kNoValue)};
  core::Acquired acquired{.block = core::Block(device->describe().channels.size(), kCopBlockScans)};
  core::Frame frame = rig.pipeline->make_frame();
  for (std::uint64_t done = 0; done < wanted + cop.delay_scans; done += acquired.block.count()) {
    if (device->read(acquired.block, std::numeric_limits<std::int64_t>::max()).outcome != device::ReadOutcome::Scans) {
      return core::fail(core::ErrorCode::Internal, device_uri + " sends no more scans");
    }
    rig.pipeline->process(acquired, frame);
    append(frame.streams[cop.stream], cop, result);
  }
  return result;
}

}  // namespace dts::lab::simulate
