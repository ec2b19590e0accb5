// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Readers.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Verify.h"
#include "Explica/Study/StudyFile.h"

#include <unistd.h>

#include <fstream>

namespace explica::fuzz {
namespace {

using Path = std::filesystem::path;

/// One of several readers of a file: that it fails is no reason to leave out the others.
template <class Read>
void ask(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

void readVolume(const Path& path) {
  ask([&] { static_cast<void>(io::readScalars(path)); });
  ask([&] { static_cast<void>(io::readLabels(path)); });
  ask([&] { static_cast<void>(io::readVectors(path)); });
}
void readSurface(const Path& path) {
  ask([&] { static_cast<void>(io::readSurface(path)); });
}
void readMaps(const Path& path) {
  constexpr Eigen::Index kVertices = 12;  // of the first inputs
  ask([&] { static_cast<void>(io::readVertexMaps(path)); });
  ask([&] { static_cast<void>(io::readVertexLabels(path, kVertices)); });
}
void readPolygon(const Path& path) {
  ask([&] { static_cast<void>(io::readPolygon(path)); });
}
void readRecord(const Path& path) {
  ask([&] { static_cast<void>(provenance::verifyRecord(path, true)); });
  ask([&] { static_cast<void>(provenance::historyOf(path)); });
}
void readStudy(const Path& path) {
  ask([&] { static_cast<void>(study::readStudyFile(path)); });
}
void readConfiguration(const Path& path) {
  ask([&] {
    static_cast<void>(provenance::textOf(provenance::flattenKeys(provenance::readJson(path))));
  });
}

}  // namespace

const std::vector<Reader>& allReaders() {
  static const std::vector<Reader> all = {
      {"nifti", "volume.nii", readVolume},
      {"nifti-gz", "volume.nii.gz", readVolume},
      {"mgh", "volume.mgh", readVolume},
      {"nrrd", "volume.nrrd", readVolume},
      {"metaimage", "volume.mha", readVolume},
      {"png", "volume.png", readVolume},
      {"gifti", "a.surf.gii", readSurface},
      {"gifti-maps", "a.shape.gii", readMaps},
      {"gifti-labels", "a.label.gii", readMaps},
      {"freesurfer-surface", "lh.white", readSurface},
      {"freesurfer-curv", "lh.curv", readMaps},
      {"freesurfer-annot", "lh.a.annot", readMaps},
      {"freesurfer-label", "lh.a.label", readMaps},
      {"vtk", "legacy.vtk", readSurface},
      {"vtp", "a.vtp", readSurface},
      {"ply", "a.ply", readSurface},
      {"ply-text", "text.ply", readSurface},
      {"obj", "a.obj", readSurface},
      {"off", "a.off", readSurface},
      {"stl", "a.stl", readSurface},
      {"stl-text", "text.stl", readSurface},
      {"polygon-csv", "polygon.csv", readPolygon},
      {"polygon-vtp", "polygon.vtp", readPolygon},
      {"record", "provenance.json", readRecord},
      {"study", "study.yaml", readStudy},
      {"configuration", "options.json", readConfiguration},
  };
  return all;
}

Trial::Trial(const Reader& reader)
    : reader_(reader), folder_("/dev/shm/explica-fuzz-" + std::to_string(getpid())) {
  std::filesystem::create_directories(folder_);
}

Trial::~Trial() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Trial::read(const std::uint8_t* bytes, std::size_t count) const {
  const Path path = folder_ / reader_.file;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  reader_.read(path);
}

}  // namespace explica::fuzz
