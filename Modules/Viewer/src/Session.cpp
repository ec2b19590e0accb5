// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Viewer/Session.h"

#include "Explica/Collision/Untangling.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Continuation.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <atomic>
#include <charconv>
#include <mutex>
#include <thread>
#include <utility>

namespace explica::viewer {
namespace {

/// Shortest text that gives the same double back.
std::string exactText(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string exactText(const Vector& v) {
  return exactText(v.x()) + "," + exactText(v.y()) + "," + exactText(v.z());
}

unfolding::Region regionOf(const TriangleMesh& surface, const Choice& choice) {
  if (!choice.marked.empty()) return unfolding::regionOfMarked(surface, choice.marked);
  unfolding::RegionOptions options;
  options.vertex = choice.centre;
  options.radius = choice.radius;
  return unfolding::selectRegion(surface, options);
}

/// Where `explica unfold` puts it with the options of optionsOf().
visibility::Viewpoints viewpointsOf(const View& view, const Point& centre) {
  return visibility::viewpoint(centre + view.distance / view.direction.norm() * view.direction);
}

using CommandOptions = std::vector<std::pair<std::string, std::string>>;

CommandOptions optionsOf(const View& view) {
  return {{"direction", exactText(view.direction)}, {"distance", exactText(view.distance)}};
}

/// A state, kept as what differs from the start: a region moves, the rest of a hemisphere does not.
struct Kept {
  std::vector<std::int32_t> vertices;
  Positions positions;
  unfolding::IterationRecord record;
  unfolding::UnfoldState state;  ///< without its positions
};

Kept keep(const Positions& start, unfolding::UnfoldState state,
          const unfolding::IterationRecord& record) {
  Kept kept;
  kept.record = record;
  for (std::int32_t v = 0; v < state.positions.rows(); ++v) {
    if (state.positions.row(v) != start.row(v)) kept.vertices.push_back(v);
  }
  kept.positions = state.positions(kept.vertices, Eigen::all);
  state.positions.resize(0, 3);
  kept.state = std::move(state);
  return kept;
}

Positions positionsOf(const Kept& kept, const Positions& start) {
  Positions positions = start;
  positions(kept.vertices, Eigen::all) = kept.positions;
  return positions;
}

}  // namespace

struct Session::Implementation {
  explicit Implementation(TriangleMesh mesh) : surface(std::move(mesh)) {}

  const TriangleMesh surface;
  Choice choice;
  Preview preview;

  // Shared between the window's thread and the iterations', under the mutex.
  mutable std::mutex mutex;
  std::vector<Kept> moments;
  Activity activity = Activity::Choosing;
  Termination termination = Termination::NotRun;
  std::string fault;                                 ///< why it could not begin
  std::optional<Parting> parting;                    ///< once it began
  bool opened = false;                               ///< the states are those of an earlier run
  std::optional<visibility::Viewpoints> openedView;  ///< of that run

  std::unique_ptr<unfolding::Unfolder>
      unfolder;  // touched by the iterations' thread only while it runs
  std::thread worker;
  std::atomic<bool> pauseWanted{false};

  Point centre() const {
    return preview.region.faces.empty() ? Point(surface.positions.colwise().mean().transpose())
                                        : unfolding::centroidOf(surface, preview.region);
  }

  visibility::Viewpoints viewpoints() const {
    return openedView ? *openedView : viewpointsOf(choice.view, centre());
  }

  std::vector<unfolding::IterationRecord> history(std::size_t last) const {
    std::vector<unfolding::IterationRecord> records;
    for (std::size_t n = 0; n <= last; ++n) records.push_back(moments[n].record);
    return records;
  }

