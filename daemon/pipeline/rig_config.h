// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/rate.h"
#include "core/thread.h"
#include "pattern/pattern_model.h"
#include "physics/cop/cop_calibration.h"
#include "physics/rig_model.h"
#include "pipeline/edge_detector.h"
#include "pipeline/stage_registry.h"

namespace dts::pipeline {

/// The model that decides which group the sway of a trial resembles.
struct SteadinessModel {
  pattern::PatternModel model;
  std::string text;  ///< Of the file; its hash identifies the model in recordings.
  /// The model decides only trials whose protocol gives them all these labels ("eyes", "closed"); empty: all trials.
  std::vector<std::pair<std::string, std::string>> labels;
};

/// The configuration of one rig, with checked values.
struct RigConfig {
  std::string name;        ///< [a-z0-9_-], unique; first part of every topic.
  std::string kind;        ///< "floor", "chair"
  std::string device_uri;  ///< "sim:floor?seed=7"
  physics::RigModel model;
  /// The rig's own calibration of the centre of pressure; absent: the stage `cop` uses the plate model.
  std::optional<physics::CopCalibration> cop_calibration;
  /// The model that classifies the trunk movement in a reach; absent: the rig classifies no reaches.
  std::optional<classifier::TrunkModel> trunk_model;
  std::string trunk_model_text{};                     ///< The same model as text; its hash identifies the model in recordings.
  std::optional<SteadinessModel> steadiness_model{};  ///< Absent: trials of standing have no decision.
  std::vector<std::size_t> sensor_channels;           ///< Device channel of each input of the model (`physics::input_names`).
  core::Rate rate;                                    ///< The configured rate; in a rig, the device's exact rate.
  std::size_t block_scans = 1;                        ///< Scans per block on the way from the device to the socket.
  std::vector<StageConfig> stages;
  std::optional<TriggerInput> trigger;  ///< Absent: the rig has no trigger channel.
  double sync_pulse_ms = 0.0;           ///< Pulse on the device's sync output when a session starts; 0: none.
  double sync_pulse_every_ms = 0.0;     ///< Repeats the pulse with this period until the session ends; 0: one pulse.
  std::vector<std::string> published;   ///< Streams that are published on the socket; empty: all of the pipeline.
  std::vector<std::string> recorded{};  ///< Streams that are recorded; empty: all of the pipeline.
  std::string definition;               ///< The rig's file and all files that it refers to as one TOML text, recorded with every session.
  core::ThreadPolicy policy;            ///< Of the rig's thread.
};

}  // namespace dts::pipeline
