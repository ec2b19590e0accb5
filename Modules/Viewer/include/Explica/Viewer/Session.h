// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Termination.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Unfolding/Unfold.h"
#include "Explica/Visibility/Viewpoints.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace explica::viewer {

/// From where a region is to be seen well.
struct View {
  Vector direction = Vector(-1, 0, 0);  ///< from the region's centroid, of any length > 0
  double distance = 1000;               ///< of the viewpoint from the region's centroid, mm
};

/// What the user has chosen so far; all that an unfolding depends on.
struct Choice {
  std::int32_t centre = -1;       ///< vertex; -1 before one is picked
  double radius = 25;             ///< mm
  std::vector<bool> marked = {};  ///< V, or empty; where given, the region instead of a ball
  /// Options of `explica unfold` that give `marked`: label, label-key.
  std::vector<std::pair<std::string, std::string>> markedOptions = {};
  View view;
  unfolding::UnfoldOptions unfold;  ///< how, and when it is over
};

/// The region that a choice makes, before anything moves.
struct Preview {
  unfolding::Region region;
  double visibility = kNaN;  ///< average, in [-1, 1]; the method needs it above zero
  std::string problem;       ///< why there is no region, or why it cannot be unfolded; else empty
};

/// What became of faces that cross at the start, where they concern what moves.
struct Parting {
  std::size_t crossings = 0;  ///< pairs of faces that cross in the whole surface
  std::size_t parted = 0;     ///< pairs that were parted
  std::size_t moved = 0;      ///< vertices that were moved for it
  double moveMax = 0;         ///< mm, of one of them
};

enum class Activity {
  Choosing,  ///< the choice may change
  Running,   ///< iterations go on in their own thread
  Paused,
  Over  ///< it ended by itself (see Session::termination), or was over when it was opened
};

/// One state on the way; number 0 is the start, its crossing faces parted.
struct Moment {
  Positions positions;
  unfolding::IterationRecord record;
};

/// An unfolding that is over: the states that were kept of it.
struct Finished {
  unfolding::Region region;
  std::vector<Moment> moments;                      ///< at least one
  std::optional<visibility::Viewpoints> view = {};  ///< that it was opened towards, if known
};

/// An unfolding that is watched and steered: what an interactive window shows and changes, without
/// the window.
///
/// Iterations run in a thread of the session's own; every member function may be called from the
/// window's thread at any time and returns at once, or, for pause() and reset(), after the
/// iteration in progress.  Every state of the way is kept.
class Session {
 public:
  /// @throws InvalidInput  not a manifold surface
  explicit Session(TriangleMesh surface);
  ~Session() { join(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const TriangleMesh& surface() const { return surface_; }
  [[nodiscard]] const Choice& choice() const { return choice_; }

  /// Changes the choice; drops the states of an earlier unfolding.  While it runs, nothing changes.
  /// @return what the choice selects; also available as preview()
  const Preview& choose(const Choice& choice);
  [[nodiscard]] const Preview& preview() const { return preview_; }
  /// "812 faces, average visibility 0.412", of an empty region nothing, and the problem.
  [[nodiscard]] std::string regionWords() const;

  /// Why it cannot be unfolded: the preview's problem, or what was found when it began; else empty.
  [[nodiscard]] std::string problem() const;

  /// Centroid of the region, without one that of the surface; RAS mm.
  [[nodiscard]] Point centre() const;
  /// From where the region is looked at: as chosen, or as the unfolding that was opened says.
  [[nodiscard]] visibility::Viewpoints viewpoints() const;

  /// Starts, or goes on from the last state.  Nothing happens if there is a problem().  Faces that
  /// cross at the start are parted first, as `explica unfold` does; no state exists until that is
  /// done, and a pause before drops it.
  void run();
  void pause();
  /// Back to choosing; keeps the choice.
  void reset();
  [[nodiscard]] Activity activity() const { return guarded(activity_); }
  /// What was parted before the first state; none before it, and of an unfolding that was opened.
  [[nodiscard]] std::optional<Parting> parting() const { return guarded(parting_); }
  /// Why it is over: as `explica unfold` would say with the same options; NotRun before.
  [[nodiscard]] Termination termination() const { return guarded(termination_); }

  /// Shows an unfolding that was done before; it cannot go on.
  /// @throws InvalidInput  no state, or states of another surface
  void open(Finished finished);

  /// States so far; at least the start once it ran.
  [[nodiscard]] std::size_t momentCount() const;
  [[nodiscard]] Moment moment(std::size_t number) const;

  /// What `explica unfold --resume` needs to write the state of `number` without computing it
  /// again; none for an unfolding that was opened.
  [[nodiscard]] std::optional<unfolding::Checkpoint> checkpoint(std::size_t number) const;

  /// Options of `explica unfold`, in the order of a command line, that give the state of `number`.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> batchOptions(
      std::size_t number) const;

 private:
  /// A state, kept as what differs from the start: a region moves, the rest of a hemisphere does
  /// not.
  struct Kept {
    std::vector<std::int32_t> vertices;
    Positions positions;
    unfolding::IterationRecord record;
    unfolding::UnfoldState state;  ///< without its positions
  };

  /// A value that the iterations' thread may be changing.
  template <class Value>
  Value guarded(const Value& value) const {
    const std::lock_guard<std::mutex> hold(mutex_);
    return value;
  }
  void keep(unfolding::UnfoldState state, const unfolding::IterationRecord& record);
  [[nodiscard]] Positions positionsOf(const Kept& kept) const;
  [[nodiscard]] std::vector<unfolding::IterationRecord> history(std::size_t last) const;
  bool begin();
  void work();
  void iterate();
  void join();

  const TriangleMesh surface_;
  Choice choice_;
  Preview preview_;

  // Shared between the window's thread and the iterations', under the mutex.
  mutable std::mutex mutex_;
  std::vector<Kept> moments_;
  Activity activity_ = Activity::Choosing;
  Termination termination_ = Termination::NotRun;
  std::string fault_;                                 ///< why it could not begin
  std::optional<Parting> parting_;                    ///< once it began
  bool opened_ = false;                               ///< the states are those of an earlier run
  std::optional<visibility::Viewpoints> openedView_;  ///< of that run

  std::unique_ptr<unfolding::Unfolder> unfolder_;  ///< touched by the iterations' thread only while
                                                   ///< it runs
  std::thread worker_;
  std::atomic<bool> pauseWanted_{false};
};

}  // namespace explica::viewer
