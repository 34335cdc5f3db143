// SPDX-License-Identifier: Apache-2.0
#include "lab/force/standing_cop.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "cli/validators.h"
#include "lab/force/plate_view.h"
#include "lab/force/raw_channels.h"

namespace dts::lab::force {
namespace {

/// One axis of the file and its direction.
struct Direction {
  std::size_t axis = 0;
  double sign = 1.0;
};

/// `text` is one of the six that `add_cop_choice` accepts.
Direction direction_of(const std::string& text) { return {static_cast<std::size_t>(text[1] - 'x'), text[0] == '-' ? -1.0 : 1.0}; }

core::Status check_axes(const std::string& file, const CopChoice& choice, std::size_t vertical) {
  const auto wrong = [&](const std::string& what, const std::string& hint) {
    return core::fail(core::ErrorCode::InvalidArgument, file + ": " + what, hint);
  };
  if (choice.ml.empty() || choice.ap.empty()) {
    return wrong("a file of force plates does not say how the subject stands on the plate",
                 "name the axes that point to the subject's right and forward, for example --ml +x --ap -y");
  }
  const std::size_t ml = direction_of(choice.ml).axis;
  const std::size_t ap = direction_of(choice.ap).axis;
  if (ml == ap) return wrong("--ml and --ap are along the same axis", "give two horizontal axes");
  if (ml == vertical || ap == vertical) {
    return wrong(std::string(1, "xyz"[vertical]) + " is the vertical axis here", "give the two horizontal axes");
  }
  return {};
}

/// What the samples of one file are added to.
class Collector {
 public:
  Collector(const ForceFile& file, const CopChoice& choice) : file_(file), ml_(direction_of(choice.ml)), ap_(direction_of(choice.ap)) {}

  void add(std::size_t sample, const Vector& cop_mm, double load_n) {
    cop_.t_s.push_back(file_.time_s(sample));
    cop_.ml_mm.push_back(ml_.sign * cop_mm[ml_.axis]);
    cop_.ap_mm.push_back(ap_.sign * cop_mm[ap_.axis]);
    cop_.load_n.push_back(std::abs(load_n));
    has_load_ = has_load_ || std::isfinite(load_n);
  }
  StandingCop take() {
    if (!has_load_) cop_.load_n.clear();
    return std::move(cop_);
  }

 private:
  const ForceFile& file_;
  Direction ml_;
  Direction ap_;
  StandingCop cop_;
  bool has_load_ = false;
};

/// Returns the index of the chosen plate.
core::Result<std::size_t> plate_of_choice(const std::string& name, const ForceFile& file, const CopChoice& choice) {
  std::size_t number = choice.plate == "net" ? 1 : 0;
  std::from_chars(choice.plate.data(), choice.plate.data() + choice.plate.size(), number);
  if (number < 1 || number > file.plates.size()) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      name + " has " + std::to_string(file.plates.size()) + " plates, --plate is " + choice.plate,
                      "give a plate from 1, or net");
  }
  if (!file.plates[number - 1].is_usable) {
    return unreadable(name, "plate " + choice.plate + ": " + file.plates[number - 1].warnings.back(), "give another plate");
  }
  return number - 1;
}

core::Result<StandingCop> cop_of_plate(const std::string& name, const ForceFile& file, const CopChoice& choice) {
  DTS_TRY_ASSIGN(const auto plate, plate_of_choice(name, file, choice));
  DTS_TRY(check_axes(name, choice, file.vertical));
  const PlateView view(file, plate, file.axes, choice.least_force_n);
  Collector collector(file, choice);
  for (std::size_t k = 0; k < file.samples; ++k) {
    const ForceSample sample = view.at(k);
    collector.add(k, sample.cop_mm, sample.force_n[file.vertical]);
  }
  return collector.take();
}

/// Returns the index of the laboratory's vertical axis: the one along which the surface of the first plate looks.
std::optional<std::size_t> vertical_of(const ForceFile& file) {
  if (file.axes == Axes::Laboratory) return file.vertical;
  for (const PlateFacts& plate : file.plates) {
    const auto place = plate.is_usable ? place_of(plate) : std::nullopt;
    if (plate.is_usable && !place) return std::nullopt;
    if (place) return std::abs(place->axes[2][1]) > std::abs(place->axes[2][2]) ? 1 : 2;
  }
  return std::nullopt;
}

