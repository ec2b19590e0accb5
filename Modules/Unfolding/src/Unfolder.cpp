// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Unfolder.h"

#include "AreaProjection.h"
#include "BlockSystem.h"
#include "PatchEnergy.h"

#include "Explica/Collision/CollisionScene.h"
#include "Explica/Collision/ContactPotential.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/PhaseClock.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace explica::unfolding {
namespace {

using collision::Contact;
using collision::Pair;
using collision::PairKind;

constexpr double kSeparated = 0.25;  // of their range: pairs that start nearer are parted first
constexpr double kStillSeparating = 0.9;   // of the contact energy before: above it the rest ...
constexpr int kSeparatingIterations = 60;  // ... or after these goes on beside the unfolding
constexpr double kMultiplierRate = 0.3;    // of the full update: the inner problem is not solved
constexpr double kLargestMultiplier = 20;  // times the pull of the visibility term
constexpr double kLeastDamping = 0.1;      // below it steps overshoot the quadratic model
constexpr double kSoftBelow = 0.1;         // of a contact's range: below it force is bounded
constexpr double kPressed = 0.03;          // of a contact's range: below it contacts stiffen ...
constexpr double kClosing = 0.99;  // of the squared distance: those that come no nearer do not
constexpr double kStiffestContact = 1e3;  // ... up to this factor
constexpr double kBlocked = 0.3;          // share of a step below which the pairs that stop it lock
constexpr double kLockStiffness = 1e5;    // against about 1 of the other terms
constexpr double kSlowGain = 0.003;       // visibility per iteration below which areas tighten ...
constexpr double kTightening = 1.2;       // ... by this factor ...
constexpr double kTightest = 20;          // ... up to this one

std::vector<bool> flags(std::size_t count, const std::vector<std::int32_t>& marked) {
  std::vector<bool> result(count, false);
  for (const std::int32_t i : marked) result[i] = true;
  return result;
}

/// A step that has been proposed, and what stands in its way.
struct Motion {
  Positions by = {};             ///< V x 3, mm
  double descent = 0;            ///< gradient . by
  double safe = 0;               ///< share of it that collision detection allows
  std::vector<Pair> pairs = {};  ///< that may meet on the way, or come within the barrier's range
};

}  // namespace

struct Unfolder::Implementation {
  TriangleMesh mesh;  ///< reference positions; faces that move or stand in the way
  Region region;      ///< faces are rows of mesh.faces
  visibility::Viewpoints viewpoints;
  UnfolderOptions options;
  UnfoldState state;
  IterationRecord record;

  double edge = 0;                    ///< mean edge length of the region, mm
  double contactRange = 0;            ///< mm
  std::vector<std::int32_t> moving;   ///< vertices that move
  std::vector<std::int32_t> unknown;  ///< V: row of the system, or -1
  PatchEnergy patch;
  std::unique_ptr<collision::CollisionScene> scene;
  std::map<Pair, double> rangeOfPair;  ///< of pairs nearer at the start than the barrier's range
  Couplings meshCouplings;
  BlockSystem system;
  std::unique_ptr<repulsion::KnotEnergy> knot;
  std::vector<Pair> near;  ///< pairs that may be within range at state.positions
  bool nearKnown = false;

  void build();
  void standAt(const Positions& positions);
  void findRoom();
  Contact contactOf(const Pair& pair) const;
  std::vector<Contact> contactsOf(const std::vector<Pair>& pairs) const;
  double objective(const Positions& x, const std::vector<Contact>& contacts,
                   IterationRecord& account) const;
  PatchStrengths strengths() const {
    return {state.separating ? 0.0 : state.drive, state.areaStiffness, options.weights.spring,
            state.separating || options.surround == Surround::None ? 0.0 : options.weights.lift};
  }
  double contactScale() const {
    return state.contactStiffness * options.weights.contact * edge * edge;
  }
  std::vector<Contact> contactsNow(IterationRecord& account);
  void endSeparationIfDone(const std::vector<Contact>& contacts);
  Positions gradientNow(const std::vector<Contact>& contacts,
                        const std::vector<collision::ContactForce>& forces,
                        IterationRecord& account) const;
  void assemble(const Couplings& couplings, const std::vector<Pair>& locked,
                const std::vector<Contact>& contacts,
                const std::vector<collision::ContactForce>& forces);
  void couple(const std::array<std::int32_t, 4>& vertices, Couplings& couplings) const;
  void addLock(const Pair& pair, const Positions& x);
  void weld(const std::vector<Pair>& pairs, std::vector<std::int32_t>& weldedTo) const;
  void moveWeldedAsOne(const std::vector<std::int32_t>& weldedTo, Positions& motion) const;
  Positions cappedMotion(const Positions& direction) const;
  void findSafeStep(Motion& motion) const;
  std::vector<Pair> blockingPairs(const Motion& motion) const;
  void weldBlocking(Motion& motion, const Positions& gradient) const;
  void accountForContacts(const std::vector<Contact>& contacts, const Positions& trial,
                          IterationRecord& now);
  void measure(IterationRecord& account) const;
  void updateMultipliers();
  bool step();
  bool implicitStep();
  bool thesisStep();
};

