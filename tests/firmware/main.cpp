// SPDX-License-Identifier: Apache-2.0
// simavr_board: a board that is not there. It runs the firmware in simavr, with its serial port on a pseudo-terminal.
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/serial_line.h"
#include "firmware/virtual_board.h"
#include "usb/host_program/rig_source.h"

namespace dts::firmware_test {
namespace {

constexpr double kStepS = 0.001;  // between looks at the line, the commands and the clock

volatile std::sig_atomic_t is_signalled = 0;

struct Options {
  std::string elf;
  std::string rig = "config/rigs/floor-sim.toml";
  std::string scene;
  std::string link;
  bool is_fast = false;
  bool resets_on_open = false;
};

class Program {
 public:
  Program(VirtualBoard& board, SerialLine& line, const Options& options) : board_(board), line_(line), options_(options) {}

  int run() {
    auto begun = std::chrono::steady_clock::now();
    while (!is_over()) {
      if (pauses_at_s_ && board_.time_s() >= *pauses_at_s_) {
        const auto paused = std::chrono::steady_clock::now();
        finish_run();
        while (pauses_at_s_ && board_.time_s() >= *pauses_at_s_ && !is_over()) take_commands(100);
        begun += std::chrono::steady_clock::now() - paused;
        continue;
      }
      if (!board_.run_until(board_.time_s() + kStepS)) {
        std::cerr << "simavr_board: the processor crashed at " << board_.time_s() << " s\n";
        return 1;
      }
      if (!options_.is_fast)
        std::this_thread::sleep_until(begun +
                                      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(board_.time_s())));
      look_at_host();
      exchange();
      answer_led();
      take_commands(0);
    }
    return 0;
  }

 private:
  [[nodiscard]] bool is_over() const noexcept { return wants_to_quit_ || is_signalled != 0; }

  /// An Uno and a Nano reset when a program opens their port.
  void look_at_host() {
    const bool has_host = line_.has_host();
    if (has_host && !had_host_ && options_.resets_on_open) board_.reset();
    had_host_ = has_host;
  }

  /// Moves bytes in both directions. If the host does not read, the board waits, so that a busy machine causes no loss.
  void exchange() {
    const std::vector<std::uint8_t> received = line_.read();
    if (!received.empty()) board_.receive(received);
    const std::vector<std::uint8_t> sent = board_.take_sent();
    std::span<const std::uint8_t> rest(sent);
    while (!rest.empty() && !is_over()) {
      const std::size_t written = line_.write(rest);
      rest = rest.subspan(written);
      if (written == 0) take_commands(10);
    }
  }

  void finish_run() {
    if (is_run_due_) std::cout << "ok" << std::endl;
    is_run_due_ = false;
  }

  void answer_led() {
    if (!led_ || board_.time_s() < led_->until_s) return;
    std::cout << "ok changes " << board_.led_changes() - led_->changes << " on_ms " << (board_.led_on_s() - led_->on_s) * 1e3 << std::endl;
    led_.reset();
  }

  void take_commands(int wait_ms) {
    pollfd wait{STDIN_FILENO, POLLIN, 0};
    if (::poll(&wait, 1, wait_ms) <= 0) return;
    std::array<char, 1024> bytes{};
    const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) return;
    if (count <= 0) {  // the program that started this one has ended
      wants_to_quit_ = true;
      return;
    }
    pending_.append(bytes.data(), static_cast<std::size_t>(count));
    for (std::size_t end = pending_.find('\n'); end != std::string::npos; end = pending_.find('\n')) {
      obey(pending_.substr(0, end));
      pending_.erase(0, end + 1);
    }
  }

  void obey(const std::string& command) {
    std::istringstream words(command);
    std::string verb;
    words >> verb;
    if (verb == "led" && led_) {
      std::cout << "error the led command before this one is not answered yet" << std::endl;
    } else if (verb == "led") {
      double window_ms = 0.0;
      words >> window_ms;
      led_ = LedWindow{board_.time_s() + window_ms / 1e3, board_.led_changes(), board_.led_on_s()};
      return;  // answered at the end of the window
    }
    if (verb == "run") {
      double ms = 0.0;
      words >> ms;
      pauses_at_s_ = board_.time_s() + ms / 1e3;
      is_run_due_ = true;
      return;  // answered at the end
    }
    if (verb == "resume") {
      pauses_at_s_.reset();
      std::cout << "ok" << std::endl;
    } else if (verb == "reset") {
      board_.reset();
      std::cout << "ok" << std::endl;
    } else if (verb == "volts") {
      std::vector<double> volts;
      for (double value = 0.0; words >> value;) volts.push_back(value);
      board_.set_inputs([volts](double, std::span<double> inputs) {
        for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i] = i < volts.size() ? volts[i] : 0.0;
      });
      std::cout << "ok" << std::endl;
    } else if (verb == "time") {
      std::cout << "ok " << board_.time_s() << std::endl;
    } else if (verb == "began") {
      std::cout << "ok " << board_.began_cycles() << std::endl;
    } else if (verb == "stack") {
      std::cout << "ok " << board_.stack_bytes() << std::endl;
    } else if (verb == "quit") {
      wants_to_quit_ = true;
      std::cout << "ok" << std::endl;
    } else {
      std::cout << "error no command is called \"" << verb
                << "\"; there are reset, volts V V ..., led MS, run MS, resume, time, began, stack, quit" << std::endl;
    }
  }

  struct LedWindow {
    double until_s;
    std::uint64_t changes;
    double on_s;
  };

  VirtualBoard& board_;
  SerialLine& line_;
  const Options& options_;
  std::optional<LedWindow> led_;
  std::optional<double> pauses_at_s_;
  bool is_run_due_ = false;
  std::string pending_;
  bool had_host_ = false;
  bool wants_to_quit_ = false;
};

