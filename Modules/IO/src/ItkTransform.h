// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <filesystem>
#include <functional>

namespace explica::io {

/// The map of an ITK transform file, or its inverse, from RAS to RAS.  A file of several transforms
/// is their composite, the last one applied first, as ITK has it.
/// @throws IOError       ITK cannot read it
/// @throws InvalidInput  not of three dimensions, or without the inverse that is wanted
[[nodiscard]] std::function<Point(const Point&)> readItkTransform(const std::filesystem::path& path,
                                                                  bool inverse);

}  // namespace explica::io
