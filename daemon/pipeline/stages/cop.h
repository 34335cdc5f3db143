// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "physics/cop/cop_estimator.h"
#include "pipeline/stage.h"
#include "pipeline/stages/contact.h"
#include "pipeline/stages/settled_stance.h"

namespace dts::pipeline {

/// Computes centre of pressure and load from the deflections of a plate (thesis 4.4, plate-model section 5), with the rig's own calibration
/// if present, otherwise with an estimator calibrated on the rig's plate model. The number of input channels must match the estimator.
///
/// Published axes: ml_mm = x to the subject's right, ap_mm = y forward, origin at the plate's centre. Estimators and the thesis's tables
/// use a plate corner as origin; this stage converts between the two.
///
/// Below the contact threshold there is no COP: ml and ap are NaN with kNoContact, and the load is still computed. Outside the calibrated
/// area or load range, values have kUncalibrated, and positions are clamped to the area. If the correction for two feet reports a
/// deflection beyond the travel of the sensors, values also have kOutOfRange. A fault bit or NaN on any sensor makes the whole scan NaN
/// with the bits of all sensors, because a COP from fewer sensors is wrong.
///
/// If the calibration has a correction for two feet, it corrects the values of a person who has settled (SettledStance), with the stance
/// width of the session if stated. While stepping on and off, in trials on one foot, and without a person, the point calibration applies.
/// Four sensors cannot distinguish a weight at rest from a person: for weights, use a calibration without the correction.
class Cop final : public Stage {
 public:
  Cop(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  struct Value {
    double value;
    std::uint8_t bits;
  };
  [[nodiscard]] core::Result<physics::CopEstimator> make_estimator() const;
  /// Returns ml, ap and load of one scan; `bits` are those of all sensors.
  std::array<Value, 3> evaluate(std::span<const double> deflection_mm, std::uint8_t bits) noexcept;
  void read_stance() noexcept;
  void forget_stance() noexcept;
  void update_stance(const core::Block& in, std::size_t scan) noexcept;
  void correct(physics::CopEstimate& estimate, std::span<const double> deflection_mm) noexcept;
  [[nodiscard]] bool is_due(const SubjectStance& stance, std::uint32_t segment, std::uint64_t index) const noexcept;

  const physics::RigModel* rig_;
  const physics::CopCalibration* calibration_;
  std::string method_;
  Contact contact_;
  std::optional<physics::CopEstimator> estimator_;

  // For the correction for two feet.
  const physics::TwoFeetCorrection* two_feet_ = nullptr;  ///< nullptr: the calibration has none.
  SubjectStances* stances_;
  std::optional<core::Rate> given_rate_;
  std::uint64_t raw_per_scan_ = 1;
  SettledStance settled_;
  SubjectStance stance_;                   ///< Used now.
  std::optional<SubjectStance> upcoming_;  ///< Its first scan is still to come.
  std::uint64_t letter_ = 0;               ///< Number of the stance read last.
};

}  // namespace dts::pipeline
