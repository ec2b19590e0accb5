// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "VolumeFormats.h"

namespace explica::io {
namespace {

[[noreturn]] StoredVolume refuseMinc(ByteSource&, const std::filesystem::path& path,
                                     const VolumeReadOptions&, Extent) {
  refuse(path,
         "is a MINC file (netCDF or HDF5), which is not read; convert it: mnc2nii IN.mnc OUT.nii");
}

/// Whether a file begins with these bytes.
template <std::size_t count>
bool begins(ByteView bytes, const char (&start)[count]) {
  const std::string_view text = textOf(bytes);
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
       readNifti,
       {{".nii.gz", true}, {".nii", false}},
       VolumeLayout{.head = niftiHeader}},
      {"NRRD", looksLikeNrrd, readNrrd},
      {"PNG", looksLikePng, readPng},
      {"MetaImage", looksLikeMetaImage, readMetaImage},
      {"MINC", looksLikeMinc, refuseMinc},
      {"MGH",
       looksLikeMgh,
       readMgh,
       {{".mgz", true}, {".mgh.gz", true}, {".mgh", false}},
       VolumeLayout{.head = mghHeader, .tail = mghFooter, .bigEndian = true}}};
  return all;
}

}  // namespace explica::io
