// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/rate.h"
#include "core/thread.h"
#include "physics/cop/cop_calibration.h"
#include "physics/rig_model.h"
#include "pipeline/edge_detector.h"
#include "pipeline/stage_registry.h"

namespace dts::pipeline {

/// One rig as configured: checked values only.
struct RigConfig {
  std::string name;        ///< [a-z0-9_-], unique; first part of every topic.
  std::string kind;        ///< "floor", "chair"
  std::string device_uri;  ///< "sim:floor?seed=7"
  physics::RigModel model;
  /// The rig's own calibration of the centre of pressure; absent: its plate model stands in for it.
  std::optional<physics::CopCalibration> cop_calibration;
  /// What tells trunk movement from a reach; absent: the rig classifies nothing.
  std::optional<classifier::TrunkModel> trunk_model;
  std::string trunk_model_text{};            ///< The same as text: its hash names the model in recordings.
  std::vector<std::size_t> sensor_channels;  ///< Device channel of each sensor of the model.
  core::Rate rate;                           ///< Wanted; a rig holds the exact rate that its device answers with.
  std::size_t block_scans = 1;               ///< Scans per block from device to socket: the publishing granularity.
  std::vector<StageConfig> stages;
  std::optional<TriggerInput> trigger;  ///< Absent: the rig has no trigger channel.
  double sync_pulse_ms = 0.0;           ///< Pulse on the device's sync output when a session starts; 0: none.
  std::vector<std::string> published;   ///< Names of the streams that go to the socket; empty: all of the pipeline.
  std::vector<std::string> recorded{};  ///< Names of the streams that go into a recording; empty: all of the pipeline.
  std::string definition;               ///< The rig's file with all it refers to, as one TOML text: recorded with every session.
  core::ThreadPolicy acquire_policy;
  core::ThreadPolicy pipeline_policy;
};

}  // namespace dts::pipeline
