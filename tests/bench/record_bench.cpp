// SPDX-License-Identifier: Apache-2.0
// What recording costs: synthetic frames of 16 channels at 1500 Hz through record::Recorder, beside a plain write of the same bytes.
#include <fcntl.h>
#include <time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fault/synthetic_frames.h"
#include "record/export/export.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::bench {
namespace {

using Clock = std::chrono::steady_clock;
using fault::SyntheticFrames;
using fault::VirtualRecording;

constexpr double kSynchroniseS = 0.45;  // as the record thread

/// Where the files go; removed at the end.
class Folder {
 public:
  explicit Folder(const std::string& parent) : path_(parent + "/dts-bench-XXXXXX") {
    if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no folder can be made in " + parent);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

struct Cost {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
};

double cpu_s() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

template <class Work>
Cost measure(Work work) {
  const auto start = Clock::now();
  const double cpu_start_s = cpu_s();
  Cost cost = work();
  cost.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  cost.cpu_s = cpu_s() - cpu_start_s;
  return cost;
}

Cost make_frames(double seconds) {
  return measure([seconds] {
    SyntheticFrames frames;
    double sum = 0.0;
    while (static_cast<double>(frames.scans()) < seconds * static_cast<double>(SyntheticFrames::kRateHz)) {
      sum += frames.next().streams.front().column(0).front();
    }
    if (sum < 0.0) throw std::runtime_error("the generator is wrong");
    return Cost{.scans = frames.scans()};
  });
}

Cost record(const std::string& file, double seconds, double synchronise_s) {
  return measure([&] {
    VirtualRecording recording(file, synchronise_s);
    recording.record(seconds);
    const auto closed = recording.close();
    return Cost{.bytes = closed.bytes, .scans = recording.scans()};
  });
}

/// The same bytes in pieces as large as the recorder's, with nothing made of them.
Cost write_plainly(const std::string& file, std::uint64_t bytes, double seconds, double synchronise_s) {
  return measure([&] {
    const auto pieces = static_cast<std::uint64_t>(seconds / 0.16);
    const std::vector<char> piece(bytes / std::max<std::uint64_t>(pieces, 1), 'x');
    const auto pieces_per_sync = synchronise_s > 0.0 ? static_cast<std::uint64_t>(synchronise_s / 0.16) : pieces + 1;
    const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    Cost cost;
    for (std::uint64_t i = 0; i < pieces; ++i) {
      if (::write(out, piece.data(), piece.size()) != static_cast<ssize_t>(piece.size())) throw std::runtime_error("the disk is full");
      cost.bytes += piece.size();
      if (i % pieces_per_sync == pieces_per_sync - 1 && ::fdatasync(out) != 0) throw std::runtime_error("fdatasync fails");
    }
    if (::fdatasync(out) != 0) throw std::runtime_error("fdatasync fails");
    ::close(out);
    return cost;
  });
}

/// Reading alone, for what verify and recover do on top.
Cost read_plainly(const std::string& file) {
  return measure([&] {
    std::ifstream in(file, std::ios::binary);
    std::vector<char> piece(1 << 20);
    Cost cost;
    while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0) {
      cost.bytes += static_cast<std::uint64_t>(in.gcount());
    }
    return cost;
  });
}

Cost verify(const std::string& file) {
  return measure([&] {
    const auto verified = record::verify(file);
    if (!verified || !verified->is_closed) throw std::runtime_error("what was recorded does not verify");
    return Cost{.bytes = verified->bytes, .scans = verified->scans};
  });
}

/// Of a file that was not closed: the footers are cut off with the name.
Cost recover(const Folder& folder, double seconds) {
  const std::string name = folder / "killed.xdf";
  {
    VirtualRecording recording(name, 0.0);
    recording.record(seconds);
  }  // abandoned, as by a crash
  return measure([&] {
    const auto recovered = record::recover(name + ".part", folder / "killed.recovered.xdf");
    if (!recovered) throw std::runtime_error(core::to_string(recovered.error()));
    return Cost{.bytes = recovered->kept_bytes};
  });
}

Cost export_csv(const std::string& file, const std::string& folder) {
  return measure([&] {
    auto recording = record::Recording::open(file);
    if (!recording) throw std::runtime_error(core::to_string(recording.error()));
    const auto exported = record::export_csv(**recording, folder);
    if (!exported) throw std::runtime_error(core::to_string(exported.error()));
    return Cost{.bytes = exported->bytes, .scans = exported->rows};
  });
}

void print_row(const char* what, const Cost& cost, double data_s) {
  std::printf("| %s | %.2f | %.1f | %.0f | %.2f |\n", what, cost.wall_s, static_cast<double>(cost.bytes) * 1e-6 / cost.wall_s,
              data_s / cost.wall_s, cost.cpu_s / data_s * 1e3);
}

void run(double minutes, const std::string& parent) {
  const Folder folder(parent);
  const double seconds = minutes * 60.0;
  const Cost frames = make_frames(seconds);
  const Cost recorded = record(folder / "a.xdf", seconds, 0.0);
  const Cost plain = write_plainly(folder / "plain", recorded.bytes, seconds, 0.0);
  const double synced_s = std::min(seconds, 60.0);
  const Cost synced = record(folder / "b.xdf", synced_s, kSynchroniseS);
  const Cost plain_synced = write_plainly(folder / "plain-synced", synced.bytes, synced_s, kSynchroniseS);
  std::printf(
      "%.0f min of 16 channels at 1500 Hz (double) and a centre of pressure (3 floats): %llu scans, %.1f MB. Million scans/s: %.2f\n\n",
      minutes, static_cast<unsigned long long>(recorded.scans), static_cast<double>(recorded.bytes) * 1e-6,
      static_cast<double>(recorded.scans) * 1e-6 / recorded.wall_s);
  std::printf("| | s | MB/s | times as fast as life | CPU ms per recorded s |\n|---|---|---|---|---|\n");
  print_row("making the frames (contained in recording)", frames, seconds);
  print_row("**recording**, synchronised once at the end", recorded, seconds);
  print_row("plain write of the same bytes", plain, seconds);
  print_row("**recording**, synchronised every 0.45 s of data", synced, synced_s);
  print_row("plain write of the same bytes, the same", plain_synced, synced_s);
  print_row("**verify**", verify(folder / "a.xdf"), seconds);
  print_row("**recover** (reads twice, writes once)", recover(folder, seconds), seconds);
  print_row("plain read of the same bytes", read_plainly(folder / "a.xdf"), seconds);
  print_row("**export csv** (MB of text)", export_csv(folder / "a.xdf", folder / "csv"), seconds);
}

}  // namespace
}  // namespace dts::bench

int main(int argc, char** argv) {
  double minutes = 60.0;
  std::string folder = "/tmp";
  CLI::App app{"What recording, verification, recovery and export cost, as a Markdown table"};
  app.add_option("--minutes", minutes, "of data; an hour needs 5 GB")->check(CLI::Range(1.0, 600.0))->capture_default_str();
  app.add_option("--folder", folder, "on the disk to measure")->check(CLI::ExistingDirectory)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    dts::bench::run(minutes, folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
