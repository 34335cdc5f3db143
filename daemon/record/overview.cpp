// SPDX-License-Identifier: Apache-2.0
#include "record/overview.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "record/losses.h"
#include "record/old_event.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {
namespace {

class Looker {
 public:
  void add(const Chunk& chunk) {
    std::visit([this](const auto& content) { add(content); }, chunk.content);
    overview_.end = chunk.offset + chunk.length;
  }
  /// Returns the result. `torn`: why reading ended early; empty: it did not.
  Overview finish(const std::string& torn);

 private:
  struct SegmentEvent {
    std::uint32_t segment;
    core::ScanIndex scan;
    double time_s;
  };
  /// Data of a stream that is needed only during this pass.
  struct Traits {
    std::optional<GridTracker> grid;
    SegmentTable segments{};
    core::Losses losses{};
    double begin_s = 0.0;
    double end_s = 0.0;
    bool has_footer = false;
    bool holds_events = false;
  };

  void add(const FileHeader& header);
  void add(const StreamHeader& header);
  void add(const Samples& samples);
  void add(const StreamFooter& footer);
  void add(const ClockOffset&) {}
  void add(const Boundary&) {}
  void add(const UnknownChunk&) {}

  void add_events(const Samples& samples);
  static void add_time(double time_s, double scan_s, Traits& traits);
  [[nodiscard]] std::optional<std::size_t> reference() const;
  void say(const std::string& damage);

  Overview overview_;
  std::vector<Traits> traits_;
  std::vector<SegmentEvent> segment_events_;
  LossCounter losses_;
  std::string incomplete_;
  std::string recovered_;
};

void Looker::say(const std::string& damage) { overview_.damage += (overview_.damage.empty() ? "" : "; ") + damage; }

void Looker::add(const FileHeader& header) {
  if (fact(header.facts, "format_version").empty()) return;  // a file of another program
  auto session = session_facts(header.facts);
  if (session) {
    overview_.session = std::move(*session);
  } else {
    say(session.error().what);
  }
}

void Looker::add(const StreamHeader& header) {
  const auto& info = header.info;
  Traits traits{.grid = std::nullopt};
  const bool is_text = info.value_type == ValueType::Text;
  if (info.rate && !is_text) traits.grid.emplace(*info.rate);
  traits.holds_events = is_text && short_name(info.name) == "events";
  overview_.index_of_number.emplace(header.stream, overview_.streams.size());
  overview_.streams.push_back(info);
  overview_.sample_counts.push_back(0);
  traits_.push_back(std::move(traits));
}

void Looker::add(const Samples& samples) {
  const std::size_t index = overview_.index_of_number.at(samples.stream);
  overview_.sample_counts[index] += samples.times_s.size();
  Traits& traits = traits_[index];
  if (traits.holds_events) add_events(samples);
  if (!traits.grid) return;
  const double scan_s = 1.0 / overview_.streams[index].rate->hz();
  for (const double time_s : samples.times_s) add_time(time_s, scan_s, traits);
}

void Looker::add_time(double time_s, double scan_s, Traits& traits) {
  constexpr double kMostScans = 9e15;  // below 2^53, where a double holds every whole number exactly
  if (traits.grid->add(time_s)) {
    const auto segment = traits.grid->place().segment;
    traits.segments.add({segment, time_s, time_s});
    const double missing = std::round((time_s - traits.end_s) / scan_s);
    if (segment == 0) {
      traits.begin_s = time_s;
    } else {
      traits.losses.add(core::GapReason::None,
                        {.gaps = 1, .scans = missing > 0.0 ? static_cast<std::uint64_t>(std::min(missing, kMostScans)) : 0U});
    }
  }
  traits.end_s = time_s + scan_s;
}

void Looker::add_events(const Samples& samples) {
  const std::size_t channels = samples.texts.size() / std::max<std::size_t>(samples.times_s.size(), 1);
  for (std::size_t text = 0; text < samples.texts.size(); ++text) {
    const auto event = event_of_text(samples.texts[text]);
    if (!event) continue;
    losses_.add(*event);
    if (event->has_segment_start()) segment_events_.push_back({event->segment(), {event->scan()}, samples.times_s[text / channels]});
  }
}

void Looker::add(const StreamFooter& footer) {
  traits_[overview_.index_of_number.at(footer.stream)].has_footer = true;
  if (incomplete_.empty()) incomplete_ = fact(footer.facts, "incomplete");
  if (recovered_.empty() && !fact(footer.facts, "recovered").empty()) recovered_ = fact(footer.facts, "lost_s_at_most");
}

/// Returns the stream whose scans the events count: the raw stream, or the fastest stream without one.
std::optional<std::size_t> Looker::reference() const {
  std::optional<std::size_t> best;
  for (std::size_t index = 0; index < traits_.size(); ++index) {
    const auto& info = overview_.streams[index];
    if (!traits_[index].grid) continue;
    if (short_name(info.name) == "raw") return index;
    if (!best || info.rate->hz() > overview_.streams[*best].rate->hz()) best = index;
  }
  return best;
}

Overview Looker::finish(const std::string& torn) {
  if (!torn.empty()) say(torn);
  if (torn.empty() && !std::ranges::all_of(traits_, &Traits::has_footer)) say("no footer: it was never closed");
  if (!incomplete_.empty()) say("incomplete: " + incomplete_);
  if (!recovered_.empty()) say("recovered, at most " + recovered_ + " s are lost");
  if (const auto index = reference()) {
    Traits& traits = traits_[*index];
    overview_.reference_rate = overview_.streams[*index].rate;
    overview_.segments = std::move(traits.segments);
    overview_.losses = traits.losses;
    const double duration_s = traits.end_s - traits.begin_s;
    overview_.duration_s = std::isfinite(duration_s) && duration_s > 0.0 ? duration_s : 0.0;
  }
  overview_.has_segment_events = overview_.reference_rate && !segment_events_.empty();
  if (!overview_.has_segment_events) segment_events_.clear();
  if (overview_.has_segment_events) {
    overview_.segments = {};
    overview_.losses = losses_.losses();
  }
  for (const auto& [segment, scan, time_s] : segment_events_)
    overview_.segments.add({segment, time_s, time_s - static_cast<double>(scan.value) / overview_.reference_rate->hz()});
  overview_.segments.sort();
  return std::move(overview_);
}

}  // namespace

core::Result<Overview> look_through(const std::string& file) {
  DTS_TRY_ASSIGN(const auto reader, XdfReader::open(file));
  Looker looker;
  bool has_header = false;
  while (true) {
    const auto chunk = reader->next();
    if (!chunk && !has_header) return tl::make_unexpected(chunk.error());
    if (!chunk) return looker.finish(chunk.error().what);
    if (!*chunk && !has_header) return core::fail(core::ErrorCode::DataDamaged, file + " ends before its file header");
    if (!*chunk) return looker.finish({});
    looker.add(**chunk);
    has_header = true;
  }
}

}  // namespace dts::record
