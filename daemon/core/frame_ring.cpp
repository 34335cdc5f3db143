// SPDX-License-Identifier: Apache-2.0
#include "core/frame_ring.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace dts::core {
namespace {

using Word = std::uint64_t;

constexpr std::size_t kHeaderWords = 8;
constexpr std::size_t kBlockWords = 6;  // before its values
constexpr std::size_t kEventWords = (sizeof(Event) + sizeof(Word) - 1) / sizeof(Word);
static_assert(std::is_trivially_copyable_v<Event>, "events are stored as words");

constexpr std::size_t words_for(std::size_t bytes) noexcept { return (bytes + sizeof(Word) - 1) / sizeof(Word); }

std::size_t words_of(const Frame& frame, const std::vector<bool>& is_short) {
  std::size_t words = kHeaderWords;
  for (std::size_t stream = 0; stream < frame.streams.size(); ++stream) {
    const Block& block = frame.streams[stream];
    const std::size_t values = block.channel_count() * block.capacity();
    words += kBlockWords + words_for(values * (is_short[stream] ? sizeof(float) : sizeof(double))) + words_for(values);
  }
  return words;
}

std::size_t slots_for(std::size_t frames, std::size_t words) {
  const std::size_t most = FrameRing::kMostBytes / (words * sizeof(Word));
  return std::clamp<std::size_t>(frames, 1, std::max<std::size_t>(most, 1));
}

/// Appends words to a buffer that has room for all of them.
class Writer {
 public:
  explicit Writer(std::span<Word> words) noexcept : words_(words) {}
  void put(Word word) noexcept { words_[size_++] = word; }
  void put(std::int64_t value) noexcept { put(std::bit_cast<Word>(value)); }
  void put(double value) noexcept { put(std::bit_cast<Word>(value)); }
  void put(std::uint32_t low, std::uint32_t high) noexcept { put(Word{low} | Word{high} << 32U); }
  /// Returns the place for `count` bytes, from the next whole word on.
  [[nodiscard]] std::uint8_t* bytes(std::size_t count) noexcept {
    auto* const first = reinterpret_cast<std::uint8_t*>(words_.data() + size_);
    size_ += words_for(count);
    return first;
  }
  [[nodiscard]] std::span<const Word> written() const noexcept { return words_.first(size_); }

 private:
  std::span<Word> words_;
  std::size_t size_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const Word> words) noexcept : words_(words) {}
  Word word() noexcept { return words_[at_++]; }
  std::int64_t time_ns() noexcept { return std::bit_cast<std::int64_t>(word()); }
  double value() noexcept { return std::bit_cast<double>(word()); }
  /// Returns the next `count` bytes, from the next whole word on.
  [[nodiscard]] const std::uint8_t* bytes(std::size_t count) noexcept {
    const auto* const first = reinterpret_cast<const std::uint8_t*>(words_.data() + at_);
    at_ += words_for(count);
    return first;
  }

 private:
  std::span<const Word> words_;
  std::size_t at_ = 0;
};

template <class Number>
void put_values(Writer& out, const Block& block) noexcept {
  std::uint8_t* to = out.bytes(block.channel_count() * block.count() * sizeof(Number));
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    for (const double value : block.column(channel)) {
      const auto number = static_cast<Number>(value);
      std::memcpy(to, &number, sizeof number);
      to += sizeof number;
    }
  }
}

template <class Number>
void read_values(Reader& in, Block& block) noexcept {
  const std::uint8_t* from = in.bytes(block.channel_count() * block.count() * sizeof(Number));
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    for (double& value : block.column(channel)) {
      Number number{};
      std::memcpy(&number, from, sizeof number);
      value = number;
      from += sizeof number;
    }
  }
}

void put_block(Writer& out, const Block& block, bool is_short) noexcept {
  out.put(static_cast<std::uint32_t>(block.count()), block.segment);
  out.put(block.first_scan.value);
  out.put(block.host_time_ns);
  out.put(block.host_time_uncertainty_ns);
  out.put(block.clock_drift_ppm);
  out.put(block.sequence);
  is_short ? put_values<float>(out, block) : put_values<double>(out, block);
  auto* bits = out.bytes(block.channel_count() * block.count());
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) bits = std::ranges::copy(block.quality(channel), bits).out;
}

void read_block(Reader& in, Block& block, bool is_short) noexcept {
  const Word count_and_segment = in.word();
  block.set_count(static_cast<std::uint32_t>(count_and_segment));
  block.segment = static_cast<std::uint32_t>(count_and_segment >> 32U);
  block.first_scan = {in.word()};
  block.host_time_ns = in.time_ns();
  block.host_time_uncertainty_ns = in.time_ns();
  block.clock_drift_ppm = in.value();
  block.sequence = in.word();
  is_short ? read_values<float>(in, block) : read_values<double>(in, block);
  const auto* bits = in.bytes(block.channel_count() * block.count());
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    std::copy_n(bits, block.count(), block.quality(channel).begin());
    bits += block.count();
  }
}

constexpr Word kStartsSegment = 1U << 9U;
constexpr Word kIsExact = 1U << 8U;

std::size_t scans_of(const Frame& frame) noexcept { return frame.streams.empty() ? 0 : frame.streams.front().count(); }

}  // namespace

