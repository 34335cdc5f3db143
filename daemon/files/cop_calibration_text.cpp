// SPDX-License-Identifier: Apache-2.0
#include <sstream>
#include <string_view>
#include <variant>

#include "files/cop_calibration_file.h"
#include "files/toml_text.h"

namespace dts::files {
namespace {

using physics::CopCalibration;
using physics::Interval;
using physics::Quintic;

constexpr std::string_view kCalibrationHead =
    R"(# Calibration of the centre of pressure of a plate, made by fitting known loads. Do not edit: measure again instead.
#
# w1..wn are the sensors' deflections in mm (positive towards the sensors, unloaded plate 0), S their sum. Results x_mm and y_mm count
# from the plate's corner. Ranges are [lowest, highest], margin for noise included: values beyond them are clamped to them, and the result
# is outside the calibration.
)";

constexpr std::string_view kPolynomialHelp =
    R"(# u = (w2 + w4 - w1 - w3) / S, v = (w3 + w4 - w1 - w2) / S, z = S / reference_sum_mm, each clamped to its range.
# A table of coefficients has one row per power k of z; a row has the 21 coefficients of u^i v^j, i + j <= 5, in the order
# u^0 v^0..v^5, u^1 v^0..v^4, u^2 v^0..v^3, u^3 v^0..v^2, u^4 v^0..v^1, u^5. A result is the sum of coefficient u^i v^j z^k.
# x_mm and y_mm are the position, load_n = S / sum_mm_per_n.
)";

constexpr std::string_view kThesisHelp =
    R"(# Position on an axis = mean over its ratios of the sum over k of quartic[k] (r - 1)^k, k = 0..4 (mm), r clamped to its range.
# thesis: x from r = (w1 + w3) / (w2 + w4), y from r = (w1 + w2) / (w3 + w4).
# thesis_per_pair: x from w1 / w2 and w3 / w4, y from w1 / w3 and w2 / w4.
)";

constexpr std::string_view kMomentHelp = R"(# load_n = sum of load_n_per_mm[i] w_i. Shares s_i = w_i / S, clamped to share; then
# with x_quadratic_mm: x_mm = x_centre_mm + (sum over i <= j of q[ij] s_i s_j) / (sum of s)^2, q in the order 11 12 .. 1n 22 .. nn;
# without: x_mm = x_centre_mm + (sum of x_moment_n[i] s_i) / (sum of load_n_per_mm[i] s_i). y likewise.
)";

constexpr std::string_view kTwoFeetHelp =
    R"(# Correction for a person on two feet, after the formulas above: features f = x_mm, y_mm, load_n and, if known, the stance width in mm
# between the middle lines of the feet. Each is clamped to [lowest, highest]; t = (f - mean) / sd. The terms are all products
# t1^i t2^j t3^k t4^l with i + j + k + l <= 3 (without the width: t1^i t2^j t3^k with i + j + k <= 4), i rising slowest. With p the sum of
# coefficient times term: x_mm += p of x_mm, y_mm += p of y_mm, load_n *= exp(p of log_load). A deflection above travel_mm is beyond the
# sensors.
)";

class CalibrationWriter {
 public:
  void text(std::string_view key, std::string_view value) { out_ << key << " = " << toml_quoted(value) << '\n'; }
  void number(std::string_view key, double value) { out_ << key << " = " << toml_number(value) << '\n'; }
  void numbers(std::string_view key, std::span<const double> values) { out_ << key << " = " << toml_numbers(values) << '\n'; }
  void range(std::string_view key, const Interval& range) { numbers(key, std::array{range.lowest, range.highest}); }
  void raw(std::string_view text) { out_ << text; }

  void figures(std::string_view table, const physics::CopErrorFigures& figures) {
    out_ << "\n[" << table << "]\n";
    number("rms_x_mm", figures.rms_x_mm);
    number("rms_y_mm", figures.rms_y_mm);
    number("rms_total_mm", figures.rms_total_mm);
    number("max_total_mm", figures.max_total_mm);
    number("load_rms_percent", figures.load_rms_percent);
  }

  void coefficients(std::string_view key, const physics::SumPolynomial& polynomial, std::size_t output) {
    out_ << key << " = [\n";
    for (std::size_t power = 0; power < polynomial.sum_power_count; ++power) {
      std::vector<double> row;
      for (const Quintic::Outputs& outputs : polynomial.by_sum_power[power].coefficients) row.push_back(outputs[output]);
      out_ << "  " << toml_numbers(row) << ",\n";
    }
    out_ << "]\n";
  }

  void polynomial_features(const physics::SumPolynomial& polynomial) {
    out_ << "\n[polynomial]\n" << kPolynomialHelp;
    range("u", polynomial.u);
    range("v", polynomial.v);
    range("relative_sum", polynomial.relative_sum);
    number("reference_sum_mm", polynomial.reference_sum_mm);
  }

