// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/CorticalTissue.h"
#include "Explica/Surface/TopologyCorrection.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace explica::surface {

/// How the surfaces are made.
struct SurfaceOptions {
  GenusRule genus = GenusRule::Zero;
  int faces = 150000;  ///< of each surface
  double fluid = 0;    ///< brightness of pure fluid in the image, of that of white matter; 0: not
                       ///< known, and the outer border lies too far in where fluid is narrow
};

/// Wall-clock time of each part, s.
struct SurfaceTimes {
  double topology = 0;
  double extraction = 0;
  double remeshing = 0;
  double interpolant = 0;  ///< with the recovery of buried sulci
  double trajectories = 0;
  double image = 0;    ///< placing the borders by an image
  double growing = 0;  ///< middle and outer surface
  double measures = 0;
};

/// The surface of white matter.
struct WhiteSurface {
  TriangleMesh mesh;
  LevelSet level;               ///< topology-corrected
  std::vector<Defect> defects;  ///< corrected, largest first
  std::int64_t voxelsChanged = 0;
  double correctedShare = 0;  ///< of the area, between voxels of which one was changed
  std::int64_t genus = 0;
  double edgeLength = 0;  ///< aimed at by the remeshing, mm
  SurfaceTimes seconds;
};

/// What an image has changed.
struct ImagePlacement {
  std::int64_t missingWhite = 0;  ///< vertices where the image shows no edge of the usual sense, so
  std::int64_t missingOuter = 0;  ///< that the labels' border holds
  double movedWhite = 0;          ///< mean way of the vertices, mm
  double movedOuter = 0;          ///< mean way of the trajectories' ends, mm
  double voxel = 0;               ///< mm
  /// V x 2: standard deviation of the white and of the outer border's place, mm, by how steep the
  /// image is there beside its noise; a voxel where it shows no border, 0 without ribbon.
  Eigen::MatrixXd doubt;
};

/// What is to be known of a sheet whose tissue runs out of the image.
struct SheetFacts {
  bool open = false;               ///< the surfaces are such a sheet, and may have rims
  std::int64_t rims = 0;           ///< of each surface
  std::int64_t pocketsFilled = 0;  ///< pieces of other labels within the tissue
  std::int64_t holesClosed = 0;
  std::int64_t piecesLeftOut = 0;   ///< of the sheet, small beside its thickness
  std::int64_t interpolated = 0;    ///< vertices whose trajectory does not reach both boundaries:
                                    ///< their ends are the mean of their neighbours'
  std::int64_t cutByImage = 0;      ///< vertices whose thickness the image's edge may change
  double thicknessKnown = kNaN;     ///< mean over the columns that it leaves, mm
  std::vector<std::uint8_t> known;  ///< V, 0 for both of these
};

/// Columns of tissue from the inner to the outer border.  Sums over them are sums over the tissue's
/// middle surface, whatever mesh stands for that: one whose edges are no shorter than cortex is
/// curved cuts off crowns and floors, and its vertices are too few to say where a region ends.
struct Columns {
  Positions inner, outer;     ///< C x 3, ends
  Eigen::VectorXd area;       ///< C, of the cross-section at half depth, mm^2
  Eigen::VectorXd thickness;  ///< C, mm; 0 is not known
};

/// White, middle and outer surface with the same faces; vertex i of one corresponds to vertex i of
/// the others.
struct CorticalSurfaces {
  WhiteSurface white;
  TriangleMesh mid;  ///< at half the way
  TriangleMesh pial;
  Eigen::VectorXd thickness;  ///< of the ribbon's voxels at the middle surface, mm; 0 where there
                              ///< is no ribbon
  Columns columns;            ///< one a voxel; of given surfaces one a vertex
  Eigen::VectorXd nearestThickness;  ///< as distanceThickness(), mm; 0 where there is no ribbon
  Eigen::VectorXd curvature;         ///< mean, of the white surface, mm^-1; positive in sulci
  Eigen::VectorXd sulcalDepth;    ///< of the white surface, maps::sulcalDepth, mm; empty of sheets
  std::int64_t noRibbon = 0;      ///< vertices without grey matter: all three surfaces coincide
  std::int64_t endedAtBank = 0;   ///< trajectories that end in the middle of a buried sulcus
  std::int64_t shortened = 0;     ///< trajectories far longer than all around: not followed
  std::int64_t cutLinks = 0;      ///< grid links that buried sulci cut
  std::int64_t heldBackMid = 0;   ///< vertices kept short of half their way, so that faces do not
  std::int64_t heldBackPial = 0;  ///< meet; or of their whole way
  double heldBackMean = 0;        ///< mean distance that pial ones among them fall short, mm
  double heldBackMost = 0;        ///< mm
  ImagePlacement image;           ///< all 0 without one
  SheetFacts sheet;               ///< not open unless buildSheets() made it
  SurfaceTimes seconds;
};

