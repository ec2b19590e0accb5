// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>
#include <utility>

namespace explica {

/// A side of the brain.
enum class Hemisphere { Left, Right };

template <>
struct EnumNames<Hemisphere> {
  static constexpr std::array table = {std::pair{Hemisphere::Left, "left"},
                                       std::pair{Hemisphere::Right, "right"}};
};

}  // namespace explica
