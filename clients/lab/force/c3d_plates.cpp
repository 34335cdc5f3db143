// SPDX-License-Identifier: Apache-2.0
#include "lab/force/c3d_plates.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>

#include "lab/force/plate_view.h"
#include "physics/conversions.h"
#include "physics/force_plate/force_plate.h"

namespace dts::lab::force {
namespace {

using physics::ForcePlate;
using physics::kSixComponents;

constexpr std::size_t kMostChannelsOfPlate = 8;
constexpr std::size_t kMostPlates = 64;
/// Samples of all plates together, if plates share channels.
constexpr std::size_t kMostSharedSamples = 2'000'000;
constexpr double kMostlyUp = 0.7;  ///< Part of a unit vector along y or z, whichever is the vertical of the laboratory.

/// A plate of type 1: its channels are forces, a point in mm, and a free moment.
struct PointPlate {
  double mm_per_unit = 1.0;
};

/// How the channels of a plate become a sample.
struct C3dPlate {
  std::vector<std::size_t> channels;  ///< Of the file, counted from 0.
  std::vector<double> zero;           ///< Subtracted from each channel.
  std::variant<PointPlate, ForcePlate> kind;
  std::optional<physics::PointPolynomial> polynomial;  ///< If it is to be applied.
};

/// Everything that the samples need.
struct C3dContents {
  c3d::C3dFile file;
  std::vector<std::optional<C3dPlate>> plates;  ///< Absent: not usable.
};

ForceSample sample_of(const C3dPlate& /*plate*/, const PointPlate& kind, const std::array<double, kMostChannelsOfPlate>& values) {
  const auto& [fx, fy, fz, px, py, tz, unused_7, unused_8] = values;
  const double x_mm = px * kind.mm_per_unit;
  const double y_mm = py * kind.mm_per_unit;
  const double metres_per_mm = 1.0 / physics::kMillimetresPerMetre;
  ForceSample sample{.force_n = {fx, fy, fz}};
  sample.cop_mm = {x_mm, y_mm, 0.0};
  sample.free_moment_nm = tz * kind.mm_per_unit * metres_per_mm;
  sample.moment_nm = {y_mm * fz * metres_per_mm, -x_mm * fz * metres_per_mm,
                      (x_mm * fy - y_mm * fx) * metres_per_mm + sample.free_moment_nm};
  return sample;
}

ForceSample sample_of(const C3dPlate& plate, const ForcePlate& kind, const std::array<double, kMostChannelsOfPlate>& values) {
  return force::sample_of(kind.wrench(std::span(values).first(plate.channels.size())), plate.polynomial);
}

ForceSample c3d_sample(const C3dContents& contents, std::size_t index, std::size_t sample) {
  const auto& plate = contents.plates[index];
  if (!plate) return {};
  std::array<double, kMostChannelsOfPlate> values{};
  for (std::size_t k = 0; k < plate->channels.size(); ++k) {
    const double value = contents.file.analogue(sample, plate->channels[k]) - plate->zero[k];
    values[k] = std::isfinite(value) ? value : core::kNaN;  // an infinite force would give a position of 0
  }
  return std::visit([&](const auto& kind) { return sample_of(*plate, kind, values); }, plate->kind);
}

/// Returns millimetres per unit of length; adds a warning for a unit that is not known.
double length_unit(const c3d::Parameters& parameters, std::vector<std::string>& warnings) {
  const std::string unit = parameters.text("POINT", "UNITS");
  if (unit.empty() || unit == "mm" || unit == "MM") return 1.0;
  if (unit == "m" || unit == "M") return physics::kMillimetresPerMetre;
  if (unit == "cm" || unit == "CM") return 10.0;
  warnings.push_back("POINT:UNITS is '" + unit + "', which is not known: lengths count as mm");
  return 1.0;
}

Vector scaled(Vector vector, double factor) {
  for (double& value : vector) value *= factor;
  return vector;
}

/// Builds the plates of one file.
class Builder {
 public:
  Builder(C3dContents& contents, ForceFile& facts, const ReadOptions& options)
      : contents_(contents), facts_(facts), options_(options), mm_per_unit_(length_unit(contents.file.parameters(), facts.warnings)) {}

