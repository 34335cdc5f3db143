// SPDX-License-Identifier: Apache-2.0
#include "fault/faulty_disk.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace dts::fault {
namespace {

std::atomic<FaultyDisk*> present{nullptr};

FaultyDisk* disk() noexcept { return present.load(std::memory_order_acquire); }  // pairs with the constructor

/// Empty for sockets, pipes and what is not open.
std::string_view path_of(int descriptor, std::array<char, PATH_MAX>& room) noexcept {
  std::array<char, 64> link{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", descriptor);
  const ssize_t length = ::readlink(link.data(), room.data(), room.size());
  return length > 0 ? std::string_view(room.data(), static_cast<std::size_t>(length)) : std::string_view();
}

/// The function that would have been called without this file.
template <class Function>
Function next(const char* symbol) noexcept {
  void* const found = ::dlsym(RTLD_NEXT, symbol);
  if (found == nullptr) std::abort();
  Function function{};
  static_assert(sizeof function == sizeof found);
  std::memcpy(&function, &found, sizeof found);
  return function;
}

template <class Subject>
FaultyDisk::Verdict verdict(Operation operation, Subject subject) noexcept {
  FaultyDisk* const faulty = disk();
  return faulty != nullptr ? faulty->error_for(operation, subject) : FaultyDisk::Verdict{};
}

/// Calls `real` unless the call has to fail.
template <class Subject, class Real>
int perform(Operation operation, Subject subject, Real real) noexcept {
  if (const auto [error, is_torn] = verdict(operation, subject); error != 0) {
    errno = error;
    return -1;
  }
  return real();
}

template <class Real>
ssize_t perform_write(int descriptor, std::size_t count, Real real) noexcept {
  const auto [error, is_torn] = verdict(Operation::Write, descriptor);
  if (error == 0) return real(count);
  if (is_torn && count > 1) return real(count / 2);
  errno = error;
  return -1;
}

template <class Real>
int perform_synchronise(Operation operation, int descriptor, Real real) noexcept {
  FaultyDisk* const faulty = disk();
  if (faulty == nullptr) return real();
  FaultyDisk::Done done;
  std::array<char, PATH_MAX> room{};
  const std::string_view path = path_of(descriptor, room);
  if (faulty->on_synchronise && faulty->is_mine(path)) done = faulty->on_synchronise(descriptor, std::string(path));
  const int result = perform(operation, descriptor, real);
  if (result == 0 && done) done();
  return result;
}

template <class Real>
int perform_open(const char* path, int flags, std::va_list arguments, Real real) noexcept {
  const bool has_mode = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = has_mode ? va_arg(arguments, mode_t) : 0;
  return perform(Operation::Open, std::string_view(path), [&] { return real(mode); });
}

const char* name_of(int error) noexcept {
  const char* const known = ::strerrorname_np(error);
  return known != nullptr ? known : "?";
}

}  // namespace

std::string_view name(Operation operation) noexcept {
  switch (operation) {
    case Operation::Write: return "write";
    case Operation::Fsync: return "fsync";
    case Operation::Fdatasync: return "fdatasync";
    case Operation::Rename: return "rename";
    case Operation::Open: return "open";
    case Operation::Truncate: return "ftruncate";
    case Operation::Unlink: return "unlink";
  }
  return "unknown";
}

std::string to_text(const Fault& fault) {
  return std::string(name(fault.operation)) + " " + std::to_string(fault.nth) + " " + (fault.is_kill ? "SIGKILL" : name_of(fault.error)) +
         (fault.is_lasting ? " for ever" : " once");
}

FaultyDisk::FaultyDisk(std::string root) : root_(std::move(root)) { present.store(this, std::memory_order_release); }
FaultyDisk::~FaultyDisk() { present.store(nullptr, std::memory_order_release); }

void FaultyDisk::arm(const Fault& fault) noexcept {
  for (auto& calls : calls_) calls.store(0, std::memory_order_relaxed);
  has_struck_.store(false, std::memory_order_relaxed);
  fault_ = fault;
  is_armed_.store(true, std::memory_order_release);  // pairs with error_for()
}

FaultyDisk::Verdict FaultyDisk::error_for(Operation operation, std::string_view path) noexcept {
  if (!is_mine(path)) return {};
  const std::uint64_t call = calls_[static_cast<std::size_t>(operation)].fetch_add(1, std::memory_order_relaxed) + 1;
  if (!is_armed_.load(std::memory_order_acquire) || operation != fault_.operation) return {};
  if (call != fault_.nth && (!fault_.is_lasting || call < fault_.nth)) return {};
  has_struck_.store(true, std::memory_order_relaxed);
  if (fault_.is_kill) ::kill(::getpid(), SIGKILL);
  return {.error = fault_.error, .is_torn = fault_.is_lasting && call == fault_.nth};
}

FaultyDisk::Verdict FaultyDisk::error_for(Operation operation, int descriptor) noexcept {
  std::array<char, PATH_MAX> room{};
  return error_for(operation, path_of(descriptor, room));
}

}  // namespace dts::fault

