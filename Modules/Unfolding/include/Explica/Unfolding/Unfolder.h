// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Unfolding/Region.h"
#include "Explica/Unfolding/Terms.h"
#include "Explica/Visibility/Viewpoints.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace explica::unfolding {

/// What becomes of the surface around the region.
enum class Surround {
  Fixed,    ///< stays, and is an obstacle [Thesis]
  Elastic,  ///< a collar follows, the rest stays
  None      ///< the region alone
};
constexpr auto enumWords(Surround) {
  using enum Surround;
  return std::to_array<EnumWord<Surround>>(
      {{Fixed, "fixed"}, {Elastic, "elastic"}, {None, "none"}});
}

/// How a region is unfolded.
enum class Method {
  Implicit,  ///< implicit steps on an incremental potential, guarded by collision detection
  Thesis     ///< explicit gradient flow with areas projected [Thesis, Eq. 5.46, 5.48]: the baseline
};
constexpr auto enumWords(Method) {
  using enum Method;
  return std::to_array<EnumWord<Method>>({{Implicit, "implicit"}, {Thesis, "thesis"}});
}

struct UnfolderOptions {
  Method method = Method::Implicit;
  Surround surround = Surround::Elastic;
  std::optional<double> collarWidth;  ///< of an elastic collar, mm along the surface, > 0; else in
                                      ///< proportion to the region
  double contactRange = 0.25;         ///< of the mean edge length: the barrier acts below it, > 0
  double yieldStrain = 0.015;  ///< strain beyond which an edge costs less than its square, > 0
  double areaSlack = 0;    ///< relative area error that needs no mending; unfold() sets it, >= 0
  int guideFaces = 30000;  ///< a region alone of so many faces is pulled towards its flat map, >= 0
  repulsion::KnotMethod knot = repulsion::KnotMethod::Off;
  bool keepAreas = true;  ///< thesis method: project; without it the region shrinks
  UnfoldWeights weights;
};

template <class Visitor>
void describe(UnfolderOptions& options, Visitor&& visit) {
  visit(Field{"surround", "",
              "the surface around the region stays, follows with a collar, or is "
              "left out"},
        options.surround);
  visit(Field{"method", "", "implicit steps, or the thesis's gradient flow as the baseline"},
        options.method);
  visit(Field{"knot", "", "how the repulsive (knot) energy is evaluated"}, options.knot);
  visit(Field{"knot-weight", "", "strength of the knot energy"}, options.weights[Term::Knot]);
}

/// Wall time of an iteration by phase, s.
struct PhaseSeconds {
  double visibility = 0;  ///< the patch's terms (visibility, areas, lengths, lift) and its measures
  double repulsion = 0;   ///< knot energy
  double collision = 0;   ///< pairs that may meet, the safe step, contacts
  double solve = 0;       ///< linear systems: assembly, factorisation, solution

  PhaseSeconds& operator+=(const PhaseSeconds& other) {
    visibility += other.visibility;
    repulsion += other.repulsion;
    collision += other.collision;
    solve += other.solve;
    return *this;
  }
};

/// What a step is for.
enum class Phase {
  Opening,   ///< folds open; the visibility term keeps its strength
  Weighing,  ///< ... and is weighed against lengths
  Settling   ///< ... while areas tighten
};
constexpr auto enumWords(Phase) {
  using enum Phase;
  return std::to_array<EnumWord<Phase>>(
      {{Opening, "opening"}, {Weighing, "weighing"}, {Settling, "settling"}});
}

/// One iteration's account: a row of evolution.tsv.
struct IterationRecord {
  int iteration = 0;
  Phase phase = Phase::Opening;
  double visibility = kNaN;     ///< average flux density of the region, [-1, 1]
  double areaErrorMean = kNaN;  ///< mean |A / A0 - 1| over the region's faces
  double areaErrorMax = kNaN;
  double areaErrorShare = kNaN;     ///< sum |A - A0| over sum A0: by it areas are kept or not
  double edgeStrainMean = kNaN;     ///< mean |l / l0 - 1| over the region's edges
  double collarStretchMean = kNaN;  ///< A / A0 of faces that move outside the region; NaN if none
  double collarStretchMax = kNaN;
  TermValues energies;           ///< terms of the objective after the step, mm^2
  double objectiveBefore = 0;    ///< sum of the terms before the step ...
  double objectiveAfter = 0;     ///< ... and after it, with the same multipliers: never larger
  int contacts = 0;              ///< pairs within the barrier's range
  double nearestContact = kNaN;  ///< mm; NaN without contacts
  double safeStep = 1;           ///< share of the step that collision detection allows
  double step = 1;               ///< share that was taken
  double largestMove = 0;        ///< mm, of any vertex
  double damping = 0;
  int solves = 0;  ///< linear systems solved for this step
  PhaseSeconds phases;
  double seconds = 0;  ///< wall time since the run began, set by unfold()
};

