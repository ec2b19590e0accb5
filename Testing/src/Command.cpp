// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Testing/Command.h"

#include "Explica/Provenance/Digest.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace explica::testing {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::ostream& operator<<(std::ostream& stream, const CommandResult& result) {
  return stream << "exit code " << result.exitCode << "\nstandard output:\n"
                << result.out << "\nstandard error:\n"
                << result.err;
}

CommandResult runProgram(const std::vector<std::string>& words, const CommandSetting& setting) {
  int outPipe[2], errPipe[2];
  if (pipe2(outPipe, O_CLOEXEC) != 0 || pipe2(errPipe, O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::vector<char*> argv;
  for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    dup2(outPipe[1], STDOUT_FILENO);
    dup2(errPipe[1], STDERR_FILENO);
    for (const auto& [name, value] : setting.environment) {
      if (value.empty()) {
        unsetenv(name.c_str());
      } else {
        setenv(name.c_str(), value.c_str(), 1);
      }
    }
    if (setting.fileSizeLimit) {
      const rlimit limit{*setting.fileSizeLimit, *setting.fileSizeLimit};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (!setting.directory.empty() && chdir(setting.directory.c_str()) != 0) _exit(126);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(outPipe[1]);
  close(errPipe[1]);

  CommandResult result;
  const auto begin = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  bool signalSent = !setting.signal;
  pollfd ends[2] = {{outPipe[0], POLLIN, 0}, {errPipe[0], POLLIN, 0}};
  std::string* texts[2] = {&result.out, &result.err};
  int open = 2;
  while (open > 0) {
    poll(ends, 2, 2);
    for (int i = 0; i < 2; ++i) {
      if (ends[i].fd < 0 || !(ends[i].revents & (POLLIN | POLLHUP))) continue;
      char buffer[4096];
      const ssize_t count = read(ends[i].fd, buffer, sizeof buffer);
      if (count > 0) {
        texts[i]->append(buffer, static_cast<std::size_t>(count));
      } else {
        close(ends[i].fd);
        ends[i].fd = -1;
        --open;
      }
    }
    if (!signalSent && seconds() > setting.signalAfter &&
        result.err.find(setting.signalWhen) != std::string::npos) {
      kill(child, *setting.signal);
      signalSent = true;
    }
    if (seconds() > setting.timeout) kill(child, SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

bool overran(const CommandResult& result) {
  return result.exitCode == 4 &&
         result.err.find("did not come to a stop after --max-time") != std::string::npos;
}

CommandResult explica(const std::vector<std::string>& words, const CommandSetting& setting) {
  std::vector<std::string> all = {EXPLICA_EXECUTABLE};
  all.insert(all.end(), words.begin(), words.end());
  return runProgram(all, setting);
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "explica-test-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::entries() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(path_)) {
    names.push_back(entry.path().lexically_relative(path_).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string readText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

nlohmann::ordered_json readJson(const fs::path& path) {
  return nlohmann::ordered_json::parse(readText(path));
}

void writeText(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::map<std::string, std::string> stableHashes(const fs::path& folder) {
  std::set<fs::path> varying;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files.push_back(entry.path());
    if (entry.path().filename() != "provenance.json") continue;
    varying.insert(entry.path());
    const auto record = readJson(entry.path());
    for (const auto& output : record["execution"]["varying_outputs"]) {
      varying.insert(entry.path().parent_path() / output["path"].get<std::string>());
    }
  }
  std::map<std::string, std::string> hashes;
  for (const auto& file : files) {
    if (varying.count(file)) continue;
    hashes[file.lexically_relative(folder).string()] = provenance::digestOf(file).sha256;
  }
  return hashes;
}

}  // namespace explica::testing
