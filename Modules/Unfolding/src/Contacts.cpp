// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Contacts.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

using collision::Contact;
using collision::Pair;
using collision::PairKind;

constexpr double kSoftBelow = 0.1;  // of a contact's range: below it force is bounded
constexpr double kParallel = 1e-3;  // of |u|^2 |v|^2, as in incremental potential contact
constexpr double kParted = 0.2;     // of the range: pairs that start nearer are parted up to there,
constexpr double kNeedle = 0.25;    // neighbours up to this share of the thinnest face's height ...
constexpr double kAsNear = 0.5;     // ... or to this one of their distance
// Of the mean edge: where faces are thinner than that, one beside the other, the surface is a hair,
// around which all pairs are as near as it is thin.  Parting them would have to blow it up.
constexpr double kHair = 0.003;

/// Height of the thinnest face at each vertex, mm.
Eigen::VectorXd thinnestFaces(const TriangleMesh& mesh) {
  Eigen::VectorXd thinnest = Eigen::VectorXd::Constant(mesh.vertexCount(), kInfinity);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
    }
    if (!(longest > 0)) continue;
    const Vector u = mesh.corner(f, 1) - mesh.corner(f, 0);
    const Vector v = mesh.corner(f, 2) - mesh.corner(f, 0);
    const double height = u.cross(v).norm() / longest;
    for (int k = 0; k < 3; ++k) {
      double& thin = thinnest[mesh.faces(f, k)];
      thin = std::min(thin, height);
    }
  }
  return thinnest;
}

/// V: the hair that a vertex belongs to, by its first vertex; -1 for those whose faces are all
/// thicker.
std::vector<std::int32_t> hairsOf(const PatchSetup& setup, const Eigen::VectorXd& thinnest) {
  const auto isThin = [&](std::int32_t v) { return thinnest[v] < kHair * setup.edge; };
  DisjointSets sets(static_cast<std::size_t>(thinnest.size()));
  for (std::int32_t v = 0; v < thinnest.size(); ++v) {
    if (!isThin(v)) continue;
    for (const std::int32_t beside : setup.topology.vertexVertices[v]) {
      if (isThin(beside)) sets.join(v, beside);
    }
  }
  std::vector<std::int32_t> hair(static_cast<std::size_t>(thinnest.size()), -1);
  for (std::int32_t v = 0; v < thinnest.size(); ++v) {
    if (isThin(v)) hair[v] = sets.root(v);
  }
  return hair;
}

/// True if the pair's features belong to one piece of surface: joined by an edge, or of one hair,
/// or by two edges at the end of one.
bool areOfOnePiece(const geometry::MeshTopology& topology, const std::vector<std::int32_t>& hair,
                   PairKind kind, const std::array<std::int32_t, 4>& v) {
  const auto adjacent = [&](std::int32_t a, std::int32_t b) {
    const auto list = topology.vertexVertices[a];
    return std::binary_search(list.begin(), list.end(), b);
  };
  const bool thin = std::any_of(v.begin(), v.end(), [&](std::int32_t a) { return hair[a] >= 0; });
  const int split = kind == PairKind::VertexFace ? 1 : 2;
  for (int i = 0; i < split; ++i) {
    for (int k = split; k < 4; ++k) {
      if (adjacent(v[i], v[k])) return true;
      if (!thin) continue;
      if (hair[v[i]] >= 0 && hair[v[i]] == hair[v[k]]) return true;
      for (const std::int32_t between : topology.vertexVertices[v[i]]) {
        if (adjacent(between, v[k])) return true;
      }
    }
  }
  return false;
}

}  // namespace

double squaredDistance(const Contact& contact, const Positions& x) {
  collision::FourPoints p;
  for (int i = 0; i < 4; ++i) p[i] = x.row(contact.vertices[i]).transpose();
  return collision::squaredDistance(contact.kind, p);
}

Contacts::Contacts(const PatchSetup& setup, const UnfolderOptions& options)
    : start_(setup.mesh.positions), range_(options.contactRange * setup.edge) {
  standAt(setup, start_);
  near_ = scene_->findPairs(start_, Positions::Zero(start_.rows(), 3), range_);
  findRanges(setup, options.method != Method::Implicit);
}

void Contacts::standAt(const PatchSetup& setup, const Positions& positions) {
  scene_ = std::make_unique<collision::CollisionScene>(TriangleMesh{positions, setup.mesh.faces},
                                                       markedOf(positions.rows(), setup.moving));
  largestCoordinate_ = 0;
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (setup.unknown[v] >= 0) continue;
    largestCoordinate_ = std::max(largestCoordinate_, positions.row(v).cwiseAbs().maxCoeff());
  }
}

void Contacts::findRanges(const PatchSetup& setup, bool mayTouch) {
  const Eigen::VectorXd thinnest = thinnestFaces(setup.mesh);
  const std::vector<std::int32_t> hair = hairsOf(setup, thinnest);
  for (const Pair& pair : *near_) {
    const double distance =
        std::sqrt(collision::squaredDistance(pair.kind, scene_->points(pair, start_)));
    const auto v = scene_->vertices(pair);
    if (distance == 0 && !mayTouch) {
      throw InvalidInput("region: the surface touches itself at vertices " + std::to_string(v[0]) +
                         " and " + std::to_string(v[3]) +
                         ", so that nothing there can move; weld coincident vertices, or part them "
                         "first (--repair)");
    }
    double thin = kInfinity;
    for (const std::int32_t vertex : v) thin = std::min(thin, thinnest[vertex]);
    const double wanted = std::max(distance, kParted * range_);
    const double needle = std::max(kAsNear * distance, std::min(wanted, kNeedle * thin));
    const bool mayStayNear = needle < wanted && areOfOnePiece(setup.topology, hair, pair.kind, v);
    ranges_.emplace_back(pair, mayStayNear ? needle : wanted);
  }
}

Contact Contacts::contactOf(const Pair& pair, double range) const {
  Contact contact;
  contact.vertices = scene_->vertices(pair);
  contact.kind = pair.kind;
  contact.softBelow = kSoftBelow;
  contact.range = range;
  if (pair.kind == PairKind::EdgeEdge) {
    const auto x = scene_->points(pair, start_);
    contact.parallelArea = kParallel * (x[1] - x[0]).squaredNorm() * (x[3] - x[2]).squaredNorm();
  }
  return contact;
}

std::vector<Contact> Contacts::contactsOf(const std::vector<Pair>& pairs) const {
  constexpr std::size_t kGrain = 1024;  // elements a task
  std::vector<Contact> contacts(pairs.size());
  const auto before = [](const auto& entry, const Pair& pair) { return entry.first < pair; };
  parallelForBlocks(pairs.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    auto own = std::lower_bound(ranges_.begin(), ranges_.end(), pairs[begin], before);
    for (std::size_t n = begin; n < end; ++n) {
      while (own != ranges_.end() && own->first < pairs[n]) ++own;
      const bool known = own != ranges_.end() && own->first == pairs[n];
      contacts[n] = contactOf(pairs[n], known ? own->second : range_);
    }
  });
  return contacts;
}

std::vector<Contact> Contacts::within(const Positions& x) {
  if (!near_) near_ = scene_->findPairs(x, Positions::Zero(x.rows(), 3), range_);
  return collision::contactsWithin(contactsOf(*near_), x);
}

}  // namespace explica::unfolding
