// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/cop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/special_numbers.h"
#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

using core::kNaN;

constexpr double kWidestStanceMm = 1e4;                         // limit for a value from a file
constexpr std::uint64_t kLatestScan = std::uint64_t{1} << 53U;  // the largest that a state can hold
constexpr std::size_t kStanceNumbers = 2;                       // of the stance used now
constexpr std::size_t kUpcomingNumbers = 5;

}  // namespace

Cop::Cop(const StageOptions& options, const StageContext& context)
    : rig_(&context.rig),
      calibration_(context.cop_calibration),
      method_(options.word("estimator")),
      contact_(options.number("contact_threshold_n")),
      two_feet_(calibration_ != nullptr && calibration_->two_feet ? &*calibration_->two_feet : nullptr),
      stances_(context.stances),
      given_rate_(context.raw_rate) {}

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
  const double raw_hz = given_rate_.value_or(input.rate).hz();
  raw_per_scan_ = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::round(raw_hz / input.rate.hz())));
  settled_.prepare(input.rate);
  forget_stance();
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
  read_stance();
  for (std::size_t i = 0; i < in.count(); ++i) {
    std::array<double, physics::kMaxCopSensors> sensors_mm{};
    const std::span<double> deflection_mm(sensors_mm.data(), estimator_->sensor_count());
    std::uint8_t bits = 0;
    for (std::size_t c = 0; c < deflection_mm.size(); ++c) {
      deflection_mm[c] = in.column(c)[i];
      bits |= explained(deflection_mm[c], in.quality(c)[i]);
    }
    update_stance(in, i);
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
  physics::CopEstimate estimate = estimator_->estimate(deflection_mm);
  const double load_n = std::isfinite(estimate.load_n) ? estimate.load_n : 0.0;  // the plate is not bent downwards
  if (!contact_.update(load_n)) {
    settled_.reset();
    const auto no_contact = static_cast<std::uint8_t>(bits | core::quality::kNoContact);
    return {Value{kNaN, no_contact}, Value{kNaN, no_contact}, Value{load_n, bits}};
  }
  correct(estimate, deflection_mm);
  if (!estimate.is_inside_calibration()) bits |= core::quality::kUncalibrated;
  if ((estimate.flags & physics::cop_flag::kOutsideTravel) != 0) bits |= core::quality::kOutOfRange;
  const double ml_mm = estimate.x_mm - 0.5 * rig_->plate.a.value;
  const double ap_mm = estimate.y_mm - 0.5 * rig_->plate.b.value;
  return {Value{ml_mm, bits}, Value{ap_mm, bits}, Value{estimate.load_n, bits}};
}

/// Corrects the estimate of a scan with contact if a person has settled on two feet.
void Cop::correct(physics::CopEstimate& estimate, std::span<const double> deflection_mm) noexcept {
  if (two_feet_ == nullptr) return;
  const bool has_settled = settled_.update(estimate.load_n, two_feet_->covers_position(estimate));
  if (!has_settled || !stance_.is_on_two_feet) return;
  const std::optional<double> width_mm = stance_.width_mm > 0.0 ? std::optional(stance_.width_mm) : std::nullopt;
  estimate = two_feet_->apply(estimate, deflection_mm, width_mm);
}

void Cop::read_stance() noexcept {
  if (stances_ == nullptr || two_feet_ == nullptr) return;
  const SubjectStance& latest = stances_->latest();
  if (latest.number == letter_) return;
  letter_ = latest.number;
  upcoming_ = latest;
}

/// Begins to use the upcoming stance if its first scan is due.
void Cop::update_stance(const core::Block& in, std::size_t scan) noexcept {
  if (!upcoming_ || !is_due(*upcoming_, in.segment, in.first_scan.value + scan)) return;
  stance_ = *upcoming_;
  upcoming_.reset();
}

/// Returns whether scan `index` of this stage's input is not before the stance's first scan of the raw stream.
bool Cop::is_due(const SubjectStance& stance, std::uint32_t segment, std::uint64_t index) const noexcept {
  return segment != stance.segment ? segment > stance.segment : index >= stance.first_scan.value / raw_per_scan_;
}

void Cop::reset() noexcept {
  contact_.reset();
  settled_.reset();
}

std::size_t Cop::state_size() const noexcept {
  return two_feet_ == nullptr ? Contact::kStateSize : Contact::kStateSize + SettledStance::kStateSize + kStanceNumbers + kUpcomingNumbers;
}

void Cop::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  contact_.save(writer);
  if (two_feet_ == nullptr) return;
  settled_.save(writer);
  writer.put(stance_.width_mm);
  writer.put(stance_.is_on_two_feet ? 1.0 : 0.0);
  // The next block reads a stance that was set since the last one: a session sets it just before its recording begins.
  const bool has_letter = stances_ != nullptr && stances_->latest().number != letter_;
  const SubjectStance upcoming = has_letter ? stances_->latest() : upcoming_.value_or(SubjectStance{});
  writer.put(has_letter || upcoming_ ? 1.0 : 0.0);
  writer.put(upcoming.width_mm);
  writer.put(upcoming.is_on_two_feet ? 1.0 : 0.0);
  writer.put_count(upcoming.segment);
  writer.put_count(std::min(upcoming.first_scan.value, kLatestScan));
}

bool Cop::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  contact_.restore(reader);
  if (two_feet_ == nullptr) return reader.is_right();
  settled_.restore(reader);
  forget_stance();
  stance_.width_mm = reader.number(0.0, kWidestStanceMm);
  stance_.is_on_two_feet = reader.flag();
  const bool has_upcoming = reader.flag();
  SubjectStance upcoming;
  upcoming.width_mm = reader.number(0.0, kWidestStanceMm);
  upcoming.is_on_two_feet = reader.flag();
  upcoming.segment = static_cast<std::uint32_t>(reader.count(std::numeric_limits<std::uint32_t>::max()));
  upcoming.first_scan = core::ScanIndex{reader.count(kLatestScan)};
  if (has_upcoming) upcoming_ = upcoming;
  if (reader.is_right()) return true;
  forget_stance();
  reset();
  return false;
}

/// Returns to the initial state, so that the newest stance will be read again.
void Cop::forget_stance() noexcept {
  stance_ = {};
  upcoming_.reset();
  letter_ = 0;
}

}  // namespace dts::pipeline