  /// Parts crossing faces as `explica unfold` does, so that what is seen is what it would write.
  /// @return false if a pause was asked for before it came to its first state
  bool begin() {
    const visibility::Viewpoints view = viewpoints();
    const unfolding::UnfolderOptions options = unfolding::solverOptions(choice.unfold);
    collision::UntangleOptions concerned;
    concerned.concerned =
        unfolding::movingFaces(surface, preview.region, view, choice.unfold.unfolder);
    Monitor monitor;
    monitor.stopWanted = [this] { return pauseWanted.load(); };
    const collision::Untangling start = collision::untangle(surface, concerned, monitor);
    if (pauseWanted) return false;
    // What is parted is compared with what a file holds of it, as by the command.
    const Positions parted =
        start.moved.empty() ? start.positions : unfolding::roundedToSingle(start.positions);
    unfolder = std::make_unique<unfolding::Unfolder>(TriangleMesh{parted, surface.faces},
                                                     preview.region, view, options);
    Kept kept = keep(surface.positions, unfolder->state(), unfolder->record());
    const std::lock_guard<std::mutex> hold(mutex);
    moments.push_back(std::move(kept));
    parting = Parting{start.before.size(), start.before.size() - start.after.size(),
                      start.moved.size(), start.moveMax};
    return true;
  }

  void work() {
    try {
      if (unfolder || begin()) return iterate();
    } catch (const InvalidInput& error) {
      const std::lock_guard<std::mutex> hold(mutex);
      fault = error.what();
    }
    const std::lock_guard<std::mutex> hold(mutex);
    activity = Activity::Choosing;
  }

  /// Only this thread adds moments while it runs, so that it may read them without the mutex.
  void iterate() {
    const unfolding::Continuation continuation(choice.unfold);
    while (!pauseWanted) {
      Termination reason = continuation.next(*unfolder, history(moments.size() - 1));
      if (reason == Termination::NotRun && !unfolder->step()) reason = Termination::Stalled;
      if (reason != Termination::NotRun) {
        const std::lock_guard<std::mutex> hold(mutex);
        activity = Activity::Over;
        termination = reason;
        return;
      }
      Kept kept = keep(surface.positions, unfolder->state(), unfolder->record());
      const std::lock_guard<std::mutex> hold(mutex);
      moments.push_back(std::move(kept));
    }
    const std::lock_guard<std::mutex> hold(mutex);
    activity = Activity::Paused;
  }

  void join() {
    pauseWanted = true;
    if (worker.joinable()) worker.join();
  }
};

Session::Session(TriangleMesh surface) {
  geometry::requireManifold(surface, "surface");
  self_ = std::make_unique<Implementation>(std::move(surface));
  self_->preview.problem = "no centre is chosen";
}

Session::~Session() {
  self_->join();
}

const TriangleMesh& Session::surface() const {
  return self_->surface;
}

Choice Session::choice() const {
  return self_->choice;
}

const Preview& Session::preview() const {
  return self_->preview;
}

const Preview& Session::choose(const Choice& choice) {
  Implementation& s = *self_;
  if (activity() == Activity::Running) return s.preview;
  s.join();
  {
    const std::lock_guard<std::mutex> hold(s.mutex);
    s.moments.clear();
    s.activity = Activity::Choosing;
    s.termination = Termination::NotRun;
    s.fault.clear();
    s.parting.reset();
    s.opened = false;
    s.openedView.reset();
  }
  s.unfolder.reset();
  s.choice = choice;
  s.preview = Preview{};
  if (choice.centre < 0 && choice.marked.empty()) {
    s.preview.problem = "no centre is chosen";
    return s.preview;
  }
  try {
    s.preview.region = regionOf(s.surface, choice);
    const visibility::AverageVisibility energy(s.surface.faces, s.preview.region.faces,
                                               s.viewpoints());
    s.preview.visibility = energy.value(s.surface.positions);
    if (!(s.preview.visibility > 0)) {
      s.preview.problem =
          "the region's average visibility is not positive: change the viewpoint, the centre or "
          "the radius";
    }
  } catch (const InvalidInput& error) {
    s.preview.problem = error.what();
  }
  return s.preview;
}

Point Session::centre() const {
  return self_->centre();
}

visibility::Viewpoints Session::viewpoints() const {
  return self_->viewpoints();
}

void Session::run() {
  Implementation& s = *self_;
  const Activity now = activity();
  if (now == Activity::Running || now == Activity::Over || !problem().empty()) return;
  s.join();
  s.pauseWanted = false;
  {
    const std::lock_guard<std::mutex> hold(s.mutex);
    s.activity = Activity::Running;
  }
  s.worker = std::thread([&s] { s.work(); });
}

void Session::pause() {
  if (activity() != Activity::Running) return;
  self_->join();
}

void Session::reset() {
  self_->join();
  {
    const std::lock_guard<std::mutex> hold(self_->mutex);
    if (self_->activity == Activity::Running) self_->activity = Activity::Paused;
  }
  choose(self_->choice);
}

std::string Session::regionWords() const {
  const Preview& preview = self_->preview;
  std::string words;
  if (!preview.region.faces.empty()) {
    words = std::to_string(preview.region.faces.size()) + " faces";
    if (std::isfinite(preview.visibility)) {
      words += printed(", average visibility %.3f", preview.visibility);
    }
  }
  return words + (words.empty() || problem().empty() ? "" : "\n") + problem();
}

std::string Session::problem() const {
  if (!self_->preview.problem.empty()) return self_->preview.problem;
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->fault;
}

std::optional<Parting> Session::parting() const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->parting;
}

Activity Session::activity() const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->activity;
}

