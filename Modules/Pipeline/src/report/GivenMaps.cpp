// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "GivenMaps.h"

#include "Explica/IO/StatedHemisphere.h"
#include "ReportParts.h"

#include <string_view>

namespace explica::pipeline {

bool GivenMap::fits(Eigen::Index vertexCount, const std::string& ofSide) const {
  return values.size() == vertexCount && (side.empty() || ofSide.empty() || side == ofSide);
}

std::string nameBesideOthers(const std::filesystem::path& file, const std::string& map) {
  std::string stem = file.filename().string();
  for (const std::string_view ending : {".gz", ".gii", ".shape", ".func", ".mgz", ".mgh"}) {
    if (stem.size() > ending.size() && stem.ends_with(ending)) {
      stem.resize(stem.size() - ending.size());
    }
  }
  // FreeSurfer's files name their maps with the folder they came from.
  std::string own = std::filesystem::path(map).filename().string();
  if (own.starts_with(stem + " ")) own.erase(0, stem.size() + 1);  // "T1w depth 0.5"
  return own.empty() || own == stem ? stem : stem + ", " + own;
}

void addGiven(report::Evolution& evolution, const std::string& side,
              const std::vector<GivenMap>& maps) {
  for (const GivenMap& map : maps) {
    if (!map.fits(evolution.mesh.vertexCount(), side)) continue;
    evolution.maps.push_back({map.values, report::scaleFor(map.values, map.name, map.unit)});
  }
}

std::vector<GivenMap> readGivenMaps(ResultFolder& results, const std::vector<std::string>& files) {
  std::vector<GivenMap> all;
  for (const std::string& file : files) {
    results.attempt("Map " + file, [&] {
      const auto stated = io::statedHemisphere(file);
      const std::string side = stated ? std::string(nameOf(*stated)) : std::string();
      for (io::VertexMap& map : io::readVertexMaps(file)) {
        all.push_back({nameBesideOthers(file, map.name), map.unit, side, std::move(map.values)});
      }
    });
  }
  return all;
}

}  // namespace explica::pipeline