// What follows stands in for libc, in this program and in the libraries that it loads.
using dts::fault::next;
using dts::fault::Operation;

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t count) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  return dts::fault::perform_write(descriptor, count, [&](size_t n) { return real(descriptor, bytes, n); });
}
ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off_t)>("pwrite");
  return dts::fault::perform_write(descriptor, count, [&](size_t n) { return real(descriptor, bytes, n, at); });
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t at) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t, off64_t)>("pwrite64");
  return dts::fault::perform_write(descriptor, count, [&](size_t n) { return real(descriptor, bytes, n, at); });
}
int fsync(int descriptor) {
  static const auto real = next<int (*)(int)>("fsync");
  return dts::fault::perform_synchronise(Operation::Fsync, descriptor, [&] { return real(descriptor); });
}
int fdatasync(int descriptor) {
  static const auto real = next<int (*)(int)>("fdatasync");
  return dts::fault::perform_synchronise(Operation::Fdatasync, descriptor, [&] { return real(descriptor); });
}
int ftruncate(int descriptor, off_t length) noexcept {
  static const auto real = next<int (*)(int, off_t)>("ftruncate");
  return dts::fault::perform(Operation::Truncate, descriptor, [&] { return real(descriptor, length); });
}
int ftruncate64(int descriptor, off64_t length) noexcept {
  static const auto real = next<int (*)(int, off64_t)>("ftruncate64");
  return dts::fault::perform(Operation::Truncate, descriptor, [&] { return real(descriptor, length); });
}
int rename(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  return dts::fault::perform(Operation::Rename, std::string_view(to), [&] { return real(from, to); });
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned int flags) noexcept {
  static const auto real = next<int (*)(int, const char*, int, const char*, unsigned int)>("renameat2");
  return dts::fault::perform(Operation::Rename, std::string_view(to), [&] { return real(from_folder, from, to_folder, to, flags); });
}
int link(const char* from, const char* to) noexcept {
  static const auto real = next<int (*)(const char*, const char*)>("link");
  return dts::fault::perform(Operation::Rename, std::string_view(to), [&] { return real(from, to); });
}
int unlink(const char* path) noexcept {
  static const auto real = next<int (*)(const char*)>("unlink");
  return dts::fault::perform(Operation::Unlink, std::string_view(path), [&] { return real(path); });
}
int unlinkat(int folder, const char* path, int flags) noexcept {
  static const auto real = next<int (*)(int, const char*, int)>("unlinkat");
  return dts::fault::perform(Operation::Unlink, folder, [&] { return real(folder, path, flags); });
}
int open(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, ...)>("open");
  std::va_list arguments;
  va_start(arguments, flags);
  const int result = dts::fault::perform_open(path, flags, arguments, [&](mode_t mode) { return real(path, flags, mode); });
  va_end(arguments);
  return result;
}
int open64(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, ...)>("open64");
  std::va_list arguments;
  va_start(arguments, flags);
  const int result = dts::fault::perform_open(path, flags, arguments, [&](mode_t mode) { return real(path, flags, mode); });
  va_end(arguments);
  return result;
}
}
