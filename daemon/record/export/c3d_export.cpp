// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "c3d/c3d_writer.h"
#include "record/export/export.h"
#include "record/export/output_files.h"
#include "record/export/row_text.h"
#include "record/export/walk.h"

namespace dts::record {
namespace {

/// C3D states the number of samples first and knows no gaps: all of a recording is collected.
constexpr std::uint64_t kMostC3dSamples = 8'000'000;
constexpr float kAbsent = std::numeric_limits<float>::quiet_NaN();
constexpr double kNewtonMillimetres = 1e3;  ///< In a newton metre.

/// A square about the centre of the plate, in the axes of the subject: x to the right, y forward, z up. It gives the axes, not the size.
constexpr c3d::Corners kSubjectAxes{{{200, 200, 0}, {-200, 200, 0}, {-200, -200, 0}, {200, -200, 0}}};

/// What a channel of our streams means for a plate.
enum Component : std::size_t { kFx, kFy, kFz, kMx, kMy, kMz, kMl, kAp, kLoad, kComponents };
constexpr std::array<std::string_view, kComponents> kLabels{"fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm", "ml_mm", "ap_mm", "load_n"};

/// One of the two streams: the place of each component in its scans.
struct PlateStream {
  std::size_t stream = 0;
  std::array<std::optional<std::size_t>, kComponents> channels{};
  TimeAxis times;
};

std::optional<PlateStream> plate_stream(const Recording& recording, const std::string& name, double origin_s) {
  const auto stream = recording.find_stream(name);
  if (!stream || recording.sample_count(*stream) == 0) return std::nullopt;
  const StreamInfo& info = recording.streams()[*stream];
  if (!info.rate || info.value_type == ValueType::Text) return std::nullopt;
  PlateStream found{.stream = *stream, .times = TimeAxis(origin_s, *info.rate)};
  bool has_any = false;
  for (std::size_t component = 0; component < kComponents; ++component) {
    const auto channel = std::ranges::find(info.channels, kLabels.at(component), &ChannelInfo::label);
    if (channel == info.channels.end()) continue;
    found.channels.at(component) = static_cast<std::size_t>(channel - info.channels.begin());
    has_any = true;
  }
  return has_any ? std::optional(std::move(found)) : std::nullopt;
}

/// Collects both streams on one grid of samples. The streams write different components, so that their threads do not meet.
class C3dSink : public ExportSink {
 public:
  C3dSink(const Recording& recording, const Corrections& corrections, double origin_s, core::Rate rate)
      : recording_(recording), markers_(recording, corrections), origin_s_(origin_s), rate_(rate) {
    for (const char* const name : {"cop", "force"}) {
      auto stream = plate_stream(recording, name, origin_s);
      if (!stream) continue;
      for (std::size_t component = 0; component < kComponents; ++component) {
        if (!streams_.empty() && streams_.front().channels.at(component)) stream->channels.at(component).reset();
      }
      streams_.push_back(std::move(*stream));
    }
  }

  [[nodiscard]] core::Status write(const RecordedScans& scans) override {
    const auto found = std::ranges::find(streams_, scans.stream, &PlateStream::stream);
    if (found == streams_.end()) return {};
    found->times.begin(scans);
    const std::size_t width = recording_.streams()[scans.stream].channels.size();
    for (std::size_t scan = 0; scan < scans.count; ++scan) {
      const double index = std::round(static_cast<double>(found->times.time_ns(scan)) * 1e-9 * rate_.hz());
      if (!(index >= 0.0)) continue;
      if (index >= static_cast<double>(kMostC3dSamples)) {
        return core::fail(core::ErrorCode::LimitExceeded,
                          "the recording has more than " + std::to_string(kMostC3dSamples) + " samples, too many for C3D",
                          "export it as CSV: --format csv");
      }
      put(*found, static_cast<std::size_t>(index), scans.values.data() + scan * width);
    }
    return {};
  }
  [[nodiscard]] core::Status write(const RecordedChange& /*change*/) override { return {}; }
  [[nodiscard]] core::Status write(const TimedEvent& timed) override {
    const EventCells cells = cells_of(markers_.corrected(timed));
    if (cells.kind != "marker" && cells.kind != "trial" && cells.kind != "trigger") return {};
    const double time_s = timed.time_s - origin_s_;
    if (std::isfinite(time_s) && time_s >= 0.0 && !cells.text.empty()) {
      events_.push_back(
          {.context = cells.kind, .label = cells.condition.empty() ? cells.text : cells.text + " " + cells.condition, .time_s = time_s});
    }
    return {};
  }

