// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Readers.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/PointTableFile.h"
#include "Explica/IO/PointTransformFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Document.h"
#include "Explica/Provenance/Verify.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>

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
void readCifti(const Path& path) {  // which is written only: as a volume, and as maps
  readVolume(path);
  readMaps(path);
}
void readTransform(const Path& path) {
  io::TransformSides sides;
  sides.volume.size = {40, 40, 40};
  sides.scannerFromTkr = Eigen::Matrix4d::Identity();
  for (const auto sense : {io::TransformSense::Auto, io::TransformSense::Inverse}) {
    sides.sense = sense;
    ask([&] { static_cast<void>(io::readPointTransform(path, sides).map(Point(1, 2, 3))); });
  }
}
void readPatch(const Path& path) {
  ask([&] { static_cast<void>(io::readPatch(path)); });
}
void readPoints(const Path& path) {
  ask([&] { static_cast<void>(io::readPointTable(path)); });
}
void readLegend(const Path& path) {
  ask([&] { static_cast<void>(io::readLabelNames(path)); });
}
void readRecord(const Path& path) {
  ask([&] { static_cast<void>(provenance::verifyRecord(path, true)); });
  ask([&] { static_cast<void>(provenance::historyOf(path)); });
}
void readStudy(const Path& path) {
  // As study::readStudyFile, with less room: a text of aliases fills any, which takes a second.
  constexpr provenance::DocumentLimits kLittle = {std::size_t{1} << 16, 32, 1000};
  ask([&] { static_cast<void>(provenance::readDocument(path, kLittle)); });
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
      {"cifti", "a.dscalar.nii", readCifti},
      {"patch", "lh.a.patch.3d", readPatch},
      {"matrix", "matrix.txt", readTransform},
      {"itk-text", "itk.tfm", readTransform},
      {"itk-mat", "itk.mat", readTransform},
      {"itk-hdf5", "itk.h5", readTransform},
      {"lta", "reg.lta", readTransform},
      {"register-dat", "register.dat", readTransform},
      {"pycortex", "matrices.xfm", readTransform},
      {"points-tsv", "points.tsv", readPoints},
      {"legend-tsv", "legend.tsv", readLegend},
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
  file_ = open((folder_ / reader_.file).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
}

Trial::~Trial() {
  close(file_);
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Trial::read(const std::uint8_t* bytes, std::size_t count) const {
  const bool written = ftruncate(file_, static_cast<off_t>(count)) == 0 &&
                       pwrite(file_, bytes, count, 0) == static_cast<ssize_t>(count);
  if (!written) std::abort();
  reader_.read(folder_ / reader_.file);
}

}  // namespace explica::fuzz
