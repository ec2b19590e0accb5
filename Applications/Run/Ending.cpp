// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Ending.h"

#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"

#include <array>
#include <optional>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr std::array<std::array<const char*, 2>, 3> kSides = {
    {{"", ""}, {"-L", "left "}, {"-R", "right "}}};

Json readIfThere(const fs::path& file) {
  return isThere(file) ? provenance::readJson(file) : Json::object();
}

std::optional<double> number(const Json& summary, const char* key) {
  const auto found = summary.find(key);
  if (found == summary.end() || !found->is_number()) return {};
  return found->get<double>();
}

/// "left 2.61 mm (SD 0.62)", from the surfaces, else from the volume.
std::string thicknessOf(const fs::path& out, const char* ending, const char* side) {
  const Json surface = readIfThere(out / ("surface" + std::string(ending)) / "summary.json");
  if (const auto mean = number(surface, "thickness_mean")) {
    const auto deviation = number(surface, "thickness_sd");
    return printed("%s%.2f mm", side, *mean) +
           (deviation ? printed(" (SD %.2f over the surface)", *deviation) : "");
  }
  const Json volume = readIfThere(out / ("thickness" + std::string(ending)) / "summary.json");
  const auto mean = number(volume, "thickness_mean");
  return mean ? printed("%s%.2f mm", side, *mean) : std::string();
}

std::string placeOf(const fs::path& folder) {
  const Json record = readIfThere(folder / provenance::kRecordName);
  if (!record.contains("options") || !record["options"].contains("center")) return {};
  const Json& c = record["options"]["center"];
  if (!c.is_array() || c.size() != 3) return {};
  return printed(" about (%.0f, %.0f, %.0f)", c[0].get<double>(), c[1].get<double>(),
                 c[2].get<double>());
}

std::string patchOf(const fs::path& out, const char* ending, const char* side) {
  const fs::path folder = out / ("unfold" + std::string(ending));
  const Json summary = readIfThere(folder / "summary.json");
  const auto area = number(summary, "region_area");
  const auto before = number(summary, "visibility_initial");
  const auto after = number(summary, "visibility_final");
  const auto strain = number(summary, "edge_strain_mean");
  if (!area || !before || !after || !strain) return {};
  return printed("%spatch: %.0f mm^2", side, *area) + placeOf(folder) +
         printed(", visibility %.2f before, %.2f after, mean edge strain %.1f %%", *before, *after,
                 100 * *strain);
}

}  // namespace

std::vector<std::string> whatCameOut(const fs::path& out) {
  std::string thickness;
  std::vector<std::string> lines;
  for (const auto& [ending, side] : kSides) {
    const std::string one = thicknessOf(out, ending, side);
    if (!one.empty()) thickness += (thickness.empty() ? "thickness: " : ", ") + one;
  }
  if (!thickness.empty()) lines.push_back(thickness);
  for (const auto& [ending, side] : kSides) {
    const std::string patch = patchOf(out, ending, side);
    if (!patch.empty()) lines.push_back(patch);
  }
  return lines;
}

}  // namespace explica::app
