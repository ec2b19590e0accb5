// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Report/Figure.h"
#include "ReportParts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFrames = 26;  // in the interactive view: a page stays below 15 MB
constexpr std::size_t kFewFrames = 16;   // where several patches share the page

/// An unfolding's surfaces: where it began, the states on the way, and the region.
struct Unfolded {
  std::optional<TriangleMesh> whole;  ///< the surface that the region is of, if it is still there
  std::vector<TriangleMesh> frames;   ///< from the start to the end
  std::vector<std::string> titles;    ///< of the frames
  std::vector<std::int32_t> region;   ///< vertices
  bool detached = false;              ///< the region was unfolded alone
  std::optional<Point> viewpoint;
};

/// Frames of an unfolding, evenly thinned to `most`, the first and last kept.
std::vector<fs::path> fewFrames(const fs::path& folder, std::size_t most) {
  const std::vector<fs::path> all = frameFiles(folder);
  if (all.size() <= most) return all;
  std::vector<fs::path> some;
  for (std::size_t f = 0; f < most; ++f) some.push_back(all[f * (all.size() - 1) / (most - 1)]);
  return some;
}

/// "frame 12, visibility 0.834".
std::string titleOf(const fs::path& frame, const Json& summary) {
  const std::string stem = frame.filename().string();
  std::size_t number = 0;
  try {
    number = std::stoul(stem.substr(6));
  } catch (const std::exception&) {
    return stem;
  }
  std::string title = "frame " + std::to_string(number);
  if (const double visibility = frameVisibility(summary, number); std::isfinite(visibility)) {
    title += printed(", visibility %.3f", visibility);
  }
  return title;
}

Point centreOf(const TriangleMesh& mesh, const std::vector<std::int32_t>& vertices) {
  Point middle = Point::Zero();
  for (const std::int32_t v : vertices) middle += mesh.positions.row(v).transpose();
  return middle / std::max<double>(1, static_cast<double>(vertices.size()));
}

/// As the run says; records of older versions give the direction alone.
std::optional<Point> viewpointOf(const StepFolder& step, const Unfolded& unfolded) {
  const Json options = step.record.value("options", Json::object());
  if (const auto used = pointIn(step.summary, "viewpoint")) return used;
  if (const auto given = pointIn(options, "viewpoint")) return given;
  const auto direction = pointIn(options, "direction");
  if (!direction || !(direction->norm() > 0) || unfolded.frames.empty()) return {};
  return centreOf(unfolded.frames.front(), unfolded.region) +
         options.value("distance", 1000.0) * direction->normalized();
}

Unfolded readUnfolded(const StepFolder& step, std::size_t mostFrames) {
  Unfolded unfolded;
  const auto source = inputOf(step, "SURFACE");
  if (source && isThere(*source)) unfolded.whole = io::readSurface(*source).mesh;
  ShownFrames frames = framesOf(step, mostFrames);
  unfolded.frames = std::move(frames.meshes);
  unfolded.titles = std::move(frames.titles);
  const TriangleMesh after = io::readSurface(step.folder / "unfolded.surf.gii").mesh;
  if (unfolded.frames.empty()) {
    if (unfolded.whole && unfolded.whole->vertexCount() == after.vertexCount()) {
      unfolded.frames.push_back({unfolded.whole->positions, after.faces});
      unfolded.titles.emplace_back("before");
    }
    unfolded.frames.push_back(after);
    unfolded.titles.emplace_back("after");
  }
  if (unfolded.whole && unfolded.whole->vertexCount() != after.vertexCount())
    unfolded.whole.reset();
  unfolded.detached = unfolded.whole && unfolded.whole->faceCount() > after.faceCount();
  unfolded.region = unfoldedRegion(step.folder);
  unfolded.viewpoint = viewpointOf(step, unfolded);
  return unfolded;
}

/// The part's faces, and those of the whole that touch no vertex of the part.
Faces withSurroundings(const Faces& part, const TriangleMesh& whole) {
  std::vector<bool> inPart(static_cast<std::size_t>(whole.vertexCount()), false);
  for (const std::int32_t v : part.reshaped()) inPart[v] = true;
  Faces faces(part.rows() + whole.faceCount(), 3);
  faces.topRows(part.rows()) = part;
  Eigen::Index count = part.rows();
  for (Eigen::Index f = 0; f < whole.faceCount(); ++f) {
    if (inPart[whole.faces(f, 0)] || inPart[whole.faces(f, 1)] || inPart[whole.faces(f, 2)])
      continue;
    faces.row(count++) = whole.faces.row(f);
  }
  faces.conservativeResize(count, 3);
  return faces;
}