void Unfolder::Implementation::build() {
  if (!(options.contactRange > 0)) throw InvalidInput("contactRange: must be positive");
  if (!(options.largestMove > 0)) throw InvalidInput("largestMove: must be positive");
  if (options.timeStep && !(*options.timeStep > 0)) {
    throw InvalidInput("time-step: must be positive");
  }
  if (options.collarRings <= 0) throw InvalidInput("collarRings: must be positive");
  if (region.faces.empty()) throw InvalidInput("region: has no face");
  const auto vertexCount = static_cast<std::size_t>(mesh.vertexCount());
  if (options.surround == Surround::None) {
    Faces own(static_cast<Eigen::Index>(region.faces.size()), 3);
    for (std::size_t f = 0; f < region.faces.size(); ++f) {
      own.row(static_cast<Eigen::Index>(f)) = mesh.faces.row(region.faces[f]);
      region.faces[f] = static_cast<std::int32_t>(f);
    }
    mesh.faces = own;
  }
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());

  // Faces that belong to the patch: the region, and rings of a collar.
  std::vector<bool> moves = flags(vertexCount, region.vertices);
  std::vector<bool> inPatch = flags(static_cast<std::size_t>(mesh.faceCount()), region.faces);
  const std::vector<bool> inRegion = inPatch;
  if (options.surround == Surround::Elastic) {
    for (int ring = 0; ring < options.collarRings; ++ring) {
      std::vector<bool> grown = moves;
      for (std::size_t v = 0; v < vertexCount; ++v) {
        if (!moves[v]) continue;
        for (const std::int32_t f : topology.vertexFaces[v]) inPatch[f] = true;
        if (ring + 1 == options.collarRings) continue;  // the outermost ring ends at fixed vertices
        for (const std::int32_t w : topology.vertexVertices[v]) grown[w] = true;
      }
      moves = grown;
    }
  }
  unknown.assign(vertexCount, -1);
  for (std::size_t v = 0; v < vertexCount; ++v) {
    if (!moves[v]) continue;
    unknown[v] = static_cast<std::int32_t>(moving.size());
    moving.push_back(static_cast<std::int32_t>(v));
  }

  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  double regionArea = 0, edgeSum = 0;
  for (const std::int32_t f : region.faces) {
    if (!(areas[f] > 0)) {
      throw InvalidInput("region: face " + std::to_string(f) +
                         " has zero area, so its area cannot be kept; remesh the surface there");
    }
    regionArea += areas[f];
    for (int k = 0; k < 3; ++k) edgeSum += (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm();
  }
  edge = edgeSum / (3 * static_cast<double>(region.faces.size()));
  contactRange = options.contactRange * edge;

  // Needles: relative area errors of a face far smaller than the rest must not rule the others.
  constexpr double kNeedleShare = 0.02;
  const double needle = kNeedleShare * regionArea / static_cast<double>(region.faces.size());
  std::vector<PatchFace> faces;
  Eigen::VectorXd faceWeight = Eigen::VectorXd::Zero(mesh.faceCount());
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (!inPatch[f]) continue;
    const double area = std::max(areas[f], 1e-12 * regionArea);
    const double share = inRegion[f] ? 1 : options.weights.collar;
    faceWeight[f] = share * area * area / (area + needle);
    faces.push_back({{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)},
                     area,
                     faceWeight[f],
                     static_cast<bool>(inRegion[f])});
  }
  // All edges count alike, as in the mean strain: by area, small faces would pay for large ones.
  const double springWeight = 2 * regionArea / (3 * static_cast<double>(region.faces.size()));
  std::vector<PatchSpring> springs;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    double share = 0;  // the region's own count in full, on its rim too
    bool looked = false;
    for (int side = 0; side < 2; ++side) {
      const std::int32_t f = topology.edgeFaces(e, side);
      if (f < 0 || !inPatch[f]) continue;
      share = std::max(share, inRegion[f] ? 1 : options.weights.collar);
      looked = looked || inRegion[f];
    }
    if (share == 0) continue;
    const std::int32_t a = topology.edges(e, 0), b = topology.edges(e, 1);
    const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
    constexpr double kShort = 0.1;  // of the mean edge: what is far shorter must not rule the rest
    const double squared = length * length, tooShort = kShort * kShort * edge * edge;
    const double weight = share * springWeight * squared / (squared + tooShort);
    springs.push_back({{a, b}, length, weight, looked});
    if (unknown[a] >= 0 && unknown[b] >= 0) {
      meshCouplings.emplace_back(std::max(unknown[a], unknown[b]),
                                 std::min(unknown[a], unknown[b]));
    }
  }
  patch = PatchEnergy(std::move(faces), std::move(springs));
  findRoom();
  std::sort(meshCouplings.begin(), meshCouplings.end());

  standAt(mesh.positions);
  state.positions = mesh.positions;
  state.multipliers = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(patch.faces().size()));
  state.areaStiffness = options.weights.area;

  // A pair that starts within range keeps its distance as range, so that the start is free of
  // forces; but very near pairs are parted a little.  Neighbours in the surface may stay as near as
  // the needles among their faces make them.
  near = scene->findPairs(mesh.positions, Positions::Zero(mesh.vertexCount(), 3), contactRange);
  nearKnown = true;
  Eigen::VectorXd thinnest = Eigen::VectorXd::Constant(mesh.vertexCount(), kInfinity);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
    }
    for (int k = 0; k < 3 && longest > 0; ++k) {
      double& thin = thinnest[mesh.faces(f, k)];
      thin = std::min(thin, 2 * areas[f] / longest);
    }
  }
  const auto adjacent = [&](std::int32_t a, std::int32_t b) {
    const auto list = topology.vertexVertices[a];
    return std::binary_search(list.begin(), list.end(), b);
  };
  for (const Pair& pair : near) {
    const double distance =
        std::sqrt(collision::squaredDistance(pair.kind, scene->points(pair, mesh.positions)));
    const auto v = scene->vertices(pair);
    if (distance == 0 && options.method == Method::Implicit) {
      throw InvalidInput("region: the surface touches itself at vertices " + std::to_string(v[0]) +
                         " and " + std::to_string(v[3]) +
                         ", so that nothing there can move; weld coincident vertices, or part them "
                         "first (--repair)");
    }
    const int split = pair.kind == PairKind::VertexFace ? 1 : 2;
    bool neighbours = false;
    double thin = kInfinity;
    for (int i = 0; i < split; ++i) {
      for (int k = split; k < 4; ++k) neighbours = neighbours || adjacent(v[i], v[k]);
    }
    for (const std::int32_t vertex : v) thin = std::min(thin, thinnest[vertex]);
    constexpr double kParted = 0.2;   // of the barrier's range
    constexpr double kNeedle = 0.25;  // of the needle's height
    const double wanted = std::max(distance, kParted * contactRange);
    rangeOfPair[pair] =
        neighbours ? std::max(0.5 * distance, std::min(wanted, kNeedle * thin)) : wanted;
  }
  measure(record);
}

