// SPDX-License-Identifier: Apache-2.0
#include "fault/logged_disk.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#define FUSE_USE_VERSION 31
#include <fuse.h>

namespace dts::fault {
namespace {

constexpr std::uint64_t kSector = 512;
constexpr std::uint64_t kMebibyte = 1024 * 1024;

/// In front of each event of a log.
struct LogHead {
  std::uint64_t is_flush = 0;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

void run(const std::string& command) {
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

void write_at(int file, std::span<const char> bytes, std::uint64_t offset) {
  if (::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset)) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the image of a disk cannot be written");
}

/// The file system that serves the disk: one file. libfuse's callbacks get it as their private data.
struct ServedDisk {
  int image = -1;
  int log = -1;
  std::uint64_t size = 0;

  static const ServedDisk& self() noexcept { return *static_cast<const ServedDisk*>(::fuse_get_context()->private_data); }
  [[nodiscard]] bool enter(const LogHead& head, std::span<const char> bytes) const {
    std::vector<char> event(sizeof head);
    std::memcpy(event.data(), &head, sizeof head);
    event.insert(event.end(), bytes.begin(), bytes.end());
    return ::write(log, event.data(), event.size()) == static_cast<ssize_t>(event.size());
  }

  static int attributes(const char* path, struct stat* found, fuse_file_info* /*file*/) {
    *found = {};
    if (std::string_view(path) == "/") {
      found->st_mode = S_IFDIR | 0700;
      found->st_nlink = 2;
      return 0;
    }
    if (std::string_view(path) != "/disk") return -ENOENT;
    found->st_mode = S_IFREG | 0600;
    found->st_nlink = 1;
    found->st_size = static_cast<off_t>(self().size);
    return 0;
  }
  static int open(const char* /*path*/, fuse_file_info* /*file*/) { return 0; }
  static int read(const char* /*path*/, char* bytes, std::size_t count, off_t offset, fuse_file_info* /*file*/) {
    const ssize_t got = ::pread(self().image, bytes, count, offset);
    return got < 0 ? -EIO : static_cast<int>(got);
  }
  static int write(const char* /*path*/, const char* bytes, std::size_t count, off_t offset, fuse_file_info* /*file*/) {
    if (::pwrite(self().image, bytes, count, offset) != static_cast<ssize_t>(count)) return -EIO;
    return self().enter({.offset = static_cast<std::uint64_t>(offset), .bytes = count}, {bytes, count}) ? static_cast<int>(count) : -EIO;
  }
  static int flush(const char* /*path*/, int /*is_data_only*/, fuse_file_info* /*file*/) {
    return self().enter({.is_flush = 1}, {}) ? 0 : -EIO;
  }
};

}  // namespace

std::vector<DiskEvent> read_log(const std::string& log, std::uint64_t length) {
  std::ifstream file(log, std::ios::binary);
  if (!file) throw std::runtime_error("the log of a disk cannot be read: " + log);
  std::vector<DiskEvent> events;
  LogHead head;
  for (std::uint64_t at = 0; at + sizeof head <= length && file.read(reinterpret_cast<char*>(&head), sizeof head);) {
    at += sizeof head + head.bytes;
    if (at > length) break;
    DiskEvent event{.is_flush = head.is_flush != 0, .offset = head.offset};
    event.bytes.resize(head.bytes);
    if (!file.read(event.bytes.data(), static_cast<std::streamsize>(head.bytes))) break;
    events.push_back(std::move(event));
  }
  return events;
}

void write_survivors(std::span<const DiskEvent> events, std::mt19937& random, const std::string& image) {
  const int file = ::open(image.c_str(), O_WRONLY);
  if (file < 0) throw std::runtime_error("the image of a disk cannot be opened: " + image);
  const auto last_flush = std::ranges::find_if(events.rbegin(), events.rend(), &DiskEvent::is_flush);
  const auto durable = static_cast<std::size_t>(events.rend() - last_flush);
  enum class Fate { Kept, Lost, Torn };
  for (std::size_t i = 0; i < events.size(); ++i) {
    const DiskEvent& event = events[i];
    const Fate fate = i < durable ? Fate::Kept : std::array{Fate::Kept, Fate::Lost, Fate::Torn}[random() % 3];
    if (fate == Fate::Kept) write_at(file, event.bytes, event.offset);
    if (fate != Fate::Torn) continue;
    for (std::uint64_t at = 0; at < event.bytes.size(); at += kSector) {
      const std::span sector = std::span(event.bytes).subspan(at, std::min<std::uint64_t>(kSector, event.bytes.size() - at));
      if (random() % 2 == 0) write_at(file, sector, event.offset + at);
    }
  }
  ::close(file);
}

LoggedDisk::LoggedDisk(std::string_view file_system, std::string folder)
    : folder_(std::move(folder)), size_((file_system == "xfs" ? 320 : 64) * kMebibyte) {  // mkfs.xfs makes nothing smaller than 300 MiB
  std::filesystem::create_directories(scratch_.path() + "/served");
  server_ = ::fork();
  if (server_ < 0) throw std::runtime_error("no process for the disk");
  if (server_ == 0) {
    serve();
    ::_exit(1);
  }
  try {
    mount_new(file_system);
  } catch (...) {
    close();
    throw;
  }
}

void LoggedDisk::mount_new(std::string_view file_system) {
  const std::string disk = scratch_.path() + "/served/disk";
  for (int turn = 0; turn < 500 && ::access(disk.c_str(), R_OK | W_OK) != 0; ++turn) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  run("mkfs." + std::string(file_system) + (file_system == "xfs" ? " -q -f " : " -q -F ") + disk);
  run("mount -o loop,noatime " + disk + " " + folder_);
  is_mounted_ = true;
}

LoggedDisk::~LoggedDisk() { close(); }

void LoggedDisk::close() const noexcept {
  for (const std::string& mounted : {is_mounted_ ? folder_ : std::string(), scratch_.path() + "/served"}) {
    if (!mounted.empty() && std::system(("umount " + mounted).c_str()) != 0) std::fprintf(stderr, "%s stays mounted\n", mounted.c_str());
  }
  ::kill(server_, SIGTERM);
  while (::waitpid(server_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void LoggedDisk::serve() const {
  constexpr int kMode = 0600;
  ServedDisk disk{.image = ::open((scratch_.path() + "/image").c_str(), O_RDWR | O_CREAT | O_EXCL, kMode),
                  .log = ::open((scratch_.path() + "/log").c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND, kMode),
                  .size = size_};
  if (disk.image < 0 || disk.log < 0 || ::ftruncate(disk.image, static_cast<off_t>(size_)) != 0) return;
  fuse_operations operations{};
  operations.getattr = ServedDisk::attributes;
  operations.open = ServedDisk::open;
  operations.read = ServedDisk::read;
  operations.write = ServedDisk::write;
  operations.fsync = ServedDisk::flush;
  std::array<std::string, 4> words{"disk", "-f", "-s", scratch_.path() + "/served"};
  std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  ::_exit(fuse_main(4, arguments.data(), &operations, &disk));
}

std::uint64_t LoggedDisk::written() const { return std::filesystem::file_size(scratch_.path() + "/log"); }

void LoggedDisk::restore(std::uint64_t moment, std::mt19937& random) {
  if (is_mounted_) run("umount " + folder_);
  is_mounted_ = false;
  const std::string image = scratch_.path() + "/restored";
  std::filesystem::remove(image);
  std::ofstream(image).close();
  std::filesystem::resize_file(image, size_);
  write_survivors(read_log(scratch_.path() + "/log", moment), random, image);
  run("mount -o loop,noatime " + image + " " + folder_);
  is_mounted_ = true;
}

}  // namespace dts::fault
