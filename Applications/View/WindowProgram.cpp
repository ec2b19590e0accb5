// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "WindowProgram.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

/// A path relative to the folder of the running program.
fs::path fromHere(const char* relative) {
  return (fs::read_symlink("/proc/self/exe").parent_path() / relative).lexically_normal();
}

/// This process's arguments, each ended by a zero.
std::string ownArguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

void startWindowProgram() {
  constexpr const char* kWithout = "; --screenshot and --film draw without a window";
  const fs::path program = fromHere(EXPLICA_WINDOW_FROM_PROGRAM);
  if (!isThere(program)) {
    throw EnvironmentError(program.string() +
                           ": the window is not installed; install Debian's package "
                           "explica-window, or build with Qt 5 and VTK's Qt widget" +
                           kWithout);
  }
  std::string arguments = ownArguments();
  std::vector<char*> words;
  for (std::size_t at = 0; at < arguments.size(); at += std::strlen(&arguments[at]) + 1) {
    words.push_back(&arguments[at]);
  }
  words.push_back(nullptr);
  execv(program.c_str(), words.data());
  throw EnvironmentError(program.string() + ": cannot be started: " + std::strerror(errno) +
                         kWithout);
}

fs::path mainProgram() {
  return fromHere(EXPLICA_PROGRAM_FROM_WINDOW);
}

}  // namespace explica::app
