// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::study {

/// A column of a heart's numbers.
struct HeartColumn {
  const char* key;
  const char* unit;
  const char* meaning;
};

}  // namespace explica::study
