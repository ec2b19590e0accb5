// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Motion.h"
#include "UnfolderImplementation.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/PhaseClock.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

using collision::Contact;
using collision::Pair;

constexpr double kSeparated = 0.25;  // of their range: pairs that start nearer are parted first
constexpr double kStillSeparating = 0.6;   // of the contact energy before: above it the rest ...
constexpr int kSeparatingIterations = 60;  // ... or after these goes on beside the unfolding
constexpr double kLargestMultiplier = 20;  // times the pull of the visibility term
constexpr double kLargestMove = 3;         // mean edges that a vertex goes in a step at most
constexpr double kLeastDamping = 0.1;      // below it steps overshoot the quadratic model
constexpr double kMassShare = 0.01;        // of the damping: the rest is the graph Laplacian
constexpr double kLeastDiagonal = 1e-9;    // keeps the matrix definite whatever the damping is
constexpr double kPressed = 0.03;          // of a contact's range: below it contacts stiffen ...
constexpr double kClosing = 0.99;  // of the squared distance: those that come no nearer do not
constexpr double kStiffestContact = 1e3;  // ... up to this factor
constexpr double kLockStiffness = 1e5;    // against about 1 of the other terms
constexpr int kHoldFirst = 4;             // iterations that a pair is locked for, twice as many ...
constexpr int kHoldLongest = 64;          // ... each time that it stops a step again, up to these
constexpr double kSlowGain = 0.003;       // visibility per iteration below which areas tighten, ...
constexpr double kTightening = 1.5;       // ... unless told otherwise, by this factor ...
constexpr double kTightest = 50;          // ... up to this one
constexpr int kMaxAttempts = 12;          // with four times the damping each
constexpr int kMaxHalvings = 8;           // of an attempt's step
constexpr double kArmijo = 1e-4;          // of the descent that the gradient promises

Pair pairOf(const HeldPair& held) {
  return {static_cast<collision::PairKind>(held.pair[0]), held.pair[1], held.pair[2]};
}

/// One damped Newton-like step: contacts, gradient and objective of the state it starts from, then
/// attempts until one lowers the objective.
class ImplicitStep {
 public:
  explicit ImplicitStep(Unfolder::Implementation& unfolder);
  /// @return false if no attempt succeeded; the state is then unchanged but for its damping
  bool take();

 private:
  bool attempt();
  template <class Other>
  void orderBeside(const Other& other);
  void differentiate();
  void fill();
  bool solve(Positions& direction);
  void addLock(const Pair& pair);
  void couple(const Pair& pair);
  void couple(const std::array<std::int32_t, 4>& vertices);
  [[nodiscard]] Positions cappedMotion(const Positions& direction) const;
  void lockHeld();
  void lock(const Pair& pair);
  bool lockBlocking(const Motion& motion);
  void hold(const Pair& pair);
  /// Halves the step until the objective does not rise.
  bool search(const Motion& motion, const std::vector<Contact>& onTheWay);
  void accept(Motion& motion);
  void tightenAreas();
  void accountForContacts();
  void updateMultipliers();
  void endSeparationIfDone();

  Unfolder::Implementation& u_;
  UnfoldState& state_;
  IterationRecord now_;
  std::vector<Contact> contacts_;
  std::optional<Configuration> start_;
  Positions gradient_, rightSide_;
  Couplings couplings_;
  std::vector<Pair> locked_;
  bool filled_ = false;    ///< the system holds the matrix of the next attempt
  bool relocked_ = false;  ///< pairs have been locked because they stopped this step
  Positions trial_;
};

ImplicitStep::ImplicitStep(Unfolder::Implementation& unfolder)
    : u_(unfolder), state_(unfolder.state) {
  now_.iteration = state_.iteration + 1;
  {
    const PhaseClock clock(now_.phases.collision);
    contacts_ = u_.contacts.within(state_.positions);
  }
  if (state_.separating) endSeparationIfDone();
  couplings_ = u_.setup.couplings;
  for (const Contact& contact : contacts_) couple(contact.vertices);
  lockHeld();
  orderBeside([this] { differentiate(); });
  filled_ = true;
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
  const auto& moving = u_.setup.moving;
  rightSide_.resize(static_cast<Eigen::Index>(moving.size()), 3);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    rightSide_.row(static_cast<Eigen::Index>(i)) = -gradient_.row(moving[i]);
  }
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
  bool locks = false;
  {
    const PhaseClock clock(now_.phases.collision);
    findSafeStep(u_.contacts, state_.positions, motion);
    locks = lockBlocking(motion);
  }
  if (locks) return attempt();  // this is no failure of the model: the same damping once more
  std::vector<Contact> onTheWay;
  {
    const PhaseClock clock(now_.phases.collision);
    weldBlocking(u_.contacts, state_.positions, u_.setup.unknown, gradient_, motion);
    onTheWay = u_.contacts.contactsOf(motion.pairs());
  }
  if (!(motion.descent < 0) || !search(motion, onTheWay)) return false;
  accept(motion);
  return true;
}

