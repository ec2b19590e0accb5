// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Motion.h"
#include "UnfolderImplementation.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/PhaseClock.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

using collision::Contact;

constexpr double kLargestMultiplier = 20;  // times the pull of the visibility term
constexpr double kLargestMove = 3;         // mean edges that a vertex goes in a step at most
constexpr double kLeastDamping = 0.1;      // below it steps overshoot the quadratic model
constexpr double kMassShare = 0.01;        // of the damping: the rest is the graph Laplacian
constexpr double kLeastDiagonal = 1e-9;    // keeps the matrix definite whatever the damping is
constexpr double kSlowGain = 0.003;  // visibility per iteration below which areas tighten, ...
constexpr double kTightening = 1.5;  // ... unless told otherwise, by this factor ...
constexpr double kTightest = 50;     // ... up to this one
constexpr int kMaxAttempts = 12;     // with four times the damping each
constexpr int kMaxHalvings = 8;      // of an attempt's step
constexpr double kArmijo = 1e-4;     // of the descent that the gradient promises

/// Squared, mm^2.
double nearest(const std::vector<Contact>& contacts, const Positions& x) {
  double least = kInfinity;
  for (const Contact& contact : contacts) least = std::min(least, squaredDistance(contact, x));
  return least;
}

/// One damped Newton-like step: contacts, gradient and objective of the state it starts from, then
/// attempts until one lowers the objective.
class ImplicitStep {
 public:
  explicit ImplicitStep(Unfolder::Implementation& unfolder);
  /// @return false if no attempt succeeded; the state is then unchanged but for its damping
  bool take();

 private:
  void findHidingFaces();
  bool attempt();
  template <class Other>
  void orderBeside(const Other& other);
  void differentiate();
  void fill();
  bool solve(Positions& direction);
  [[nodiscard]] Positions cappedMotion(const Positions& direction) const;
  /// Halves the step until the objective does not rise.
  bool search(const Motion& motion, const std::vector<Contact>& onTheWay);
  void accept(Motion& motion);
  void tightenAreas();
  void updateMultipliers();

  Unfolder::Implementation& u_;
  UnfoldState& state_;
  IterationRecord now_;
  std::vector<Contact> contacts_;
  std::optional<Configuration> start_;
  Positions gradient_, rightSide_;
  Couplings couplings_;
  bool filled_ = false;  ///< the system holds the matrix of the next attempt
  Positions trial_;
};

ImplicitStep::ImplicitStep(Unfolder::Implementation& unfolder)
    : u_(unfolder), state_(unfolder.state) {
  now_.iteration = state_.iteration + 1;
  {
    const PhaseClock clock(now_.phases.collision);
    contacts_ = u_.contacts.within(state_.positions);
  }
  if (u_.options.surround == Surround::Elastic) findHidingFaces();
  couplings_ = u_.setup.couplings;
  for (const Contact& contact : contacts_) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        const std::int32_t a = u_.setup.unknown[contact.vertices[i]];
        const std::int32_t b = u_.setup.unknown[contact.vertices[j]];
        if (a >= 0 && b >= 0) couplings_.emplace_back(std::max(a, b), std::min(a, b));
      }
    }
  }
  orderBeside([this] { differentiate(); });
  filled_ = true;
}

/// Which faces of the collar stand over the region; they stay those until the step is taken.
void ImplicitStep::findHidingFaces() {
  const PhaseClock clock(now_.phases.visibility);
  Patch& patch = u_.setup.patch;
  const std::vector<float> over =
      visibility::standingOver(state_.positions, u_.setup.mesh.faces, u_.setup.region.faces,
                               u_.setup.collar, patch.room.axis);
  for (std::size_t f = 0; f < over.size(); ++f) {
    PatchFace& face = patch.faces[patch.regionFaces + f];
    face.overWeight = over[f] * face.weight;
  }
}

/// The order of elimination asks for couplings alone: it is found while `other` fills the system.
template <class Other>
void ImplicitStep::orderBeside(const Other& other) {
  {
    const PhaseClock clock(now_.phases.solve);
    u_.system.reset(static_cast<std::int32_t>(u_.setup.moving.size()), couplings_);
  }
  parallelFor(2, 1, [&](std::size_t n) {
    if (n == 0) {
      u_.system.order();
    } else {
      other();
    }
  });
}

/// Objective and gradient at the start, and the matrix of the first attempt.
void ImplicitStep::differentiate() {
  start_.emplace(u_.configurationAt(state_.positions, contacts_));
  now_.objectiveBefore = u_.objective.value(*start_, u_.strengths(), now_);
  gradient_ = u_.objective.gradient(*start_, u_.strengths(), now_);
  rightSide_ = -gradient_(u_.setup.moving, Eigen::all);
  fill();
}

bool ImplicitStep::take() {
  for (int n = 0; n < kMaxAttempts; ++n, state_.damping *= 4) {
    if (attempt()) return true;
  }
  return false;
}

bool ImplicitStep::attempt() {
  Positions direction;
  if (!solve(direction)) return false;
  Motion motion{cappedMotion(direction)};
  motion.descent = (gradient_.array() * motion.by.array()).sum();
  if (!(motion.descent < 0)) return false;
  std::vector<Contact> onTheWay;
  {
    const PhaseClock clock(now_.phases.collision);
    findSafeStep(u_.contacts, state_.positions, motion);
    clearWay(u_.contacts, state_.positions, u_.setup.unknown, gradient_, motion);
    onTheWay = u_.contacts.contactsOf(collision::pairsOf(motion.meetings));
  }
  if (!(motion.descent < 0) || !search(motion, onTheWay)) return false;
  accept(motion);
  return true;
}