/// Fixed vertices stand at these positions from now on: as obstacles, and for the knot energy.
void Unfolder::Implementation::standAt(const Positions& positions) {
  const TriangleMesh standing{positions, mesh.faces};
  const std::vector<bool> moves = flags(static_cast<std::size_t>(positions.rows()), moving);
  scene = std::make_unique<collision::CollisionScene>(standing, moves);
  knot = repulsion::makeKnotEnergy(options.knot, standing, moves);
}

/// Laid flat, the patch needs a disc of its area, which is wider than the hole that it came from;
/// so it has to rise until nothing stands within that disc.
void Unfolder::Implementation::findRoom() {
  PatchRoom room;
  Point middle = Point::Zero();
  for (const std::int32_t v : region.vertices) middle += mesh.positions.row(v).transpose();
  middle /= static_cast<double>(region.vertices.size());
  Vector towards = Vector::Zero();
  for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
    towards += viewpoints.weights[k] * (viewpoints.points[k] - middle).normalized();
  }
  double area = 0;
  for (const PatchFace& face : patch.faces()) area += face.looked ? face.restArea : 0;
  room.radius = std::sqrt(area / kPi);
  if (towards.norm() > 0.1) {  // else they look from all sides, and no way leads towards them
    room.axis = towards.normalized();
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const Vector from = mesh.positions.row(v).transpose() - middle;
      const double height = room.axis.dot(from);
      if ((from - height * room.axis).norm() < room.radius) {
        room.height = std::max(room.height, room.axis.dot(mesh.positions.row(v).transpose()));
      }
    }
  }
  patch.setRoom(room);
}

