// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/block.h"
#include "core/event.h"
#include "core/result.h"
#include "physics/cop/cop_calibration.h"
#include "physics/rig_model.h"
#include "pipeline/steadiness_window.h"
#include "pipeline/tare.h"

namespace dts::pipeline {

using OptionValue = std::variant<double, std::string>;

/// One setting of a stage: either a number with unit and range, or one of `choices`.
struct OptionDescription {
  std::string_view name;  ///< "window_scans"; the unit is part of it.
  std::string_view sentence;
  double default_value = 0.0;
  double minimum = 0.0;
  double maximum = 0.0;
  bool is_whole = false;                  ///< Only whole numbers make sense: a count, a channel.
  std::vector<std::string_view> choices;  ///< Not empty: a word; the first is the default.
};

struct StageDescription {
  std::string_view id;  ///< [a-z0-9_]
  std::string_view sentence;
  std::string_view output_stream;  ///< Name of the stream it makes: "filtered". Empty: it only watches, the next stage gets the same input.
  std::vector<OptionDescription> options;
};

/// What a stage may use besides its input. `rig`, `tare`, `windows` and the calibration outlive the stage; the context itself need not.
struct StageContext {
  const physics::RigModel& rig;
  /// Range of each sensor channel of the device, V: for rail detection.
  struct InputRange {
    double minimum_v = -10.0;
    double maximum_v = 10.0;
    double resolution_v = 0.0;
  };
  std::vector<InputRange> input_ranges;
  Tare& tare;
  SteadinessWindows& windows;
  /// Of the rig's raw stream, whose scans windows and events name; the pipeline fills it in. Without: a stage's input counts as raw.
  std::optional<core::Rate> raw_rate{};
  /// The rig's own calibration of the centre of pressure; nullptr: the rig's plate model stands in for it.
  const physics::CopCalibration* cop_calibration = nullptr;
  /// What tells trunk movement from a reach; nullptr: the rig has none.
  const classifier::TrunkModel* trunk_model = nullptr;
};

/// Option values by name, complete and in range: `create_stage` checks them against the description and fills in the
/// defaults, so that a stage never sees a bad one.
class StageOptions {
 public:
  explicit StageOptions(std::map<std::string, OptionValue, std::less<>> values) : values_(std::move(values)) {}
  /// Only for names of the stage's description, as what they are described there: anything else is a bug and throws.
  [[nodiscard]] double number(std::string_view name) const;
  [[nodiscard]] const std::string& word(std::string_view name) const;

 private:
  std::map<std::string, OptionValue, std::less<>> values_;
};

/// One step of the pipeline: a block of one stream in, a block of the next out.
///
/// Promises, checked by the contract test for every registered stage: the same result whatever the block size; finite
/// output for finite, contact-making input; no allocation in `process`; `reset` equals fresh; a fresh stage that takes up a saved
/// state goes on as the other did; bad options and states are refused.
class Stage {
 public:
  virtual ~Stage() = default;

  [[nodiscard]] virtual const StageDescription& describe() const noexcept = 0;
  /// Sees the format of its input and says the format of its output (the pipeline sets its name). All memory for blocks
  /// of up to `max_scans` is taken here. Thread: control.
  [[nodiscard]] virtual core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) = 0;
  /// Fills `out` from `in`. `out` arrives with the position and count of `in` and capacity for as many scans; a stage that gives fewer
  /// scans sets count, first scan and host time itself. Values may be NaN only where a quality bit says why. Thread: pipeline.
  /// Realtime-safe: yes.
  /// A stage that makes no stream gets an `out` without channels.
  virtual void process(const core::Block& in, core::Block& out) noexcept = 0;
  /// Adds what the last `process` noticed to `events`, where the stages before it have put theirs: told in the order of scans, the same
  /// whatever the block size. Called once after each `process`. Thread: pipeline. Realtime-safe: yes.
  virtual void tell(core::FrameEvents& events) noexcept { static_cast<void>(events); }
  /// Forgets the signal's history: called between segments. What a command has set (a tare) stays.
  /// Thread: pipeline. Realtime-safe: yes.
  virtual void reset() noexcept = 0;

  /// The signal's history as numbers, so that a replay can begin in the middle of a stream. How many there are; fixed after `prepare`.
  [[nodiscard]] virtual std::size_t state_size() const noexcept = 0;
  /// Writes them to `state`, of `state_size()`. Thread: pipeline. Realtime-safe: yes.
  virtual void save(std::span<double> state) const noexcept = 0;
  /// Goes on as the stage that saved them would have. They come from a file: false when their count is wrong or one is impossible; the
  /// stage is then as fresh. Thread: pipeline, or control before there is one.
  [[nodiscard]] virtual bool restore(std::span<const double> state) noexcept = 0;
};

}  // namespace dts::pipeline