/// The matrix of the step: Gauss-Newton, contacts, locked pairs and the damping's metric.
void ImplicitStep::fill() {
  const PhaseClock clock(now_.phases.solve);
  BlockSystem& system = u_.system;
  u_.objective.addStiffness(*start_, u_.strengths(), u_.setup.unknown, system);
  const Patch& patch = u_.setup.patch;
  const auto& unknown = u_.setup.unknown;
  const Eigen::Matrix3d metric = state_.damping * Eigen::Matrix3d::Identity();
  addBlocks(
      patch.springsAround, 0, patch.springs.size(),
      [&](std::int32_t s) { return patch.springs[s].vertices; }, unknown, system,
      [&](std::int32_t s, int i, int j) -> Eigen::Matrix3d {
        const auto& [a, b] = patch.springs[s].vertices;
        if (unknown[a] < 0 || unknown[b] < 0) return Eigen::Matrix3d::Zero();
        return i == j ? metric : Eigen::Matrix3d(-metric);
      });
  system.addDiagonal(kMassShare * state_.damping + kLeastDiagonal);
}

bool ImplicitStep::solve(Positions& direction) {
  if (!filled_) orderBeside([this] { fill(); });
  filled_ = false;
  ++now_.solves;
  const PhaseClock clock(now_.phases.solve);
  return u_.system.solve(rightSide_, direction);
}

/// The direction (one row per unknown) on all vertices (V x 3), none farther than it may go.
Positions ImplicitStep::cappedMotion(const Positions& direction) const {
  const double largest = std::sqrt(direction.rowwise().squaredNorm().maxCoeff());
  const double cap = kLargestMove * u_.setup.edge;
  const double share = largest > cap ? cap / largest : 1;
  Positions motion = Positions::Zero(state_.positions.rows(), 3);
  motion(u_.setup.moving, Eigen::all) = share * direction;
  return motion;
}

bool ImplicitStep::search(const Motion& motion, const std::vector<Contact>& onTheWay) {
  double taken = motion.safe;
  trial_ = state_.positions;
  for (int halving = 0; halving < kMaxHalvings && taken > 0; ++halving, taken *= 0.5) {
    for (const std::int32_t v : u_.setup.moving) {
      trial_.row(v) = state_.positions.row(v) + taken * motion.by.row(v);
    }
    now_.objectiveAfter =
        u_.objective.value(u_.configurationAt(trial_, onTheWay), u_.strengths(), now_);
    if (now_.objectiveAfter <=
        now_.objectiveBefore + std::min(0.0, kArmijo * taken * motion.descent)) {
      now_.step = taken;
      return true;
    }
  }
  return false;
}

void ImplicitStep::accept(Motion& motion) {
  now_.safeStep = motion.safe;
  now_.largestMove = now_.step * std::sqrt(motion.by.rowwise().squaredNorm().maxCoeff());
  now_.damping = state_.damping;
  now_.contacts = static_cast<int>(contacts_.size());
  now_.nearestContact = contacts_.empty() ? kNaN : std::sqrt(nearest(contacts_, trial_));
  state_.positions = trial_;
  state_.iteration = now_.iteration;
  u_.contacts.remember(collision::pairsOf(motion.meetings));
  if (now_.step == 1) {
    state_.damping = std::max(kLeastDamping, state_.damping / 4);
  } else if (now_.step < 0.25 * now_.safeStep) {
    state_.damping *= 2;
  }
  updateMultipliers();
  u_.measure(now_);
  tightenAreas();
  u_.record = now_;
}

/// Soft areas let folds open, and stiff ones keep them open only where they are.
void ImplicitStep::tightenAreas() {
  const bool slow = std::abs(now_.visibility - u_.record.visibility) < kSlowGain;
  now_.phase = u_.asked.value_or(slow ? Phase::Settling : Phase::Opening);
  if (now_.phase != Phase::Settling) return;
  state_.areaStiffness =
      std::min(kTightest * u_.options.weights[Term::Area], kTightening * state_.areaStiffness);
}

/// A multiplier grows by what an area is off beyond the slack, so that faces that press against
/// their areas end at its edge.
void ImplicitStep::updateMultipliers() {
  const auto faces = u_.setup.patch.ofRegion();
  const double slack = u_.options.areaSlack;
  const double largest = kLargestMultiplier * std::max(1.0, state_.drive);
  parallelFor(faces.size(), [&](std::size_t f) {
    const double error = shapeOf(faces[f], state_.positions).area / faces[f].restArea - 1;
    const double excess = error - std::clamp(error, -slack, slack);
    double& multiplier = state_.multipliers[static_cast<Eigen::Index>(f)];
    multiplier = std::clamp(multiplier + state_.areaStiffness * excess, -largest, largest);
  });
}

}  // namespace

bool Unfolder::Implementation::implicitStep() {
  if (ImplicitStep(*this).take()) return true;
  state.stalled = true;
  return false;
}

}  // namespace explica::unfolding
