// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/event.h"
#include "core/frame.h"
#include "core/log.h"
#include "core/spsc_ring.h"
#include "device/usb/usb_bus.h"
#include "pipeline/pipeline.h"
#include "pipeline/rig_config.h"
#include "pipeline/steadiness_window.h"
#include "pipeline/tare.h"
#include "session/acquisition.h"
#include "session/channel_statistics.h"
#include "session/latency_report.h"
#include "session/record_tap.h"
#include "session/rig_pipeline.h"
#include "session/sensor_watch.h"

namespace dts::session {

/// The pipeline thread's report about itself.
struct PipelineReport {
  std::uint64_t dropped_blocks_total = 0;  ///< Frames dropped because the publisher's ring was full.
  std::uint64_t lost_events_total = 0;     ///< Events dropped on the way to the publisher or to the session's results.
  double us_per_scan = 0.0;                ///< Time spent in the stages, moving mean.
  std::uint32_t segment = 0;               ///< With `next_scan`, the end of the processed scans: all data before it are in the rings.
  core::ScanIndex next_scan;
  RecentPeak frames_waiting;  ///< Frames that wait for the publisher.
  RecentPeak slots_waiting;   ///< Slots that wait for the recorder.
};

/// The recent peak fill of each ring (RecentPeak).
struct RingFill {
  double scans_percent = 0.0;
  double frames_percent = 0.0;
  double record_percent = 0.0;
};

/// A running rig: a device, its two sample threads and the rings between them.
///
///     acquire thread: device --> [scans ring] --> pipeline thread: stages --> [frames ring] --> publish thread
///                                                                         --> [record tap] --> record thread
///
/// `start` starts the threads; `stop` or the destructor ends them. Each has a name and, if permitted, SCHED_FIFO.
class Rig {
 public:
  /// Creates device and pipeline; an error says what is wrong in `config`. Rings `publish_bell` for every frame. `clock`, the bell and
  /// `usb` (nullptr: simulated devices only) outlive the rig.
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> create(pipeline::RigConfig config, core::Clock& clock,
                                                                 core::Doorbell& publish_bell, device::usb::UsbBus* usb = nullptr);
  /// Like above, with a ready device in place of `config.device_uri`: for tests and benchmarks.
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> create(pipeline::RigConfig config, std::unique_ptr<device::Device> device,
                                                                 core::Clock& clock, core::Doorbell& publish_bell);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Thread: control. Refused scheduling requests go to `log` and to `notices`.
  void start(core::Log log);
  void stop() noexcept;

  [[nodiscard]] const pipeline::RigConfig& config() const noexcept { return *config_; }
  [[nodiscard]] const device::DeviceDescription& device() const noexcept { return device_->describe(); }
  /// Returns what the connected device reports about itself. Thread: control; may wait for a control request.
  [[nodiscard]] device::DeviceReport device_report() const { return device_->report(); }
  /// Thread: control; may wait for a control request.
  [[nodiscard]] core::Status set_sync_output(bool is_high) { return device_->set_sync_output(is_high); }
  [[nodiscard]] std::span<const core::StreamFormat> formats() const noexcept { return pipeline_->formats(); }
  [[nodiscard]] const std::vector<std::string>& notices() const noexcept { return notices_; }

  /// Thread: control (the one reader of each).
  [[nodiscard]] const AcquisitionReport& acquisition() noexcept { return acquisition_.report(); }
  [[nodiscard]] const PipelineReport& pipeline_report() noexcept { return pipeline_report_.load(); }
  [[nodiscard]] const StatisticsReport& statistics() noexcept { return statistics_.latest(); }
  /// Returns which sensors of a streaming device did not measure in the last second; empty: all measured.
  [[nodiscard]] std::string sensor_problems();
  [[nodiscard]] pipeline::Tare& tare() noexcept { return *tare_; }
  [[nodiscard]] RingFill ring_fill() noexcept;
  [[nodiscard]] const LatencyReport& latency() noexcept { return latency_.load(); }

  /// Thread: publish (the one writer).
  void note_latency(const LatencyReport& report) noexcept { latency_.store(report); }

