// SPDX-License-Identifier: Apache-2.0
// For LD_PRELOAD: keeps what a power cut would leave. Each time the program has synchronised a file or folder below $DTS_POWER_ROOT, its
// content is copied to $DTS_POWER_COPY: "data-INODE" has the bytes of a file, "names-INODE" the lines "INODE NAME" of a folder. power_cut.py
// puts them back. The program dies before it synchronises the folder $DTS_POWER_DIE. Thread: any.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>

namespace {

std::mutex copying;

void copy_file(int descriptor, const std::string& target) {
  // Opened again: the program may have opened it for writing only.
  const int source = open(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), O_RDONLY | O_CLOEXEC);
  const int copy = open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (source < 0 || copy < 0) std::abort();  // a test without copies would pass
  std::array<char, 65536> buffer;
  for (ssize_t size = 0; (size = read(source, buffer.data(), buffer.size())) > 0;) {
    if (write(copy, buffer.data(), static_cast<std::size_t>(size)) != size) std::abort();
  }
  close(source);
  close(copy);
}

void copy_names(int descriptor, const std::string& target) {
  DIR* const folder = fdopendir(open(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  std::FILE* const copy = std::fopen(target.c_str(), "w");
  if (folder == nullptr || copy == nullptr) std::abort();
  while (const dirent* const entry = readdir(folder)) {
    if (entry->d_name[0] != '.') std::fprintf(copy, "%llu %s\n", static_cast<unsigned long long>(entry->d_ino), entry->d_name);
  }
  closedir(folder);
  std::fclose(copy);
}

std::string path_of(int descriptor) {
  std::array<char, 4096> path;
  const ssize_t length = readlink(("/proc/self/fd/" + std::to_string(descriptor)).c_str(), path.data(), path.size());
  return {path.data(), static_cast<std::size_t>(std::max<ssize_t>(0, length))};
}

void keep(int descriptor) {
  const char* const root = std::getenv("DTS_POWER_ROOT");
  const char* const copies = std::getenv("DTS_POWER_COPY");
  struct stat status {};
  if (root == nullptr || copies == nullptr || fstat(descriptor, &status) != 0 || !path_of(descriptor).starts_with(root)) return;
  const std::lock_guard lock(copying);
  const std::string inode = std::to_string(status.st_ino);
  const std::string temporary = std::string(copies) + "/new-" + inode;
  const bool is_folder = S_ISDIR(status.st_mode);
  is_folder ? copy_names(descriptor, temporary) : copy_file(descriptor, temporary);
  // The program may be killed at any moment: a copy is whole or not there.
  if (std::rename(temporary.c_str(), (std::string(copies) + (is_folder ? "/names-" : "/data-") + inode).c_str()) != 0) std::abort();
}

int synchronise(const char* function, int descriptor) {
  using Function = int (*)(int);
  const char* const death = std::getenv("DTS_POWER_DIE");
  if (death != nullptr && path_of(descriptor) == death) raise(SIGKILL);
  const auto real = reinterpret_cast<Function>(dlsym(RTLD_NEXT, function));
  const int result = real(descriptor);
  if (result == 0) keep(descriptor);
  return result;
}

}  // namespace

extern "C" int fsync(int descriptor) { return synchronise("fsync", descriptor); }
extern "C" int fdatasync(int descriptor) { return synchronise("fdatasync", descriptor); }
