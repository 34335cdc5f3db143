// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/cop.h"

#include <cmath>
#include <utility>

#include "core/special_numbers.h"
#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

using core::kNaN;

/// Contact ends below this part of the threshold, so that it does not flicker near the threshold.
constexpr double kReleaseRatio = 0.8;

}  // namespace

Cop::Cop(const StageOptions& options, const StageContext& context)
    : rig_(&context.rig),
      calibration_(context.cop_calibration),
      method_(options.word("estimator")),
      contact_threshold_n_(options.number("contact_threshold_n")) {}

const StageDescription& Cop::description() {
  static const StageDescription described{
      .id = "cop",
      .sentence = "Estimates centre of pressure and load from the sensors' deflections.",
      .output_stream = "cop",
      .options = {{.name = "estimator",
                   .sentence = "poly3: quintic in two normalised differences and the sum; thesis, thesis_per_pair: thesis 4.4, eq. 4.1; "
                               "moment: for more than four sensors; model: the plate model inverted, a diagnostic.",
                   .choices = {"poly3", "thesis", "thesis_per_pair", "moment", "model"}},
                  {.name = "contact_threshold_n",
                   .sentence = "Load from which a person counts as standing on the plate, until it falls below 80 % of this load.",
                   .default_value = 50.0,
                   .minimum = 1.0,
                   .maximum = 2000.0}}};
  return described;
}

core::Result<core::StreamFormat> Cop::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("cop", input, max_scans, "mm"));
  auto estimator = make_estimator();
  if (!estimator) return core::fail(estimator.error().code, "stage cop: " + estimator.error().what, estimator.error().hint);
  if (input.channels.size() != estimator->sensor_count()) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage cop: " + std::to_string(input.channels.size()) +
                                                            " channels arrive; estimator " + method_ + " is made for " +
                                                            std::to_string(estimator->sensor_count()) + " sensors");
  }
  estimator_ = std::move(*estimator);
  reset();
  core::StreamFormat output = input;
  output.channels = {{.name = "ml_mm", .unit = "mm"}, {.name = "ap_mm", .unit = "mm"}, {.name = "load_n", .unit = "N"}};
  return output;
}

core::Result<physics::CopEstimator> Cop::make_estimator() const {
  DTS_TRY_ASSIGN(const auto method, physics::parse_cop_method(method_));
  if (calibration_ == nullptr) return physics::CopEstimator::from_model(method, *rig_);
  if (calibration_->estimator.method() == method) return calibration_->estimator;
  return core::fail(core::ErrorCode::InvalidArgument,
                    "estimator is " + method_ + ", but calibration '" + calibration_->id + "' is for " +
                        std::string(physics::to_string(calibration_->estimator.method())),
                    "leave the estimator to the calibration, or calibrate for " + method_);
}

void Cop::process(const core::Block& in, core::Block& out) noexcept {
  for (std::size_t i = 0; i < in.count(); ++i) {
    std::array<double, physics::kMaxCopSensors> sensors_mm{};
    const std::span<double> deflection_mm(sensors_mm.data(), estimator_->sensor_count());
    std::uint8_t bits = 0;
    for (std::size_t c = 0; c < deflection_mm.size(); ++c) {
      deflection_mm[c] = in.column(c)[i];
      bits |= explained(deflection_mm[c], in.quality(c)[i]);
    }
    const std::array<Value, 3> values = evaluate(deflection_mm, bits);
    for (std::size_t c = 0; c < values.size(); ++c) {
      out.column(c)[i] = values[c].value;
      out.quality(c)[i] = values[c].bits;
    }
  }
}

std::array<Cop::Value, 3> Cop::evaluate(std::span<const double> deflection_mm, std::uint8_t bits) noexcept {
  // A faulty scan does not show whether there is contact: the state stays.
  if ((bits & kFaultBits) != 0) return {Value{kNaN, bits}, Value{kNaN, bits}, Value{kNaN, bits}};
  const physics::CopEstimate estimate = estimator_->estimate(deflection_mm);
  const double load_n = std::isfinite(estimate.load_n) ? estimate.load_n : 0.0;  // the plate is not bent downwards
  if (!update_contact(load_n)) {
    const auto no_contact = static_cast<std::uint8_t>(bits | core::quality::kNoContact);
    return {Value{kNaN, no_contact}, Value{kNaN, no_contact}, Value{load_n, bits}};
  }
  if (!estimate.is_inside_calibration()) bits |= core::quality::kUncalibrated;
  const double ml_mm = estimate.x_mm - 0.5 * rig_->plate.a.value;
  const double ap_mm = estimate.y_mm - 0.5 * rig_->plate.b.value;
  return {Value{ml_mm, bits}, Value{ap_mm, bits}, Value{load_n, bits}};
}

void Cop::save(std::span<double> state) const noexcept { StateWriter(state).put(is_in_contact_ ? 1.0 : 0.0); }

bool Cop::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  is_in_contact_ = reader.flag();
  return reader.is_right();
}

bool Cop::update_contact(double load_n) noexcept {
  is_in_contact_ = load_n >= (is_in_contact_ ? kReleaseRatio : 1.0) * contact_threshold_n_;
  return is_in_contact_;
}

}  // namespace dts::pipeline