  /// Returns the finished frames, oldest first. Thread: publish (the consumer).
  [[nodiscard]] core::SpscRing<core::Frame>& frames() noexcept { return frames_; }
  /// Returns the events of the finished frames (`Frame::event_count`). Thread: publish (the consumer).
  [[nodiscard]] core::EventLane& events() noexcept { return events_; }
  /// Returns reaches and classes, oldest first, for the results of a session. Thread: control (the consumer).
  [[nodiscard]] core::SpscRing<core::Event>& reaches() noexcept { return reaches_; }
  /// Returns the blocks of the stream "cop", oldest first, for the results of a session. The ring holds several seconds; a loss shows as a
  /// jump of the scan indices. Thread: control (the consumer).
  [[nodiscard]] core::SpscRing<core::Block>& cops() noexcept { return cops_; }
  /// Returns the rate of the stream "cop"; nothing if the rig has none.
  [[nodiscard]] std::optional<core::Rate> cop_rate() const noexcept;
  /// Returns the measuring windows of trials, which the control thread sends to the stage `steadiness`. Thread: control.
  [[nodiscard]] pipeline::SteadinessWindows& windows() noexcept { return *windows_; }
  /// Passes a cue to the device: a simulated subject follows it. Thread: control.
  void hear(const device::Cue& cue) noexcept { device_->hear(cue); }
  /// Returns the branch of the frames to the recorder.
  [[nodiscard]] RecordTap& tap() noexcept { return tap_; }
  /// Returns the stages in order: "window_filter window_scans=3 shift_scans=1".
  [[nodiscard]] const std::vector<std::string>& stage_texts() const noexcept { return pipeline_->stage_texts(); }
  /// Returns the number of frames dropped because the publisher was too slow. Thread: any.
  [[nodiscard]] std::uint64_t dropped_blocks() const noexcept { return frames_.dropped(); }

 private:
  Rig(std::unique_ptr<const pipeline::RigConfig> config, core::Clock& clock, core::Doorbell& publish_bell,
      std::unique_ptr<device::Device> device, RigPipeline made);
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> assemble(std::unique_ptr<pipeline::RigConfig> config,
                                                                   std::unique_ptr<device::Device> device, core::Clock& clock,
                                                                   core::Doorbell& publish_bell);
  void run_pipeline(const std::stop_token& stop) noexcept;
  void process(const core::Acquired& acquired) noexcept;
  void wait_for_recorder(const std::stop_token& stop) noexcept;
  void offer_events(const core::FrameEvents& events) noexcept;
  void offer_cop(const core::Frame& frame) noexcept;
  void note_progress(const core::Block& block, std::int64_t spent_ns) noexcept;

  std::unique_ptr<const pipeline::RigConfig> config_;  ///< On the heap: device and stages keep references to its model.
  core::Clock& clock_;
  core::Doorbell& publish_bell_;
  std::unique_ptr<device::Device> device_;
  std::unique_ptr<pipeline::Tare> tare_;
  std::unique_ptr<pipeline::SteadinessWindows> windows_;
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  core::SpscRing<core::Acquired> scans_;
  core::SpscRing<core::Frame> frames_;
  core::EventLane events_;
  core::SpscRing<core::Event> reaches_;
  std::optional<std::size_t> cop_stream_;  ///< Index of the frame's stream "cop".
  core::SpscRing<core::Block> cops_;
  RecordTap tap_;
  core::Frame spare_frame_;    ///< Filled when the publisher's ring is full, because the stages must process every scan.
  core::Gap unpublished_gap_;  ///< Gap before dropped frames; goes with the next frame that is published.
  core::Doorbell scans_bell_;
  Acquisition acquisition_;
  StatisticsCollector statistics_;
  std::optional<std::size_t> sensor_stream_;  ///< Index of the frame's stream that has the most processed values of each sensor.
  SensorWatch sensor_watch_;
  PipelineReport pipeline_state_;
  core::LatestValue<PipelineReport> pipeline_report_;
  core::LatestValue<LatencyReport> latency_;
  std::vector<std::string> notices_;
  std::jthread acquire_thread_;
  std::jthread pipeline_thread_;
};

}  // namespace dts::session
