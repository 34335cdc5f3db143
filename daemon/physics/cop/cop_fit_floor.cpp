// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>
#include <string>
#include <tuple>

#include "physics/cop/cop_features.h"
#include "physics/cop/cop_fit.h"
#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// Loads within this factor are one calibration load, because the loads of persons and weights scatter. Loads farther apart show how the
/// plate stiffens (plate-model 5.2 advises a factor of 2, which measures stiffening best).
constexpr double kSameLoadRatio = 1.25;
/// Up to this factor, loads without a grid of their own may still be one scattering load.
constexpr double kScatteredLoadRatio = 2.0;

using Samples = std::vector<CopSample>;

double x_of(const CopSample& sample) { return sample.load_position.x.value; }
double y_of(const CopSample& sample) { return sample.load_position.y.value; }

std::size_t count_distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::size_t count = 0;
  double last = 0.0;
  for (const double value : values) {
    if (count > 0 && value - last < kSamePositionMm) continue;
    last = value;
    ++count;
  }
  return count;
}

/// The number of columns and rows of a grid through the positions, and the number of positions.
struct Layout {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t positions = 0;

  [[nodiscard]] static Layout of(std::span<const CopSample> samples);
  [[nodiscard]] bool holds(std::size_t side) const { return columns >= side && rows >= side && positions >= side * side; }
};

Layout Layout::of(std::span<const CopSample> samples) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<Point> distinct;
  for (const auto& sample : samples) {
    const Point here = sample.load_position;
    x.push_back(here.x.value);
    y.push_back(here.y.value);
    const bool is_new = std::none_of(distinct.begin(), distinct.end(), [&](const Point& there) {
      return std::hypot((here.x - there.x).value, (here.y - there.y).value) < kSamePositionMm;
    });
    if (is_new) distinct.push_back(here);
  }
  return {count_distinct(x), count_distinct(y), distinct.size()};
}

/// u^i v^j z^k.
struct Term {
  std::size_t u = 0;
  std::size_t v = 0;
  std::size_t sum = 0;
};

/// Plate-model 5.2: i + j <= degree and i + j + k <= degree + 1.
std::vector<Term> full_terms(std::size_t degree, std::size_t sum_power_count) {
  std::vector<Term> terms;
  for (std::size_t k = 0; k < sum_power_count; ++k) {
    const std::size_t highest = std::min(degree, degree + 1 - k);
    for (std::size_t i = 0; i <= highest; ++i) {
      for (std::size_t j = 0; i + j <= highest; ++j) terms.push_back({i, j, k});
    }
  }
  return terms;
}

/// Terms without products of u and v, because points on the two mid-lines do not determine these.
std::vector<Term> mid_line_terms() {
  std::vector<Term> terms{{0, 0, 0}};
  for (std::size_t k = 1; k <= 4; ++k) {
    terms.push_back({k, 0, 0});
    terms.push_back({0, k, 0});
  }
  return terms;
}

struct PolynomialFit {
  SumPolynomial polynomial;
  std::vector<CopEstimate> left_out;
};

SumPolynomial empty_polynomial(std::span<const CopSample> samples) {
  SumPolynomial empty;
  empty.u = calibrated_range(samples, [](const CopSample& sample) { return FloorFeatures::of(sample.deflection_mm).u; });
  empty.v = calibrated_range(samples, [](const CopSample& sample) { return FloorFeatures::of(sample.deflection_mm).v; });
  empty.reference_sum_mm = 0.0;
  for (const auto& sample : samples) empty.reference_sum_mm += sum_of(sample) / static_cast<double>(samples.size());
  const auto [lowest, highest] = calibrated_range(samples, sum_of);
  empty.relative_sum = {lowest * (1.0 - kCopLoadMargin) / empty.reference_sum_mm,
                        highest * (1.0 + kCopLoadMargin) / empty.reference_sum_mm};
  return empty;
}

/// Fits three outputs: x, y, and the sum of the deflections divided by the load.
core::Result<PolynomialFit> fit_polynomial(std::span<const CopSample> samples, const std::vector<Term>& terms) {
  constexpr std::size_t kOutputs = 3;
  PolynomialFit fit{.polynomial = empty_polynomial(samples), .left_out = {}};
  LeastSquares problem{.column_count = terms.size(), .target_count = kOutputs};
  for (const CopSample& sample : samples) {
    const auto features = FloorFeatures::of(sample.deflection_mm);
    const double z = features.sum / fit.polynomial.reference_sum_mm;
    for (const Term& term : terms) {
      problem.system.push_back(std::pow(features.u, term.u) * std::pow(features.v, term.v) * std::pow(z, term.sum));
    }
    problem.targets.insert(problem.targets.end(), {x_of(sample), y_of(sample), features.sum / sample.load.value});
  }
  DTS_TRY_ASSIGN(const auto solution, solve(problem));
  for (std::size_t k = 0; k < terms.size(); ++k) {
    auto& coefficients = fit.polynomial.by_sum_power[terms[k].sum].coefficients[Quintic::index(terms[k].u, terms[k].v)];
    std::copy_n(solution.coefficients.begin() + static_cast<std::ptrdiff_t>(k * kOutputs), kOutputs, coefficients.begin());
    fit.polynomial.sum_power_count = std::max(fit.polynomial.sum_power_count, terms[k].sum + 1);
  }
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double* const outputs = solution.left_out.data() + k * kOutputs;
    fit.left_out.push_back({.x_mm = outputs[0], .y_mm = outputs[1], .load_n = sum_of(samples[k]) / outputs[2], .flags = 0});
  }
  return fit;
}

