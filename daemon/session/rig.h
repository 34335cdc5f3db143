// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/frame_ring.h"
#include "core/latest_value.h"
#include "core/log.h"
#include "device/program_rights.h"
#include "device/usb/usb_bus.h"
#include "pipeline/pipeline.h"
#include "pipeline/rig_config.h"
#include "pipeline/steadiness_window.h"
#include "pipeline/subject_stance.h"
#include "pipeline/tare.h"
#include "session/acquisition.h"
#include "session/channel_statistics.h"
#include "session/publish_report.h"
#include "session/record_tap.h"
#include "session/rig_pipeline.h"
#include "session/sensor_watch.h"

namespace dts::session {

/// The rig thread's report about the stages.
struct PipelineReport {
  double us_per_scan = 0.0;                        ///< Time spent in the stages, moving mean.
  core::FramePosition end;                         ///< The end of the processed frames,
  core::ScanIndex next_scan;                       ///< and of the scans in the newest segment. All data before it are in the ring.
  std::optional<std::int64_t> beyond_travel_ns{};  ///< When a load last bent the plate beyond the travel of the sensors.
};

/// The recent peak fill of each queue (RecentPeak).
struct RingFill {
  double frames_percent = 0.0;  ///< Frames that waited for the publisher.
  double record_percent = 0.0;  ///< Frames that waited for the recorder.
};

/// Publishes the frames of a rig on the rig's own thread.
class FramePublisher {
 public:
  virtual ~FramePublisher() = default;
  /// Publishes the frames that are new in the rig's ring, without waiting for anything. Returns false if the publish thread must do it.
  /// Thread: rig. Realtime-safe: yes.
  [[nodiscard]] virtual bool publish() noexcept = 0;
};

/// A running rig: a device, the stages, and the ring of the newest frames.
///
///     rig thread: device --> stages --> [ring of frames] --> FramePublisher --> subscribers
///                                           '--> record thread, publish thread, control thread: each with its FrameReader
///
/// One thread does all of this for a block before it reads the next one. It never waits for those who follow the frames: a slow one loses
/// frames, and knows how many. `start` starts the thread; `stop` or the destructor ends it. It has a name and, if permitted, SCHED_FIFO.
class Rig final : private ScanSink {
 public:
  /// Creates device and pipeline; an error says what is wrong in `config`. Rings `publish_bell` for frames that no FramePublisher has
  /// published. `clock`, the bell and `usb` (nullptr: no USB devices) outlive the rig.
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> create(pipeline::RigConfig config, core::Clock& clock,
                                                                 core::Doorbell& publish_bell, device::usb::UsbBus* usb = nullptr,
                                                                 device::ProgramRights programs = {});
  /// Like above, with a ready device in place of `config.device_uri`: for tests and benchmarks.
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> create(pipeline::RigConfig config, std::unique_ptr<device::Device> device,
                                                                 core::Clock& clock, core::Doorbell& publish_bell);
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Sets who publishes frames on the rig's thread; call it before `start`. `publisher` outlives the run of the rig's thread.
  void publish_with(FramePublisher& publisher) noexcept { publisher_ = &publisher; }
  /// Thread: control. Rejected scheduling requests go to `log` and to `notices`.
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
  /// Returns which sensors of a streaming device did not measure in the last second, else that a load was beyond their travel; empty: all
  /// measured.
  [[nodiscard]] std::string sensor_problems();
  [[nodiscard]] pipeline::Tare& tare() noexcept { return *tare_; }
  [[nodiscard]] RingFill ring_fill() noexcept;
  [[nodiscard]] const PublishReport& published() noexcept { return published_.load(); }

  /// Thread: that of the publisher, one at a time.
  void note_published(const PublishReport& report) noexcept { published_.store(report); }

  /// Returns the newest frames; follow them with a FrameReader.
  [[nodiscard]] core::FrameRing& frames() noexcept { return frames_; }
  /// Notes that a session has processed the frames before `frame`. A device that waits for its reader then waits for the session, too.
  /// Thread: control.
  void note_followed(std::uint64_t frame) noexcept { followed_.store(frame, std::memory_order_relaxed); }
  /// No session needs the frames. Thread: control.
  void follow_without_limit() noexcept { note_followed(kNobodyFollows); }
  /// Returns the index of the stream "cop" in a frame; nothing if the rig has none.
  [[nodiscard]] std::optional<std::size_t> cop_stream() const noexcept { return cop_stream_; }
  /// Returns the rate of the stream "cop"; nothing if the rig has none.
  [[nodiscard]] std::optional<core::Rate> cop_rate() const noexcept;
  /// Returns the measuring windows of trials, which the control thread sends to the stage `steadiness`. Thread: control.
  [[nodiscard]] pipeline::SteadinessWindows& windows() noexcept { return *windows_; }
  /// Returns what the control thread sends to the stage `cop` about the subject of a session. Thread: control.
  [[nodiscard]] pipeline::SubjectStances& stances() noexcept { return *stances_; }
  /// Passes a cue to the device: a simulated subject follows it. Thread: control.
  void hear(const device::Cue& cue) noexcept { device_->hear(cue); }
  /// Returns the branch of the frames to the recorder.
  [[nodiscard]] RecordTap& tap() noexcept { return tap_; }
  /// Returns the stages in order: "window_filter window_scans=3 shift_scans=1".
  [[nodiscard]] const std::vector<std::string>& stage_texts() const noexcept { return pipeline_->stage_texts(); }

 private:
  Rig(std::unique_ptr<const pipeline::RigConfig> config, core::Clock& clock, core::Doorbell& publish_bell,
      std::unique_ptr<device::Device> device, RigPipeline made);
  [[nodiscard]] static core::Result<std::unique_ptr<Rig>> assemble(std::unique_ptr<pipeline::RigConfig> config,
                                                                   std::unique_ptr<device::Device> device, core::Clock& clock,
                                                                   core::Doorbell& publish_bell);
  [[nodiscard]] bool has_room() noexcept override;
  void process(const core::Acquired& acquired, bool has_more) noexcept override;
  void publish(bool has_more) noexcept;
  void note_travel() noexcept;
  void note_progress(const core::Block& block, std::int64_t spent_ns) noexcept;

  std::unique_ptr<const pipeline::RigConfig> config_;  ///< On the heap: device and stages keep references to its model.
  core::Clock& clock_;
  core::Doorbell& publish_bell_;
  std::unique_ptr<device::Device> device_;
  std::unique_ptr<pipeline::Tare> tare_;
  std::unique_ptr<pipeline::SteadinessWindows> windows_;
  std::unique_ptr<pipeline::SubjectStances> stances_;
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  core::Frame frame_;  ///< The newest frame.
  core::FrameRing frames_;
  FramePublisher* publisher_ = nullptr;
  int unpublished_ = 0;                    ///< Frames in the ring since the publisher was called.
  std::optional<std::size_t> cop_stream_;  ///< Index of the frame's stream "cop".
  static constexpr std::uint64_t kNobodyFollows = std::numeric_limits<std::uint64_t>::max();
  std::atomic<std::uint64_t> followed_{kNobodyFollows};
  RecordTap tap_;
  Acquisition acquisition_;
  StatisticsCollector statistics_;
  std::optional<std::size_t> sensor_stream_;  ///< Index of the frame's stream that has the most processed values of each sensor.
  SensorWatch sensor_watch_;
  PipelineReport pipeline_state_;
  core::LatestValue<PipelineReport> pipeline_report_;
  core::LatestValue<PublishReport> published_;
  std::vector<std::string> notices_;
  std::jthread thread_;
};

}  // namespace dts::session