Contact Unfolder::Implementation::contactOf(const Pair& pair) const {
  Contact contact;
  contact.vertices = scene->vertices(pair);
  contact.kind = pair.kind;
  contact.softBelow = kSoftBelow;
  const auto found = rangeOfPair.find(pair);
  contact.range = found == rangeOfPair.end() ? contactRange : found->second;
  if (pair.kind == PairKind::EdgeEdge) {
    const auto x = scene->points(pair, mesh.positions);
    constexpr double kParallel = 1e-3;  // of |u|^2 |v|^2, as in incremental potential contact
    contact.parallelArea = kParallel * (x[1] - x[0]).squaredNorm() * (x[3] - x[2]).squaredNorm();
  }
  return contact;
}

std::vector<Contact> Unfolder::Implementation::contactsOf(const std::vector<Pair>& pairs) const {
  std::vector<Contact> contacts(pairs.size());
  parallelFor(pairs.size(), 1024, [&](std::size_t n) { contacts[n] = contactOf(pairs[n]); });
  return contacts;
}

double Unfolder::Implementation::objective(const Positions& x, const std::vector<Contact>& contacts,
                                           IterationRecord& account) const {
  PatchValue value;
  {
    const PhaseClock clock(account.phases.visibility);
    value = patch.value(x, viewpoints, strengths(), state.multipliers);
  }
  account.energyVisibility = value.visibility;
  account.energyArea = value.area;
  account.energySpring = value.spring;
  account.energyLift = value.lift;
  {
    const PhaseClock clock(account.phases.collision);
    account.energyContact = contactScale() * collision::contactEnergy(contacts, x);
  }
  if (knot) {
    const PhaseClock clock(account.phases.repulsion);
    account.energyKnot = options.weights.knot * knot->value(x);
  }
  return value.total() + account.energyContact + account.energyKnot;
}

void Unfolder::Implementation::couple(const std::array<std::int32_t, 4>& vertices,
                                      Couplings& couplings) const {
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      const std::int32_t a = unknown[vertices[i]], b = unknown[vertices[j]];
      if (a >= 0 && b >= 0) couplings.emplace_back(std::max(a, b), std::min(a, b));
    }
  }
}

/// Stiff springs along the six lines that join a pair's four vertices: the pair can then turn and
/// shift, and open, but not slide or shear.  A rigid turn that is followed along straight lines
/// brings nothing closer, so a locked pair does not stop the step.
void Unfolder::Implementation::addLock(const Pair& pair, const Positions& x) {
  const auto v = scene->vertices(pair);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      const Vector along = (x.row(v[i]) - x.row(v[j])).transpose();
      const Eigen::Matrix3d block =
          kLockStiffness / along.squaredNorm() * along * along.transpose();
      const std::int32_t a = unknown[v[i]], b = unknown[v[j]];
      if (a >= 0) system.add(a, a, block);
      if (b >= 0) system.add(b, b, block);
      if (a >= 0 && b >= 0) system.add(a, b, -block);
    }
  }
}

/// The direction (one row per unknown) on all vertices (V x 3), none farther than it may go.
Positions Unfolder::Implementation::cappedMotion(const Positions& direction) const {
  const double largest = std::sqrt(direction.rowwise().squaredNorm().maxCoeff());
  const double cap = options.largestMove * edge;
  const double share = largest > cap ? cap / largest : 1;
  Positions motion = Positions::Zero(mesh.vertexCount(), 3);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    motion.row(moving[i]) = share * direction.row(static_cast<Eigen::Index>(i));
  }
  return motion;
}

void Unfolder::Implementation::findSafeStep(Motion& motion) const {
  motion.pairs = scene->findPairs(state.positions, motion.by, contactRange);
  motion.safe = collision::largestSafeStep(*scene, motion.pairs, state.positions, motion.by);
}

/// Pairs that alone would stop the motion before kBlocked of it.
std::vector<Pair> Unfolder::Implementation::blockingPairs(const Motion& motion) const {
  const std::vector<Pair>& pairs = motion.pairs;
  std::vector<char> blocks(pairs.size(), 0);
  parallelFor(pairs.size(), 512, [&](std::size_t n) {
    blocks[n] = collision::safeTime(pairs[n].kind, scene->points(pairs[n], state.positions),
                                    scene->points(pairs[n], motion.by), kBlocked) < kBlocked;
  });
  std::vector<Pair> blocking;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    if (blocks[n]) blocking.push_back(pairs[n]);
  }
  return blocking;
}

