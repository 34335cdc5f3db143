// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "physics/cop/cop_estimator.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// Centre of pressure and load from the four deflections of a floor platform (thesis 4.4, plate-model section 5).
///
/// Published axes: ml_mm = x to the subject's right, ap_mm = y forward, origin at the plate's centre. The estimators, like
/// the thesis's tables, count from a plate corner: this is the edge where that is converted.
///
/// Below the contact threshold there is no COP: ml and ap are NaN with kNoContact, the load is still given. A fault bit or a
/// NaN on any sensor makes the whole scan NaN with the bits of all sensors: three of four sensors give a wrong COP.
class Cop final : public Stage {
 public:
  Cop(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override { is_in_contact_ = false; }

 private:
  struct Value {
    double value;
    std::uint8_t bits;
  };
  /// ml, ap, load of one scan; `bits` are those of all four sensors.
  std::array<Value, 3> evaluate(const std::array<double, physics::kFloorSensors>& deflection_mm, std::uint8_t bits) noexcept;
  bool update_contact(double load_n) noexcept;

  const physics::RigModel* rig_;
  std::string method_;
  double contact_threshold_n_;
  std::optional<physics::CopEstimator> estimator_;
  bool is_in_contact_ = false;
};

}  // namespace dts::pipeline
