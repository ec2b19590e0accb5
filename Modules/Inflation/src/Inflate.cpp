// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Inflate.h"

#include "Looks.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Inflation/DirectionField.h"
#include "Explica/Visibility/SphereView.h"

#include <algorithm>
#include <cmath>

namespace explica::inflation {
namespace {

constexpr double kLargestDrive = 4;       // lengths and contacts are outweighed up to here
constexpr double kAreaTolerance = 0.008;  // mean relative error of faces at the goal
constexpr double kSlowGain = 0.004;  // of visibility between two looks: slower is driven harder ...
constexpr double kSettled = 0.001;   // ... and, once that ends, given up
constexpr std::size_t kSettledLooks = 4;  // over which that is measured

void requireUsable(const TriangleMesh& mesh, const InflateOptions& options) {
  geometry::requireClosedManifold(mesh, "surface");
  const auto components = geometry::faceComponents(mesh.faces, mesh.vertexCount());
  const auto last = std::ranges::max_element(components);
  if (last != components.end() && *last > 0) {
    throw InvalidInput("surface: it has " + std::to_string(*last + 1) +
                       " pieces that do not hang together; inflate each by itself");
  }
  if (!(options.targetSeen > 0 && options.targetSeen <= 1)) {
    throw InvalidInput("target-seen: must be above 0 and at most 1");
  }
  if (!(options.smoothing > 0)) throw InvalidInput("smoothing: must be positive");
  if (options.lookEvery < 1) throw InvalidInput("look-every: must be positive");
  if (options.viewpoints < 1) throw InvalidInput("viewpoints: must be positive");
  if (options.maxIterations < 1) throw InvalidInput("max-iterations: must be positive");
  if (options.frames < 0) throw InvalidInput("frames: must not be negative");
}

unfolding::Region wholeOf(const TriangleMesh& mesh) {
  unfolding::Region region;
  region.faces = mesh.allFaces();
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (const std::int32_t v : mesh.faces.reshaped()) used[v] = true;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (used[v]) region.vertices.push_back(v);
  }
  return region;
}

unfolding::UnfolderOptions solverOptions(const InflateOptions& options) {
  unfolding::UnfolderOptions solver;
  solver.surround = unfolding::Surround::None;
  solver.contactRange = options.contactRange;
  solver.yieldStrain = kInfinity;  // strain is spread, so that curvature is
  solver.weights[unfolding::Term::Spring] = options.springWeight;
  solver.weights[unfolding::Term::Area] = options.areaWeight;
  for (const unfolding::TermInfo& info : unfolding::kTerms) {
    if (!info.closed) solver.weights[info.term] = 0;
  }
  return solver;
}

/// What to aim at for a goal: a little beyond, since areas that are still off cost visibility.
double aimFor(double goal) {
  constexpr double kBeyond = 0.2;  // of what the goal leaves
  return goal + kBeyond * (1 - goal);
}

/// How much harder to drive: more the farther the aim is.
double driveFactor(double visibility, double aim) {
  return std::clamp(1 + 30 * (aim - visibility), 1.1, 1.5);
}

/// An inflation under way.
class Inflation {
 public:
  Inflation(const TriangleMesh& mesh, const InflateOptions& options, const Monitor& monitor)
      : options_(options),
        monitor_(monitor),
        unfolder_(mesh, wholeOf(mesh), visibility::enclosingSphere(mesh, 1),
                  solverOptions(options)),
        field_(mesh, options.smoothing * std::sqrt(geometry::totalArea(mesh) / (4 * kPi))) {}

  void begin() {
    look();
    history_.push_back(unfolder_.record());
    keepPath();
  }

  void resume(const unfolding::Checkpoint& from) {
    looks_ = looksFrom(from.notes);
    unfolder_.restore(from.state);
    history_ = from.history;
    path_ = from.path;
    keepPath();
  }

  void run() {
    const double earlier = history_.back().seconds;
    while ((termination_ = reasonToStop()) == Termination::NotRun) {
      const unfolding::UnfoldState last = unfolder_.state();
      try {
        const StopScope abandoned(&monitor_);
        if (!unfolder_.step()) {
          termination_ = Termination::Stalled;
          break;
        }
        if (unfolder_.state().iteration % options_.lookEvery == 0) look();
      } catch (const Interrupted&) {
        unfolder_.restore(last);
        termination_ = Termination::Interrupted;
        break;
      }
      history_.push_back(unfolder_.record());
      history_.back().seconds = earlier + elapsed_();
      keepPath();
      tellProgress();
    }
    // What is given back is looked at, too; the run goes on, if it is resumed, from its own looks.
    ending_ = looks_;
    if (ending_.back().iteration != unfolder_.state().iteration &&
        termination_ != Termination::Interrupted) {
      ending_.push_back(lookNow().first);
    }
  }

  InflateResult result() const {
    InflateResult result;
    result.mesh = unfolder_.current();
    result.termination = termination_;
    result.history = withLooks(history_, ending_);
    result.frames = framesAlong(path_, ending_, options_.frames);
    result.checkpoint.state = unfolder_.state();
    result.checkpoint.history = history_;
    result.checkpoint.path = path_;
    result.checkpoint.notes = notesOf(looks_);
    return result;
  }

