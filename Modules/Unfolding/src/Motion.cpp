// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Motion.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>

namespace explica::unfolding {
namespace {

using collision::Pair;

// Of the contact range: pairs as near as that come no nearer than four fifths of their distance.
// Steps that use up nine tenths of it each time lead to gaps in which the barrier is noise.
constexpr double kTouching = 1e-2;

/// Files hold single precision: a coordinate is off by half of epsilon times its size at most, two
/// points by sqrt(3) of that each.  What is farther apart does not cross once it is written.
collision::AdvanceOptions advanceFrom(const Contacts& contacts, const Positions& x,
                                      const Positions& motion) {
  collision::AdvanceOptions options;
  options.keptDistance = kTouching * contacts.range();
  double largest = contacts.largestCoordinate();
  for (const std::int32_t v : contacts.scene().movingVertices()) {
    largest = std::max(largest, (x.row(v).cwiseAbs() + motion.row(v).cwiseAbs()).maxCoeff());
  }
  options.leastDistance = std::sqrt(3.0) * std::numeric_limits<float>::epsilon() * largest;
  return options;
}

double safeShare(const Contacts& contacts, std::span<const collision::Meeting> meetings,
                 const Positions& x, const Positions& motion) {
  return collision::largestSafeStep(contacts.scene(), meetings, x, motion, 1,
                                    advanceFrom(contacts, x, motion));
}

/// Groups of vertices that move as one.
class Welds {
 public:
  explicit Welds(Eigen::Index vertexCount) : groups_(static_cast<std::size_t>(vertexCount)) {}

  void join(std::int32_t a, std::int32_t b) {
    groups_.join(a, b);
    members_.insert({a, b});
  }

  /// Each group takes the mean of its motions; none with a vertex that stays.
  /// @return the vertices of all groups that move at all
  std::vector<std::int32_t> moveAsOne(const std::vector<std::int32_t>& unknown, Positions& motion) {
    std::map<std::int32_t, std::pair<Vector, double>> groups;
    for (const std::int32_t v : members_) {
      auto& [sum, members] = groups.try_emplace(groups_.root(v), Vector::Zero(), 0.0).first->second;
      if (unknown[v] < 0) {
        members = kInfinity;
      } else {
        sum += motion.row(v).transpose();
        members += 1;
      }
    }
    std::vector<std::int32_t> moved;
    for (const std::int32_t v : members_) {
      const auto& [sum, members] = groups.at(groups_.root(v));
      motion.row(v) = (sum / members).transpose();
      if (unknown[v] >= 0) moved.push_back(v);
    }
    return moved;
  }

 private:
  DisjointSets groups_;
  std::set<std::int32_t> members_;  ///< vertices that are in a group
};

}  // namespace

void findSafeStep(const Contacts& contacts, const Positions& x, Motion& motion) {
  motion.meetings = contacts.scene().findMeetings(x, motion.by, contacts.range());
  motion.safe = safeShare(contacts, motion.meetings, x, motion.by);
}

namespace {

/// A pair that alone would stop the motion before kBlocked of it, and the share that it allows.
struct Blocking {
  Pair pair;
  double share;
};

std::vector<Blocking> blockingPairs(const Contacts& contacts, const Positions& x,
                                    const Motion& motion) {
  const collision::AdvanceOptions options = advanceFrom(contacts, x, motion.by);
  std::vector<double> shares(motion.meetings.size());
  parallelFor(shares.size(), 512, [&](std::size_t n) {
    const std::span<const collision::Meeting> one(&motion.meetings[n], 1);
    shares[n] = collision::largestSafeStep(contacts.scene(), one, x, motion.by, kBlocked, options);
  });
  std::vector<Blocking> blocking;
  for (std::size_t n = 0; n < shares.size(); ++n) {
    if (shares[n] < kBlocked) blocking.push_back({motion.meetings[n].pair, shares[n]});
  }
  return blocking;
}

/// Changes the motion of pairs that block it, and of those that block it then, until none does.
/// @param change  given the blocking pairs, changes `motion.by`; returns where
template <class Change>
void untilClear(const Contacts& contacts, const Positions& x, Motion& motion,
                const Change& change) {
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds && motion.safe < kBlocked; ++round) {
    const std::vector<Blocking> blocking = blockingPairs(contacts, x, motion);
    if (blocking.empty()) return;
    const std::vector<std::int32_t> moved = change(blocking);
    motion.meetings =
        contacts.scene().updateMeetings(motion.meetings, x, motion.by, contacts.range(), moved);
    motion.safe = safeShare(contacts, motion.meetings, x, motion.by);
  }
}

/// Blocking pairs go along as one, without turning, or stay where something holds them.
void weld(const Contacts& contacts, const Positions& x, const std::vector<std::int32_t>& unknown,
          Motion& motion) {
  Welds welds(x.rows());
  untilClear(contacts, x, motion, [&](const std::vector<Blocking>& blocking) {
    for (const Blocking& one : blocking) {
      const auto v = contacts.scene().vertices(one.pair);
      for (int i = 1; i < 4; ++i) welds.join(v[0], v[i]);
    }
    return welds.moveAsOne(unknown, motion.by);
  });
}

/// Vertices of a blocking pair go as much less as it allows.
void slow(const Contacts& contacts, const Positions& x, const std::vector<std::int32_t>& unknown,
          Motion& motion) {
  untilClear(contacts, x, motion, [&](const std::vector<Blocking>& blocking) {
    std::map<std::int32_t, double> shares;
    for (const Blocking& one : blocking) {
      for (const std::int32_t v : contacts.scene().vertices(one.pair)) {
        if (unknown[v] < 0) continue;
        double& share = shares.try_emplace(v, one.share).first->second;
        share = std::min(share, one.share);
      }
    }
    std::vector<std::int32_t> slowed;
    for (const auto& [v, share] : shares) {
      motion.by.row(v) *= share;
      slowed.push_back(v);
    }
    return slowed;
  });
}

}  // namespace

void clearWay(const Contacts& contacts, const Positions& x,
              const std::vector<std::int32_t>& unknown, const Positions& gradient, Motion& motion) {
  if (motion.safe >= kBlocked) return;
  const Motion proposed = motion;
  weld(contacts, x, unknown, motion);
  if (motion.safe < kBlocked) {
    // Each weld runs into the next pair, where many lie close: a jam.
    motion = proposed;
    slow(contacts, x, unknown, motion);
  }
  motion.descent = (gradient.array() * motion.by.array()).sum();
}

}  // namespace explica::unfolding
