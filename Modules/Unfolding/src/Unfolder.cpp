// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Guide.h"
#include "Room.h"
#include "UnfolderImplementation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/PhaseClock.h"
#include "Explica/Visibility/AverageVisibility.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kSunk = 0.01;   // of the region's area: less than that below is no reason
constexpr int kMostWays = 3;     // times that surroundings are asked to part further ...
constexpr double kWiden = 1.5;   // ... by this factor of the collar's width ...
constexpr double kStronger = 2;  // ... and this one of the lift

}  // namespace

Unfolder::Implementation::Implementation(TriangleMesh mesh, Region region,
                                         visibility::Viewpoints eyes, const UnfolderOptions& chosen)
    : viewpoints(std::move(eyes)),
      options(chosen),
      setup(setUpPatch(std::move(mesh), std::move(region), viewpoints, options)),
      contacts(setup, options) {
  state.positions = setup.mesh.positions;
  state.multipliers = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(setup.patch.regionFaces));
  state.areaStiffness = options.weights[Term::Area];
  state.collarWidth = setup.collarWidth;
  makeKnot(state.positions);
  measure(record);
}

void Unfolder::Implementation::standAt(const Positions& positions) {
  contacts.standAt(setup, positions);
  makeKnot(positions);
}

void Unfolder::Implementation::setUpCollar(double width) {
  options.collarWidth = width;
  setup = setUpPatch(std::move(setup.mesh), std::move(setup.region), viewpoints, options);
  contacts = Contacts(setup, options);
  standAt(state.positions);
  contacts.forget();
}

void Unfolder::Implementation::makeKnot(const Positions& positions) {
  const TriangleMesh standing{positions, setup.mesh.faces};
  knot =
      repulsion::makeKnotEnergy(options.knot, standing, markedOf(positions.rows(), setup.moving));
}

TermValues Unfolder::Implementation::strengths() const {
  TermValues strengths = options.weights;
  strengths[Term::Visibility] = state.drive;
  strengths[Term::Overhang] *= state.drive;
  strengths[Term::Area] = state.areaStiffness;
  strengths[Term::Lift] *= state.lift;
  if (options.surround == Surround::None) strengths[Term::Lift] = 0;
  strengths[Term::Contact] *= setup.edge * setup.edge;
  return strengths;
}

Configuration Unfolder::Implementation::configurationAt(
    const Positions& x, std::span<const collision::Contact> near) const {
  Configuration now(setup.patch, x, viewpoints, state.multipliers, near, knot.get());
  if (state.directions.rows() > 0) now.directions = &state.directions;
  return now;
}

double Unfolder::Implementation::meanFlux() const {
  const auto faces = setup.patch.ofRegion();
  double flux = 0, area = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const FaceShape shape = shapeOf(faces[f], state.positions);
    flux += shape.area * state.directions.row(static_cast<Eigen::Index>(f)).dot(shape.normal);
    area += shape.area;
  }
  return flux / area;
}

void Unfolder::Implementation::measure(IterationRecord& account) const {
  const PhaseClock clock(account.phases.visibility);
  account.visibility =
      state.directions.rows() > 0
          ? meanFlux()
          : visibility::AverageVisibility(setup.mesh.faces, setup.region.faces, viewpoints)
                .value(state.positions);
  double sum = 0, largest = 0, off = 0, area = 0;
  const auto faces = setup.patch.ofRegion();
  std::vector<double> errors(faces.size());
  parallelFor(faces.size(), [&](std::size_t f) {
    errors[f] = std::abs(shapeOf(faces[f], state.positions).area / faces[f].restArea - 1);
  });
  for (std::size_t f = 0; f < faces.size(); ++f) {
    sum += errors[f];
    largest = std::max(largest, errors[f]);
    off += errors[f] * faces[f].restArea;
    area += faces[f].restArea;
  }
  account.areaErrorMean = sum / static_cast<double>(setup.patch.regionFaces);
  account.areaErrorMax = largest;
  account.areaErrorShare = off / area;
  sum = 0;
  for (const PatchSpring& spring : setup.patch.regionEdges()) {
    sum += std::abs(lengthOf(spring, state.positions) / spring.restLength - 1);
  }
  account.edgeStrainMean = sum / static_cast<double>(setup.patch.regionSprings);
  sum = 0;
  largest = 1;
  for (const PatchFace& face : setup.patch.ofCollar()) {
    const double ratio = shapeOf(face, state.positions).area / face.restArea;
    sum += ratio;
    largest = std::max(largest, ratio);
  }
  account.collarStretchMean =
      setup.collar.empty() ? kNaN : sum / static_cast<double>(setup.collar.size());
  account.collarStretchMax = setup.collar.empty() ? kNaN : largest;
}

