// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Software.h"

#include <cstdio>

/// Uses one function of each module, so that every library must link.
int main() {
  const auto sphere = explica::geometry::makeIcosphere(2);
  const auto condition = explica::geometry::inspectMesh(sphere);
  explica::Grid grid;
  grid.size = {2, 2, 2};
  explica::io::writeVolume("consumer.nii.gz", explica::Volume<explica::Label>(grid, 1));
  const auto back = explica::io::readLabels("consumer.nii.gz");
  std::printf("%s: chi %d, voxels %zu\n", explica::provenance::softwareText().c_str(),
              static_cast<int>(condition.eulerCharacteristic), back.volume.size());
  return condition.eulerCharacteristic == 2 && back.volume.size() == 8 ? 0 : 1;
}
