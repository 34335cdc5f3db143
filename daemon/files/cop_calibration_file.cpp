// SPDX-License-Identifier: Apache-2.0
#include "files/cop_calibration_file.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "files/whole_file.h"

namespace dts::files {
namespace {

using physics::CopMethod;
using physics::Interval;
using physics::SumPolynomial;

constexpr std::int64_t kCalibrationFormat = 1;
constexpr std::size_t kMostPoints = 10'000;
constexpr double kHuge = 1e30;
constexpr double kLargestPositionMm = 1e5;
constexpr double kLargestLoadN = 1e6;
constexpr double kLargestDeflectionMm = 1e3;
constexpr double kSmallestTravelMm = 0.1;

std::vector<double> read_numbers(TomlReader& reader, std::string_view key, std::size_t count, double largest = kHuge) {
  return read_list(reader, key, reader.node(key), count, count, largest);
}

Interval interval_of(TomlReader& reader, std::string_view key, const std::vector<double>& values) {
  if (values.size() != 2) return {};
  if (values[0] > values[1]) reader.report(key, std::string(key) + ": write the lowest value of a range first");
  return {values[0], values[1]};
}

Interval read_range(TomlReader& reader, std::string_view key, double largest = kHuge) {
  return interval_of(reader, key, read_numbers(reader, key, 2, largest));
}

physics::CopErrorFigures read_cop_figures(TomlReader reader) {
  physics::CopErrorFigures figures;
  for (const auto& [key, target] : {std::pair{"rms_x_mm", &figures.rms_x_mm}, std::pair{"rms_y_mm", &figures.rms_y_mm},
                                    std::pair{"rms_total_mm", &figures.rms_total_mm}, std::pair{"max_total_mm", &figures.max_total_mm},
                                    std::pair{"load_rms_percent", &figures.load_rms_percent}}) {
    reader.require(key);
    *target = reader.number(key, 0.0, 0.0, kHuge);
  }
  reader.finish();
  return figures;
}

/// Reads the coefficients of one output: one row of 21 per power of the sum.
void read_coefficients(TomlReader& reader, std::string_view key, std::size_t output, SumPolynomial& polynomial, bool is_first) {
  const toml::node* const found = reader.node(key);
  const toml::array* const rows = found == nullptr ? nullptr : found->as_array();
  if (rows == nullptr || rows->empty() || rows->size() > SumPolynomial::kMaxSumPowers) {
    reader.report(key, std::string(key) + " must be a list of 1 to " + std::to_string(SumPolynomial::kMaxSumPowers) + " lists");
    return;
  }
  if (!is_first && rows->size() != polynomial.sum_power_count) {
    reader.report(key, std::string(key) + " has " + std::to_string(rows->size()) + " rows, another output has " +
                           std::to_string(polynomial.sum_power_count));
    return;
  }
  polynomial.sum_power_count = rows->size();
  for (std::size_t power = 0; power < rows->size(); ++power) {
    const auto row = read_list(reader, key, rows->get(power), physics::Quintic::kTermCount, physics::Quintic::kTermCount, kHuge);
    for (std::size_t term = 0; term < row.size(); ++term) polynomial.by_sum_power[power].coefficients[term][output] = row[term];
  }
}

SumPolynomial read_polynomial(TomlReader reader, bool has_position) {
  SumPolynomial polynomial;
  polynomial.u = read_range(reader, "u");
  polynomial.v = read_range(reader, "v");
  polynomial.relative_sum = read_range(reader, "relative_sum");
  reader.require("reference_sum_mm");
  polynomial.reference_sum_mm = reader.number("reference_sum_mm", 1.0, 1e-9, kHuge);
  read_coefficients(reader, "sum_mm_per_n", 2, polynomial, true);
  if (has_position) {
    read_coefficients(reader, "x_mm", 0, polynomial, false);
    read_coefficients(reader, "y_mm", 1, polynomial, false);
  }
  reader.finish();
  return polynomial;
}

std::vector<physics::RatioFit> read_ratios(TomlReader& top, std::string_view key, std::size_t count) {
  std::vector<physics::RatioFit> fits;
  auto readers = top.tables(key);
  if (readers.size() != count) {
    top.report(key, "[[" + std::string(key) + "]] must appear " + (count == 1 ? "once" : "twice") + " for this method");
    return fits;
  }
  for (TomlReader& reader : readers) {
    physics::RatioFit fit{.ratio = read_range(reader, "ratio")};
    const auto quartic = read_numbers(reader, "quartic", fit.quartic.size());
    std::copy(quartic.begin(), quartic.end(), fit.quartic.begin());
    fits.push_back(fit);
    reader.finish();
  }
  return fits;
}

physics::MomentForm read_moment(TomlReader reader, std::size_t sensors) {
  physics::MomentForm form;
  form.centre = {{reader.number("x_centre_mm", 0.0, -kLargestPositionMm, kLargestPositionMm)},
                 {reader.number("y_centre_mm", 0.0, -kLargestPositionMm, kLargestPositionMm)}};
  form.load_n_per_mm = read_numbers(reader, "load_n_per_mm", sensors);
  form.x_moment_n = read_numbers(reader, "x_moment_n", sensors);
  form.y_moment_n = read_numbers(reader, "y_moment_n", sensors);
  if (reader.has("x_quadratic_mm") || reader.has("y_quadratic_mm")) {
    form.x_quadratic_mm = read_numbers(reader, "x_quadratic_mm", sensors * (sensors + 1) / 2);
    form.y_quadratic_mm = read_numbers(reader, "y_quadratic_mm", sensors * (sensors + 1) / 2);
  }
  const toml::node* const shares = reader.node("share");
  if (shares == nullptr || !shares->is_array() || shares->as_array()->size() != sensors) {
    reader.report("share", "share must be a list of " + std::to_string(sensors) + " ranges");
  } else {
    for (const toml::node& share : *shares->as_array()) {
      form.share.push_back(interval_of(reader, "share", read_list(reader, "share", &share, 2, 2, kHuge)));
    }
  }
  reader.finish();
  return form;
}

physics::CopForm read_form(TomlReader& top, CopMethod method, std::size_t sensors) {
  if (method == CopMethod::Moment) return read_moment(top.table("moment"), sensors);
  if (method == CopMethod::Poly3) return physics::Poly3Form{read_polynomial(top.table("polynomial"), true)};
  const std::size_t ratios = method == CopMethod::ThesisPerPair ? 2 : 1;
  physics::ThesisForm form{.x = read_ratios(top, "x_ratio", ratios), .y = read_ratios(top, "y_ratio", ratios)};
  form.load = read_polynomial(top.table("polynomial"), false);
  return form;
}

std::vector<physics::CopCalibrationPoint> read_points(TomlReader& top, std::size_t sensors) {
  std::vector<physics::CopCalibrationPoint> points;
  auto readers = top.tables("point");
  if (readers.size() > kMostPoints) {
    top.report("point", std::to_string(readers.size()) + " points; at most " + std::to_string(kMostPoints) + " are allowed");
    return points;
  }
  for (TomlReader& reader : readers) {
    for (const char* key : {"x_mm", "y_mm", "load_n"}) reader.require(key);
    physics::CopCalibrationPoint point;
    point.sample = {.load_position = {{reader.number("x_mm", 0.0, -kLargestPositionMm, kLargestPositionMm)},
                                      {reader.number("y_mm", 0.0, -kLargestPositionMm, kLargestPositionMm)}},
                    .load = {reader.number("load_n", 1.0, 1e-9, kLargestLoadN)},
                    .deflection_mm = read_numbers(reader, "w_mm", sensors, kLargestDeflectionMm)};
    point.x_error_mm = reader.number("x_error_mm", 0.0, -kHuge, kHuge);
    point.y_error_mm = reader.number("y_error_mm", 0.0, -kHuge, kHuge);
    point.load_error_percent = reader.number("load_error_percent", 0.0, -kHuge, kHuge);
    reader.finish();
    points.push_back(std::move(point));
  }
  return points;
}

physics::TwoFeetPolynomial read_two_feet(TomlReader reader, std::size_t feature_count) {
  physics::TwoFeetPolynomial polynomial{.feature_count = feature_count};
  const auto read_features = [&](std::string_view key, auto set) {
    const auto values = read_numbers(reader, key, feature_count);
    for (std::size_t f = 0; f < values.size(); ++f) set(polynomial.features[f], values[f]);
  };
  using Feature = physics::TwoFeetPolynomial::Feature;
  read_features("mean", [](Feature& feature, double value) { feature.mean = value; });
  read_features("sd", [&](Feature& feature, double value) {
    if (value <= 0.0) reader.report("sd", "sd: every number must be positive");
    feature.sd = value;
  });
  read_features("lowest", [](Feature& feature, double value) { feature.range.lowest = value; });
  read_features("highest", [&](Feature& feature, double value) {
    feature.range.highest = value;
    if (value < feature.range.lowest) reader.report("highest", "highest: a number is below the one in lowest");
  });
  for (const auto& [key, target] :
       {std::pair{"x_mm", &polynomial.x_mm}, std::pair{"y_mm", &polynomial.y_mm}, std::pair{"log_load", &polynomial.log_load}}) {
    const auto coefficients = read_numbers(reader, key, target->size());
    std::copy(coefficients.begin(), coefficients.end(), target->begin());
  }
  reader.finish();
  return polynomial;
}

physics::TwoFeetForm read_two_feet(TomlReader reader) {
  reader.require("travel_mm");
  physics::TwoFeetForm form;
  form.travel_mm = reader.number("travel_mm", form.travel_mm, kSmallestTravelMm, kLargestDeflectionMm);
  form.with_width = read_two_feet(reader.table("with_width"), physics::TwoFeetPolynomial::kMaxFeatures);
  form.without_width = read_two_feet(reader.table("without_width"), physics::TwoFeetPolynomial::kMaxFeatures - 1);
  reader.finish();
  return form;
}

/// Identity, origin and format of a calibration: everything except the estimator's coefficients.
struct Head {
  std::string id;
  physics::CopCalibrationOrigin origin;
  CopMethod method = CopMethod::Poly3;
  std::size_t sensors = 0;
};

Head read_head(TomlReader& top) {
  for (const char* key : {"format", "id", "created_utc", "method", "sensors"}) top.require(key);
  if (const auto format = top.integer("format", kCalibrationFormat, 0, 1'000'000); format != kCalibrationFormat) {
    top.report("format",
               "format " + std::to_string(format) + " is not known; this program reads format " + std::to_string(kCalibrationFormat));
  }
  Head head;
  head.id = top.short_text("id");
  head.origin = {.created_utc = top.short_text("created_utc"),
                 .rig = top.short_text("rig"),
                 .daq_model = top.short_text("daq_model"),
                 .daq_serial = top.short_text("daq_serial")};
  if (!physics::is_utc_time(head.origin.created_utc)) top.report("created_utc", "created_utc must be like \"2026-01-31T12:00:00Z\"");
  head.method = physics::parse_cop_method(top.choice("method", {"poly3", "thesis", "thesis_per_pair", "moment"})).value();
  const bool is_moment = head.method == CopMethod::Moment;
  head.sensors = static_cast<std::size_t>(top.integer("sensors", physics::kFloorSensors,
                                                      is_moment ? physics::kFloorSensors + 1 : physics::kFloorSensors,
                                                      is_moment ? physics::kMaxCopSensors : physics::kFloorSensors));
  return head;
}

}  // namespace

core::Status write_cop_calibration(const std::string& file, const physics::CopCalibration& calibration) {
  return write_whole_file(file, cop_calibration_text(calibration));
}

std::optional<physics::CopCalibration> read_cop_calibration(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return std::nullopt;
  TomlReader top(&*table, "", file, problems);
  return read_cop_calibration(top, problems);
}

std::optional<physics::CopCalibration> read_cop_calibration(TomlReader& top, Problems& problems) {
  const std::size_t known_problems = problems.size();
  const Head head = read_head(top);
  TomlReader valid = top.table("valid");
  const physics::CopValidity validity{.x_mm = read_range(valid, "x_mm", kLargestPositionMm),
                                      .y_mm = read_range(valid, "y_mm", kLargestPositionMm),
                                      .load_n = read_range(valid, "load_n", kLargestLoadN)};
  valid.finish();
  const auto residuals = read_cop_figures(top.table("residuals"));
  std::optional<physics::CopErrorFigures> cross_validated;
  if (top.has("cross_validated")) cross_validated = read_cop_figures(top.table("cross_validated"));
  auto form = read_form(top, head.method, head.sensors);
  std::optional<physics::TwoFeetForm> two_feet;
  if (top.has("two_feet")) two_feet = read_two_feet(top.table("two_feet"));
  auto points = read_points(top, head.sensors);
  top.finish();
  if (problems.size() > known_problems) return std::nullopt;
  auto estimator = physics::CopEstimator::from_form(head.method, std::move(form), validity);
  if (!estimator) {
    top.report("method", core::to_string(estimator.error()));
    return std::nullopt;
  }
  physics::CopCalibration calibration{.id = head.id,
                                      .origin = head.origin,
                                      .estimator = std::move(*estimator),
                                      .points = std::move(points),
                                      .residuals = residuals,
                                      .cross_validated = cross_validated};
  if (!two_feet) return calibration;
  auto correction = physics::TwoFeetCorrection::from_form(*two_feet);
  if (!correction) {
    top.report("two_feet", core::to_string(correction.error()));
    return std::nullopt;
  }
  calibration.two_feet = *correction;
  return calibration;
}

}  // namespace dts::files