/// Returns groups of clearly distinct loads, light to heavy.
std::vector<Samples> groups_by_load(std::span<const CopSample> given) {
  Samples samples(given.begin(), given.end());
  std::stable_sort(samples.begin(), samples.end(), [](const CopSample& a, const CopSample& b) { return a.load < b.load; });
  std::vector<Samples> groups;
  for (const CopSample& sample : samples) {
    if (groups.empty() || sample.load / groups.back().front().load > kSameLoadRatio) groups.emplace_back();
    groups.back().push_back(sample);
  }
  return groups;
}

/// Columns and rows that Poly3 of degree 3 needs.
constexpr std::size_t kFewestPerSide = 4;

std::vector<Layout> layouts_by_load(std::span<const CopSample> samples) {
  std::vector<Layout> layouts;
  for (const Samples& group : groups_by_load(samples)) layouts.push_back(Layout::of(group));
  const auto [lightest, heaviest] =
      std::ranges::minmax(samples | std::views::transform([](const CopSample& sample) { return sample.load.value; }));
  const bool have_grids = layouts.front().holds(kFewestPerSide) && layouts.back().holds(kFewestPerSide);
  if (!have_grids && heaviest < kScatteredLoadRatio * lightest) layouts = {Layout::of(samples)};
  return layouts;
}

/// Returns as many powers of the sum as there are loads with enough positions; 0 if the lightest or the heaviest has too few for the
/// degree.
std::size_t sum_powers(const std::vector<Layout>& layouts, std::size_t degree) {
  const auto is_full = [degree](const Layout& layout) { return layout.holds(degree + 1); };
  if (!is_full(layouts.front()) || !is_full(layouts.back())) return 0;
  return std::min(static_cast<std::size_t>(std::ranges::count_if(layouts, is_full)), SumPolynomial::kMaxSumPowers);
}

/// A polynomial also fits mirrored or swapped positions; therefore u must grow with x, and v with y.
core::Status check_order(std::span<const CopSample> samples) {
  const auto correlation = [samples](auto first, auto second) {
    const auto count = static_cast<double>(samples.size());
    double a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
    for (const CopSample& sample : samples) {
      const double p = first(sample);
      const double q = second(sample);
      a += p / count;
      b += q / count;
      aa += p * p / count;
      bb += q * q / count;
      ab += p * q / count;
    }
    return (ab - a * b) / std::sqrt((aa - a * a) * (bb - b * b));
  };
  const double along_x = correlation(x_of, [](const CopSample& sample) { return FloorFeatures::of(sample.deflection_mm).u; });
  const double along_y = correlation(y_of, [](const CopSample& sample) { return FloorFeatures::of(sample.deflection_mm).v; });
  constexpr double kLeastCorrelation = 0.5;
  if (along_x > kLeastCorrelation && along_y > kLeastCorrelation) return {};
  return refuse_calibration(std::string("the sensors do not bend towards the load along ") + (along_x > kLeastCorrelation ? "y" : "x"),
                            kSensorOrderHint);
}

core::Result<CopFit> fit_poly3(std::span<const CopSample> samples, const CopValidity& validity) {
  const auto layouts = layouts_by_load(samples);
  for (const std::size_t degree : {Quintic::kDegree, std::size_t{3}}) {
    const std::size_t powers = sum_powers(layouts, degree);
    if (powers == 0) continue;
    DTS_TRY(check_order(samples));
    DTS_TRY_ASSIGN(auto fitted, fit_polynomial(samples, full_terms(degree, powers)));
    return CopFit{.form = Poly3Form{fitted.polynomial}, .validity = validity, .left_out = std::move(fitted.left_out)};
  }
  const Layout& worse = layouts.front().holds(4) ? layouts.back() : layouts.front();
  return refuse_calibration(std::to_string(worse.positions) + " positions in " + std::to_string(worse.columns) + " columns and " +
                                std::to_string(worse.rows) + " rows are too few for poly3" +
                                (layouts.size() == 1 ? "" : " at each of the loads"),
                            "measure at least 4 x 4 positions, better 7 x 7");
}

/// A ratio must fall along its line by clearly more than rounding.
constexpr double kFalls = 1.0 - 1e-6;

/// One ratio at the positions of a mid-line, in rising order.
struct Line {
  std::string axis;
  std::vector<double> position_mm;
  std::vector<double> ratio;
};