/// Joins the vertices of the pairs: `weldedTo` leads from each vertex to the root of its group.
void Unfolder::Implementation::weld(const std::vector<Pair>& pairs,
                                    std::vector<std::int32_t>& weldedTo) const {
  const auto root = [&](std::int32_t v) {
    while (weldedTo[v] != v) v = weldedTo[v] = weldedTo[weldedTo[v]];
    return v;
  };
  for (const Pair& pair : pairs) {
    const auto v = scene->vertices(pair);
    for (int i = 1; i < 4; ++i) {
      const std::int32_t a = root(v[0]), b = root(v[i]);
      weldedTo[std::max(a, b)] = std::min(a, b);
    }
  }
}

/// Each group takes the mean of its motions; none with a vertex that stays.
void Unfolder::Implementation::moveWeldedAsOne(const std::vector<std::int32_t>& weldedTo,
                                               Positions& motion) const {
  std::map<std::int32_t, std::pair<Vector, double>> groups;
  const auto rootOf = [&](std::int32_t v) {
    while (weldedTo[v] != v) v = weldedTo[v];
    return v;
  };
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(weldedTo.size()); ++v) {
    const std::int32_t root = rootOf(v);
    if (root != v) groups.try_emplace(root, Vector::Zero(), 0.0);
  }
  const auto groupOf = [&](std::int32_t v) { return groups.find(rootOf(v)); };
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(weldedTo.size()); ++v) {
    const auto group = groupOf(v);
    if (group == groups.end()) continue;
    auto& [sum, count] = group->second;
    if (unknown[v] < 0) {
      count = kInfinity;
    } else {
      sum += motion.row(v).transpose();
      count += 1;
    }
  }
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(weldedTo.size()); ++v) {
    const auto group = groupOf(v);
    if (group != groups.end()) {
      motion.row(v) = (group->second.first / group->second.second).transpose();
    }
  }
}

