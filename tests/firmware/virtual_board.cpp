// SPDX-License-Identifier: Apache-2.0
#include "firmware/virtual_board.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#pragma GCC diagnostic pop

namespace dts::firmware_test {
namespace {

constexpr std::uint64_t kCyclesPerByte = VirtualBoard::kHertz / 11520;
constexpr std::uint32_t kMillivolts = 5000;

/// Returns the lowest input, mV, at which simavr's converter has this code: code = mV * 1023 / 5000, rounded down.
std::uint32_t millivolts_for(std::uint32_t code) { return (code * kMillivolts + 1022) / 1023; }

/// A converter of 10 bit at a reference of 5 V: one code is 5 / 1024 V.
std::uint32_t code_for(double volts) { return static_cast<std::uint32_t>(std::clamp(std::floor(volts * 1024.0 / 5.0), 0.0, 1023.0)); }

}  // namespace

core::Result<std::unique_ptr<VirtualBoard>> VirtualBoard::create(const std::string& elf) {
  // Standard output is for answers; simavr would print what it loads.
  avr_global_logger_set([](avr_t*, const int level, const char* format, va_list arguments) {
    if (level <= LOG_ERROR) std::vfprintf(stderr, format, arguments);
  });
  elf_firmware_t code{};
  if (elf_read_firmware(elf.c_str(), &code) != 0) {
    return core::fail(core::ErrorCode::NotFound, "cannot read the firmware " + elf, "build it: make -C clients/firmware");
  }
  std::unique_ptr<VirtualBoard> board(new VirtualBoard);
  board->avr_ = avr_make_mcu_by_name("atmega328p");
  if (board->avr_ == nullptr)
    return core::fail(core::ErrorCode::Unsupported, "simavr has no atmega328p", "install another version of simavr");
  avr_init(board->avr_);
  code.frequency = kHertz;
  avr_load_firmware(board->avr_, &code);
  board->connect();
  return board;
}

VirtualBoard::~VirtualBoard() {
  if (avr_ != nullptr) avr_terminate(avr_);
}

void VirtualBoard::connect() {
  avr_->frequency = kHertz;
  avr_->vcc = avr_->avcc = avr_->aref = kMillivolts;
  avr_->log = LOG_ERROR;
  avr_->sleep = [](avr_t*, avr_cycle_count_t) {};  // the caller decides when cycles happen

  std::uint32_t flags = 0;
  avr_ioctl(avr_, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
  flags &= ~static_cast<std::uint32_t>(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
  avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);

  adc_ = avr_io_getirq(avr_, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0);
  avr_irq_register_notify(
      avr_io_getirq(avr_, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER),
      [](avr_irq_t*, std::uint32_t value, void* board) {
        avr_adc_mux_t mux{};
        std::memcpy(&mux, &value, sizeof value);
        static_cast<VirtualBoard*>(board)->convert(mux.src);
      },
      this);
  receiver_ = avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
  avr_irq_register_notify(
      avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
      [](avr_irq_t*, std::uint32_t value, void* board) {
        static_cast<VirtualBoard*>(board)->sent_.push_back(static_cast<std::uint8_t>(value));
      },
      this);
  avr_irq_register_notify(
      avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ('B'), 5),
      [](avr_irq_t*, std::uint32_t value, void* board) { static_cast<VirtualBoard*>(board)->led_is(value != 0); }, this);
  run_line();
}

void VirtualBoard::convert(std::size_t input) {
  if (input >= kInputs) return;
  if (input == 0) {
    if (avr_->cycle - converted_cycles_ > kHertz / 20) began_cycles_ = avr_->cycle;
    converted_cycles_ = avr_->cycle;
  }
  if (inputs_ && input == 0) inputs_(time_s(), volts_);
  const std::uint32_t code = inputs_ ? code_for(volts_[input]) : wave_code(input, conversions_[input]);
  ++conversions_[input];
  avr_raise_irq(adc_ + input, millivolts_for(code));
}

bool VirtualBoard::run_until(double time_s) {
  const auto wanted = static_cast<std::uint64_t>(time_s * kHertz);
  while (cycles_before_reset_ + avr_->cycle < wanted) {
    const int state = avr_run(avr_);
    if (state == cpu_Done || state == cpu_Crashed) return false;
    const auto stack = static_cast<std::uint16_t>(avr_->data[0x5D] | (avr_->data[0x5E] << 8));
    if (stack > 0x100) lowest_stack_ = std::min(lowest_stack_, stack);  // not while it is being set after a reset
  }
  return true;
}

double VirtualBoard::time_s() const noexcept { return static_cast<double>(cycles_before_reset_ + avr_->cycle) / kHertz; }

void VirtualBoard::reset() {
  const std::uint64_t passed = avr_->cycle;
  avr_reset(avr_);
  if (avr_->cycle < passed) cycles_before_reset_ += passed - avr_->cycle;
  conversions_.fill(0);
  converted_cycles_ = 0;
  to_board_.clear();
  run_line();  // the reset has removed it
}

void VirtualBoard::receive(std::span<const std::uint8_t> bytes) { to_board_.insert(to_board_.end(), bytes.begin(), bytes.end()); }

/// Calls itself once per byte time: it gives the receiver a byte, and a processor that sleeps does not skip over the bytes to come.
void VirtualBoard::run_line() {
  avr_cycle_timer_register(
      avr_, kCyclesPerByte,
      [](avr_t*, avr_cycle_count_t when, void* board) {
        static_cast<VirtualBoard*>(board)->feed_receiver();
        return when + kCyclesPerByte;
      },
      this);
}

void VirtualBoard::feed_receiver() {
  if (to_board_.empty()) return;
  avr_raise_irq(receiver_, to_board_.front());
  to_board_.pop_front();
}

std::vector<std::uint8_t> VirtualBoard::take_sent() { return std::exchange(sent_, {}); }

void VirtualBoard::led_is(bool is_on) {
  if (is_on == is_led_on_) return;
  const std::uint64_t now = cycles_before_reset_ + avr_->cycle;
  if (is_led_on_) led_on_cycles_ += now - led_since_;
  led_since_ = now;
  is_led_on_ = is_on;
  ++led_changes_;
}

double VirtualBoard::led_on_s() const noexcept {
  const std::uint64_t since = is_led_on_ ? cycles_before_reset_ + avr_->cycle - led_since_ : 0;
  return static_cast<double>(led_on_cycles_ + since) / kHertz;
}

std::size_t VirtualBoard::stack_bytes() const noexcept { return static_cast<std::size_t>(std::max(avr_->ramend - lowest_stack_, 0)); }

}  // namespace dts::firmware_test