/// The matrix of the step: Gauss-Newton, contacts, locked pairs and the damping's metric.
void ImplicitStep::fill() {
  const PhaseClock clock(now_.phases.solve);
  BlockSystem& system = u_.system;
  for (const Pair& pair : locked_) addLock(pair);
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

/// Stiff springs along the six lines that join a pair's four vertices, and along the one between
/// its nearest points: the pair can then turn and shift, but not slide, shear or close.  A rigid
/// turn that is followed along straight lines brings nothing closer, so a locked pair does not stop
/// the step.
void ImplicitStep::addLock(const Pair& pair) {
  const Positions& x = state_.positions;
  const auto v = u_.contacts.scene().vertices(pair);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      const Vector along = (x.row(v[i]) - x.row(v[j])).transpose();
      const Eigen::Matrix3d block =
          kLockStiffness / along.squaredNorm() * along * along.transpose();
      const std::int32_t a = u_.setup.unknown[v[i]], b = u_.setup.unknown[v[j]];
      if (a >= 0) u_.system.add(a, a, block);
      if (b >= 0) u_.system.add(b, b, block);
      if (a >= 0 && b >= 0) u_.system.add(a, b, -block);
    }
  }
  const collision::Proximity near =
      collision::findProximity(pair.kind, u_.contacts.scene().points(pair, x));
  if (!(near.squaredDistance > 0)) return;
  const Eigen::Matrix3d across =
      kLockStiffness / near.squaredDistance * near.difference * near.difference.transpose();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) {
      const std::int32_t a = u_.setup.unknown[v[i]], b = u_.setup.unknown[v[j]];
      if (a >= 0 && b >= 0) u_.system.add(a, b, near.weights[i] * near.weights[j] * across);
    }
  }
}

void ImplicitStep::couple(const Pair& pair) {
  couple(u_.contacts.scene().vertices(pair));
}

void ImplicitStep::couple(const std::array<std::int32_t, 4>& vertices) {
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      const std::int32_t a = u_.setup.unknown[vertices[i]], b = u_.setup.unknown[vertices[j]];
      if (a >= 0 && b >= 0) couplings_.emplace_back(std::max(a, b), std::min(a, b));
    }
  }
}

/// The direction (one row per unknown) on all vertices (V x 3), none farther than it may go.
Positions ImplicitStep::cappedMotion(const Positions& direction) const {
  const double largest = std::sqrt(direction.rowwise().squaredNorm().maxCoeff());
  const double cap = kLargestMove * u_.setup.edge;
  const double share = largest > cap ? cap / largest : 1;
  Positions motion = Positions::Zero(state_.positions.rows(), 3);
  const auto& moving = u_.setup.moving;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    motion.row(moving[i]) = share * direction.row(static_cast<Eigen::Index>(i));
  }
  return motion;
}

/// Pairs that stopped steps before are likely to stop this one.
void ImplicitStep::lockHeld() {
  std::erase_if(state_.held, [&](const HeldPair& h) { return h.until + h.hold < now_.iteration; });
  if (state_.separating) return;
  for (const HeldPair& held : state_.held) {
    if (held.until > now_.iteration) lock(pairOf(held));
  }
}

void ImplicitStep::lock(const Pair& pair) {
  locked_.push_back(pair);
  couple(pair);
}

/// Few pairs, almost in contact, would stop all the rest: they are solved for as rigid, once.
/// @return true if the step has to be solved again
bool ImplicitStep::lockBlocking(const Motion& motion) {
  if (motion.safe >= kBlocked || relocked_) return false;
  relocked_ = true;
  const std::size_t before = locked_.size();
  for (const Pair& pair : blockingPairs(u_.contacts, state_.positions, motion)) {
    if (std::find(locked_.begin(), locked_.end(), pair) != locked_.end()) continue;
    lock(pair);
    hold(pair);
  }
  return locked_.size() > before;
}