  void build() {
    const c3d::ForcePlatforms platforms = force_platforms(contents_.file.parameters());
    facts_.zero_frames = platforms.zero_frames;
    for (const c3d::ForcePlatform& platform : platforms.plates) {
      if (facts_.plates.size() == kMostPlates) {
        facts_.warnings.push_back("the file has " + std::to_string(platforms.plates.size()) + " plates: only the first " +
                                  std::to_string(kMostPlates) + " are read");
        return;
      }
      PlateFacts& facts = facts_.plates.emplace_back(facts_of(platform));
      auto plate = is_too_much() ? Built(too_much()) : plate_of(platform, facts);
      if (!plate) {
        facts.is_usable = false;
        facts.warnings.push_back(plate.error());
        contents_.plates.emplace_back();
        continue;
      }
      set_zero(*plate, facts);
      contents_.plates.emplace_back(std::move(*plate));
    }
  }

 private:
  using Built = tl::expected<C3dPlate, std::string>;

  /// Plates with channels of their own need work for each byte of the file; those that share channels could need any.
  [[nodiscard]] bool is_too_much() const {
    const auto usable = std::ranges::count_if(contents_.plates, [](const auto& plate) { return plate.has_value(); });
    const std::size_t plates = static_cast<std::size_t>(usable) + 1;
    return plates * kSixComponents > contents_.file.channels() && plates * contents_.file.samples() > kMostSharedSamples;
  }
  [[nodiscard]] tl::unexpected<std::string> too_much() const {
    return tl::unexpected("is not read: the plates share " + std::to_string(contents_.file.channels()) +
                          " channels, and would have more than " + std::to_string(kMostSharedSamples) +
                          " samples together; export a part of the file");
  }

  [[nodiscard]] PlateFacts facts_of(const c3d::ForcePlatform& platform) const {
    PlateFacts facts{.c3d_type = platform.type};
    if (platform.origin) facts.origin_mm = scaled(*platform.origin, mm_per_unit_);
    if (platform.corners) {
      facts.corners_mm.emplace();
      for (std::size_t k = 0; k < 4; ++k) facts.corners_mm->at(k) = scaled(platform.corners->at(k), mm_per_unit_);
    }
    if (platform.polynomial) {
      facts.polynomial.emplace();
      std::copy_n(platform.polynomial->begin(), 6, facts.polynomial->x.begin());
      std::copy_n(platform.polynomial->begin() + 6, 6, facts.polynomial->y.begin());
    }
    return facts;
  }

  Built plate_of(const c3d::ForcePlatform& platform, PlateFacts& facts) {
    if (!platform.type) return tl::unexpected<std::string>("FORCE_PLATFORM:TYPE has no value for this plate");
    if (*platform.type < 1 || *platform.type > 4) {
      return tl::unexpected("type " + std::to_string(*platform.type) + " is not read: only types 1 to 4 are");
    }
    const std::size_t count = *platform.type == 3 ? physics::kKistlerChannels : kSixComponents;
    C3dPlate plate{.channels = {}, .zero = std::vector<double>(count, 0.0), .kind = PointPlate{mm_per_unit_}, .polynomial = {}};
    if (platform.channels.size() < count) {
      return tl::unexpected("FORCE_PLATFORM:CHANNEL has " + std::to_string(platform.channels.size()) + " rows, type " +
                            std::to_string(*platform.type) + " needs " + std::to_string(count));
    }
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t channel = platform.channels[k];
      if (channel < 1 || channel > contents_.file.channels()) {
        return tl::unexpected("FORCE_PLATFORM:CHANNEL names channel " + std::to_string(channel) + ", the file has channels 1 to " +
                              std::to_string(contents_.file.channels()));
      }
      plate.channels.push_back(channel - 1);
    }
    if (*platform.type == 1) return plate;
    if (!facts.origin_mm) facts.warnings.emplace_back("FORCE_PLATFORM:ORIGIN is missing: 0 0 0 is used");
    const Vector origin_mm = facts.origin_mm.value_or(Vector{});
    const auto place = place_of(facts);
    if (*platform.type == 3 && place && std::max(place->axes[2][1], place->axes[2][2]) > kMostlyUp) {
      facts.warnings.emplace_back("Kistler's axes have z down, but CORNERS give z up: a horizontal axis of the laboratory is mirrored");
    }
    auto kind = *platform.type == 3 ? kistler(origin_mm, facts) : six_component(platform, origin_mm, facts);
    if (!kind) return tl::unexpected(kind.error().what);
    plate.kind = std::move(*kind);
    if (options_.is_polynomial_of_file && facts.polynomial) {
      plate.polynomial = facts.polynomial;
      facts.is_polynomial_applied = true;
    }
    return plate;
  }