/// What rays to the viewpoints told of a state.
struct Look {
  int iteration = -1;  ///< whose state it was; -1: there was no look
  double seen = kNaN;  ///< share of the region's area that is seen then
  double rise = 0;     ///< of that share since the look before
};

/// Everything that the next step depends on, beyond the inputs of construction.
struct UnfoldState {
  Positions positions;          ///< V x 3, all vertices of the surface
  Eigen::VectorXd multipliers;  ///< one per kept face
  Positions directions;  ///< R x 3, see Unfolder::setDirections(); no rows: towards the viewpoints
  double damping = 1;
  double areaStiffness = 0;  ///< current, >= weights.area
  double drive = 1;          ///< strength of the visibility term against the others
  int driveIteration = 0;    ///< when it was raised last, or way was made
  double lift = 1;           ///< factor of weights.lift, raised where way was made
  double collarWidth = 0;    ///< mm along the surface; wider where way was made
  int ways = 0;              ///< how often that was
  int iteration = 0;
  bool stalled = false;  ///< no step lowered the objective
  Look look;             ///< the last
};

/// Unfolds a region one iteration at a time, so that a viewer or a script can watch and steer.
///
/// Each iteration minimises a quadratic model of
///   sum A0 (1 - n . d)  +  areas kept, with multipliers  +  edge springs  +  contact barrier
/// (beside surroundings also a pull up to the height where the region laid flat has room)
/// plus damping in a Sobolev metric, caps the step by continuous collision detection over all pairs
/// with a moving vertex, and backtracks until the objective does not rise.  So no state has an
/// intersection that the start did not have, and crossings of the start stay as they are.
///
/// Results are the same for any number of threads.
///
/// The thesis's method has none of this: it follows the flow of visibility and knot energy with its
/// areas kept to first order, and may intersect.
class Unfolder {
 public:
  /// @throws InvalidInput  ill-formed mesh, viewpoint or option; a region face of zero area; with
  ///                       the implicit method, a moving part that touches another at the start
  Unfolder(TriangleMesh mesh, Region region, visibility::Viewpoints viewpoints,
           const UnfolderOptions& options = {});
  ~Unfolder();
  Unfolder(Unfolder&&) noexcept;
  Unfolder& operator=(Unfolder&&) noexcept;

  /// One iteration; false if none that lowers the objective was found (the state is then marked
  /// stalled and unchanged).
  bool step();

  /// Says what the next step is for (Opening, Weighing or Settling), and strengthens or weakens the
  /// visibility term a little.  Without it areas tighten once the visibility rises slowly.
  void steer(Phase phase, double factor);
  /// Strengthens the visibility term for good: what follows has to be waited for.
  void raiseDrive(double factor);

  /// Whether a part of the region that counts is held below its elastic surroundings, which can
  /// still be asked to part further.
  [[nodiscard]] bool isHeldBelow() const;
  /// Parts the surroundings: from now on more of them moves (beginning where it stands, so that
  /// nothing is lost), and the region is pulled up with more force.  More vertices move then.
  void makeWay();

  /// Share of the region's area that is seen from the viewpoints, by rays: about as expensive as a
  /// quarter of a step.
  [[nodiscard]] double seenShare() const;
  /// The same, taken note of in the state.
  double look();

  [[nodiscard]] const UnfoldState& state() const;
  /// Continues from a state of the same inputs: bit-identical to never having stopped.
  /// @throws InvalidInput  sizes that do not fit
  void restore(UnfoldState state);

  /// Account of the last iteration; before the first, of the start.
  [[nodiscard]] const IterationRecord& record() const;

  /// The surface that moves: all of it, or the region alone (Surround::None), on all vertices.
  [[nodiscard]] const TriangleMesh& reference() const;
  [[nodiscard]] TriangleMesh current() const;
  [[nodiscard]] const Region& region() const;
  [[nodiscard]] const std::vector<std::int32_t>& movingVertices() const;
  /// Faces outside the region with a vertex that moves: its collar, or the ring that joins it to
  /// fixed surroundings.
  [[nodiscard]] const std::vector<std::int32_t>& collarFaces() const;

  void setViewpoints(visibility::Viewpoints viewpoints);
  /// Lets each face of the region look along a direction of its own, held until the next call, in
  /// place of towards the viewpoints; `visibility` of the account is then the mean of n . d by
  /// area.
  /// @param directions  R x 3, at most unit length; no rows: towards the viewpoints
  /// @throws InvalidInput  another number of rows
  void setDirections(Positions directions);

  struct Implementation;  ///< internal

 private:
  std::unique_ptr<Implementation> self_;
};

/// F flags: the faces with a vertex that will move, the region's and those of its surroundings.
[[nodiscard]] std::vector<bool> movingFaces(const TriangleMesh& mesh, const Region& region,
                                            const visibility::Viewpoints& viewpoints,
                                            const UnfolderOptions& options);

}  // namespace explica::unfolding
