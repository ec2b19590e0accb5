// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Statistics/RandomField.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>

namespace explica::statistics {

/// A matrix of people and places that is read in blocks of places, none larger than stated.
struct PlaceBlocks {
  Eigen::Index people = 0, places = 0;
  std::size_t bytes = 0;  ///< of a block, at most; one place at least

  /// Places of a block.
  [[nodiscard]] Eigen::Index atOnce() const;
  [[nodiscard]] bool single() const { return atOnce() >= places; }
};

/// Reads every person once for each block, several at a time, and calls body(first place, N x B
/// values).
void forEachBlock(const PlaceBlocks& blocks, const PersonReader& reader,
                  const std::function<void(Eigen::Index first, Eigen::MatrixXd& values)>& body,
                  const Monitor& monitor = {});

}  // namespace explica::statistics
