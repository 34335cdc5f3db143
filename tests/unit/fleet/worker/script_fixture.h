// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"

namespace dts::fleet::worker {

/// Writes an executable script. What it starts must replace it (exec): it may start no process.
inline std::string write_script(const std::string& file, const std::string& text, const std::string& shell = "/bin/sh") {
  std::ofstream(file) << "#!" << shell << "\n" << text << '\n';
  std::filesystem::permissions(file, std::filesystem::perms::owner_all | std::filesystem::perms::group_read);
  return file;
}

}  // namespace dts::fleet::worker