  [[nodiscard]] std::size_t samples() const noexcept {
    std::size_t most = 0;
    for (const auto& values : columns_) most = std::max(most, values.size());
    return most;
  }
  /// Returns the events by time.
  [[nodiscard]] std::vector<c3d::Event> events() const {
    std::vector<c3d::Event> sorted = events_;
    std::ranges::stable_sort(sorted, {}, &c3d::Event::time_s);
    return sorted;
  }
  /// Returns Fx Fy Fz Px Py Mz of a sample.
  [[nodiscard]] std::array<double, c3d::kChannelsOfPlate> plate(std::size_t sample) const {
    const auto at = [&](Component component) {
      const auto& values = columns_.at(component);
      return static_cast<double>(sample < values.size() ? values[sample] : kAbsent);
    };
    const double force_n = columns_.at(kFz).empty() ? at(kLoad) : at(kFz);
    const double free_moment_nm = at(kMz) - (at(kMl) * at(kFy) - at(kAp) * at(kFx)) / kNewtonMillimetres;
    return {at(kFx), at(kFy), force_n, at(kMl), at(kAp), free_moment_nm * kNewtonMillimetres};
  }

 private:
  void put(const PlateStream& from, std::size_t sample, const double* scan) {
    for (std::size_t component = 0; component < kComponents; ++component) {
      const auto channel = from.channels.at(component);
      if (!channel) continue;
      auto& values = columns_.at(component);
      if (sample >= values.size()) values.resize(sample + 1, kAbsent);
      values[sample] = static_cast<float>(scan[*channel]);
    }
  }

  const Recording& recording_;
  MarkerTexts markers_;
  double origin_s_;
  core::Rate rate_;
  std::vector<PlateStream> streams_;
  std::array<std::vector<float>, kComponents> columns_;
  std::vector<c3d::Event> events_;
};

/// Returns the rate of the streams to write. Fails if there is none, or if their rates differ.
core::Result<core::Rate> rate_of_plate(const Recording& recording) {
  std::optional<core::Rate> rate;
  for (const char* const name : {"cop", "force"}) {
    const auto stream = plate_stream(recording, name, 0.0);
    if (!stream) continue;
    const core::Rate own = *recording.streams()[stream->stream].rate;
    if (rate && rate->hz() != own.hz()) {
      return core::fail(core::ErrorCode::Unsupported, "cop and force have different rates: C3D has one", "export it as CSV: --format csv");
    }
    rate = own;
  }
  if (rate) return *rate;
  return core::fail(core::ErrorCode::Unsupported, "the recording has no centre of pressure and no force: C3D holds force plates",
                    "export it as CSV: --format csv");
}

}  // namespace

core::Result<Exported> export_c3d(Recording& recording, const std::string& folder, const Progress& progress,
                                  const Corrections& corrections) {
  DTS_TRY_ASSIGN(const auto rate, rate_of_plate(recording));
  DTS_TRY_ASSIGN(const auto origin_s, find_origin(recording));
  C3dSink sink(recording, corrections, origin_s, rate);
  DTS_TRY(walk(recording, sink, progress));
  c3d::Outline outline{.rate_hz = rate.hz(), .samples = sink.samples(), .plates = {kSubjectAxes}, .events = sink.events()};
  const std::size_t dropped = outline.events.size() - std::min(outline.events.size(), c3d::kMostEvents);
  outline.events.resize(outline.events.size() - dropped);
  if (recording.session()) outline.software = recording.session()->software;
  DTS_TRY_ASSIGN(std::string bytes, c3d::file_beginning(outline));
  OutputFiles files(folder);
  DTS_TRY_ASSIGN(auto file, files.create(file_stem(recording) + ".c3d"));
  for (std::size_t sample = 0; sample < outline.samples; ++sample) {
    c3d::append_sample(bytes, sink.plate(sample));
    file->append(bytes);
    bytes.clear();
  }
  DTS_TRY(file->status());
  return files.commit().map([&](OutputFiles::Written&& written) {
    return Exported{.files = std::move(written.files), .rows = outline.samples, .bytes = written.bytes, .dropped_events = dropped};
  });
}

}  // namespace dts::record
