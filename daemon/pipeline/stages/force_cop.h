// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "pipeline/stage.h"
#include "pipeline/stages/contact.h"

namespace dts::pipeline {

/// Computes centre of pressure and load from the force and moment of a force plate (the stream "force"): ml_mm = -My/Fz, ap_mm = Mx/Fz, in
/// the subject's frame, origin at the centre of the surface. The same stream as that of `Cop`, so that everything behind it works for both.
///
/// With `top_mm`, the centre of pressure is on top of something of this height that is on the plate: there the line of the force is off by
/// height x shear / Fz. Load cells do not measure shear, so for them `top_mm` must be 0. A force plate with a polynomial of its maker
/// gets its correction at the surface.
///
/// Below the contact threshold, ml and ap are NaN with kNoContact, and the load remains. Outside the surface, values have kUncalibrated. A
/// fault bit or NaN on any channel makes the whole scan NaN.
class ForceCop final : public Stage {
 public:
  ForceCop(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override { contact_.reset(); }
  [[nodiscard]] std::size_t state_size() const noexcept override { return Contact::kStateSize; }
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  const physics::RigModel* rig_;
  Contact contact_;
  double top_mm_;
  std::optional<physics::PointPolynomial> polynomial_;  ///< In the subject's frame.
};

}  // namespace dts::pipeline