/// Topology correction, extraction and remeshing.  The mesh is closed, of genus 0 (unless asked
/// otherwise), of `faces` faces, and free of self-intersections by an exact test.
[[nodiscard]] WhiteSurface extractWhite(const CorticalTissue& tissue,
                                        const SurfaceOptions& options = {},
                                        const Monitor& monitor = {});

/// All three surfaces.  Vertices of the outer surface start at the ends of the trajectories of the
/// harmonic interpolant that begin at the white vertices, those of the middle one at half the arc
/// length.  Both grow out of the white surface by small moves, each checked exactly, so that
/// neither intersects itself; a vertex whose faces would meet others waits on its trajectory. Where
/// growth has left stretched, poor or folded triangles, vertices then slide along their surface,
/// and what that takes off the outer boundary grows towards it again.  A trajectory ends where it
/// no longer leaves white matter behind: from there it would only follow the floor of a sulcus.
/// Along one more than 1.3 times as long as the median within two edges of its vertex, and by half
/// a voxel, the surfaces stay at that median; thickness keeps its length.
/// @throws InvalidInput  no grey matter
[[nodiscard]] CorticalSurfaces buildSurfaces(const CorticalTissue& tissue,
                                             const SurfaceOptions& options = {},
                                             const Monitor& monitor = {});

/// What borders are placed by; let go of once that is done.
struct BorderImages {
  // NOLINTNEXTLINE(google-explicit-constructor): most have one
  BorderImages(Volume<float> only, std::optional<Volume<float>> besides = {})
      : image(std::move(only)), second(std::move(besides)) {}
  Volume<float> image;  ///< any contrast between white and grey matter and fluid, as a T1
  std::optional<Volume<float>> second;  ///< in its frame, with a contrast between grey matter and
                                        ///< fluid, as a T2 or FLAIR
};

/// As above, the borders placed by the image whose labels these are: white and outer border lie
/// where it changes most steeply along each trajectory, within about a voxel of the labels' border,
/// weighed against the neighbours' places.  Change of the usual sense only (most vertices' own)
/// counts; where it is flat or missing, as in a sulcus without visible fluid or off the image, the
/// labels' border stays, and is counted.  Where the tissue comes of shares, not of labels
/// (`byBrightness`), the white border is first searched up to 4 voxels inward: one brightness for a
/// neighbourhood may have put it into bright cortex.  Topology is kept, and nothing meets.
/// A second image has its say at the outer border.
/// @param images  on any grids
[[nodiscard]] CorticalSurfaces buildSurfaces(const CorticalTissue& tissue, BorderImages images,
                                             const SurfaceOptions& options = {},
                                             const Monitor& monitor = {});

/// Mean over the middle surface where there is grey matter, mm.
/// @param areas      of the middle surface, per column or vertex
/// @param thickness  there, mm; 0 where there is no grey matter
[[nodiscard]] double meanThickness(const Eigen::VectorXd& areas, const Eigen::VectorXd& thickness);

/// Its standard deviation over that surface, mm.
[[nodiscard]] double thicknessDeviation(const Eigen::VectorXd& areas,
                                        const Eigen::VectorXd& thickness);

template <class Visitor>
void describe(SurfaceOptions& options, Visitor&& visit) {
  visit(Field{"genus", "", "whether handles and tunnels are removed"}, options.genus);
  visit(Field{"faces", "", "faces of each surface", 100, 1e8}, options.faces);
  visit(Field{"fluid", "",
              "brightness of pure fluid in --image, of that of white matter (fluid_of_white of "
              "segment); tells the outer border where fluid is narrower than voxels; 0: not known"},
        options.fluid);
}

}  // namespace explica::surface