std::size_t Session::momentCount() const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->moments.size();
}

Moment Session::moment(std::size_t number) const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  const Kept& kept = self_->moments.at(number);
  return {positionsOf(kept, self_->surface.positions), kept.record};
}

unfolding::IterationRecord Session::record(std::size_t number) const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->moments.at(number).record;
}

Termination Session::termination() const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  return self_->termination;
}

void Session::open(Finished finished) {
  Implementation& s = *self_;
  if (finished.moments.empty()) throw InvalidInput("unfolding: it holds no state");
  for (const Moment& moment : finished.moments) {
    if (moment.positions.rows() != s.surface.vertexCount()) {
      throw InvalidInput("unfolding: its states have " + std::to_string(moment.positions.rows()) +
                         " vertices, the surface " + std::to_string(s.surface.vertexCount()));
    }
  }
  reset();
  s.preview.region = std::move(finished.region);
  s.preview.visibility = finished.moments.front().record.visibility;
  s.preview.problem = "this unfolding is over; reset to choose anew";
  const std::lock_guard<std::mutex> hold(s.mutex);
  for (Moment& moment : finished.moments) {
    unfolding::UnfoldState state;
    state.positions = std::move(moment.positions);
    s.moments.push_back(keep(s.surface.positions, std::move(state), moment.record));
  }
  s.activity = Activity::Over;
  s.opened = true;
  s.openedView = std::move(finished.view);
}

std::optional<unfolding::Checkpoint> Session::checkpoint(std::size_t number) const {
  const std::lock_guard<std::mutex> hold(self_->mutex);
  if (self_->opened || number >= self_->moments.size()) return {};
  const Kept& kept = self_->moments[number];
  unfolding::Checkpoint checkpoint;
  checkpoint.state = kept.state;
  checkpoint.state.positions = positionsOf(kept, self_->surface.positions);
  checkpoint.history = self_->history(number);
  return checkpoint;
}

std::vector<std::pair<std::string, std::string>> Session::batchOptions(std::size_t number) const {
  const Choice& c = self_->choice;
  CommandOptions options = c.markedOptions;
  if (c.marked.empty()) {
    options = {{"vertex", std::to_string(c.centre)}, {"radius", exactText(c.radius)}};
  }
  for (auto& option : optionsOf(c.view)) options.push_back(std::move(option));
  options.emplace_back("surround", std::string(nameOf(c.unfold.unfolder.surround)));
  if (c.unfold.targetVisibility) {
    options.emplace_back("target-visibility", exactText(*c.unfold.targetVisibility));
  }
  options.emplace_back("max-iterations", std::to_string(number));
  return options;
}

}  // namespace explica::viewer