/// Maps of the unfolding mean something in its region only.
void addOwnMaps(const StepFolder& step, const Unfolded& unfolded, report::Evolution& evolution) {
  std::vector<bool> inRegion(static_cast<std::size_t>(evolution.mesh.vertexCount()), false);
  for (const std::int32_t v : unfolded.region) inRegion[v] = true;
  for (const char* file : {"visibility.shape.gii", "distortion.shape.gii"}) {
    if (!step.has(file)) continue;
    for (io::VertexMap& map :
         io::readVertexMaps(step.folder / file, evolution.mesh.vertexCount())) {
      for (Eigen::Index v = 0; v < map.values.size(); ++v) {
        if (!inRegion[v]) map.values[v] = kNaN;
      }
      evolution.maps.push_back(
          {map.values, report::scaleFor(map.values, mapWords(map.name), map.unit)});
    }
  }
}

/// The patch opens on its hemisphere, where the page shows that; else it is shown by itself.
void joinTheBrain(std::vector<report::Evolution>& shown, const std::string& side,
                  report::Evolution patch) {
  const auto brain = std::ranges::find_if(shown, [&](const report::Evolution& one) {
    return !one.shapes.empty() && one.title == side && one.frames.empty() && !patch.detached &&
           one.mesh.faces.rows() == patch.mesh.faces.rows() &&
           one.mesh.vertexCount() == patch.mesh.vertexCount();
  });
  if (brain == shown.end()) {
    shown.push_back(std::move(patch));
    return;
  }
  brain->moved = std::move(patch.moved);
  brain->frames = std::move(patch.frames);
  brain->frameTitles = std::move(patch.frameTitles);
  brain->region = std::move(patch.region);
  brain->viewpoint = patch.viewpoint;
  for (report::EvolutionMap& map : patch.maps) {
    const bool known = std::ranges::any_of(
        brain->maps, [&](const auto& other) { return other.scale.title == map.scale.title; });
    if (!known) brain->maps.push_back(std::move(map));
  }
}

/// What the patch is coloured by in the pictures before and after, and what they are called.
struct PatchPaint {
  std::string id, title, caption;
  report::SurfacePaint paint;
};

/// Sulci painted on the surface show on the opened patch what was folded; without a curvature the
/// patch itself is coloured.
PatchPaint foldsOf(const Unfolded& unfolded, Eigen::Index vertexCount, const StepFolder* surface,
                   const std::string& side) {
  PatchPaint folds{kPatchViewsPlace,
                   "The patch" + (side.empty() ? "" : " on the " + side) + " before and after",
                   "",
                   {}};
  const auto curvature = surface != nullptr
                             ? mapNamed(surface->folder / "curvature.shape.gii", vertexCount)
                             : std::nullopt;
  folds.caption =
      std::string("From the viewpoint and from the side, to one scale, the patch's rim dark: ") +
      (curvature ? "gyri blue, sulci brown." : "the patch coloured, its surroundings pale.");
  report::SurfacePaint& paint = folds.paint;
  paint.region.setZero(vertexCount);
  for (const std::int32_t v : unfolded.region) paint.region[v] = 1;
  if (curvature) {
    paint.values = curvature->values;
    paint.scale = report::scaleFor(paint.values, curvature->name, curvature->unit,
                                   report::ColourMap::Diverging);
  } else {
    paint.labels = paint.region;
  }
  return folds;
}

PatchPaint paintOf(const Unfolded& unfolded, const GivenMap& map) {
  PatchPaint given{"",
                   map.name + " on the patch before and after",
                   "From the viewpoint and from the side, with the same colours; what lies off the "
                   "patch is pale, what is not known grey.",
                   {}};
  given.paint.region.setZero(map.values.size());
  for (const std::int32_t v : unfolded.region) given.paint.region[v] = 1;
  given.paint.values = map.values;
  Eigen::VectorXd onPatch(static_cast<Eigen::Index>(unfolded.region.size()));
  for (std::size_t n = 0; n < unfolded.region.size(); ++n) {
    onPatch[n] = map.values[unfolded.region[n]];
  }
  given.paint.scale = report::scaleFor(onPatch, map.name, map.unit);
  return given;
}

/// Scenes and cameras for pictures of the patch before and after.
class PatchPictures {
 public:
  explicit PatchPictures(const Unfolded& unfolded)
      : unfolded_(unfolded),
        before_(unfolded.whole ? *unfolded.whole : unfolded.frames.front()),
        after_(unfolded.frames.back()),
        sceneBefore_(before_),
        sceneAfter_(after_) {
    front_.towards = (centreOf(before_, unfolded.region) - *unfolded.viewpoint).normalized();
    front_.focus = unfolded.region;
    side_ = front_;
    const Vector across = front_.towards.cross(Vector(0, 0, 1));
    side_.towards =
        front_.towards + 1.7 * (across.norm() > 1e-3 ? across.normalized() : Vector(1, 0, 0));
  }