Unfolder::Unfolder(TriangleMesh mesh, Region region, visibility::Viewpoints viewpoints,
                   const UnfolderOptions& options)
    : self_(std::make_unique<Implementation>(std::move(mesh), std::move(region),
                                             std::move(viewpoints), options)) {}
Unfolder::~Unfolder() = default;
Unfolder::Unfolder(Unfolder&&) noexcept = default;
Unfolder& Unfolder::operator=(Unfolder&&) noexcept = default;

bool Unfolder::step() {
  const bool moved = self_->step();
  self_->asked.reset();
  return moved;
}
void Unfolder::raiseDrive(double factor) {
  self_->state.drive *= factor;
  self_->state.driveIteration = self_->state.iteration;
}
void Unfolder::steer(Phase phase, double factor) {
  self_->asked = phase;
  self_->state.drive *= factor;
}
bool Unfolder::isHeldBelow() const {
  return self_->options.surround == Surround::Elastic && self_->state.ways < kMostWays &&
         sunkShare(self_->setup.patch, self_->state.positions) > kSunk;
}
void Unfolder::makeWay() {
  UnfoldState& state = self_->state;
  ++state.ways;
  state.driveIteration = state.iteration;
  state.lift *= kStronger;
  state.collarWidth *= kWiden;
  self_->setUpCollar(state.collarWidth);
  self_->measure(self_->record);
}
double Unfolder::seenShare() const {
  return visibility::seenShare(current(), self_->setup.region.faces, self_->viewpoints);
}
double Unfolder::look() {
  Look& look = self_->state.look;
  const int now = self_->state.iteration;
  if (look.iteration == now) return look.seen;
  const double seen = seenShare();
  look = {now, seen, look.iteration < 0 ? 0 : seen - look.seen};
  return seen;
}
const UnfoldState& Unfolder::state() const {
  return self_->state;
}
void Unfolder::restore(UnfoldState state) {
  if (state.positions.rows() != self_->setup.mesh.vertexCount() ||
      state.multipliers.size() != self_->state.multipliers.size()) {
    throw InvalidInput("state: it belongs to another surface or region");
  }
  self_->state = std::move(state);
  if (self_->state.collarWidth != self_->setup.collarWidth) {
    self_->setUpCollar(self_->state.collarWidth);
  }
  const Positions& positions = self_->state.positions;
  bool standing = true;  // unless another region of the surface was unfolded before
  for (Eigen::Index v = 0; v < positions.rows() && standing; ++v) {
    standing =
        self_->setup.unknown[v] >= 0 || positions.row(v) == self_->setup.mesh.positions.row(v);
  }
  if (!standing) self_->standAt(positions);
  self_->contacts.forget();
  self_->measure(self_->record);
}
const IterationRecord& Unfolder::record() const {
  return self_->record;
}
const TriangleMesh& Unfolder::reference() const {
  return self_->setup.mesh;
}
TriangleMesh Unfolder::current() const {
  return {self_->state.positions, self_->setup.mesh.faces};
}
const Region& Unfolder::region() const {
  return self_->setup.region;
}
const std::vector<std::int32_t>& Unfolder::collarFaces() const {
  return self_->setup.collar;
}
const std::vector<std::int32_t>& Unfolder::movingVertices() const {
  return self_->setup.moving;
}
void Unfolder::setViewpoints(visibility::Viewpoints viewpoints) {
  self_->viewpoints = std::move(viewpoints);
  PatchSetup& setup = self_->setup;
  setup.patch.room = findRoom(setup.mesh, setup.region, self_->viewpoints);
  layGuide(setup.mesh, setup.patch.room, setup.patch.guide);
}
void Unfolder::setDirections(Positions directions) {
  if (directions.rows() != 0 &&
      directions.rows() != static_cast<Eigen::Index>(self_->setup.region.faces.size())) {
    throw InvalidInput("directions: " + std::to_string(directions.rows()) + " for " +
                       std::to_string(self_->setup.region.faces.size()) + " faces");
  }
  self_->state.directions = std::move(directions);
  self_->measure(self_->record);
}

}  // namespace explica::unfolding
