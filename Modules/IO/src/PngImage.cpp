// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "VolumeFormats.h"

#include <png.h>

#include <memory>

namespace explica::io {

StoredVolume readPng(ByteSource&, const std::filesystem::path& path, const VolumeReadOptions&,
                     Extent extent) {
  const Bytes bytes = readFile(path);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, void (*)(png_image*)> owned(&image, png_image_free);
  const auto require = [&](int success) {
    if (success == 0) failToRead(path, std::string("is damaged: ") + image.message);
  };
  require(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  if ((image.format & (PNG_FORMAT_FLAG_COLOR | PNG_FORMAT_FLAG_ALPHA)) != 0) {
    refuse(path, "is a picture in colour or with transparency; a grey one is needed");
  }
  // A compressed byte gives at most 1032, a byte at most eight pixels.
  constexpr std::int64_t kPixelsPerByte = 8 * 1032;
  const std::int64_t pixels = checkedProduct(path, {image.width, image.height});
  if (pixels > static_cast<std::int64_t>(bytes.size()) * kPixelsPerByte) {
    failToRead(path, "the file is too short for the size that its header announces");
  }
  StoredVolume volume;
  const bool wide = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  volume.type = wide ? StoredType::UInt16 : StoredType::UInt8;
  const std::array<int, 3> size = {static_cast<int>(image.width), static_cast<int>(image.height),
                                   1};
  volume.origin.path = path;
  volume.origin.format = "PNG";
  volume.origin.placement = kNotPlaced;
  volume.origin.storedType = nameOf(volume.type);
  volume.origin.storedSize = {size[0], size[1]};
  volume.origin.affine.setIdentity();
  volume.origin.affine.topRows<2>() *= -1;  // to the right and downwards, as others place it
  volume.grid = gridOf(path, size, volume.origin.affine);
  if (extent == Extent::Header) return volume;
  image.format = wide ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  volume.values.resize(static_cast<std::size_t>(pixels) * widthOf(volume.type));
  require(png_image_finish_read(&image, nullptr, volume.values.data(), 0, nullptr));
  return volume;
}

}  // namespace explica::io
