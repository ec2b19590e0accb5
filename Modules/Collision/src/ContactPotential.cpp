// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContactPotential.h"

#include "MeetingKernels.h"

#include "Explica/Collision/Barrier.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

constexpr std::size_t kGrain = 512;  // elements a task

FourPoints pointsOf(const Contact& contact, const Positions& positions) {
  FourPoints x;
  for (int i = 0; i < 4; ++i) x[i] = positions.row(contact.vertices[i]).transpose();
  return x;
}

/// Calls visit(n), ascending, for contacts begin ... end - 1 but those that are surely out of
/// range.
template <class Visit>
void visitNear(std::span<const Contact> contacts, const Positions& positions, std::size_t begin,
               std::size_t end, const Visit& visit) {
  constexpr int kLanes = kernels::PairBatch::kLanes;
  kernels::PairBatch batch;
  for (std::size_t n = begin; n < end;) {
    const PairKind kind = contacts[n].kind;
    int count = 0;
    while (count < kLanes && n + count < end && contacts[n + count].kind == kind) ++count;
    for (int lane = 0; lane < kLanes; ++lane) {  // the last contact fills lanes that are left
      const auto& v = contacts[n + std::min(lane, count - 1)].vertices;
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
          batch.at[i][k][lane] = positions(v[i + 1], k) - positions(v[0], k);
          batch.motion[i][k][lane] = 0;
        }
      }
    }
    if (kind == PairKind::VertexFace) {
      kernels::separateVertexFace(batch);
    } else {
      kernels::separateEdgeEdge(batch);
    }
    constexpr double kRoundUp = 1 + 1e-9;
    for (int lane = 0; lane < count; ++lane) {
      if (!(batch.separation[lane] > kRoundUp * contacts[n + lane].range)) visit(n + lane);
    }
    n += count;
  }
}

/// Factor in [0, 1] that fades edge pairs out towards parallel: m = (2 - c/e) c/e below e, for
/// c = |u x v|^2 [Li2020, Eq. 24].
struct Fade {
  double value = 1;
  Vector12 gradient = Vector12::Zero();
  bool acts = false;
};

Fade fadeOf(const Contact& contact, const FourPoints& x) {
  Fade fade;
  if (contact.kind != PairKind::EdgeEdge || !(contact.parallelArea > 0)) return fade;
  const Vector u = x[1] - x[0], v = x[3] - x[2];
  const Vector cross = u.cross(v);
  const double ratio = cross.squaredNorm() / contact.parallelArea;
  if (ratio >= 1) return fade;
  fade.acts = true;
  fade.value = (2 - ratio) * ratio;
  const double slope = 2 * (1 - ratio) / contact.parallelArea;
  const Vector byU = slope * 2 * v.cross(cross), byV = slope * 2 * cross.cross(u);
  fade.gradient << -byU, byU, -byV, byV;
  return fade;
}

}  // namespace

std::vector<Contact> contactsWithin(std::span<const Contact> contacts, const Positions& positions) {
  std::vector<std::vector<Contact>> blocks((contacts.size() + kGrain - 1) / kGrain);
  parallelForBlocks(contacts.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    visitNear(contacts, positions, begin, end, [&](std::size_t n) {
      const Contact& contact = contacts[n];
      const double squared = squaredDistance(contact.kind, pointsOf(contact, positions));
      if (squared < contact.range * contact.range) blocks[begin / kGrain].push_back(contact);
    });
  });
  std::vector<Contact> near;
  for (const auto& block : blocks) near.insert(near.end(), block.begin(), block.end());
  return near;
}

double contactEnergy(std::span<const Contact> contacts, const Positions& positions) {
  return parallelSum(contacts.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    visitNear(contacts, positions, begin, end, [&](std::size_t n) {
      const Contact& contact = contacts[n];
      const FourPoints x = pointsOf(contact, positions);
      const double squared = squaredDistance(contact.kind, x);
      if (squared >= contact.range * contact.range) return;
      sum += fadeOf(contact, x).value *
             evaluateBarrier(std::sqrt(squared), contact.range, contact.softBelow).value;
    });
    return sum;
  });
}

std::vector<ContactForce> contactForces(std::span<const Contact> contacts,
                                        const Positions& positions) {
  std::vector<ContactForce> forces(contacts.size());
  parallelFor(contacts.size(), [&](std::size_t n) {
    const Contact& contact = contacts[n];
    const FourPoints x = pointsOf(contact, positions);
    const Proximity proximity = findProximity(contact.kind, x);
    if (proximity.squaredDistance >= contact.range * contact.range) return;
    const double distance = std::sqrt(proximity.squaredDistance);
    const BarrierValue barrier = evaluateBarrier(distance, contact.range, contact.softBelow);
    const Fade fade = fadeOf(contact, x);
    ContactForce& force = forces[n];
    force.direction = squaredDistanceGradient(proximity) / (2 * distance);
    force.gradient = fade.value * barrier.slope * force.direction;
    if (fade.acts) force.gradient += barrier.value * fade.gradient;
    force.curvature = fade.value * barrier.curvature;
  });
  return forces;
}

}  // namespace explica::collision