  static core::Result<ForcePlate> kistler(const Vector& origin_mm, PlateFacts& facts) {
    if (origin_mm[2] > 0.0) facts.warnings.emplace_back("ORIGIN has z > 0: it is read as a surface above the sensors (az0 < 0)");
    physics::KistlerPlate plate{.a_mm = origin_mm[0], .b_mm = origin_mm[1], .az0_mm = -std::abs(origin_mm[2])};
    plate.newtons_per_unit.fill(1.0);
    return ForcePlate::create(plate);
  }

  core::Result<ForcePlate> six_component(const c3d::ForcePlatform& platform, const Vector& origin_mm, PlateFacts& facts) const {
    const bool is_opposite = origin_mm[2] > 0.0;
    if (is_opposite) facts.warnings.emplace_back("ORIGIN has z > 0: it is read as the opposite vector");
    const bool has_matrix = *platform.type == 4 && platform.matrix.has_value();
    if (*platform.type == 4 && !has_matrix) {
      facts.warnings.emplace_back(
          "FORCE_PLATFORM:CAL_MATRIX is missing, not of 6 x 6, or has a number that is not finite: the channels count as forces and "
          "moments");
    }
    physics::SixComponentPlate plate{.surface_mm = scaled(origin_mm, is_opposite ? -1.0 : 1.0)};
    for (std::size_t row = 0; row < kSixComponents; ++row) {
      const double unit = row < 3 ? 1.0 : mm_per_unit_ / physics::kMillimetresPerMetre;  // moments: to N m
      for (std::size_t column = 0; column < kSixComponents; ++column) {
        const double identity = row == column ? 1.0 : 0.0;
        plate.matrix.at(row).at(column) = unit * (has_matrix ? (*platform.matrix)[column * kSixComponents + row] : identity);
      }
    }
    return ForcePlate::create(plate);
  }

  /// Subtracts the mean of the frames in ZERO, if that is asked for. Type 1 does not use ZERO.
  void set_zero(C3dPlate& plate, PlateFacts& facts) const {
    if (!options_.is_zero_of_file) return;
    const auto no_effect = [&facts](const std::string& why) { facts.warnings.push_back("--zero file has no effect: " + why); };
    if (std::holds_alternative<PointPlate>(plate.kind)) return no_effect("a plate of type 1 does not use ZERO");
    if (!facts_.zero_frames) return no_effect("FORCE_PLATFORM:ZERO is missing");
    const auto [first, last] = *facts_.zero_frames;
    const auto frames = static_cast<int>(std::min<std::size_t>(contents_.file.frames(), 65536));
    if (first < 1 || last < first || first > frames) {
      return no_effect("FORCE_PLATFORM:ZERO has frames " + std::to_string(first) + " to " + std::to_string(last));
    }
    const std::size_t each = contents_.file.samples_per_frame();
    const std::size_t begin = (static_cast<std::size_t>(first) - 1) * each;
    const std::size_t end = static_cast<std::size_t>(std::min(last, frames)) * each;
    for (std::size_t k = 0; k < plate.channels.size(); ++k) {
      double sum = 0.0;
      std::size_t count = 0;
      for (std::size_t sample = begin; sample < end; ++sample) {
        const double value = contents_.file.analogue(sample, plate.channels[k]);
        if (!std::isfinite(value)) continue;
        sum += value;
        ++count;
      }
      if (count > 0) plate.zero[k] = sum / static_cast<double>(count);
    }
    facts.is_zero_applied = true;
  }

  C3dContents& contents_;
  ForceFile& facts_;
  const ReadOptions& options_;
  double mm_per_unit_;
};

}  // namespace

core::Result<ForceFile> read_c3d_plates(const std::string& file, std::string bytes, const ReadOptions& options) {
  auto read = c3d::C3dFile::read(std::move(bytes));
  if (!read) return unreadable(file, read.error().what, read.error().hint);
  const auto contents = std::make_shared<C3dContents>(C3dContents{.file = std::move(*read), .plates = {}});
  ForceFile facts{.format = "c3d",
                  .rate_hz = contents->file.analogue_rate_hz(),
                  .point_rate_hz = contents->file.point_rate_hz(),
                  .samples = contents->file.samples()};
  facts.events = contents->file.events();
  facts.warnings = contents->file.warnings();
  Builder(*contents, facts, options).build();
  if (facts.plates.empty()) return unreadable(file, "FORCE_PLATFORM has no plate", "give a file with force plates");
  if (std::ranges::none_of(facts.plates, &PlateFacts::is_usable)) {
    return unreadable(file, "no plate is usable: plate 1: " + facts.plates.front().warnings.back(), "export the file again");
  }
  facts.sample_at = [contents](std::size_t plate, std::size_t sample) { return c3d_sample(*contents, plate, sample); };
  return facts;
}

}  // namespace dts::lab::force
