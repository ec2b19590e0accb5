// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace explica::surface {

/// The lattice's Freudenthal (Kuhn) triangulation: each cell is cut into the six tetrahedra that
/// walk from its lowest corner to its highest along one axis after another.  A lattice point then
/// has 14 neighbours, seven steps up and the same seven down.
inline constexpr int kNeighbours = 14;

/// Steps to the neighbours; step n + 7 is the reverse of step n < 7.
inline constexpr std::array<std::array<int, 3>, kNeighbours> kSteps = {{{1, 0, 0},
                                                                        {0, 1, 0},
                                                                        {0, 0, 1},
                                                                        {1, 1, 0},
                                                                        {1, 0, 1},
                                                                        {0, 1, 1},
                                                                        {1, 1, 1},
                                                                        {-1, 0, 0},
                                                                        {0, -1, 0},
                                                                        {0, 0, -1},
                                                                        {-1, -1, 0},
                                                                        {-1, 0, -1},
                                                                        {0, -1, -1},
                                                                        {-1, -1, -1}}};

/// Which neighbours are foreground: bit n is the neighbour at kSteps[n].
using Neighbourhood = std::uint16_t;

/// True if the point between these neighbours can change sides without changing the topology of
/// either side: its link, a triangulated sphere of 14 vertices, holds exactly one piece of
/// foreground and one of background.  The rule is the same for both sides.
[[nodiscard]] bool isSimple(Neighbourhood foreground);

}  // namespace explica::surface
