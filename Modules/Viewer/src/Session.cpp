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

#include <charconv>
#include <utility>

namespace explica::viewer {
namespace {

constexpr const char* kNoCentre = "no centre is chosen";

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

/// Where `explica unfold` puts it with the same direction and distance.
visibility::Viewpoints viewpointsOf(const View& view, const Point& centre) {
  return visibility::viewpoint(centre + view.distance / view.direction.norm() * view.direction);
}

}  // namespace

Session::Session(TriangleMesh surface) : surface_(std::move(surface)) {
  geometry::requireManifold(surface_, "surface");
  preview_.problem = kNoCentre;
}

const Preview& Session::choose(const Choice& choice) {
  if (activity() == Activity::Running) return preview_;
  join();
  {
    const std::lock_guard<std::mutex> hold(mutex_);
    moments_.clear();
    activity_ = Activity::Choosing;
    termination_ = Termination::NotRun;
    fault_.clear();
    parting_.reset();
    opened_ = false;
    openedView_.reset();
  }
  unfolder_.reset();
  choice_ = choice;
  preview_ = Preview{};
  if (choice.centre < 0 && choice.marked.empty()) {
    preview_.problem = kNoCentre;
    return preview_;
  }
  try {
    preview_.region = regionOf(surface_, choice);
    const visibility::AverageVisibility energy(surface_.faces, preview_.region.faces, viewpoints());
    preview_.visibility = energy.value(surface_.positions);
    if (!(preview_.visibility > 0)) {
      preview_.problem =
          "the region's average visibility is not positive: change the viewpoint, the centre or "
          "the radius";
    }
  } catch (const InvalidInput& error) {
    preview_.problem = error.what();
  }
  return preview_;
}

Point Session::centre() const {
  return preview_.region.faces.empty() ? Point(surface_.positions.colwise().mean().transpose())
                                       : unfolding::centroidOf(surface_, preview_.region);
}

visibility::Viewpoints Session::viewpoints() const {
  return openedView_ ? *openedView_ : viewpointsOf(choice_.view, centre());
}

void Session::keep(unfolding::UnfoldState state, const unfolding::IterationRecord& record) {
  Kept kept;
  kept.record = record;
  for (std::int32_t v = 0; v < state.positions.rows(); ++v) {
    if (state.positions.row(v) != surface_.positions.row(v)) kept.vertices.push_back(v);
  }
  kept.positions = state.positions(kept.vertices, Eigen::all);
  state.positions.resize(0, 3);
  kept.state = std::move(state);
  const std::lock_guard<std::mutex> hold(mutex_);
  moments_.push_back(std::move(kept));
}

Positions Session::positionsOf(const Kept& kept) const {
  Positions positions = surface_.positions;
  positions(kept.vertices, Eigen::all) = kept.positions;
  return positions;
}

std::vector<unfolding::IterationRecord> Session::history(std::size_t last) const {
  std::vector<unfolding::IterationRecord> records;
  for (std::size_t n = 0; n <= last; ++n) records.push_back(moments_[n].record);
  return records;
}

/// Parts crossing faces as `explica unfold` does, so that what is seen is what it would write.
/// @return false if a pause was asked for before it came to its first state
bool Session::begin() {
  const visibility::Viewpoints view = viewpoints();
  const unfolding::UnfolderOptions options = unfolding::solverOptions(choice_.unfold);
  collision::UntangleOptions concerned;
  concerned.concerned =
      unfolding::movingFaces(surface_, preview_.region, view, choice_.unfold.unfolder);
  Monitor monitor;
  monitor.stopWanted = [this] { return pauseWanted_.load(); };
  const collision::Untangling start = collision::untangle(surface_, concerned, monitor);
  if (pauseWanted_) return false;
  // What is parted is compared with what a file holds of it, as by the command.
  const Positions parted =
      start.moved.empty() ? start.positions : unfolding::roundedToSingle(start.positions);
  unfolder_ = std::make_unique<unfolding::Unfolder>(TriangleMesh{parted, surface_.faces},
                                                    preview_.region, view, options);
  {
    const std::lock_guard<std::mutex> hold(mutex_);
    parting_ = Parting{start.before.size(), start.before.size() - start.after.size(),
                       start.moved.size(), start.moveMax};
  }
  keep(unfolder_->state(), unfolder_->record());
  return true;
}

void Session::work() {
  std::string fault;
  try {
    if (unfolder_ || begin()) return iterate();
  } catch (const InvalidInput& error) {
    fault = error.what();
  }
  const std::lock_guard<std::mutex> hold(mutex_);
  fault_ = fault;
  activity_ = Activity::Choosing;
}

/// Only this thread adds moments while it runs, so that it may read them without the mutex.
void Session::iterate() {
  const unfolding::Continuation continuation(choice_.unfold);
  Termination reason = Termination::NotRun;
  while (!pauseWanted_) {
    reason = continuation.next(*unfolder_, history(moments_.size() - 1));
    if (reason == Termination::NotRun && !unfolder_->step()) reason = Termination::Stalled;
    if (reason != Termination::NotRun) break;
    keep(unfolder_->state(), unfolder_->record());
  }
  const std::lock_guard<std::mutex> hold(mutex_);
  termination_ = reason;
  activity_ = reason == Termination::NotRun ? Activity::Paused : Activity::Over;
}

void Session::join() {
  pauseWanted_ = true;
  if (worker_.joinable()) worker_.join();
}

void Session::run() {
  const Activity now = activity();
  if (now == Activity::Running || now == Activity::Over || !problem().empty()) return;
  join();
  pauseWanted_ = false;
  {
    const std::lock_guard<std::mutex> hold(mutex_);
    activity_ = Activity::Running;
  }
  worker_ = std::thread([this] { work(); });
}

void Session::pause() {
  if (activity() == Activity::Running) join();
}

void Session::reset() {
  pause();
  choose(choice());
}

std::string Session::regionWords() const {
  std::string words;
  if (!preview_.region.faces.empty()) {
    words = std::to_string(preview_.region.faces.size()) + " faces";
    if (std::isfinite(preview_.visibility)) {
      words += printed(", average visibility %.3f", preview_.visibility);
    }
  }
  return words + (words.empty() || problem().empty() ? "" : "\n") + problem();
}

std::string Session::problem() const {
  return preview_.problem.empty() ? guarded(fault_) : preview_.problem;
}

std::size_t Session::momentCount() const {
  const std::lock_guard<std::mutex> hold(mutex_);
  return moments_.size();
}

Moment Session::moment(std::size_t number) const {
  const std::lock_guard<std::mutex> hold(mutex_);
  const Kept& kept = moments_.at(number);
  return {positionsOf(kept), kept.record};
}

void Session::open(Finished finished) {
  if (finished.moments.empty()) throw InvalidInput("unfolding: it holds no state");
  for (const Moment& moment : finished.moments) {
    if (moment.positions.rows() != surface_.vertexCount()) {
      throw InvalidInput("unfolding: its states have " + std::to_string(moment.positions.rows()) +
                         " vertices, the surface " + std::to_string(surface_.vertexCount()));
    }
  }
  reset();
  preview_.region = std::move(finished.region);
  preview_.visibility = finished.moments.front().record.visibility;
  preview_.problem = "this unfolding is over; reset to choose anew";
  for (Moment& moment : finished.moments) {
    unfolding::UnfoldState state;
    state.positions = std::move(moment.positions);
    keep(std::move(state), moment.record);
  }
  const std::lock_guard<std::mutex> hold(mutex_);
  activity_ = Activity::Over;
  opened_ = true;
  openedView_ = std::move(finished.view);
}

std::optional<unfolding::Checkpoint> Session::checkpoint(std::size_t number) const {
  const std::lock_guard<std::mutex> hold(mutex_);
  if (opened_ || number >= moments_.size()) return {};
  const Kept& kept = moments_[number];
  unfolding::Checkpoint checkpoint;
  checkpoint.state = kept.state;
  checkpoint.state.positions = positionsOf(kept);
  checkpoint.history = history(number);
  return checkpoint;
}

std::vector<std::pair<std::string, std::string>> Session::batchOptions(std::size_t number) const {
  auto options = choice_.markedOptions;
  if (choice_.marked.empty()) {
    options = {{"vertex", std::to_string(choice_.centre)}, {"radius", exactText(choice_.radius)}};
  }
  options.emplace_back("direction", exactText(choice_.view.direction));
  options.emplace_back("distance", exactText(choice_.view.distance));
  options.emplace_back("surround", std::string(nameOf(choice_.unfold.unfolder.surround)));
  if (choice_.unfold.targetVisibility) {
    options.emplace_back("target-visibility", exactText(*choice_.unfold.targetVisibility));
  }
  options.emplace_back("max-iterations", std::to_string(number));
  return options;
}

}  // namespace explica::viewer
