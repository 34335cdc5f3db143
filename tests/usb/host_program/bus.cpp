// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/bus.h"

#include "usb/vhci/vhci_host.h"
#ifdef DTS_HAS_UMOCKDEV
#include "usb/umockdev/umockdev_host.h"
#endif

namespace dts::emulator {
namespace {

using core::ErrorCode;

class KernelBus final : public Bus {
 public:
  explicit KernelBus(std::unique_ptr<VhciHost> host) : host_(std::move(host)) {}
  core::Status plug(EmulatedDevice& device) override { return host_->plug(device); }
  void unplug(EmulatedDevice& device) override { host_->unplug(device); }
  void locked(EmulatedDevice& device, const std::function<void()>& action) override { host_->locked(device, action); }

 private:
  std::unique_ptr<VhciHost> host_;
};

#ifdef DTS_HAS_UMOCKDEV
class MockedBus final : public Bus {
 public:
  core::Status plug(EmulatedDevice& device) override {
    host_.plug(device);
    return {};
  }
  void unplug(EmulatedDevice& device) override { host_.unplug(device); }
  void locked(EmulatedDevice& device, const std::function<void()>& action) override { host_.locked(device, action); }
  std::vector<std::string> environment() const override { return {"LD_PRELOAD=libumockdev-preload.so.0"}; }

 private:
  UmockdevHost host_;
};
#endif

}  // namespace

core::Result<std::unique_ptr<Bus>> create_bus(std::string_view kind) {
  if (kind == "vhci") {
    auto host = VhciHost::create();
    if (!host) return tl::make_unexpected(host.error());
    return std::make_unique<KernelBus>(std::move(*host));
  }
  if (kind != "umockdev")
    return core::fail(ErrorCode::InvalidArgument, "no bus is called \"" + std::string(kind) + "\"", "umockdev or vhci");
#ifdef DTS_HAS_UMOCKDEV
  return std::make_unique<MockedBus>();
#else
  return core::fail(ErrorCode::Unsupported, "this program was built without umockdev", "install libumockdev-dev and build again");
#endif
}

}  // namespace dts::emulator
