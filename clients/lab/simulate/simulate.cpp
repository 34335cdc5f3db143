// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate/simulate.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "device/sim/chair/chair.h"
#include "files/toml_text.h"
#include "record/recorder.h"
#include "session/rig_pipeline.h"

namespace dts::lab::simulate {
namespace {

constexpr std::size_t kSimulatedScans = 64;
constexpr std::int64_t kStartNs = 1'000'000'000;  // of the virtual clock: time axis of the recording
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

tl::unexpected<core::Error> cannot_write(const std::string& file) {
  return core::fail(core::ErrorCode::Failed, "cannot write " + file, "check that the folder exists and the disk has free space");
}

/// Creates a CSV file; fails if it exists.
core::Result<std::ofstream> new_csv(const std::string& file, const char* header) {
  if (std::filesystem::exists(file)) return core::fail(core::ErrorCode::WrongState, file + " already exists", "choose another name");
  std::ofstream out(file, std::ios::binary);
  out << header << std::flush;
  if (!out) return cannot_write(file);  // fail now, not after hours
  return out;
}

/// The true values, written beside the recording.
class Truth {
 public:
  virtual ~Truth() = default;
  virtual void add(const core::Block& block) = 0;
  virtual core::Status close() = 0;
};

/// The true centre of pressure: columns t_s,true_ml_mm,true_ap_mm,true_load_n; empty cells while nobody is on the plate.
class CopTruth final : public Truth {
 public:
  static core::Result<std::unique_ptr<Truth>> create(const Simulation& simulation, const device::DeviceDescription& device) {
    DTS_TRY_ASSIGN(auto out, new_csv(simulation.truth, "t_s,true_ml_mm,true_ap_mm,true_load_n\n"));
    auto truth = std::unique_ptr<CopTruth>(new CopTruth(simulation.truth, simulation.config.rate, std::move(out)));
    for (const char* name : {"true_ml_mm", "true_ap_mm", "true_load_n"}) {
      for (std::size_t channel = 0; channel < device.channels.size(); ++channel) {
        if (device.channels[channel].name == name) truth->channels_.push_back(channel);
      }
    }
    return truth;
  }

  void add(const core::Block& block) override {
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
  core::Status close() override {
    out_.close();
    if (out_) return {};
    return cannot_write(file_);
  }

 private:
  CopTruth(std::string file, core::Rate rate, std::ofstream out) : file_(std::move(file)), rate_(rate), out_(std::move(out)) {}

  std::string file_;
  core::Rate rate_;
  std::vector<std::size_t> channels_;
  std::ofstream out_;
};

/// The completed reaches, one per row.
class ReachTruth final : public Truth {
 public:
  static core::Result<std::unique_ptr<Truth>> create(const Simulation& simulation) {
    DTS_TRY_ASSIGN(const auto uri, device::DeviceUri::parse(simulation.config.device_uri));
    DTS_TRY_ASSIGN(const auto person, device::sim::chair_person(uri, simulation.config.model));
    DTS_TRY_ASSIGN(auto out, new_csv(simulation.truth, "number,condition,target_cm,t_on_s,t_hit_s,t_back_s,t_end_s,trunk_deg\n"));
    return std::unique_ptr<Truth>(new ReachTruth(simulation.truth, simulation.duration_s, person, std::move(out)));
  }

  void add(const core::Block&) override {}
  /// Simulates the same person again, without a chair.
  core::Status close() override {
    sim::SeatedPerson person(person_);
    sim::ReachPlan last;
    for (double time_s = 0.0; time_s <= duration_s_; time_s += kStepS) {
      const sim::ReachPlan* const reach = person.at(time_s).reach;
      if (last.number > 0 && (reach == nullptr || reach->number != last.number)) write(last);
      last = reach != nullptr ? *reach : sim::ReachPlan{};
    }
    if (last.number > 0 && last.end_s <= duration_s_) write(last);
    out_.close();
    if (out_) return {};
    return cannot_write(file_);
  }

 private:
  static constexpr double kStepS = 0.01;

  ReachTruth(std::string file, double duration_s, const sim::SeatedPersonOptions& person, std::ofstream out)
      : file_(std::move(file)), duration_s_(duration_s), person_(person), out_(std::move(out)) {}

  void write(const sim::ReachPlan& reach) {
    out_ << reach.number << ',' << reach.condition;
    for (const double value : {reach.target_cm, reach.on_s, reach.hit_s, reach.back_s, reach.end_s, reach.trunk_deg}) {
      out_ << ',' << files::toml_number(value);
    }
    out_ << '\n';
  }

