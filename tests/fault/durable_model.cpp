// SPDX-License-Identifier: Apache-2.0
#include "fault/durable_model.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace dts::fault {
namespace {

/// The descriptor may be open for writing only: the file is read through its path in /proc.
std::shared_ptr<const std::string> content_of(int descriptor) {
  std::ifstream file("/proc/self/fd/" + std::to_string(descriptor), std::ios::binary);
  return std::make_shared<const std::string>(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

}  // namespace

FaultyDisk::Done DurableModel::synchronising(int descriptor, const std::string& path) {
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) return {};
  if (!S_ISDIR(facts.st_mode)) {
    return [this, inode = facts.st_ino, content = content_of(descriptor)] {
      const std::lock_guard lock(mutex_);
      contents_[inode] = content;
    };
  }
  Names names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(path, error)) {
    struct stat found {};
    if (::lstat(entry.path().c_str(), &found) != 0) continue;
    names[entry.path().filename()] = {.inode = found.st_ino, .is_folder = S_ISDIR(found.st_mode)};
  }
  return [this, path, names = std::move(names)] {
    const std::lock_guard lock(mutex_);
    names_[path] = names;
  };
}

DurableModel::Survivors DurableModel::cut() const {
  const std::lock_guard lock(mutex_);
  Survivors survivors;
  collect(root_, "", survivors);
  return survivors;
}

void DurableModel::collect(const std::string& folder, const std::string& prefix, Survivors& survivors) const {
  const auto names = names_.find(folder);
  if (names == names_.end()) return;
  for (const auto& [name, entry] : names->second) {
    if (entry.is_folder) {
      survivors[prefix + name + "/"] = nullptr;
      collect(folder + "/" + name, prefix + name + "/", survivors);
      continue;
    }
    const auto content = contents_.find(entry.inode);
    survivors[prefix + name] = content != contents_.end() ? content->second : std::make_shared<const std::string>();
  }
}

void put(const DurableModel::Survivors& survivors, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& [path, content] : survivors) {
    const std::filesystem::path target = std::filesystem::path(folder) / path;
    if (!content) {
      std::filesystem::create_directories(target);
      continue;
    }
    std::ofstream(target, std::ios::binary).write(content->data(), static_cast<std::streamsize>(content->size()));
  }
}

}  // namespace dts::fault