FrameRing::FrameRing(std::size_t frames, const Frame& prototype, std::vector<bool> is_short)
    : is_short_(std::move(is_short)),
      frames_(slots_for(frames, words_of(prototype, is_short_)), words_of(prototype, is_short_)),
      events_(kEvents, kEventWords),
      prototype_(prototype),
      words_(words_of(prototype, is_short_)) {}

void FrameRing::write(const Frame& frame, const FrameEvents& events) noexcept {
  std::array<Word, kEventWords> event_words{};
  std::uint32_t event_count = 0;
  for_each(events, [&](const Event& event) {
    std::memcpy(event_words.data(), &event, sizeof event);
    events_.write(event_words);
    ++event_count;
  });
  end_.events += event_count;
  end_.lost_events += events.lost();
  const bool starts_segment = frame.gap_before.reason != GapReason::None;
  if (starts_segment) segment_gap_ = frame.gap_before;
  Writer out(words_);
  out.put(frame.segment, event_count);
  out.put(frame.host_time_ns);
  out.put(frame.lost_scans_total);
  out.put(static_cast<Word>(segment_gap_.reason) | (segment_gap_.is_exact ? kIsExact : 0) | (starts_segment ? kStartsSegment : 0));
  out.put(segment_gap_.missing_scans);
  out.put(end_.scans);
  out.put(end_.events);
  out.put(end_.lost_events);
  for (std::size_t stream = 0; stream < frame.streams.size(); ++stream) put_block(out, frame.streams[stream], is_short_[stream]);
  ++end_.frame;
  end_.scans += scans_of(frame);
  end_.lost_scans_total = frame.lost_scans_total;
  end_.segment = frame.segment;
  frames_.write(out.written());
}

FrameReader::FrameReader(const FrameRing& ring, std::size_t longest_lag)
    : ring_(ring),
      longest_lag_(std::clamp<std::size_t>(longest_lag, 1, ring.capacity())),
      words_(ring.frames_.slot_words()),
      frame_(ring.prototype_) {}

void FrameReader::start_at(const FramePosition& position) noexcept {
  position_ = position;
  lost_frames_ = lost_scans_ = lost_events_ = 0;
  has_front_ = false;
}

const Frame* FrameReader::front() noexcept {
  if (has_front_) return &frame_;
  constexpr int kAttempts = 4;  // the writer would have to pass the reader so many times
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::uint64_t written = ring_.written();
    if (position_.frame >= written) return nullptr;
    if (written - position_.frame <= longest_lag_ && read_front()) return &frame_;
    const std::uint64_t newer = std::max(ring_.written() - std::max<std::size_t>(longest_lag_ / 2, 1), position_.frame + 1);
    lost_frames_ += newer - position_.frame;
    position_.frame = newer;
  }
  return nullptr;
}

/// Returns false if the frame was overwritten.
bool FrameReader::read_front() noexcept {
  const auto size = ring_.frames_.read(position_.frame, words_);
  if (!size) return false;
  Reader in(std::span<const Word>(words_).first(*size));
  const Word segment_and_events = in.word();
  frame_.segment = static_cast<std::uint32_t>(segment_and_events);
  event_count_ = static_cast<std::size_t>(segment_and_events >> 32U);
  frame_.host_time_ns = in.time_ns();
  frame_.lost_scans_total = in.word();
  const Word gap_bits = in.word();
  Gap gap{.reason = static_cast<GapReason>(gap_bits & 0xFFU), .missing_scans = in.word(), .is_exact = (gap_bits & kIsExact) != 0};
  const std::uint64_t scans_before = in.word();
  const FramePosition end{.frame = position_.frame + 1,
                          .events = in.word(),
                          .lost_events = in.word(),
                          .lost_scans_total = frame_.lost_scans_total,
                          .segment = frame_.segment};
  for (std::size_t stream = 0; stream < frame_.streams.size(); ++stream) read_block(in, frame_.streams[stream], ring_.is_short_[stream]);

  const bool has_lost = scans_before != position_.scans;
  frame_.gap_before = {};
  if (has_lost && frame_.segment != position_.segment) {
    gap.missing_scans = frame_.lost_scans_total - position_.lost_scans_total;
    gap.is_exact = gap.is_exact && frame_.segment - position_.segment == 1;
    frame_.gap_before = gap;
  } else if ((gap_bits & kStartsSegment) != 0) {
    frame_.gap_before = gap;
  }
  lost_scans_ += scans_before - position_.scans;
  next_ = end;
  next_.scans = scans_before + scans_of(frame_);
  read_events(end);
  has_front_ = true;
  return true;
}

void FrameReader::read_events(const FramePosition& end) noexcept {
  lost_events_ += end.lost_events - position_.lost_events;
  const std::uint64_t first = end.events - event_count_;
  lost_events_ += first - position_.events;  // of lost frames
  const std::size_t wanted = std::min(event_count_, events_.size());
  event_count_ = 0;
  std::array<Word, kEventWords> words{};
  for (std::uint64_t index = first; index < first + wanted; ++index) {
    if (ring_.events_.read(index, words)) {
      std::memcpy(static_cast<void*>(&events_[event_count_++]), words.data(), sizeof(Event));
    } else {
      ++lost_events_;
    }
  }
}

void FrameReader::release() noexcept {
  position_ = next_;
  has_front_ = false;
}

}  // namespace dts::core
