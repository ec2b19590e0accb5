// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace explica::statistics::kernels {

constexpr std::ptrdiff_t kPanelPlaces = 32;  // whose values are packed together, person by person
constexpr std::ptrdiff_t kTileWeights = 6;   // columns of weights that are summed at a time

/// sums[c * stride + v] = sum over people of panel[person * kPanelPlaces + v] * weights[person *
/// kTileWeights + c], added up in the order of the people and without fused multiply-add, so that
/// every instruction set gives the same bits.
void projectPanel(const float* panel, const float* weights, std::ptrdiff_t people, float* sums,
                  std::ptrdiff_t stride);

}  // namespace explica::statistics::kernels