  void form(const physics::Poly3Form& form) {
    polynomial_features(form.polynomial);
    coefficients("x_mm", form.polynomial, 0);
    coefficients("y_mm", form.polynomial, 1);
    coefficients("sum_mm_per_n", form.polynomial, 2);
  }

  void form(const physics::ThesisForm& form) {
    out_ << '\n' << kThesisHelp;
    for (const auto& [name, fits] : {std::pair{"x_ratio", &form.x}, std::pair{"y_ratio", &form.y}}) {
      for (const physics::RatioFit& fit : *fits) {
        out_ << "[[" << name << "]]\n";
        range("ratio", fit.ratio);
        numbers("quartic", fit.quartic);
      }
    }
    polynomial_features(form.load);
    coefficients("sum_mm_per_n", form.load, 2);
  }

  void form(const physics::MomentForm& form) {
    out_ << "\n[moment]\n" << kMomentHelp;
    number("x_centre_mm", form.centre.x.value);
    number("y_centre_mm", form.centre.y.value);
    numbers("load_n_per_mm", form.load_n_per_mm);
    numbers("x_moment_n", form.x_moment_n);
    numbers("y_moment_n", form.y_moment_n);
    if (!form.x_quadratic_mm.empty()) {
      numbers("x_quadratic_mm", form.x_quadratic_mm);
      numbers("y_quadratic_mm", form.y_quadratic_mm);
    }
    out_ << "share = [";
    for (const Interval& share : form.share) out_ << toml_numbers(std::array{share.lowest, share.highest}) << ", ";
    out_ << "]\n";
  }

  void form(const physics::ModelForm&) {}  // never in a calibration: CopEstimator::fit rejects it

  void two_feet(std::string_view table, const physics::TwoFeetPolynomial& polynomial) {
    out_ << "[two_feet." << table << "]\n";
    const std::span features(polynomial.features.data(), polynomial.feature_count);
    const auto list = [&](std::string_view key, auto value_of) {
      std::vector<double> values;
      for (const physics::TwoFeetPolynomial::Feature& feature : features) values.push_back(value_of(feature));
      numbers(key, values);
    };
    using Feature = physics::TwoFeetPolynomial::Feature;
    list("mean", [](const Feature& feature) { return feature.mean; });
    list("sd", [](const Feature& feature) { return feature.sd; });
    list("lowest", [](const Feature& feature) { return feature.range.lowest; });
    list("highest", [](const Feature& feature) { return feature.range.highest; });
    numbers("x_mm", polynomial.x_mm);
    numbers("y_mm", polynomial.y_mm);
    numbers("log_load", polynomial.log_load);
  }

  void two_feet(const physics::TwoFeetForm& form) {
    out_ << "\n[two_feet]\n" << kTwoFeetHelp;
    number("travel_mm", form.travel_mm);
    two_feet("with_width", form.with_width);
    two_feet("without_width", form.without_width);
  }

  void points(const CopCalibration& calibration) {
    if (calibration.points.empty()) return;
    out_ << "\n# The loads it was fitted to, and estimate minus truth.\n";
    for (const auto& [sample, x_error_mm, y_error_mm, load_error_percent] : calibration.points) {
      out_ << "[[point]]\n";
      number("x_mm", sample.load_position.x.value);
      number("y_mm", sample.load_position.y.value);
      number("load_n", sample.load.value);
      numbers("w_mm", sample.deflection_mm);
      number("x_error_mm", x_error_mm);
      number("y_error_mm", y_error_mm);
      number("load_error_percent", load_error_percent);
    }
  }

  [[nodiscard]] std::string result() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

}  // namespace

std::string cop_calibration_text(const CopCalibration& calibration) {
  CalibrationWriter writer;
  writer.raw(kCalibrationHead);
  writer.raw("format = 1\n");
  writer.text("id", calibration.id);
  writer.text("created_utc", calibration.origin.created_utc);
  writer.text("rig", calibration.origin.rig);
  writer.text("daq_model", calibration.origin.daq_model);
  writer.text("daq_serial", calibration.origin.daq_serial);
  writer.text("method", physics::to_string(calibration.estimator.method()));
  writer.raw("sensors = " + std::to_string(calibration.estimator.sensor_count()) + "\n");
  const auto& [x_mm, y_mm, load_n] = calibration.estimator.validity();
  writer.raw("\n[valid]\n");
  writer.range("x_mm", x_mm);
  writer.range("y_mm", y_mm);
  writer.range("load_n", load_n);
  writer.raw("\n# Of the fitted loads themselves, root mean squares; total is radial.");
  writer.figures("residuals", calibration.residuals);
  if (calibration.cross_validated) {
    writer.raw("\n# Each load by a fit without it: what to expect of the next one.");
    writer.figures("cross_validated", *calibration.cross_validated);
  }
  std::visit([&writer](const auto& form) { writer.form(form); }, calibration.estimator.form());
  if (calibration.two_feet) writer.two_feet(calibration.two_feet->form());
  writer.points(calibration);
  return writer.result();
}

}  // namespace dts::files