/// Pairs that still stop the motion go along without turning, or stay where something holds them.
void Unfolder::Implementation::weldBlocking(Motion& motion, const Positions& gradient) const {
  if (motion.safe >= kBlocked) return;
  constexpr int kMaxWeldings = 8;
  std::vector<std::int32_t> weldedTo(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(weldedTo.begin(), weldedTo.end(), 0);
  for (int welding = 0; welding < kMaxWeldings && motion.safe < kBlocked; ++welding) {
    const std::vector<Pair> blocking = blockingPairs(motion);
    if (blocking.empty()) return;
    weld(blocking, weldedTo);
    moveWeldedAsOne(weldedTo, motion.by);
    findSafeStep(motion);
    motion.descent = (gradient.array() * motion.by.array()).sum();
  }
}

/// How near contacts are at the new positions; those pressed close stiffen from the next step on.
void Unfolder::Implementation::accountForContacts(const std::vector<Contact>& contacts,
                                                  const Positions& trial, IterationRecord& now) {
  const auto squaredDistanceAt = [](const Contact& c, const Positions& x) {
    collision::FourPoints p;
    for (int i = 0; i < 4; ++i) p[i] = x.row(c.vertices[i]).transpose();
    return collision::squaredDistance(c.kind, p);
  };
  double nearest = kInfinity, pressed = 1;
  for (const Contact& c : contacts) {
    const double squared = squaredDistanceAt(c, trial);
    nearest = std::min(nearest, squared);
    if (squared < kClosing * squaredDistanceAt(c, state.positions)) {
      pressed = std::min(pressed, std::sqrt(squared) / c.range);
    }
  }
  now.contacts = static_cast<int>(contacts.size());
  now.nearestContact = contacts.empty() ? kNaN : std::sqrt(nearest);
  if (!state.separating && pressed < kPressed) {
    state.contactStiffness = std::min(kStiffestContact, 2 * state.contactStiffness);
  }
}

void Unfolder::Implementation::measure(IterationRecord& account) const {
  const PhaseClock clock(account.phases.visibility);
  account.visibility =
      visibility::AverageVisibility(mesh.faces, region.faces, viewpoints).value(state.positions);
  double sum = 0, largest = 0, count = 0;
  for (const PatchFace& face : patch.faces()) {
    if (!face.looked) continue;
    const Point a = state.positions.row(face.vertices[0]).transpose(),
                b = state.positions.row(face.vertices[1]).transpose(),
                c = state.positions.row(face.vertices[2]).transpose();
    const double error = std::abs(0.5 * (b - a).cross(c - a).norm() / face.restArea - 1);
    sum += error;
    largest = std::max(largest, error);
    count += 1;
  }
  account.areaErrorMean = sum / count;
  account.areaErrorMax = largest;
  sum = count = 0;
  for (const PatchSpring& spring : patch.springs()) {
    if (!spring.looked) continue;
    const double length =
        (state.positions.row(spring.vertices[0]) - state.positions.row(spring.vertices[1])).norm();
    sum += std::abs(length / spring.restLength - 1);
    count += 1;
  }
  account.edgeStrainMean = sum / count;
}

void Unfolder::Implementation::updateMultipliers() {
  for (std::size_t f = 0; f < patch.faces().size(); ++f) {
    const PatchFace& face = patch.faces()[f];
    if (!face.looked) continue;
    const Point a = state.positions.row(face.vertices[0]).transpose(),
                b = state.positions.row(face.vertices[1]).transpose(),
                c = state.positions.row(face.vertices[2]).transpose();
    const double error = 0.5 * (b - a).cross(c - a).norm() / face.restArea - 1;
    state.multipliers[f] =
        std::clamp(state.multipliers[f] + kMultiplierRate * state.areaStiffness * error,
                   -kLargestMultiplier, kLargestMultiplier);
  }
}

/// The pairs within the barrier's range, in an order that does not depend on how they were found.
std::vector<Contact> Unfolder::Implementation::contactsNow(IterationRecord& account) {
  const PhaseClock clock(account.phases.collision);
  const Positions& x = state.positions;
  if (!nearKnown) {
    near = scene->findPairs(x, Positions::Zero(x.rows(), 3), contactRange);
    nearKnown = true;
  }
  std::sort(near.begin(), near.end());
  std::vector<Contact> contacts = contactsOf(near);
  std::erase_if(contacts, [&](const Contact& c) {
    collision::FourPoints p;
    for (int i = 0; i < 4; ++i) p[i] = x.row(c.vertices[i]).transpose();
    return collision::squaredDistance(c.kind, p) >= c.range * c.range;
  });
  return contacts;
}

void Unfolder::Implementation::endSeparationIfDone(const std::vector<Contact>& contacts) {
  double least = 1;
  for (const Contact& c : contacts) {
    collision::FourPoints p;
    for (int i = 0; i < 4; ++i) p[i] = state.positions.row(c.vertices[i]).transpose();
    least = std::min(least, std::sqrt(collision::squaredDistance(c.kind, p)) / c.range);
  }
  const double energy = collision::contactEnergy(contacts, state.positions);
  if (least > kSeparated || energy > kStillSeparating * state.separatingEnergy ||
      state.iteration >= kSeparatingIterations) {
    state.separating = false;
    state.driveIteration = state.iteration;
  }
  state.separatingEnergy = energy;
}

/// V x 3, of the objective.
Positions Unfolder::Implementation::gradientNow(const std::vector<Contact>& contacts,
                                                const std::vector<collision::ContactForce>& forces,
                                                IterationRecord& account) const {
  const Positions& x = state.positions;
  Positions gradient = Positions::Zero(x.rows(), 3);
  {
    const PhaseClock clock(account.phases.visibility);
    patch.addGradient(x, viewpoints, strengths(), state.multipliers, gradient);
  }
  if (knot) {
    const PhaseClock clock(account.phases.repulsion);
    gradient += options.weights.knot * knot->evaluate(x).gradient;
  }
  const PhaseClock clock(account.phases.collision);
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    for (int i = 0; i < 4; ++i) {
      gradient.row(contacts[n].vertices[i]) +=
          contactScale() * forces[n].gradient.segment<3>(3 * i).transpose();
    }
  }
  return gradient;
}

/// The matrix of the step: Gauss-Newton, contacts, locked pairs and the damping's metric.
void Unfolder::Implementation::assemble(const Couplings& couplings, const std::vector<Pair>& locked,
                                        const std::vector<Contact>& contacts,
                                        const std::vector<collision::ContactForce>& forces) {
  const Positions& x = state.positions;
  system.reset(static_cast<std::int32_t>(moving.size()), couplings);
  for (const Pair& pair : locked) addLock(pair, x);
  patch.addStiffness(x, strengths(), state.multipliers, unknown, system);
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    if (forces[n].curvature == 0) continue;
    for (int i = 0; i < 4; ++i) {
      const std::int32_t a = unknown[contacts[n].vertices[i]];
      if (a < 0) continue;
      for (int j = 0; j <= i; ++j) {
        const std::int32_t b = unknown[contacts[n].vertices[j]];
        if (b < 0) continue;
        system.add(a, b,
                   contactScale() * forces[n].curvature * forces[n].direction.segment<3>(3 * i) *
                       forces[n].direction.segment<3>(3 * j).transpose());
      }
    }
  }
  constexpr double kMassShare = 0.01;  // of the damping: the rest is the graph Laplacian
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  for (const auto& [i, j] : meshCouplings) {
    system.add(i, i, state.damping * identity);
    system.add(j, j, state.damping * identity);
    system.add(i, j, -state.damping * identity);
  }
  system.addDiagonal(kMassShare * state.damping + 1e-9);
}

