// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Steer.h"

#include "Explica/Core/Text.h"
#include "Explica/Unfolding/Region.h"
#include "Explica/Viewer/Window.h"
#include "OpenedFiles.h"
#include "WindowProgram.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <future>
#include <vector>

namespace explica::app {
namespace {

/// Runs explica with these words and waits for its end.
/// @return its exit code, or -1 if it could not be started
int runExplica(std::vector<std::string> words) {
  const std::string program = mainProgram();
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ) != 0) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

using CommandOptions = std::vector<std::pair<std::string, std::string>>;

/// Options of `explica unfold` that differ from their defaults.
CommandOptions optionsOf(const io::SurfaceReadOptions& reading) {
  CommandOptions options;
  if (reading.space != io::SurfaceSpace::Stated) {
    options.emplace_back("surface-space", std::string(nameOf(reading.space)));
  }
  if (reading.fsVolume) options.emplace_back("fs-volume", *reading.fsVolume);
  return options;
}

/// Writes the state that is shown as `explica unfold` would, from where it stands: the command goes
/// on from a checkpoint and finds nothing left to do.
std::future<std::string> saveState(Context& context, const std::string& surface,
                                   const CommandOptions& reading, const std::string& folder,
                                   const viewer::Session& session, std::size_t state) {
  const auto checkpoint = session.checkpoint(state);
  if (!checkpoint) {
    std::promise<std::string> answer;
    answer.set_value("this unfolding is saved already: it was opened from a folder");
    return answer.get_future();
  }
  const std::string out = folder + "/iteration-" + std::to_string(state);
  std::vector<std::string> words = {"explica", "unfold", surface, "--out", out};
  for (const auto& options : {session.batchOptions(state), reading}) {
    for (const auto& [name, value] : options) {
      words.push_back("--" + name);
      words.push_back(value);
    }
  }
  context.info("saving, the same as: " + joined(words, " "));
  std::filesystem::remove_all(out);
  std::filesystem::create_directories(out);
  unfolding::writeCheckpoint(std::filesystem::path(out) / "unfolding.state", *checkpoint);
  words.insert(words.end(), {"--resume", "--quiet"});
  return std::async(std::launch::async, [words, out] {
    const int code = runExplica(words);
    // 3 says that the limit of iterations was reached first, which is what is asked for.
    return code == 0 || code == 3 ? "saved in " + out
                                  : "not saved: explica unfold ended with " + std::to_string(code);
  });
}

}  // namespace

void steer(Context& context, const ShownSurface& surface, const io::SurfaceReadOptions& reading,
           const Vector& direction, std::vector<viewer::Opened> opened, const SteerOptions& options,
           const ShowWindow& show) {
  const std::string& path = surface.file;
  viewer::Session session(surface.mesh);
  viewer::Choice choice;
  choice.centre = options.vertex.value_or(-1);
  choice.radius = options.radius;
  choice.view.direction = direction;
  choice.view.distance = options.distance.value_or(unfolding::usualDistance(surface.mesh));
  choice.unfold.unfolder.surround = options.surround;
  choice.unfold.targetVisibility = options.targetVisibility;
  session.choose(choice);

  viewer::WindowOptions window{.title = "Explica: " + path,
                               .surface = path,
                               .reading = optionsOf(reading),
                               .opened = std::move(opened),
                               .script = options.script};
  viewer::WindowCalls calls;
  calls.open = [&](const std::string& file) { return openForWindow(file, surface); };
  calls.save = [&](const viewer::Session& shown, std::size_t state) {
    return saveState(context, path, window.reading, options.save, shown, state);
  };
  show(session, calls, window);
}

}  // namespace explica::app
