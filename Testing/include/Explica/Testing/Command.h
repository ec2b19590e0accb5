// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {

/// How a program ended and what it said.
struct CommandResult {
  int exitCode = -1;  ///< 128 + signal if a signal ended it
  std::string out;    ///< standard output
  std::string err;    ///< standard error
};
std::ostream& operator<<(std::ostream& stream, const CommandResult& result);

/// Whether --max-time ended the program before it came to a stop by itself: exit code 4 with the
/// sentence that says so.  On a busy machine any command may end so: the grace that it has is time
/// of the clock.
[[nodiscard]] bool overran(const CommandResult& result);

/// How to run a program.
struct CommandSetting {
  std::filesystem::path directory;                 ///< working directory; empty: this process's
  std::map<std::string, std::string> environment;  ///< set in addition; an empty value unsets
  std::optional<std::uint64_t> fileSizeLimit;      ///< bytes: a disk that is full after so many
  std::optional<int> signal;                       ///< sent once, when both of the next hold
  double signalAfter = 0;                          ///< seconds
  std::string signalWhen = {};                     ///< standard error holds this
  double timeout = 100;                            ///< s; the program is killed then
};

/// Runs a program and waits.
CommandResult runProgram(const std::vector<std::string>& words, const CommandSetting& setting = {});

/// Runs the `explica` of this build: explica({"phantom", "shell", "--out", folder / "a"}).
CommandResult explica(const std::vector<std::string>& words, const CommandSetting& setting = {});

/// A fresh folder that goes away with this object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// A name in it, as text for a command line.
  [[nodiscard]] std::string operator/(const std::string& name) const {
    return (path_ / name).string();
  }
  /// Names of everything in it, hidden entries too, relative, sorted.
  [[nodiscard]] std::vector<std::string> entries() const;

 private:
  std::filesystem::path path_;
};

[[nodiscard]] nlohmann::ordered_json readJson(const std::filesystem::path& path);
[[nodiscard]] std::string readText(const std::filesystem::path& path);
void writeText(const std::filesystem::path& path, const std::string& text);
[[nodiscard]] inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// SHA-256 of every file under a folder whose bytes must be equal between equal runs, by name:
/// without provenance.json and the outputs that it calls varying.
[[nodiscard]] std::map<std::string, std::string> stableHashes(const std::filesystem::path& folder);

}  // namespace explica::testing