  /// From the viewpoint and from the side, filled by the region.
  [[nodiscard]] report::ReportViews draw(const PatchPaint& painted) const {
    const auto colours = report::coloursOf(painted.paint, before_.vertexCount());
    const bool smooth = painted.paint.values.size() > 0;
    const std::vector<std::int32_t> rim(painted.paint.region.begin(), painted.paint.region.end());
    report::SurfacePictureOptions size{.width = 360, .height = 280};
    report::ReportViews views;
    views.id = painted.id;
    views.title = painted.title;
    views.caption = painted.caption;
    if (unfolded_.detached) {
      views.caption += " It was unfolded alone, and is drawn apart from the surface.";
    }
    for (const bool folded : {true, false}) {
      for (const report::FigureView* view : {&front_, &side_}) {
        views.views.push_back(
            {std::string(folded ? "before" : "after") +
                 (view == &front_ ? ", from the viewpoint" : ", from the side"),
             (folded ? sceneBefore_ : sceneAfter_)
                 .render(cameraFor(folded, *view, size), colours,
                         smooth ? report::Filling::Smooth : report::Filling::Discrete, size, rim)});
      }
    }
    if (smooth) views.scale = painted.paint.scale;
    return views;
  }

 private:
  /// On the patch, before and after to one scale.
  [[nodiscard]] report::Camera cameraFor(bool folded, const report::FigureView& view,
                                         const report::SurfacePictureOptions& size) const {
    report::Camera before = report::cameraOf(before_, view, size.width, size.height);
    report::Camera after = report::cameraOf(after_, view, size.width, size.height);
    before.halfHeight = after.halfHeight = std::max(before.halfHeight, after.halfHeight);
    return folded ? before : after;
  }

  const Unfolded& unfolded_;
  const TriangleMesh& before_;
  const TriangleMesh& after_;
  report::SurfaceScene sceneBefore_, sceneAfter_;
  report::FigureView front_, side_;
};

void drawBeforeAndAfter(ResultFolder& results, const Unfolded& unfolded, const StepFolder* surface,
                        const std::string& side, const std::vector<const GivenMap*>& maps) {
  const PatchPictures pictures(unfolded);
  const Eigen::Index count = unfolded.frames.front().vertexCount();
  results.content().views.push_back(pictures.draw(foldsOf(unfolded, count, surface, side)));
  for (const GivenMap* map : maps) {
    results.content().views.push_back(pictures.draw(paintOf(unfolded, *map)));
  }
}

}  // namespace

ShownFrames framesOf(const StepFolder& step, std::size_t most) {
  ShownFrames frames;
  for (const fs::path& file : fewFrames(step.folder, most)) {
    frames.meshes.push_back(io::readSurface(file).mesh);
    frames.titles.push_back(titleOf(file, step.summary));
  }
  return frames;
}

void showUnfolding(ResultFolder& results, const StepFolder& step,
                   const std::vector<GivenMap>& maps) {
  const std::size_t patches = results.stepsOf("unfold").size();
  const Unfolded unfolded = readUnfolded(step, patches > 1 ? kFewFrames : kMostFrames);
  report::Evolution evolution = report::evolutionOf(unfolded.frames);
  evolution.frameTitles = unfolded.titles;
  evolution.region = unfolded.region;
  evolution.detached = unfolded.detached;
  evolution.viewpoint = unfolded.viewpoint;
  if (unfolded.detached) {
    evolution.mesh.faces = withSurroundings(evolution.mesh.faces, *unfolded.whole);
    evolution.mesh.positions = unfolded.whole->positions;
  }
  const StepFolder* surface = results.beside(step, "surface");
  results.attempt("Maps of the unfolding", [&] { addOwnMaps(step, unfolded, evolution); });
  std::vector<const GivenMap*> fitting;
  for (const GivenMap& map : maps) {
    if (!map.fits(evolution.mesh.vertexCount(), step.side())) continue;
    fitting.push_back(&map);
    evolution.maps.push_back({map.values, report::scaleFor(map.values, map.name, map.unit)});
  }
  if (!unfolded.region.empty() && unfolded.viewpoint) {
    results.attempt("Before and after",
                    [&] { drawBeforeAndAfter(results, unfolded, surface, step.side(), fitting); });
  }
  evolution.title = titleOf(step.name);
  joinTheBrain(results.content().evolutions, step.side(), std::move(evolution));
}

}  // namespace explica::pipeline
