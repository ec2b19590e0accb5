// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "VolumeFormats.h"

#include "ItkVolume.h"
#include "MghFormat.h"
#include "NiftiFormat.h"
#include "PngImage.h"

namespace explica::io {
namespace {

using Path = std::filesystem::path;

StoredVolume readNiftiFile(ByteSource& source, const Path&, const VolumeReadOptions& options,
                           Extent extent) {
  return readNifti(source, options.placement, extent);
}

StoredVolume readMghFile(ByteSource& source, const Path&, const VolumeReadOptions&, Extent extent) {
  return readMgh(source, extent);
}

[[noreturn]] StoredVolume refuseMinc(ByteSource&, const Path& path, const VolumeReadOptions&,
                                     Extent) {
  refuse(path,
         "is a MINC file (netCDF or HDF5), which is not read; convert it: mnc2nii IN.mnc OUT.nii");
}

/// ITK opens the file itself.
template <ItkFormat format>
StoredVolume readByItk(ByteSource&, const Path& path, const VolumeReadOptions&, Extent extent) {
  return readWithItk(path, format, extent);
}

StoredVolume readPngFile(ByteSource&, const Path& path, const VolumeReadOptions&, Extent extent) {
  return readPng(path, extent);
}

/// Whether a file begins with these bytes.
template <std::size_t count>
bool begins(ByteView bytes, const char (&start)[count]) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with(std::string_view(start, count - 1));
}

bool looksLikeNrrd(ByteView bytes) {
  return begins(bytes, "NRRD000");
}

bool looksLikePng(ByteView bytes) {
  return begins(bytes, "\x89PNG\r\n\x1a\n");
}

bool looksLikeMinc(ByteView bytes) {
  return begins(bytes, "CDF\1") || begins(bytes, "CDF\2") || begins(bytes, "\x89HDF\r\n\x1a\n");
}

bool looksLikeMetaImage(ByteView bytes) {
  return begins(bytes, "ObjectType") || begins(bytes, "NDims");
}

}  // namespace

const std::vector<VolumeFormat>& volumeFormats() {
  static const std::vector<VolumeFormat> all = {
      {"NIfTI",
       looksLikeNifti,
       readNiftiFile,
       {{".nii.gz", true}, {".nii", false}},
       VolumeLayout{.head = niftiHeader}},
      {"NRRD", looksLikeNrrd, readByItk<ItkFormat::Nrrd>},
      {"PNG", looksLikePng, readPngFile},
      {"MetaImage", looksLikeMetaImage, readByItk<ItkFormat::MetaImage>},
      {"MINC", looksLikeMinc, refuseMinc},
      {"MGH",
       looksLikeMgh,
       readMghFile,
       {{".mgz", true}, {".mgh.gz", true}, {".mgh", false}},
       VolumeLayout{.head = mghHeader, .tail = mghFooter, .bigEndian = true}}};
  return all;
}

}  // namespace explica::io
