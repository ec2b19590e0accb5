// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Steer.h"

#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Picture.h"
#include "Explica/Viewer/Window.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <future>
#include <vector>

namespace explica::app {
namespace {

/// Runs this program with other words and waits for its end.
/// @return its exit code, or -1 if it could not be started
int runSelf(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, "/proc/self/exe", nullptr, nullptr, argv.data(), environ) != 0) return -1;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Colours as in the pictures of `explica view --screenshot`.
std::vector<viewer::Rgb> paintOf(const std::string& name, const Eigen::VectorXd& values) {
  std::vector<viewer::Rgb> bytes;
  for (const report::Colour& colour :
       report::coloursOf(values, report::scaleFor(values, name, ""))) {
    viewer::Rgb rgb;
    for (int c = 0; c < 3; ++c) {
      rgb[c] = report::encodeSrgb(colour[c]);
    }
    bytes.push_back(rgb);
  }
  return bytes;
}

}  // namespace

void steer(Context& context, const std::string& path, const TriangleMesh& surface,
           const Vector& direction, const std::vector<io::VertexMap>& maps,
           const SteerOptions& options) {
  viewer::Session session(surface);
  viewer::Choice choice;
  choice.centre = options.vertex.value_or(-1);
  choice.radius = options.radius;
  choice.direction = direction;
  choice.distance = options.distance;
  choice.unfolder.surround = options.surround;
  session.choose(choice);

  const auto save = [&](const viewer::Session& shown, std::size_t moment) {
    const std::string out = options.save + "/iteration-" + std::to_string(moment);
    std::vector<std::string> words = {"explica", "unfold",  path,     "--out",
                                      out,       "--force", "--quiet"};
    for (const auto& [name, value] : shown.batchOptions(moment)) {
      words.push_back("--" + name);
      words.push_back(value);
    }
    std::string command;
    for (const std::string& word : words) command += (command.empty() ? "" : " ") + word;
    context.info("saving, the same as: " + command);
    return std::async(std::launch::async, [words, out] {
      const int code = runSelf(words);
      // 3 says that the iteration limit was reached before full visibility, which is what is asked
      // for.
      return code == 0 || code == 3
                 ? "saved in " + out
                 : "not saved: explica unfold ended with " + std::to_string(code);
    });
  };
  viewer::WindowOptions window;
  window.title = "Explica: " + path;
  window.script = options.script;
  for (const io::VertexMap& map : maps) {
    window.maps.push_back({map.unit.empty() ? map.name : map.name + ", " + map.unit, map.values});
  }
  viewer::showWindow(session, paintOf, save, window);
}

}  // namespace explica::app
