// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Motion.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Parallel.h"

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

std::vector<Pair> blockingPairs(const Contacts& contacts, const Positions& x,
                                const Motion& motion) {
  const collision::AdvanceOptions options = advanceFrom(contacts, x, motion.by);
  std::vector<char> blocks(motion.meetings.size(), 0);
  parallelFor(blocks.size(), 512, [&](std::size_t n) {
    const std::span<const collision::Meeting> one(&motion.meetings[n], 1);
    blocks[n] = collision::largestSafeStep(contacts.scene(), one, x, motion.by, kBlocked, options) <
                kBlocked;
  });
  std::vector<Pair> blocking;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    if (blocks[n] != 0) blocking.push_back(motion.meetings[n].pair);
  }
  return blocking;
}

void weldBlocking(const Contacts& contacts, const Positions& x,
                  const std::vector<std::int32_t>& unknown, const Positions& gradient,
                  Motion& motion) {
  if (motion.safe >= kBlocked) return;
  constexpr int kMaxWeldings = 8;
  Welds welds(x.rows());
  const collision::CollisionScene& scene = contacts.scene();
  for (int welding = 0; welding < kMaxWeldings && motion.safe < kBlocked; ++welding) {
    const std::vector<Pair> blocking = blockingPairs(contacts, x, motion);
    if (blocking.empty()) return;
    for (const Pair& pair : blocking) {
      const auto v = scene.vertices(pair);
      for (int i = 1; i < 4; ++i) welds.join(v[0], v[i]);
    }
    const std::vector<std::int32_t> moved = welds.moveAsOne(unknown, motion.by);
    motion.meetings = scene.updateMeetings(motion.meetings, x, motion.by, contacts.range(), moved);
    motion.safe = safeShare(contacts, motion.meetings, x, motion.by);
    motion.descent = (gradient.array() * motion.by.array()).sum();
  }
}

}  // namespace explica::unfolding
