// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/SlicePicture.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace explica::report {

/// On which side of a slice the person's left is shown.
enum class SideConvention {
  Neurological,  ///< left on the left, as seen from behind and above
  Radiological   ///< left on the right, as seen from the feet and from the front
};
constexpr auto enumWords(SideConvention) {
  using enum SideConvention;
  return std::to_array<EnumWord<SideConvention>>(
      {{Neurological, "neurological"}, {Radiological, "radiological"}});
}

/// A surface whose cut line is drawn in every tile.
struct MosaicOutline {
  const TriangleMesh* mesh = nullptr;  ///< not owned
  std::string name;                    ///< "white surface": outlines of one name share a switch
  std::string colour;                  ///< "#ff3b30", for HTML
  std::string part = {};               ///< title of the evolution on the page that has it
  std::string shape = {};              ///< which of that evolution's shapes it is
};

/// One slice, and the words and lines that lie on it.
struct MosaicTile {
  std::string place;                   ///< "x = -12 mm"
  std::array<std::string, 4> letters;  ///< at left, right, top and bottom: "L", "R", "A", "P"
  Picture picture;
  std::vector<std::string> paths;  ///< SVG path data in pixels, one an outline; may be empty
};

/// A place to look at closely.
struct CloseUp {
  Point place = Point::Zero();  ///< RAS mm
  std::string words;            ///< what is there; short
};

/// Rows of slices.
struct SliceMosaic {
  SideConvention convention = SideConvention::Neurological;
  std::vector<std::pair<std::string, std::string>> outlines;  ///< name and colour
  std::vector<std::vector<MosaicTile>> rows;                  ///< axial, coronal, sagittal
};

struct MosaicOptions {
  int perRow = 7;        ///< slices in each direction, > 0
  int tileHeight = 220;  ///< pixels
  SideConvention convention = SideConvention::Neurological;
  /// What the image is of, above 0 there: grey levels are chosen for these voxels, so that the fat
  /// of a head does not leave its brain dim.  Of the image's size; not owned; nullptr: all voxels.
  const Volume<float>* subject = nullptr;
};

/// Black below 0, white at the brightest of the subject (above 0; nullptr: of all voxels) but for
/// the last half per cent.
/// @throws InvalidInput  the subject is of another size than the image
[[nodiscard]] ColourScale greyScale(const Volume<float>& image, const Volume<float>* subject);

/// Evenly spaced slices over the box of the outlines, or else of the voxels above 0, in three
/// directions.
/// @throws InvalidInput  nothing to show, an option out of range, or a subject of another size
[[nodiscard]] SliceMosaic makeMosaic(const Volume<float>& image,
                                     const std::vector<MosaicOutline>& outlines,
                                     const MosaicOptions& options = {});
/// Slices through each of the places, `width` mm to a side and the place in their middle, ringed: a
/// column a place, a row a direction.
/// @throws InvalidInput  no place, or an option out of range
[[nodiscard]] SliceMosaic makeCloseUps(const Volume<float>& image,
                                       const std::vector<MosaicOutline>& outlines,
                                       const std::vector<CloseUp>& places, double width,
                                       const MosaicOptions& options = {});
/// The same slices of two images of one grid, such as before and after a correction: over the
/// voxels of `after` above 0, framed by those of `before`, both in the grey scale of `after`.
/// @throws as makeMosaic; InvalidInput also for images of different size
[[nodiscard]] std::array<SliceMosaic, 2> makeMosaics(const Volume<float>& before,
                                                     const Volume<float>& after,
                                                     const MosaicOptions& options = {});
/// The same of labels, each in its colour.
[[nodiscard]] SliceMosaic makeMosaic(const Volume<Label>& labels,
                                     const MosaicOptions& options = {});

}  // namespace explica::report
