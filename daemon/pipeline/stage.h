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
#include "pipeline/subject_stance.h"
#include "pipeline/tare.h"

namespace dts::pipeline {

/// A number in the option's unit, or one of its words.
using OptionValue = std::variant<double, std::string>;

/// One option of a stage: a number with unit and range, or one of `choices`.
struct OptionDescription {
  std::string_view name;      ///< "window_scans"; includes the unit.
  std::string_view sentence;  ///< What the option does, for the list of stages.
  double default_value = 0.0;
  double minimum = 0.0;
  double maximum = 0.0;
  bool is_whole = false;                  ///< Only whole numbers are allowed, as for a count or a channel.
  std::vector<std::string_view> choices;  ///< If not empty, the option is one of these words; the first is the default.
};

/// Description of a kind of stage, for configuration files and their checks.
struct StageDescription {
  std::string_view id;             ///< [a-z0-9_]
  std::string_view sentence;       ///< What the stage does.
  std::string_view output_stream;  ///< Name of the stream that the stage makes: "filtered". Empty: it only finds events, and the next stage
                                   ///< has the same input.
  std::vector<OptionDescription> options;
};

/// The environment of a stage. `rig`, `tare`, `windows`, `stances`, calibration and model outlive the stage; the context itself need not.
struct StageContext {
  const physics::RigModel& rig;
  /// Input range of each sensor channel of the device, V, to detect values at the rail.
  struct InputRange {
    double minimum_v = -10.0;
    double maximum_v = 10.0;
    double resolution_v = 0.0;
  };
  std::vector<InputRange> input_ranges;
  Tare& tare;
  SteadinessWindows& windows;
  /// Rate of the rig's raw stream, whose scan indices are used in windows and events; set by the pipeline. Without it, a stage's input
  /// counts as raw.
  std::optional<core::Rate> raw_rate{};
  /// The rig's own calibration of the centre of pressure; nullptr: the stage `cop` uses the plate model.
  const physics::CopCalibration* cop_calibration = nullptr;
  /// The model that classifies the trunk movement in a reach; nullptr: the rig has none.
  const classifier::TrunkModel* trunk_model = nullptr;
  /// How the subject of a session stands; nullptr: never known.
  SubjectStances* stances = nullptr;
};

/// Option values by name, complete and in range: `create_stage` checks them against the description and adds the defaults, so that a stage
/// never receives a wrong value.
class StageOptions {
 public:
  explicit StageOptions(std::map<std::string, OptionValue, std::less<>> values) : values_(std::move(values)) {}
  /// Returns the number of an option, in its unit. Throws if the stage's description has no such option of this kind: that is a bug.
  [[nodiscard]] double number(std::string_view name) const;
  /// Returns the word of an option; valid as long as these options exist. Throws like `number`.
  [[nodiscard]] const std::string& word(std::string_view name) const;

 private:
  std::map<std::string, OptionValue, std::less<>> values_;
};

/// One step of the pipeline: reads a block of one stream and makes a block of the next.
///
/// Guarantees, checked by the contract test for every registered stage: the result does not depend on the block size; the output is finite
/// for finite input with contact; `process` does not allocate; `reset` restores the initial state; a new stage with a restored state
/// continues like the stage that saved it; wrong options and states are rejected.
class Stage {
 public:
  virtual ~Stage() = default;

  /// Returns the description of this kind of stage; it never changes. Thread: any.
  [[nodiscard]] virtual const StageDescription& describe() const noexcept = 0;
  /// Receives the format of its input (channels with units, rate) and returns the format of its output (the pipeline sets the name).
  /// Allocates all memory for blocks of up to `max_scans`. Fails with InvalidArgument if the stage cannot use this input, and with
  /// LimitExceeded if an option is beyond its limit at this rate. Thread: control, before the rig's thread runs.
  [[nodiscard]] virtual core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) = 0;
  /// Fills `out` from `in`. `out` already has the position and count of `in` and capacity for as many scans; a stage that makes fewer scans
  /// sets count, first scan and host time itself. A value may be NaN only with a quality bit that explains it. A stage that makes no stream
  /// gets an `out` without channels. Thread: rig. Realtime-safe: yes.
  virtual void process(const core::Block& in, core::Block& out) noexcept = 0;
  /// Appends the events of the last `process` to `events`, after those of the stages before it: in the order of scans, independent of the
  /// block size. Called once after each `process`. Thread: rig. Realtime-safe: yes.
  virtual void tell(core::FrameEvents& events) noexcept { static_cast<void>(events); }
  /// Forgets the signal's history; called between segments. Keeps the effect of commands (a tare).
  /// Thread: rig. Realtime-safe: yes.
  virtual void reset() noexcept = 0;

  /// Returns the number of values in the saved history of the signal, with which a replay can begin in the middle of a stream; fixed after
  /// `prepare`. Thread: any, after `prepare`. Realtime-safe: yes.
  [[nodiscard]] virtual std::size_t state_size() const noexcept = 0;
  /// Returns how many values at the end of the state recordings of dtsd 0.1 lack. They are restored as zeros.
  [[nodiscard]] virtual std::size_t state_added_since_0_1() const noexcept { return 0; }
  /// Writes this history to `state`, which has `state_size()` values. Thread: rig. Realtime-safe: yes.
  virtual void save(std::span<double> state) const noexcept = 0;
  /// Restores a saved history, so that the stage continues like the one that saved it. The values come from a file: returns false for a
  /// wrong number of values or an impossible value; the stage is then in its initial state. Thread: rig, or control before the
  /// rig's thread runs.
  [[nodiscard]] virtual bool restore(std::span<const double> state) noexcept = 0;
};

}  // namespace dts::pipeline