 private:
  [[nodiscard]] std::pair<Look, Positions> lookNow() const {
    const TriangleMesh now = unfolder_.current();
    visibility::SphereView view =
        visibility::lookFromSphere(now, visibility::enclosingSphere(now, options_.viewpoints));
    return {{unfolder_.state().iteration, view.visibility, view.seenShare},
            std::move(view.direction)};
  }

  /// Looks from the sphere, gives faces their directions, and drives harder where that is needed.
  void look() {
    auto [now, directions] = lookNow();
    unfolder_.setDirections(field_.spread(directions));
    const double aim = aimFor(options_.targetSeen), drive = unfolder_.state().drive;
    const bool slow = !looks_.empty() && now.visibility - looks_.back().visibility < kSlowGain;
    if (slow && now.visibility < aim && drive < kLargestDrive) {
      unfolder_.raiseDrive(std::min(driveFactor(now.visibility, aim), kLargestDrive / drive));
    }
    looks_.push_back(now);
  }

  void keepPath() {
    if (options_.frames == 0) return;
    const auto count = static_cast<std::size_t>(unfolder_.state().iteration) + 1;
    if (path_.size() < count) path_.push_back(unfolder_.state().positions);
  }

  [[nodiscard]] Termination reasonToStop() const {
    const int iteration = unfolder_.state().iteration;
    const bool kept = unfolder_.record().areaErrorMean <= kAreaTolerance;
    if (looks_.back().iteration == iteration && kept) {
      if (looks_.back().visibility >= options_.targetSeen) return Termination::TargetReached;
      if (isSettled()) return Termination::Stalled;
    }
    if (iteration >= options_.maxIterations) return Termination::MaxIterations;
    if (monitor_.shouldStop()) return Termination::Interrupted;
    return Termination::NotRun;
  }

  /// True if the strongest drive brings the visibility no further.
  [[nodiscard]] bool isSettled() const {
    if (unfolder_.state().drive < kLargestDrive || looks_.size() <= kSettledLooks) return false;
    const double before = looks_[looks_.size() - 1 - kSettledLooks].visibility;
    return looks_.back().visibility - before < kSettled;
  }

  void tellProgress() const {
    const unfolding::IterationRecord& now = unfolder_.record();
    const double first = looks_.front().visibility, last = looks_.back().visibility;
    const double way = std::max(options_.targetSeen - first, 1e-6);
    monitor_.progress(std::clamp((last - first) / way, 0.0, 1.0),
                      printed("iteration %d: visibility %.4f, area error %.2f %%", now.iteration,
                              last, 100 * now.areaErrorMean));
  }

  const InflateOptions& options_;
  const Monitor& monitor_;
  Stopwatch elapsed_;
  unfolding::Unfolder unfolder_;
  DirectionField field_;
  std::vector<unfolding::IterationRecord> history_;
  std::vector<Look> looks_, ending_;
  std::vector<Positions> path_;  ///< if frames are asked for
  Termination termination_ = Termination::NotRun;
};

constexpr double kHeldBelow = 0.1;  // of visibility: so far below what was to be seen it is held

/// Says what a user must know about the result.
void judge(const InflateOptions& options, const Monitor& monitor, InflateResult& result) {
  const InflateRecord &first = result.history.front(), &last = result.history.back();
  if (last.step.iteration > 0 && last.visibility < first.visibility - unfolding::kAccuracy) {
    result.flag = unfolding::Flag::Worse;
    monitor.warn(printed("the visibility fell from %.3f to %.3f: nothing is opened",
                         first.visibility, last.visibility));
  } else if (result.termination == Termination::Stalled &&
             last.visibility < options.targetSeen - kHeldBelow) {
    result.flag = unfolding::Flag::Held;
    monitor.warn(
        printed("the surface is held at a visibility of %.3f: areas and lengths kept, it does not "
                "open further",
                last.visibility));
  } else {
    return;
  }
  if (result.termination == Termination::TargetReached) result.termination = Termination::Stalled;
}

}  // namespace

InflateResult inflate(const TriangleMesh& mesh, const InflateOptions& options,
                      const Monitor& monitor, const unfolding::Checkpoint* resume) {
  requireUsable(mesh, options);
  const Point origin = unfolding::originNear(mesh.positions.colwise().mean().transpose());
  TriangleMesh work = mesh;
  work.positions.rowwise() -= origin.transpose();
  // Inside out, as the mirror image of a surface is: faces look outward while it is inflated.
  geometry::turnOutward(work);
  const StopScope abandoned(&monitor);  // until there is a state
  Inflation inflation(work, options, monitor);
  if (resume != nullptr) {
    inflation.resume(*resume);
  } else {
    inflation.begin();
  }
  const StopScope kept(nullptr);
  inflation.run();
  InflateResult result = inflation.result();
  judge(options, monitor, result);
  result.mesh.faces = mesh.faces;
  result.mesh.positions.rowwise() += origin.transpose();
  for (InflateFrame& frame : result.frames) frame.positions.rowwise() += origin.transpose();
  return result;
}

}  // namespace explica::inflation