bool Unfolder::Implementation::implicitStep() {
  const Positions& x = state.positions;
  IterationRecord now;
  now.iteration = state.iteration + 1;
  const std::vector<Contact> contacts = contactsNow(now);
  if (state.separating) endSeparationIfDone(contacts);
  now.objectiveBefore = objective(x, contacts, now);
  std::vector<collision::ContactForce> forces;
  {
    const PhaseClock clock(now.phases.collision);
    forces = collision::contactForces(contacts, x);
  }
  const Positions gradient = gradientNow(contacts, forces, now);
  const auto unknownCount = static_cast<std::int32_t>(moving.size());
  Positions rightSide(unknownCount, 3);
  for (std::int32_t i = 0; i < unknownCount; ++i) rightSide.row(i) = -gradient.row(moving[i]);

  Couplings couplings = meshCouplings;
  for (const Contact& contact : contacts) couple(contact.vertices, couplings);

  constexpr int kMaxAttempts = 12;
  const double dampingBefore = state.damping;
  std::vector<Pair> locked;
  Positions direction;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt, state.damping *= 4) {
    {
      const PhaseClock clock(now.phases.solve);
      assemble(couplings, locked, contacts, forces);
      ++now.solves;
      if (!system.solve(rightSide, direction)) continue;
    }
    Motion motion{cappedMotion(direction)};
    motion.descent = (gradient.array() * motion.by.array()).sum();
    if (!(motion.descent < 0)) continue;
    std::vector<Contact> onTheWay;
    {
      const PhaseClock clock(now.phases.collision);
      findSafeStep(motion);
      if (motion.safe < kBlocked && locked.empty()) {
        // Few pairs, almost in contact, would stop all the rest: solve again, each of them rigid.
        locked = blockingPairs(motion);
        for (const Pair& pair : locked) couple(scene->vertices(pair), couplings);
        if (!locked.empty()) {
          --attempt;
          state.damping /= 4;  // of the loop: this is no failure of the model
          continue;
        }
      }
      weldBlocking(motion, gradient);
      onTheWay = contactsOf(motion.pairs);
    }
    if (!(motion.descent < 0)) continue;
    double taken = motion.safe;
    constexpr int kMaxHalvings = 8;
    bool accepted = false;
    Positions trial;
    for (int halving = 0; halving < kMaxHalvings && taken > 0; ++halving, taken *= 0.5) {
      trial = x + taken * motion.by;
      now.objectiveAfter = objective(trial, onTheWay, now);
      constexpr double kArmijo = 1e-4;
      if (now.objectiveAfter <=
          now.objectiveBefore + std::min(0.0, kArmijo * taken * motion.descent)) {
        accepted = true;
        break;
      }
    }
    if (!accepted) continue;

    now.safeStep = motion.safe;
    now.step = taken;
    now.largestMove = taken * std::sqrt(motion.by.rowwise().squaredNorm().maxCoeff());
    now.damping = state.damping;
    accountForContacts(contacts, trial, now);
    state.positions = trial;
    state.iteration = now.iteration;
    near = std::move(motion.pairs);
    if (taken == 1) {
      state.damping = std::max(kLeastDamping, state.damping / 4);
    } else if (taken < 0.25 * now.safeStep) {
      state.damping *= 2;
    }
    updateMultipliers();
    measure(now);
    if (!state.separating && std::abs(now.visibility - record.visibility) < kSlowGain) {
      state.areaStiffness =
          std::min(kTightest * options.weights.area, kTightening * state.areaStiffness);
    }
    record = now;
    return true;
  }
  if (state.separating) {
    // What is held from both sides cannot be parted: the rest unfolds beside it.
    state.separating = false;
    state.driveIteration = state.iteration;
    state.damping = dampingBefore;
    return implicitStep();
  }
  state.stalled = true;
  return false;
}