/// All plates together: p = sum(F p) / sum(F), with vertical forces F and points p in the laboratory.
core::Result<StandingCop> net_cop(const std::string& name, const ForceFile& file, const CopChoice& choice) {
  std::vector<PlateView> views;
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    if (!file.plates[plate].is_usable) continue;
    if (file.axes == Axes::Plate && !place_of(file.plates[plate])) {
      return core::fail(core::ErrorCode::InvalidArgument, name + ": the file does not say where the plates are",
                        "choose one plate: --plate 1");
    }
    views.emplace_back(file, plate, Axes::Laboratory, 0.0);
  }
  const std::size_t vertical = vertical_of(file).value_or(2);
  DTS_TRY(check_axes(name, choice, vertical));
  Collector collector(file, choice);
  for (std::size_t k = 0; k < file.samples; ++k) {
    double force_n = 0.0;
    Vector moments{};
    for (const PlateView& view : views) {
      const ForceSample sample = view.at(k);
      const double part_n = sample.force_n[vertical];
      const bool has_point = std::isfinite(sample.cop_mm[0] + sample.cop_mm[1] + sample.cop_mm[2]);
      if (part_n == 0.0 || (!has_point && std::abs(part_n) < choice.least_force_n)) continue;  // no part in the sum
      force_n += part_n;
      for (std::size_t axis = 0; axis < 3; ++axis) moments[axis] += part_n * sample.cop_mm[axis];
    }
    const bool is_loaded = std::abs(force_n) >= choice.least_force_n;
    for (double& moment : moments) moment = is_loaded ? moment / force_n : core::kNaN;
    collector.add(k, moments, force_n);
  }
  return collector.take();
}

}  // namespace

void add_cop_choice(CLI::App& command, CopChoice& choice) {
  const auto axes = CLI::IsMember({"+x", "-x", "+y", "-y", "+z", "-z"});
  command.add_option("--plate", choice.plate, "Plate in a file of force plates, or net for all together; default: 1")
      ->option_text("N|net")
      ->check(CLI::IsMember({"net"}) | cli::whole_number_between(1, 255));
  command.add_option("--ml", choice.ml, "Axis of the plate (net: of the laboratory) that points to the subject's right: +x, -x, +y, ..")
      ->option_text("AXIS")
      ->check(axes);
  command.add_option("--ap", choice.ap, "Axis that points forward")->option_text("AXIS")->check(axes);
  command.add_option("--zero", choice.zero, "file: subtract the mean of the frames in FORCE_PLATFORM:ZERO (C3D); default: none")
      ->option_text("NAME")
      ->check(CLI::IsMember({"none", "file"}));
  command.add_option("--min-force", choice.least_force_n, "Below this vertical force there is no centre of pressure; default: 20")
      ->option_text("N")
      ->check(cli::number_between(0.0, 1e6, "newtons"));
  command.add_option("--plate-file", choice.plate_file, "File with the table [force_plate], for raw channels")->option_text("PLATE.toml");
}

bool has_plates(const std::string& file, const CopChoice& choice) {
  return is_force_file(file) || (!choice.plate_file.empty() && has_raw_channels(file));
}

core::Result<StandingCop> read_standing_cop(const std::string& file, const CopChoice& choice) {
  const ReadOptions options{.is_zero_of_file = choice.zero == "file", .plate_file = is_force_file(file) ? "" : choice.plate_file};
  DTS_TRY_ASSIGN(const auto plates, read_force_file(file, options));
  // The only plate of a text export or of raw channels is the net, but nobody knows where it is in the laboratory.
  const bool is_only_plate = plates.plates.size() == 1 && plates.axes == Axes::Plate && !place_of(plates.plates.front());
  return choice.plate == "net" && !is_only_plate ? net_cop(file, plates, choice) : cop_of_plate(file, plates, choice);
}

}  // namespace dts::lab::force