/// Keeps a pair locked in the next steps, so that these need not be solved twice.
void ImplicitStep::hold(const Pair& pair) {
  const auto known = std::find_if(state_.held.begin(), state_.held.end(),
                                  [&](const HeldPair& held) { return pairOf(held) == pair; });
  if (known == state_.held.end()) {
    state_.held.push_back({{static_cast<std::int32_t>(pair.kind), pair.first, pair.second},
                           kHoldFirst,
                           now_.iteration + kHoldFirst});
  } else {
    known->hold = std::min(kHoldLongest, 2 * known->hold);
    known->until = now_.iteration + known->hold;
  }
}

bool ImplicitStep::search(const Motion& motion, const std::vector<Contact>& onTheWay) {
  double taken = motion.safe;
  for (int halving = 0; halving < kMaxHalvings && taken > 0; ++halving, taken *= 0.5) {
    trial_ = state_.positions + taken * motion.by;
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
  accountForContacts();
  state_.positions = trial_;
  state_.iteration = now_.iteration;
  u_.contacts.remember(motion.pairs());
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
  if (state_.separating || !u_.areasTighten.value_or(slow)) return;
  state_.areaStiffness =
      std::min(kTightest * u_.options.weights[Term::Area], kTightening * state_.areaStiffness);
}

/// How near contacts are at the new positions; those pressed close stiffen from the next step on.
void ImplicitStep::accountForContacts() {
  struct Nearness {
    double nearest = kInfinity, pressed = 1;
    void operator+=(const Nearness& other) {
      nearest = std::min(nearest, other.nearest);
      pressed = std::min(pressed, other.pressed);
    }
  };
  constexpr std::size_t kGrain = 256;  // elements a task
  const Nearness all =
      parallelSum(contacts_.size(), kGrain, Nearness{}, [&](std::size_t begin, std::size_t end) {
        Nearness block;
        for (std::size_t n = begin; n < end; ++n) {
          const Contact& c = contacts_[n];
          const double squared = squaredDistance(c, trial_);
          block.nearest = std::min(block.nearest, squared);
          const double share = std::sqrt(squared) / c.range;
          if (share < block.pressed && squared < kClosing * squaredDistance(c, state_.positions)) {
            block.pressed = share;
          }
        }
        return block;
      });
  now_.contacts = static_cast<int>(contacts_.size());
  now_.nearestContact = contacts_.empty() ? kNaN : std::sqrt(all.nearest);
  if (!state_.separating && all.pressed < kPressed) {
    state_.contactStiffness = std::min(kStiffestContact, 2 * state_.contactStiffness);
  }
}

/// A multiplier grows by what an area is off beyond the slack, so that faces that press against
/// their areas end at its edge.
void ImplicitStep::updateMultipliers() {
  const auto faces = u_.setup.patch.ofRegion();
  const double slack = u_.options.areaSlack;
  const double largest = kLargestMultiplier * std::max(1.0, state_.drive);
  constexpr std::size_t kGrain = 1024;  // faces a task
  parallelFor(faces.size(), kGrain, [&](std::size_t f) {
    const double error = shapeOf(faces[f], state_.positions).area / faces[f].restArea - 1;
    const double excess = error - std::clamp(error, -slack, slack);
    double& multiplier = state_.multipliers[static_cast<Eigen::Index>(f)];
    multiplier = std::clamp(multiplier + state_.areaStiffness * excess, -largest, largest);
  });
}

void ImplicitStep::endSeparationIfDone() {
  double least = 1;
  for (const Contact& c : contacts_) {
    least = std::min(least, std::sqrt(squaredDistance(c, state_.positions)) / c.range);
  }
  const double energy = collision::contactEnergy(contacts_, state_.positions);
  if (least > kSeparated || energy > kStillSeparating * state_.separatingEnergy ||
      state_.iteration >= kSeparatingIterations) {
    state_.separating = false;
    state_.driveIteration = state_.iteration;
  }
  state_.separatingEnergy = energy;
}

}  // namespace

bool Unfolder::Implementation::implicitStep() {
  const double damping = state.damping;
  if (ImplicitStep(*this).take()) return true;
  if (state.separating) {
    // What is held from both sides cannot be parted: the rest unfolds beside it.
    state.separating = false;
    state.driveIteration = state.iteration;
    state.damping = damping;
    return implicitStep();
  }
  state.stalled = true;
  return false;
}

}  // namespace explica::unfolding
