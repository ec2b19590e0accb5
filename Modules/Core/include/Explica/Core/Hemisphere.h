// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>

namespace explica {

/// A side of the brain.
enum class Hemisphere { Left, Right };
constexpr auto enumWords(Hemisphere) {
  using enum Hemisphere;
  return std::to_array<EnumWord<Hemisphere>>({{Left, "left"}, {Right, "right"}});
}

}  // namespace explica
