// SPDX-License-Identifier: Apache-2.0
#include "lsl/outlet.h"

#include <tuple>
#include <utility>

#include "core/rate.h"

namespace dts::lsl {
namespace {

constexpr std::int32_t kAsPushed = 0;  // chunks reach consumers as they are pushed

/// Returns the kind of quantity in the words of the XDF wiki, as recordings of dtsd have it.
const char* channel_type(const std::string& unit) {
  if (unit == "V") return "Voltage";
  if (unit == "mm") return "Position";
  return unit == "N" ? "Force" : "Misc";
}

bool are_equal(const client::StreamFormat& a, const client::StreamFormat& b) {
  if (a.name != b.name || a.rate != b.rate || a.delay_ns != b.delay_ns || a.channels.size() != b.channels.size()) return false;
  for (std::size_t channel = 0; channel < a.channels.size(); ++channel) {
    if (a.channels[channel].name != b.channels[channel].name || a.channels[channel].unit != b.channels[channel].unit) return false;
  }
  return true;
}

/// Writes the <desc> of a stream, in the words of the XDF wiki and, below <dts>, in those of dtsd's recordings.
class Description {
 public:
  Description(const Liblsl& lsl, api::Info info) : lsl_(lsl), root_(lsl.get_desc(info)) {}

  void add(const OutletFacts& facts) {
    const api::Xml channels = child(root_, "channels");
    if (facts.format) {
      for (const client::ChannelFormat& channel : facts.format->channels) {
        add_channel(channels, channel.name, channel.unit, channel_type(channel.unit));
      }
    } else {
      add_channel(channels, "event", "", "Marker");
    }
    const api::Xml acquisition = child(root_, "acquisition");
    value(acquisition, "manufacturer", "dtsd");
    value(acquisition, "model", facts.device_model);
    value(acquisition, "serial_number", facts.device_serial);
    // Loaders then keep the time stamps as they are, instead of fitting a line through gaps.
    value(child(root_, "synchronization"), "can_drop_samples", "true");
    const api::Xml ours = child(root_, "dts");
    value(ours, "version", facts.daemon_version);
    if (!facts.format) return;
    const api::Xml rate = child(ours, "rate");
    value(rate, "numerator", std::to_string(facts.format->rate.numerator));
    value(rate, "denominator", std::to_string(facts.format->rate.denominator));
    value(ours, "delay_ns", std::to_string(facts.format->delay_ns));
  }

 private:
  api::Xml child(api::Xml node, const char* name) { return lsl_.append_child(node, name); }
  void value(api::Xml node, const char* name, const std::string& text) { lsl_.append_child_value(node, name, text.c_str()); }
  void add_channel(api::Xml channels, const std::string& label, const std::string& unit, const char* type) {
    const api::Xml channel = child(channels, "channel");
    value(channel, "label", label);
    value(channel, "unit", unit);
    value(channel, "type", type);
  }

  const Liblsl& lsl_;
  api::Xml root_;
};

api::Info make_info(const Liblsl& lsl, const OutletFacts& facts) {
  if (!facts.format) {
    return lsl.create_streaminfo(facts.name.c_str(), "Markers", 1, api::kIrregularRate, api::kString, facts.source_id.c_str());
  }
  return lsl.create_streaminfo(facts.name.c_str(), "DTS", static_cast<std::int32_t>(facts.format->channels.size()), facts.format->rate.hz(),
                               api::kFloat32, facts.source_id.c_str());
}

}  // namespace

bool operator==(const OutletFacts& a, const OutletFacts& b) {
  const auto texts = [](const OutletFacts& facts) {
    return std::tie(facts.name, facts.source_id, facts.device_model, facts.device_serial, facts.daemon_version);
  };
  if (texts(a) != texts(b) || a.format.has_value() != b.format.has_value()) return false;
  return !a.format || are_equal(*a.format, *b.format);
}

std::int64_t host_time_ns(const client::Block& block, std::size_t scan) {
  const core::Rate rate = core::Rate::create(block.rate.numerator, block.rate.denominator).value_or(core::Rate());
  const core::ScanIndex first{block.first_scan};
  return block.host_time_ns + (rate.time_ns(first + scan) - rate.time_ns(first));
}

core::Result<std::unique_ptr<Outlet>> Outlet::create(const Liblsl& lsl, OutletFacts facts, std::int32_t buffer_s) {
  const api::Info info = make_info(lsl, facts);
  if (info == nullptr) return core::fail(core::ErrorCode::Failed, "liblsl cannot describe the stream " + facts.name);
  Description(lsl, info).add(facts);
  const api::Outlet outlet = lsl.create_outlet(info, kAsPushed, buffer_s);
  lsl.destroy_streaminfo(info);
  if (outlet == nullptr) {
    return core::fail(core::ErrorCode::Failed, "liblsl cannot offer the stream " + facts.name,
                      "check that ports 16572 to 16604 are free and that a network interface is up");
  }
  return std::unique_ptr<Outlet>(new Outlet(lsl, std::move(facts), outlet));
}

Outlet::~Outlet() { lsl_.destroy_outlet(outlet_); }

void Outlet::push(const client::Block& block) {
  if (lsl_.have_consumers(outlet_) == 0) return;
  const std::size_t channels = block.channel_count();
  values_.resize(channels * block.scan_count);
  stamps_s_.resize(block.scan_count);
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const auto column = block.column(channel);
    for (std::size_t scan = 0; scan < block.scan_count; ++scan) values_[scan * channels + channel] = column[scan];
  }
  for (std::size_t scan = 0; scan < block.scan_count; ++scan) stamps_s_[scan] = lsl_time_s(host_time_ns(block, scan));
  lsl_.push_chunk_ftnp(outlet_, values_.data(), values_.size(), stamps_s_.data(), 1);
}

void Outlet::push(const std::string& text, std::int64_t host_ns) {
  const char* const c_text = text.c_str();
  const char* texts[] = {c_text};
  lsl_.push_sample_strtp(outlet_, texts, lsl_time_s(host_ns), 1);
}

}  // namespace dts::lsl
