// SPDX-License-Identifier: Apache-2.0
#include "lab/base/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string_view>

#include "files/whole_file.h"

namespace dts::lab {
namespace {

using core::ErrorCode;

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
/// An unnamed file in memory or /tmp: unlike a pipe it cannot block.
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

std::string content_of(std::FILE* file) {
  std::string text;
  std::rewind(file);
  std::array<char, 65536> chunk{};
  for (std::size_t bytes = 0; (bytes = std::fread(chunk.data(), 1, chunk.size(), file)) > 0;) text.append(chunk.data(), bytes);
  return text;
}

/// Runs gnuplot with these three files and returns its exit status, or an errno as error.
core::Result<int> run_gnuplot(std::FILE* in, std::FILE* out, std::FILE* talk) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(in), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(out), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ::fileno(talk), STDERR_FILENO);
  std::array<char, 8> name{"gnuplot"};
  std::array<char, 3> no_start_files{"-d"};
  const std::array<char*, 3> arguments{name.data(), no_start_files.data(), nullptr};
  pid_t child = -1;
  const int problem = ::posix_spawnp(&child, name.data(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (problem == ENOENT) {
    return core::fail(ErrorCode::Unsupported, "--plot needs gnuplot, which is not installed", "apt-get install gnuplot-nox");
  }
  if (problem != 0) return core::fail_errno(problem, "gnuplot cannot be started");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return core::fail_errno(errno, "gnuplot cannot be waited for");
  }
  return status;
}

/// Returns "svg" for "map.SVG".
std::string extension_of(const std::string& file) {
  const std::size_t dot = file.rfind('.');
  std::string extension = dot == std::string::npos ? "" : file.substr(dot + 1);
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension;
}

std::string_view terminal_for(const std::string& file) {
  return extension_of(file) == "svg" ? "set terminal svg size 900,820 background 'white' font 'sans,13'\n"
                                     : "set terminal pngcairo size 900,820 background 'white' font 'sans,11'\n";
}

}  // namespace

core::Status check_plot_name(const std::string& file) {
  const std::string extension = extension_of(file);
  if (extension == "svg" || extension == "png") return {};
  return core::fail(ErrorCode::InvalidArgument, "--plot " + file + ": unknown picture format", "give a name that ends in .svg or .png");
}

core::Status draw(const std::string& script, const std::string& file) {
  DTS_TRY(check_plot_name(file));
  const TemporaryFile in(std::tmpfile());
  const TemporaryFile out(std::tmpfile());
  const TemporaryFile talk(std::tmpfile());
  if (!in || !out || !talk) return core::fail_errno(errno, "no temporary file for the picture");
  const std::string whole = std::string(terminal_for(file)) + script;
  if (std::fwrite(whole.data(), 1, whole.size(), in.get()) != whole.size() || std::fflush(in.get()) != 0) {
    return core::fail_errno(errno, "no disk space for a temporary file");
  }
  std::rewind(in.get());
  DTS_TRY_ASSIGN(const auto status, run_gnuplot(in.get(), out.get(), talk.get()));
  const std::string picture = content_of(out.get());
  if (status != 0 || picture.empty()) {
    return core::fail(ErrorCode::Failed, "gnuplot failed: " + content_of(talk.get()),
                      "check that its version is 5.4 or later: gnuplot --version");
  }
  return files::write_whole_file(file, picture);
}

}  // namespace dts::lab