  std::string file_;
  double duration_s_;
  sim::SeatedPersonOptions person_;
  std::ofstream out_;
};

/// Returns nullptr if no truth is requested.
core::Result<std::unique_ptr<Truth>> create_truth(const Simulation& simulation, const device::DeviceDescription& device) {
  if (simulation.truth.empty()) return nullptr;
  return simulation.config.kind == "chair" ? ReachTruth::create(simulation) : CopTruth::create(simulation, device);
}

record::SessionFacts facts_of(const Simulation& simulation, const device::Device& device, const pipeline::Pipeline& pipeline) {
  const std::int64_t utc_minus_monotonic_ns = core::SystemClock{}.utc_minus_monotonic_ns();
  const core::SystemClock clock;
  record::SessionFacts facts{.session_id = "simulated-" + simulation.config.kind + "-" + std::to_string(simulation.seed),
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
  DTS_TRY_ASSIGN(auto recorder, record::Recorder::create(simulation.out, facts_of(simulation, device, pipeline), std::move(streams)));
  std::vector<double> state(pipeline.state_size());
  pipeline.save(state);
  recorder->set_stage_state(state);
  return recorder;
}

core::Result<std::unique_ptr<device::Device>> start_device(const Simulation& simulation, core::Clock& clock) {
  DTS_TRY_ASSIGN(auto device, device::create_device(simulation.config.device_uri, {.clock = clock, .rig = simulation.config.model}));
  DTS_TRY(device->open());
  auto started = device->start({.rate = simulation.config.rate, .max_block_scans = kSimulatedScans});
  if (!started) return tl::make_unexpected(started.error());
  return device;
}

core::Status record_scans(device::Device& device, pipeline::Pipeline& pipeline, record::Recorder& recorder, Truth* truth,
                          std::uint64_t scans, const std::function<void(double)>& progress) {
  core::Acquired acquired{.block = core::Block(device.describe().channels.size(), kSimulatedScans)};
  core::Frame frame = pipeline.make_frame();
  std::vector<core::Event> events;
  for (std::uint64_t done = 0; done < scans; done += acquired.block.count()) {
    if (device.read(acquired.block, kNever).outcome != device::ReadOutcome::Scans) {
      return core::fail(core::ErrorCode::Internal, device.describe().uri + " sends no more scans");
    }
    acquired.block.set_count(static_cast<std::size_t>(std::min<std::uint64_t>(acquired.block.count(), scans - done)));
    pipeline.process(acquired, frame);
    events.clear();
    core::for_each(pipeline.events(), [&](const core::Event& event) { events.push_back(event); });
    DTS_TRY(recorder.take(frame, events));
    if (truth != nullptr) truth->add(acquired.block);
    progress(static_cast<double>(done) / static_cast<double>(scans));
  }
  return {};
}

}  // namespace

core::Result<Simulated> simulate_rig(Simulation simulation, const std::function<void(double)>& progress) {
  simulation.config.device_uri = "sim:" + simulation.config.kind + "?seed=" + std::to_string(simulation.seed);
  simulation.config.block_scans = kSimulatedScans;
  core::VirtualClock clock(kStartNs);
  DTS_TRY_ASSIGN(auto device, start_device(simulation, clock));
  DTS_TRY_ASSIGN(auto rig, session::make_rig_pipeline(simulation.config, device->describe()));
  DTS_TRY_ASSIGN(auto truth, create_truth(simulation, device->describe()));
  auto recorder = begin_recording(simulation, *device, *rig.pipeline);
  if (!recorder) {
    std::error_code ignored;
    if (truth) std::filesystem::remove(simulation.truth, ignored);  // there is no recording that it describes
    return tl::make_unexpected(recorder.error());
  }

  const std::uint64_t scans = simulation.config.rate.scans_in_ms(simulation.duration_s * 1000.0);
  DTS_TRY(record_scans(*device, *rig.pipeline, **recorder, truth.get(), scans, progress));
  DTS_TRY((*recorder)->flush());
  DTS_TRY_ASSIGN(const auto closed, (*recorder)->close(""));
  if (truth) {
    DTS_TRY(truth->close());
  }
  return Simulated{.file = closed.file, .sha256 = closed.sha256, .scans = scans, .bytes = closed.bytes};
}

}  // namespace dts::lab::simulate
