// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Film.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Report/Film.h"
#include "OpenedFolders.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <string>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr report::Colour kInside = {0.74F, 0.31F, 0.09F};
constexpr report::Colour kOutside = {0.60F, 0.58F, 0.55F};

std::vector<fs::path> framesOf(const fs::path& folder) {
  std::vector<fs::path> files = pipeline::frameFiles(folder);
  if (files.empty()) {
    throw InvalidInput(folder.string() +
                       ": holds no frames/frame-*.surf.gii; unfold with --frames");
  }
  return files;
}

std::string captionOf(const Json& summary, std::size_t frame, std::size_t count) {
  const double visibility = pipeline::frameVisibility(summary, frame);
  if (!std::isfinite(visibility)) return "";
  std::string caption = printed("average visibility %.2f", visibility);
  if (frame + 1 == count && summary.contains("area_error_mean")) {
    caption += printed("   areas kept to %.2g %%", 100 * summary.value("area_error_mean", kNaN));
  }
  return caption;
}

/// From the unfolding's own viewpoint, where its summary tells it.
report::FigureView fromViewpoint(const Json& summary, const TriangleMesh& mesh,
                                 const std::vector<std::int32_t>& region) {
  report::FigureView view;
  const auto viewpoint = pipeline::pointIn(summary, "viewpoint");
  if (!viewpoint) return view;
  Point middle = Point::Zero();
  for (const std::int32_t v : region) middle += mesh.positions.row(v).transpose();
  middle /= std::max<double>(1, static_cast<double>(region.size()));
  view.towards = middle - *viewpoint;
  return view;
}

/// Sends the pictures to ffmpeg's standard input.
void encodeByFfmpeg(const fs::path& path, const std::vector<report::Picture>& frames, double fps) {
  const report::Picture& first = frames.front();
  const int width = first.width / 2 * 2, height = first.height / 2 * 2;  // as its codecs want
  const std::string size = std::to_string(first.width) + "x" + std::to_string(first.height);
  const std::string crop = "crop=" + std::to_string(width) + ":" + std::to_string(height) + ":0:0";
  const std::string rate = std::to_string(fps);
  const char* codec = path.extension() == ".webm" ? "libvpx-vp9" : "libx264";
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw EnvironmentError("film: no pipe could be made");
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[0], STDIN_FILENO);
    close(ends[0]);
    close(ends[1]);
    execlp("ffmpeg", "ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
           "-s", size.c_str(), "-r", rate.c_str(), "-i", "-", "-vf", crop.c_str(), "-c:v", codec,
           "-pix_fmt", "yuv420p", path.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(ends[0]);
  const auto before = std::signal(SIGPIPE, SIG_IGN);  // NOLINT: its failure is seen by write()
  for (const report::Picture& frame : frames) {
    std::size_t sent = 0;
    while (sent < frame.rgb.size()) {
      const ssize_t now = write(ends[1], frame.rgb.data() + sent, frame.rgb.size() - sent);
      if (now <= 0) break;
      sent += static_cast<std::size_t>(now);
    }
  }
  close(ends[1]);
  std::signal(SIGPIPE, before);
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) throw EnvironmentError("film: ffmpeg could not write " + path.string());
}

}  // namespace

TriangleMesh firstFrame(const fs::path& folder) {
  return io::readSurface(framesOf(folder).front()).mesh;
}

std::vector<report::Picture> drawFilm(const fs::path& folder,
                                      const std::optional<report::SurfacePaint>& paint,
                                      std::vector<report::FigureView> views, int columns,
                                      bool focus, const report::SurfacePictureOptions& options) {
  const Json summary = summaryOf(folder);
  const std::vector<fs::path> files = framesOf(folder);
  std::vector<report::FilmFrame> frames;
  for (std::size_t n = 0; n < files.size(); ++n) {
    frames.push_back({io::readSurface(files[n]).mesh, captionOf(summary, n, files.size())});
  }
  const Eigen::Index vertices = frames.front().mesh.vertexCount();
  report::FilmLook look;
  const std::vector<std::int32_t> region = pipeline::unfoldedRegion(folder, vertices);
  if (paint) {
    look.colours = report::coloursOf(*paint, vertices);
    look.filling = paint->values.size() == 0 ? report::Filling::Discrete : report::Filling::Smooth;
  } else if (!region.empty()) {
    look.colours.assign(static_cast<std::size_t>(vertices), kOutside);
    look.keys.assign(static_cast<std::size_t>(vertices), 0);
    for (const std::int32_t v : region) {
      look.colours[v] = kInside;
      look.keys[v] = 1;
    }
    look.filling = report::Filling::Discrete;
  }
  if (views.empty()) views = {fromViewpoint(summary, frames.front().mesh, region)};
  std::vector<std::vector<report::Picture>> bySide;
  for (const report::FigureView& view : views) {
    look.view = view;
    if (focus) look.view.focus = region;
    bySide.push_back(report::filmPictures(frames, look, options));
  }
  std::vector<report::Picture> pictures;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    std::vector<report::Picture> beside;
    for (auto& side : bySide) beside.push_back(std::move(side[n]));
    pictures.push_back(beside.size() == 1 ? std::move(beside.front())
                                          : report::tilePictures(beside, columns));
  }
  return pictures;
}

void requireFilmFormat(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".gif") return;
  if (ending != ".mp4" && ending != ".webm") {
    throw UsageError("--film " + path.string() + ": expected a name ending in .gif, .mp4 or .webm");
  }
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) {  // NOLINT: no words of the user
    throw EnvironmentError("film: ffmpeg is not installed; write a .gif, or install ffmpeg");
  }
}

void writeFilm(const fs::path& path, const std::vector<report::Picture>& frames,
               double framesPerSecond) {
  const std::string ending = path.extension().string();
  if (ending == ".mp4" || ending == ".webm") {
    fs::path unfinished = path;
    unfinished.replace_filename("." + path.stem().string() + ".unfinished" + ending);
    try {
      encodeByFfmpeg(unfinished, frames, framesPerSecond);
      fs::rename(unfinished, path);
    } catch (...) {
      std::error_code ignored;
      fs::remove(unfinished, ignored);
      throw;
    }
    return;
  }
  WholeFile file(path);
  file.write(report::encodeGif(frames, framesPerSecond));
  file.commit();
}

}  // namespace explica::app
