// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Results.h"

#include <string>

namespace explica::app {

/// A page on the results: what was tested, where, how sure, and how each person compares at the
/// peaks.
/// @param values  N x V, for plots of people at peaks; null if they are not in memory
[[nodiscard]] std::string resultPage(const GlmSettings& settings, const Observations& observations,
                                     const GlmResults& results, const Eigen::MatrixXd* values);

}  // namespace explica::app