int refuse(const core::Error& error) {
  std::cerr << "simavr_board: " << core::to_string(error) << '\n';
  return 1;
}

/// A symbolic link to the pseudo-terminal. Its end removes it, unless it belongs to another program by then: a link that stays would lead a
/// host to the terminal that has the same number later.
class Link {
 public:
  Link(std::filesystem::path path, std::filesystem::path target) : path_(std::move(path)), target_(std::move(target)) {}
  ~Link() {
    std::error_code failure;
    if (std::filesystem::read_symlink(path_, failure) == target_ && !failure) std::filesystem::remove(path_, failure);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  [[nodiscard]] std::error_code make() const {
    std::error_code failure;
    if (std::filesystem::is_symlink(path_)) std::filesystem::remove(path_, failure);
    std::filesystem::create_symlink(target_, path_, failure);
    return failure;
  }

 private:
  std::filesystem::path path_;
  std::filesystem::path target_;
};

int run(const Options& options) {
  for (const int number : {SIGTERM, SIGINT}) std::signal(number, [](int) { is_signalled = 1; });

  auto board = VirtualBoard::create(options.elf);
  if (!board) return refuse(board.error());
  std::unique_ptr<emulator::RigSource> rig;
  if (!options.scene.empty()) {
    auto made = emulator::RigSource::create(options.rig, options.scene);
    if (!made) return refuse(made.error());
    rig = std::move(*made);
    (*board)->set_inputs(rig->source());
  }
  auto line = SerialLine::open();
  if (!line) return refuse(line.error());
  std::optional<Link> link;
  if (!options.link.empty()) {
    link.emplace(options.link, line->path());
    if (const std::error_code failure = link->make()) {
      return refuse({core::ErrorCode::InvalidArgument, "cannot make the link " + options.link + ": " + failure.message(),
                     "name a file that does not exist, in a folder that you may write"});
    }
  }
  std::cout << "port " << line->path() << std::endl;
  return Program(**board, *line, options).run();
}

}  // namespace
}  // namespace dts::firmware_test

int main(int argc, char** argv) {
  dts::firmware_test::Options options;
  CLI::App app{
      "simavr_board - runs the firmware in simavr; its serial port is a pseudo-terminal, whose path is printed first.\n\n"
      "Examples:\n"
      "  simavr_board dts-firmware.elf --link /tmp/board                        inputs: a test wave with known codes\n"
      "  simavr_board dts-firmware.elf --link /tmp/board --scene 'sim:floor?seed=7'   inputs: a simulated platform\n\n"
      "Commands on standard input, one line each, answered by one line:\n"
      "  reset          as the board's button\n"
      "  volts V V ...  inputs 0, 1, ... from now on\n"
      "  led MS         how often the LED changes in so many ms of the board's time, and how long it is on\n"
      "  run MS         run so many ms of the board's time, then pause until run or resume\n"
      "  resume\n"
      "  time           the board's time, s\n"
      "  began          cycles (16 MHz) from the reset to the first conversion after a pause of 50 ms\n"
      "  stack          the most bytes of stack so far\n"
      "  quit           as the end of the input"};
  app.add_option("ELF", options.elf, "The firmware")->required();
  app.add_option("--rig", options.rig, "Rig file for --scene: plate and sensors")->capture_default_str();
  app.add_option("--scene", options.scene, "What is on the plate, with sensor n at input n: sim:floor?...");
  app.add_option("--link", options.link, "Make a symbolic link to the pseudo-terminal, and remove it at the end");
  app.add_flag("--fast", options.is_fast, "As fast as possible. Default: the board's time is the machine's time");
  app.add_flag("--reset-on-open", options.resets_on_open, "Reset when a program opens the port, as an Uno does");
  CLI11_PARSE(app, argc, argv);
  return dts::firmware_test::run(options);
}