/// [Thesis, Eq. 5.46] with the sign that lets the knot energy fall, and [Thesis, Eq. 5.48].
bool Unfolder::Implementation::thesisStep() {
  const Positions& x = state.positions;
  IterationRecord now;
  now.iteration = state.iteration + 1;
  visibility::VisibilityValue average;
  {
    const PhaseClock clock(now.phases.visibility);
    average = visibility::AverageVisibility(mesh.faces, region.faces, viewpoints).evaluate(x);
  }
  Positions velocity = average.area * average.gradient;
  if (knot) {
    const PhaseClock clock(now.phases.repulsion);
    const repulsion::KnotValue value = knot->evaluate(x);
    velocity -= options.weights.knot * value.gradient;
    now.energyKnot = options.weights.knot * value.value;
  }
  for (Eigen::Index v = 0; v < velocity.rows(); ++v) {
    if (unknown[v] < 0) velocity.row(v).setZero();
  }
  if (options.keepAreas) {
    const PhaseClock clock(now.phases.solve);
    now.solves = keepAreas(patch, x, unknown, velocity).iterations;
  }
  const double fastest = std::sqrt(velocity.rowwise().squaredNorm().maxCoeff());
  if (!(fastest > 0)) {
    state.stalled = true;
    return false;
  }
  constexpr double kAdaptiveMove = 0.05;  // mean edge lengths: about as far as areas stay linear
  const double timeStep = options.timeStep.value_or(kAdaptiveMove * edge / fastest);
  now.step = timeStep;
  now.largestMove = timeStep * fastest;
  now.energyVisibility = average.area * (1 - average.value);
  now.objectiveBefore = now.energyVisibility + now.energyKnot;
  state.positions += timeStep * velocity;
  state.iteration = now.iteration;
  nearKnown = false;
  measure(now);
  now.objectiveAfter = kNaN;  // a flow: no search along the line
  record = now;
  if (!state.positions.allFinite()) throw InvalidInput("time-step: too large, the flow diverged");
  return true;
}

bool Unfolder::Implementation::step() {
  return options.method == Method::Thesis ? thesisStep() : implicitStep();
}

Unfolder::Unfolder(TriangleMesh mesh, Region region, visibility::Viewpoints viewpoints,
                   const UnfolderOptions& options)
    : self_(std::make_unique<Implementation>()) {
  self_->mesh = std::move(mesh);
  self_->region = std::move(region);
  self_->viewpoints = std::move(viewpoints);
  self_->options = options;
  self_->build();
}
Unfolder::~Unfolder() = default;
Unfolder::Unfolder(Unfolder&&) noexcept = default;
Unfolder& Unfolder::operator=(Unfolder&&) noexcept = default;

bool Unfolder::step() {
  return self_->step();
}
void Unfolder::raiseDrive(double factor) {
  self_->state.drive *= factor;
  self_->state.driveIteration = self_->state.iteration;
}
const UnfoldState& Unfolder::state() const {
  return self_->state;
}
void Unfolder::restore(UnfoldState state) {
  if (state.positions.rows() != self_->mesh.vertexCount() ||
      state.multipliers.size() != self_->state.multipliers.size()) {
    throw InvalidInput("state: it belongs to another surface or region");
  }
  self_->state = std::move(state);
  const Positions& positions = self_->state.positions;
  bool standing = true;  // unless another region of the surface was unfolded before
  for (Eigen::Index v = 0; v < positions.rows() && standing; ++v) {
    standing = self_->unknown[v] >= 0 || positions.row(v) == self_->mesh.positions.row(v);
  }
  if (!standing) self_->standAt(positions);
  self_->nearKnown = false;
  self_->measure(self_->record);
}
const IterationRecord& Unfolder::record() const {
  return self_->record;
}
const TriangleMesh& Unfolder::reference() const {
  return self_->mesh;
}
TriangleMesh Unfolder::current() const {
  return {self_->state.positions, self_->mesh.faces};
}
const Region& Unfolder::region() const {
  return self_->region;
}
const std::vector<std::int32_t>& Unfolder::movingVertices() const {
  return self_->moving;
}
void Unfolder::setViewpoints(visibility::Viewpoints viewpoints) {
  self_->viewpoints = std::move(viewpoints);
  self_->findRoom();
}
void Unfolder::setWeights(const UnfoldWeights& weights) {
  self_->options.weights = weights;
  self_->state.areaStiffness = std::max(self_->state.areaStiffness, weights.area);
}
const UnfoldWeights& Unfolder::weights() const {
  return self_->options.weights;
}

}  // namespace explica::unfolding
