// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "files/toml_text.h"
#include "record/recorder.h"
#include "session/rig_pipeline.h"

namespace dts::lab {
namespace {

constexpr std::size_t kBlockScans = 64;
constexpr std::int64_t kStartNs = 1'000'000'000;  // of the virtual clock: the recording's time axis
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

/// The true centre of pressure beside the recording: columns t_s,true_ml_mm,true_ap_mm,true_load_n; empty cells while nobody is there.
class TruthFile {
 public:
  static core::Result<TruthFile> create(const std::string& file, const device::DeviceDescription& device, core::Rate rate) {
    TruthFile truth(file, rate);
    for (const char* name : {"true_ml_mm", "true_ap_mm", "true_load_n"}) {
      for (std::size_t channel = 0; channel < device.channels.size(); ++channel) {
        if (device.channels[channel].name == name) truth.channels_.push_back(channel);
      }
    }
    if (std::filesystem::exists(file)) return core::fail(core::ErrorCode::WrongState, file + " exists already", "choose another name");
    truth.out_.open(file, std::ios::binary);
    truth.out_ << "t_s,true_ml_mm,true_ap_mm,true_load_n\n" << std::flush;
    if (!truth.out_) return truth.failure();  // now, not after hours
    return truth;
  }

  void add(const core::Block& block) {
    for (std::size_t i = 0; i < block.count(); ++i) {
      const auto seconds = static_cast<double>((block.first_scan.value + i) * static_cast<std::uint64_t>(rate_.denominator()));
      out_ << files::toml_number(seconds / static_cast<double>(rate_.numerator()));
      for (const std::size_t channel : channels_) {
        const double value = block.column(channel)[i];
        out_ << ',' << (std::isfinite(value) ? files::toml_number(value) : std::string());
      }
      out_ << '\n';
    }
  }
  core::Status close() {
    out_.close();
    if (out_) return {};
    return failure();
  }

 private:
  TruthFile(std::string file, core::Rate rate) : file_(std::move(file)), rate_(rate) {}

  [[nodiscard]] tl::unexpected<core::Error> failure() const {
    return core::fail(core::ErrorCode::Failed, "cannot write " + file_, "does the folder exist, is there room?");
  }

  std::string file_;
  core::Rate rate_;
  std::vector<std::size_t> channels_;
  std::ofstream out_;
};

record::SessionFacts facts_of(const Simulation& simulation, const device::Device& device, const pipeline::Pipeline& pipeline) {
  const std::int64_t utc_minus_monotonic_ns = core::utc_minus_monotonic_ns();
  const core::SystemClock clock;
  record::SessionFacts facts{.session_id = "simulated-floor-" + std::to_string(simulation.seed),
                             .rig = simulation.config.name,
                             .kind = simulation.config.kind,
                             .protocol = "free",
                             .label = "synthetic: no person"};
  facts.started_utc_ns = clock.now_ns() + utc_minus_monotonic_ns;
  facts.utc_minus_monotonic_ns = facts.started_utc_ns - kStartNs;
  facts.boot_id = "simulated";
  facts.software = std::string("dtslab ") + DTS_VERSION;
  facts.device_uri = simulation.config.device_uri;
  facts.device_model = device.describe().model;
  facts.device_serial = device.describe().serial;
  facts.calibration_id = simulation.config.cop_calibration ? simulation.config.cop_calibration->id : "";
  facts.stages = pipeline.stage_texts();
  facts.rig_definition = simulation.definition;
  return facts;
}

core::Result<std::unique_ptr<record::Recorder>> begin_recording(const Simulation& simulation, const device::Device& device,
                                                                const pipeline::Pipeline& pipeline) {
  auto streams = session::recorded_streams(simulation.config, device.describe(), pipeline.formats());
  auto recorder = record::Recorder::create(simulation.out, facts_of(simulation, device, pipeline), std::move(streams));
  if (!recorder) return recorder;
  std::vector<double> state(pipeline.state_size());
  pipeline.save(state);
  (*recorder)->set_stage_state(state);
  return recorder;
}

core::Result<std::unique_ptr<device::Device>> start_device(const Simulation& simulation, core::Clock& clock) {
  auto device = device::create_device(simulation.config.device_uri, {.clock = clock, .rig = simulation.config.model});
  if (!device) return device;
  if (auto opened = (*device)->open(); !opened) return tl::make_unexpected(opened.error());
  auto started = (*device)->start({.rate = simulation.config.rate, .max_block_scans = kBlockScans});
  if (!started) return tl::make_unexpected(started.error());
  return device;
}

core::Status record_scans(device::Device& device, pipeline::Pipeline& pipeline, record::Recorder& recorder, TruthFile* truth,
                          std::uint64_t scans, const std::function<void(double)>& progress) {
  core::Acquired acquired{.block = core::Block(device.describe().channels.size(), kBlockScans)};
  core::Frame frame = pipeline.make_frame();
  for (std::uint64_t done = 0; done < scans; done += acquired.block.count()) {
    if (device.read(acquired.block, kNever).outcome != device::ReadOutcome::Scans) {
      return core::fail(core::ErrorCode::Internal, device.describe().uri + " stopped giving scans");
    }
    acquired.block.set_count(static_cast<std::size_t>(std::min<std::uint64_t>(acquired.block.count(), scans - done)));
    pipeline.process(acquired, frame);
    if (auto taken = recorder.take(frame); !taken) return taken;
    if (truth != nullptr) truth->add(acquired.block);
    progress(static_cast<double>(done) / static_cast<double>(scans));
  }
  return {};
}

}  // namespace

core::Result<Simulated> simulate_floor(Simulation simulation, const std::function<void(double)>& progress) {
  simulation.config.device_uri = "sim:floor?seed=" + std::to_string(simulation.seed);
  simulation.config.block_scans = kBlockScans;
  core::VirtualClock clock(kStartNs);
  auto device = start_device(simulation, clock);
  if (!device) return tl::make_unexpected(device.error());
  auto rig = session::make_rig_pipeline(simulation.config, (*device)->describe());
  if (!rig) return tl::make_unexpected(rig.error());
  std::optional<TruthFile> truth;
  if (!simulation.truth.empty()) {
    auto created = TruthFile::create(simulation.truth, (*device)->describe(), simulation.config.rate);
    if (!created) return tl::make_unexpected(created.error());
    truth = std::move(*created);
  }
  auto recorder = begin_recording(simulation, **device, *rig->pipeline);
  if (!recorder) {
    std::error_code ignored;
    if (truth) std::filesystem::remove(simulation.truth, ignored);  // it tells of nothing
    return tl::make_unexpected(recorder.error());
  }

  const std::uint64_t scans = simulation.config.rate.scans_in_ms(simulation.duration_s * 1000.0);
  auto recorded = record_scans(**device, *rig->pipeline, **recorder, truth ? &*truth : nullptr, scans, progress);
  if (!recorded) return tl::make_unexpected(recorded.error());
  if (auto flushed = (*recorder)->flush(); !flushed) return tl::make_unexpected(flushed.error());
  const auto closed = (*recorder)->close("");
  if (!closed) return tl::make_unexpected(closed.error());
  if (truth) {
    if (auto written = truth->close(); !written) return tl::make_unexpected(written.error());
  }
  return Simulated{.file = closed->file, .sha256 = closed->sha256, .scans = scans, .bytes = closed->bytes};
}

}  // namespace dts::lab
