// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Contacts.h"
#include "PatchSetup.h"
#include "energies/Energy.h"

#include "Explica/Unfolding/Unfolder.h"

#include <memory>
#include <optional>

namespace explica::unfolding {

/// What an Unfolder holds; its steps stand in the files of their names.
struct Unfolder::Implementation {
  Implementation(TriangleMesh mesh, Region region, visibility::Viewpoints viewpoints,
                 const UnfolderOptions& options);

  visibility::Viewpoints viewpoints;
  UnfolderOptions options;
  PatchSetup setup;
  Contacts contacts;
  std::unique_ptr<repulsion::KnotEnergy> knot;
  Objective objective;
  BlockSystem system;
  UnfoldState state;
  IterationRecord record;
  std::optional<Phase> asked;  ///< of the next step, by whoever steers

  /// Fixed vertices stand at these positions from now on: as obstacles, and for the knot energy.
  void standAt(const Positions& positions);
  void makeKnot(const Positions& positions);
  /// Sets up once more with another collar, the state as it is.
  void setUpCollar(double width);

  /// Strengths of the terms in the present state.
  [[nodiscard]] TermValues strengths() const;
  [[nodiscard]] Configuration configurationAt(const Positions& x,
                                              std::span<const collision::Contact> near) const;
  void measure(IterationRecord& account) const;
  /// Mean of n . d by area, where faces have directions of their own.
  [[nodiscard]] double meanFlux() const;

  bool step() { return options.method == Method::Thesis ? thesisStep() : implicitStep(); }
  bool implicitStep();
  bool thesisStep();
};

}  // namespace explica::unfolding
