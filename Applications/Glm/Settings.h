// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Statistics/Shuffler.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::app {

/// What is done about differences between sites.
enum class SiteModel { None, Fixed, Random, Combat };
constexpr auto enumWords(SiteModel) {
  using enum SiteModel;
  return std::to_array<EnumWord<SiteModel>>(
      {{None, "none"}, {Fixed, "fixed"}, {Random, "random"}, {Combat, "combat"}});
}

/// Options of `explica glm`.
struct GlmSettings {
  std::optional<std::string> regions, maps, table;
  std::vector<std::string> surfaces, masks, atlases, columns, contrasts;
  std::string model;
  std::string person = "participant_id";
  bool subset = false;
  SiteModel site = SiteModel::None;
  std::string siteColumn = "site";
  std::optional<std::string> blocks;
  statistics::Exchange exchange = statistics::Exchange::Auto;
  int permutations = 0;
  int seed = 1;
  bool tfce = false;
  double threshold = 0.001;
  int blockMegabytes = 1024;
};

}  // namespace explica::app
