// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "PatchSetup.h"

#include "Explica/Collision/CollisionScene.h"
#include "Explica/Collision/ContactPotential.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace explica::unfolding {

/// Who may meet whom, and from which distance on a pair is pushed apart.
class Contacts {
 public:
  /// A pair that starts within the barrier's range keeps its distance as range, so that the start
  /// is free of forces; but very near pairs are parted a little.  Neighbours in the surface may
  /// stay as near as the needles among their faces make them.
  /// @throws InvalidInput  with the implicit method, a moving part that touches another
  Contacts(const PatchSetup& setup, const UnfolderOptions& options);

  /// Fixed vertices stand at these positions from now on.
  void standAt(const PatchSetup& setup, const Positions& positions);

  [[nodiscard]] const collision::CollisionScene& scene() const { return *scene_; }
  [[nodiscard]] double range() const { return range_; }
  /// Of the vertices that stand, mm.
  [[nodiscard]] double largestCoordinate() const { return largestCoordinate_; }

  /// The pairs' barriers, in their order, which has to be ascending.
  [[nodiscard]] std::vector<collision::Contact> contactsOf(
      const std::vector<collision::Pair>& pairs) const;

  /// The pairs within range, in an order that does not depend on how they were found.
  [[nodiscard]] std::vector<collision::Contact> within(const Positions& x);

  /// Tells all pairs that may be within range at the positions of the next call of within(),
  /// ascending.
  void remember(std::vector<collision::Pair> pairs) { near_ = std::move(pairs); }
  /// Makes the next call of within() search.
  void forget() { near_.reset(); }

 private:
  void findRanges(const PatchSetup& setup, bool mayTouch);
  [[nodiscard]] collision::Contact contactOf(const collision::Pair& pair, double range) const;

  Positions start_;
  double range_;
  double largestCoordinate_ = 0;
  std::unique_ptr<collision::CollisionScene> scene_;
  /// Of pairs nearer at the start than range_, ascending.
  std::vector<std::pair<collision::Pair, double>> ranges_;
  std::optional<std::vector<collision::Pair>> near_;
};

/// Squared distance of a contact's features, mm^2.
[[nodiscard]] double squaredDistance(const collision::Contact& contact, const Positions& x);

}  // namespace explica::unfolding
