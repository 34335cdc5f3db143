// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/window_filter.h"

#include <algorithm>
#include <limits>
#include <string>

#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

constexpr std::size_t kMaxWindowScans = 65'536;  // 43 s at 1500 Hz; 9 bytes per scan and channel

}  // namespace

WindowFilter::WindowFilter(const StageOptions& options, const StageContext& /*context*/)
    : window_scans_(static_cast<std::size_t>(options.number("window_scans"))),
      window_ms_(options.number("window_ms")),
      shift_scans_(static_cast<std::size_t>(options.number("shift_scans"))) {}

const StageDescription& WindowFilter::description() {
  static const StageDescription described{
      .id = "window_filter",
      .sentence = "Averages over a sliding window.",
      .output_stream = "filtered",
      .options = {{.name = "window_scans",
                   .sentence = "Length of the window in scans.",
                   .default_value = 3.0,
                   .minimum = 1.0,
                   .maximum = 4096.0,
                   .is_whole = true},
                  {.name = "window_ms",
                   .sentence = "Length of the window in time, rounded to whole scans; 0: window_scans applies.",
                   .default_value = 0.0,
                   .minimum = 0.0,
                   .maximum = 60'000.0},
                  {.name = "shift_scans",
                   .sentence = "Keeps only every n-th scan; divides the rate by n.",
                   .default_value = 1.0,
                   .minimum = 1.0,
                   .maximum = 4096.0,
                   .is_whole = true}}};
  return described;
}

core::Result<core::StreamFormat> WindowFilter::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("window_filter", input, max_scans, ""));
  if (window_ms_ > 0.0) window_scans_ = input.rate.scans_in_ms(window_ms_);
  if (window_scans_ > kMaxWindowScans) {
    return core::fail(core::ErrorCode::LimitExceeded,
                      "stage window_filter: option 'window_ms' of " + std::to_string(window_ms_) + " ms is " +
                          std::to_string(window_scans_) + " scans at " + std::to_string(input.rate.hz()) + " Hz; the limit is " +
                          std::to_string(kMaxWindowScans) + " scans",
                      "choose a shorter window");
  }
  rate_ = input.rate;
  channels_.assign(input.channels.size(),
                   Channel{.sums = std::vector<double>(window_scans_ + 1), .bits = std::vector<std::uint8_t>(window_scans_ + 1)});
  reset();
  core::StreamFormat output = input;
  output.rate = rate_.divided_by(static_cast<std::int64_t>(shift_scans_));
  // The mean of evenly spaced scans refers to the middle of their time.
  output.delay_ns += rate_.time_ns(core::ScanIndex{window_scans_ - 1}) / 2;
  return output;
}

void WindowFilter::process(const core::Block& in, core::Block& out) noexcept {
  const std::size_t scans = in.count();
  std::size_t first_kept = seen_scans_ + 1 >= window_scans_ ? 0 : window_scans_ - 1 - static_cast<std::size_t>(seen_scans_);
  const std::uint64_t phase = shift_scans_ == 1 ? 0 : (in.first_scan.value + first_kept) % shift_scans_;
  if (phase != 0) first_kept += shift_scans_ - static_cast<std::size_t>(phase);

  out.set_count(first_kept < scans ? (scans - 1 - first_kept) / shift_scans_ + 1 : 0);
  const core::ScanIndex completing = in.first_scan + first_kept;
  out.first_scan = core::ScanIndex{completing.value / shift_scans_};
  if (first_kept > 0) out.host_time_ns = in.host_time_ns + (rate_.time_ns(completing) - rate_.time_ns(in.first_scan));
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    filter_channel(channels_[c], in.column(c), in.quality(c), first_kept, out.column(c), out.quality(c));
  }
  slot_ = (slot_ + scans) % window_scans_;
  seen_scans_ += scans;
}

void WindowFilter::filter_channel(Channel& channel, std::span<const double> in, std::span<const std::uint8_t> in_bits,
                                  std::size_t first_kept, std::span<double> out, std::span<std::uint8_t> out_bits) const noexcept {
  const auto divisor = static_cast<double>(window_scans_);
  std::size_t slot = slot_;
  std::size_t next_kept = first_kept;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const std::uint8_t bits = explained(in[i], in_bits[i]);
    channel.head_sum += in[i];
    channel.head_bits |= bits;
    channel.sums[slot] = in[i];
    channel.bits[slot] = bits;
    if (i == next_kept) {
      out[kept] = (channel.head_sum + channel.sums[slot + 1]) / divisor;
      out_bits[kept] = channel.head_bits | channel.bits[slot + 1];
      ++kept;
      next_kept += shift_scans_;
    }
    if (++slot == window_scans_) {
      fold(channel);
      slot = 0;
    }
  }
}

void WindowFilter::fold(Channel& channel) const noexcept {
  for (std::size_t slot = window_scans_ - 1; slot > 0; --slot) {
    channel.sums[slot - 1] += channel.sums[slot];
    channel.bits[slot - 1] |= channel.bits[slot];
  }
  channel.head_sum = 0.0;
  channel.head_bits = 0;
}

void WindowFilter::reset() noexcept {
  for (Channel& channel : channels_) {
    channel.head_sum = 0.0;
    channel.head_bits = 0;
  }
  slot_ = 0;
  seen_scans_ = 0;
}

std::size_t WindowFilter::state_size() const noexcept { return 1 + channels_.size() * (2 + 2 * window_scans_); }

void WindowFilter::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  writer.put_count(seen_scans_);
  for (const Channel& channel : channels_) {
    writer.put(channel.head_sum);
    writer.put_count(channel.head_bits);
    for (std::size_t slot = 0; slot < window_scans_; ++slot) {
      const bool is_known = slot < seen_scans_;  // other slots hold values from before the segment, which are not used
      writer.put(is_known ? channel.sums[slot] : 0.0);
      writer.put_count(is_known ? channel.bits[slot] : 0);
    }
  }
}

bool WindowFilter::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  seen_scans_ = reader.count(std::numeric_limits<std::uint64_t>::max());
  slot_ = static_cast<std::size_t>(seen_scans_ % window_scans_);
  for (Channel& channel : channels_) {
    channel.head_sum = reader.any();
    channel.head_bits = reader.bits();
    reader.check_explained(channel.head_sum, channel.head_bits);
    for (std::size_t slot = 0; slot < window_scans_; ++slot) {
      channel.sums[slot] = reader.any();
      channel.bits[slot] = reader.bits();
      reader.check_explained(channel.sums[slot], channel.bits[slot]);
    }
  }
  if (!reader.is_right()) reset();
  return reader.is_right();
}

}  // namespace dts::pipeline
