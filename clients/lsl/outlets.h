// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "core/clock.h"
#include "core/log.h"
#include "dts/stream.h"
#include "lsl/liblsl.h"
#include "lsl/outlet.h"
#include "lsl/settings.h"

namespace dts::lsl {

/// Returns dtsd's answer about its devices; an error if it does not answer.
using AskDevices = std::function<client::Result<v1::GetDevicesResponse>()>;

/// Keeps one outlet for each stream, and one for the events of each rig, in step with what dtsd publishes.
///
/// The outlet of a stream is made with the first block, when the device is open and its serial number is known. Outlets stay while dtsd
/// restarts, so that recorders continue, and are made again only if the stream has changed. Thread: one.
class Outlets {
 public:
  /// `lsl` and `clock` outlive the object.
  Outlets(const Settings& settings, const Liblsl& lsl, AskDevices ask_devices, core::Clock& clock, core::Log log);

  void take(const client::Block& block);
  void take(const client::Event& event);
  void take(const v1::StatusSnapshot& status);
  void take(const client::Restart& restart);

  [[nodiscard]] std::size_t count() const noexcept { return outlets_.size(); }

 private:
  struct Device {
    std::string model;
    std::string serial;
    std::string uri;
  };

  [[nodiscard]] bool is_wanted(std::string_view rig) const;
  [[nodiscard]] bool is_wanted(const client::Block& block) const;
  [[nodiscard]] const Device* device_of(std::string_view rig);
  [[nodiscard]] Outlet* outlet_of(const client::Block& block);
  [[nodiscard]] std::string source_id(const std::string& name, const Device& device) const;
  Outlet* offer(OutletFacts facts);
  void push_event(std::string_view rig, const std::string& text, std::int64_t host_ns);

  std::set<std::string, std::less<>> rigs_;
  std::set<std::string, std::less<>> streams_;
  std::int32_t buffer_s_;
  const Liblsl& lsl_;
  AskDevices ask_devices_;
  core::Clock& clock_;
  core::Log log_;
  std::string host_;
  std::int64_t opened_ns_;
  std::string daemon_version_;
  std::map<std::string, Device, std::less<>> devices_;  ///< By rig; without those whose device may be another one now.
  std::int64_t next_question_ns_ = 0;
  std::map<std::string, std::unique_ptr<Outlet>, std::less<>> outlets_;  ///< By name.
  std::set<std::string, std::less<>> checked_;                           ///< Names of outlets that agree with what dtsd publishes now.
  std::int64_t next_offer_ns_ = 0;                                       ///< After a failure of the library.
};

}  // namespace dts::lsl