core::Status check_line(const Line& line) {
  constexpr std::size_t kNeeded = std::tuple_size_v<decltype(RatioFit::quartic)>;
  if (const auto count = count_distinct(line.position_mm); count < kNeeded) {
    return refuse_calibration("the mid-line along " + line.axis + " has " + std::to_string(count) +
                              " positions; the thesis method needs 5");
  }
  for (std::size_t k = 0; k < line.ratio.size(); ++k) {
    if (!std::isfinite(line.ratio[k]) || line.ratio[k] <= 0.0) {
      return refuse_calibration(
          "a sensor of the mid-line along " + line.axis + " is not pressed at " + std::to_string(line.position_mm[k]) + " mm",
          kSensorOrderHint);
    }
    if (k == 0 || line.position_mm[k] - line.position_mm[k - 1] < kSamePositionMm || line.ratio[k] < kFalls * line.ratio[k - 1]) continue;
    return refuse_calibration("the ratio of the sensor pairs does not fall along " + line.axis + " from " +
                                  std::to_string(line.position_mm[k - 1]) + " to " + std::to_string(line.position_mm[k]) + " mm",
                              kSensorOrderHint);
  }
  return {};
}

/// Fits thesis eq. 4.1. In r - 1, which is 0 in the middle of the line, the five columns are well separated. The range is that of all
/// samples, because ratios of single sensors are more extreme in the corners than on the mid-line.
core::Result<RatioFit> fit_quartic(const Line& line, std::span<const CopSample> samples, RatioOf ratio_of) {
  DTS_TRY(check_line(line));
  RatioFit fit;
  const auto [lowest, highest] =
      std::ranges::minmax(samples | std::views::transform([ratio_of](const CopSample& sample) { return ratio_of(sample.deflection_mm); }));
  const double margin = std::pow(highest / lowest, kCopMargin);  // as a factor: the mirrored load has the inverse ratio
  fit.ratio = {lowest / margin, highest * margin};
  LeastSquares problem{.column_count = fit.quartic.size()};
  problem.targets = line.position_mm;
  for (const double ratio : line.ratio) {
    for (std::size_t power = 0; power < fit.quartic.size(); ++power) problem.system.push_back(std::pow(ratio - 1.0, power));
  }
  DTS_TRY_ASSIGN(const auto solution, solve(problem));
  std::copy(solution.coefficients.begin(), solution.coefficients.end(), fit.quartic.begin());
  return fit;
}

core::Result<std::vector<RatioFit>> fit_axis(const std::string& axis, Samples line, double (*position)(const CopSample&),
                                             std::span<const RatioOf> ratios, std::span<const CopSample> samples) {
  std::ranges::sort(line, {}, position);
  std::vector<RatioFit> fits;
  for (const RatioOf ratio : ratios) {
    Line one{.axis = axis, .position_mm = {}, .ratio = {}};
    for (const CopSample& sample : line) {
      one.position_mm.push_back(position(sample));
      one.ratio.push_back(ratio(sample.deflection_mm));
    }
    DTS_TRY_ASSIGN(const auto fit, fit_quartic(one, samples, ratio));
    fits.push_back(fit);
  }
  return fits;
}

core::Result<CopFit> fit_thesis(CopMethod method, std::span<const CopSample> samples, const CopValidity& validity) {
  const double middle_x = 0.5 * (validity.x_mm.lowest + validity.x_mm.highest);
  const double middle_y = 0.5 * (validity.y_mm.lowest + validity.y_mm.highest);
  Samples along_x;
  Samples along_y;
  for (const auto& sample : samples) {
    if (std::abs(y_of(sample) - middle_y) < kSamePositionMm) along_x.push_back(sample);
    if (std::abs(x_of(sample) - middle_x) < kSamePositionMm) along_y.push_back(sample);
  }
  const ThesisRatios& ratios = ratios_of(method);
  DTS_TRY_ASSIGN(auto x, fit_axis("x", std::move(along_x), x_of, ratios.x, samples));
  DTS_TRY_ASSIGN(auto y, fit_axis("y", std::move(along_y), y_of, ratios.y, samples));
  const auto layouts = layouts_by_load(samples);
  auto terms = mid_line_terms();
  for (const std::size_t degree : {std::size_t{3}, Quintic::kDegree}) {
    if (const std::size_t powers = sum_powers(layouts, degree); powers > 0) terms = full_terms(degree, powers);
  }
  DTS_TRY_ASSIGN(auto load, fit_polynomial(samples, terms));
  for (Quintic& quintic : load.polynomial.by_sum_power) {
    for (auto& outputs : quintic.coefficients) outputs[0] = outputs[1] = 0.0;  // the position is computed from the ratios
  }
  return CopFit{.form = ThesisForm{.x = std::move(x), .y = std::move(y), .load = load.polynomial}, .validity = validity, .left_out = {}};
}

}  // namespace

core::Result<CopFit> fit_floor(CopMethod method, std::span<const CopSample> samples, const CopValidity& validity) {
  return method == CopMethod::Poly3 ? fit_poly3(samples, validity) : fit_thesis(method, samples, validity);
}

}  // namespace dts::physics
