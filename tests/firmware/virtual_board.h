// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

struct avr_t;
struct avr_irq_t;

namespace dts::firmware_test {

/// An ATmega328P of simavr that runs the firmware: inputs, line and LED as values. It has no clock but its own cycles. Thread: one.
class VirtualBoard {
 public:
  static constexpr std::size_t kInputs = 8;
  static constexpr std::uint32_t kHertz = 16'000'000;

  /// Fills the volts of all inputs. Called once per scan, before its first input is converted.
  using Inputs = std::function<void(double time_s, std::span<double> volts)>;

  /// Loads an ELF file. Fails if it cannot be read.
  [[nodiscard]] static core::Result<std::unique_ptr<VirtualBoard>> create(const std::string& elf);
  ~VirtualBoard();
  VirtualBoard(const VirtualBoard&) = delete;
  VirtualBoard& operator=(const VirtualBoard&) = delete;

  /// nullptr: the test wave. Input c of conversion k since the reset then has the code wave_code(c, k).
  void set_inputs(Inputs inputs) { inputs_ = std::move(inputs); }
  [[nodiscard]] static std::uint32_t wave_code(std::size_t input, std::uint64_t conversion) noexcept {
    return static_cast<std::uint32_t>((conversion * (2 * input + 3) + 100 * input) % 1024);
  }

  /// Runs until the board's time reaches `time_s`. Returns false if the processor has crashed.
  [[nodiscard]] bool run_until(double time_s);
  [[nodiscard]] double time_s() const noexcept;
  void reset();

  /// Gives bytes to the board's receiver, which gets them at the speed of the line.
  void receive(std::span<const std::uint8_t> bytes);
  /// Returns what the board has sent since the last call.
  [[nodiscard]] std::vector<std::uint8_t> take_sent();

  [[nodiscard]] std::uint64_t led_changes() const noexcept { return led_changes_; }
  [[nodiscard]] double led_on_s() const noexcept;
  /// Returns the cycles from the last reset to the conversion of input 0 that came first after a pause of 50 ms.
  [[nodiscard]] std::uint64_t began_cycles() const noexcept { return began_cycles_; }
  /// Returns the most bytes of stack since the start.
  [[nodiscard]] std::size_t stack_bytes() const noexcept;

 private:
  VirtualBoard() = default;
  void connect();
  void convert(std::size_t input);
  void run_line();
  void feed_receiver();
  void led_is(bool is_on);

  avr_t* avr_ = nullptr;
  avr_irq_t* adc_ = nullptr;
  avr_irq_t* receiver_ = nullptr;
  Inputs inputs_;
  std::array<double, kInputs> volts_{};
  std::array<std::uint64_t, kInputs> conversions_{};
  std::uint64_t converted_cycles_ = 0;  ///< Input 0, last.
  std::uint64_t began_cycles_ = 0;
  std::deque<std::uint8_t> to_board_;
  std::vector<std::uint8_t> sent_;
  std::uint64_t cycles_before_reset_ = 0;
  std::uint16_t lowest_stack_ = 0xFFFF;
  bool is_led_on_ = false;
  std::uint64_t led_changes_ = 0;
  std::uint64_t led_on_cycles_ = 0;
  std::uint64_t led_since_ = 0;
};

}  // namespace dts::firmware_test
