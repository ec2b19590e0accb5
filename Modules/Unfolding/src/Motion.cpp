// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Motion.h"

#include "Explica/Core/Parallel.h"

#include <map>
#include <numeric>
#include <utility>

namespace explica::unfolding {
namespace {

using collision::Pair;

/// Groups of vertices that move as one.
class Welds {
 public:
  explicit Welds(Eigen::Index vertexCount) : parent_(static_cast<std::size_t>(vertexCount)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  void join(std::int32_t a, std::int32_t b) {
    a = rootOf(a);
    b = rootOf(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// Each group takes the mean of its motions; none with a vertex that stays.
  void moveAsOne(const std::vector<std::int32_t>& unknown, Positions& motion) {
    std::map<std::int32_t, std::pair<Vector, double>> groups;
    const auto count = static_cast<std::int32_t>(parent_.size());
    for (std::int32_t v = 0; v < count; ++v) {
      if (rootOf(v) != v) groups.try_emplace(rootOf(v), Vector::Zero(), 0.0);
    }
    for (std::int32_t v = 0; v < count; ++v) {
      const auto group = groups.find(rootOf(v));
      if (group == groups.end()) continue;
      auto& [sum, members] = group->second;
      if (unknown[v] < 0) {
        members = kInfinity;
      } else {
        sum += motion.row(v).transpose();
        members += 1;
      }
    }
    for (std::int32_t v = 0; v < count; ++v) {
      const auto group = groups.find(rootOf(v));
      if (group == groups.end()) continue;
      motion.row(v) = (group->second.first / group->second.second).transpose();
    }
  }

 private:
  std::int32_t rootOf(std::int32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

  std::vector<std::int32_t> parent_;
};

}  // namespace

void findSafeStep(const Contacts& contacts, const Positions& x, Motion& motion) {
  const auto meetings = contacts.scene().findMeetings(x, motion.by, contacts.range());
  motion.safe = collision::largestSafeStep(contacts.scene(), meetings, x, motion.by);
  motion.pairs.resize(meetings.size());
  for (std::size_t n = 0; n < meetings.size(); ++n) motion.pairs[n] = meetings[n].pair;
}

std::vector<Pair> blockingPairs(const Contacts& contacts, const Positions& x,
                                const Motion& motion) {
  const std::vector<Pair>& pairs = motion.pairs;
  const collision::CollisionScene& scene = contacts.scene();
  std::vector<char> blocks(pairs.size(), 0);
  parallelFor(pairs.size(), 512, [&](std::size_t n) {
    blocks[n] = collision::safeTime(pairs[n].kind, scene.points(pairs[n], x),
                                    scene.points(pairs[n], motion.by), kBlocked) < kBlocked;
  });
  std::vector<Pair> blocking;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    if (blocks[n]) blocking.push_back(pairs[n]);
  }
  return blocking;
}

void weldBlocking(const Contacts& contacts, const Positions& x,
                  const std::vector<std::int32_t>& unknown, const Positions& gradient,
                  Motion& motion) {
  if (motion.safe >= kBlocked) return;
  constexpr int kMaxWeldings = 8;
  Welds welds(x.rows());
  for (int welding = 0; welding < kMaxWeldings && motion.safe < kBlocked; ++welding) {
    const std::vector<Pair> blocking = blockingPairs(contacts, x, motion);
    if (blocking.empty()) return;
    for (const Pair& pair : blocking) {
      const auto v = contacts.scene().vertices(pair);
      for (int i = 1; i < 4; ++i) welds.join(v[0], v[i]);
    }
    welds.moveAsOne(unknown, motion.by);
    findSafeStep(contacts, x, motion);
    motion.descent = (gradient.array() * motion.by.array()).sum();
  }
}

}  // namespace explica::unfolding
