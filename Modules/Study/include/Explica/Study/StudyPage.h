// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/StudyTable.h"

#include <string>
#include <vector>

namespace explica::study {

/// A page on all rows: what failed and what to do, how the numbers are distributed, a table that
/// sorts, filters and leads to the reports, and the regions' means.
///
/// One file, no request but for the small pictures of the runs, which lie beside it; 200 rows are
/// shown at a time, so that it stays quick with 100,000.
/// @param part  HTML to stand before the distributions; may be empty
[[nodiscard]] std::string indexPage(const std::vector<StudyRow>& rows, const std::string& title,
                                    const std::string& part = {});

}  // namespace explica::study
