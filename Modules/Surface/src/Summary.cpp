// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Summary.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"

namespace explica::surface {

SurfaceCheck checkOf(const TriangleMesh& mesh) {
  SurfaceCheck check;
  check.condition = geometry::inspectMesh(mesh);
  check.area = geometry::totalArea(mesh);
  check.volume.reset();
  if (check.condition.boundaryEdges == 0) check.volume = geometry::enclosedVolume(mesh);
  check.evenness = evennessOf(mesh);
  check.selfIntersections = static_cast<std::int64_t>(geometry::findSelfIntersections(mesh).size());
  return check;
}

ThicknessMeans thicknessMeansOf(const CorticalSurfaces& made, bool nearest) {
  ThicknessMeans means;
  means.measure = nearest ? "nearest" : "trajectory";
  const Eigen::VectorXd areas = geometry::vertexAreas(made.mid);
  means.trajectory = meanThickness(made.columns.area, made.columns.thickness);
  means.nearest = meanThickness(areas, made.nearestThickness);
  means.mean = nearest ? means.nearest : means.trajectory;
  means.sd = nearest ? thicknessDeviation(areas, made.nearestThickness)
                     : thicknessDeviation(made.columns.area, made.columns.thickness);
  return means;
}

std::int64_t SurfaceSummary::meetings() const {
  std::int64_t sum = 0;
  for (const auto& check : checks) sum += check ? check->selfIntersections : 0;
  return sum;
}

Eigen::VectorXd validOf(const CorticalSurfaces& made) {
  Eigen::VectorXd valid = (made.thickness.array() > 0).cast<double>().matrix();
  for (std::size_t v = 0; v < made.sheet.known.size(); ++v) {
    if (!made.sheet.known[v]) valid[static_cast<Eigen::Index>(v)] = 0;
  }
  return valid;
}

Eigen::VectorXd doubtfulOf(const CorticalSurfaces& made) {
  if (made.image.doubt.size() == 0) return {};
  return (made.image.doubt.rowwise().maxCoeff().array() > 0.5 * made.image.voxel)
      .cast<double>()
      .matrix();
}

namespace {

constexpr std::array kNames = {"white", "mid", "pial"};                              // in keys
constexpr std::array kTitles = {"white surface", "middle surface", "pial surface"};  // in titles

/// The value where it applies, else nothing.
template <class T>
std::optional<T> where(bool applies, T value) {
  return applies ? std::optional<T>(value) : std::nullopt;
}

void describeTissue(Results& t, const SurfaceSummary& s) {
  const TissueFacts facts = s.tissue ? *s.tissue : TissueFacts{};
  t.text("structure", "Structure", "As GIFTI names it.", facts.structure);
  t.text("surfaces", "Surfaces", "Made of the tissue, or given.",
         std::string(s.given ? "given" : "made"));
  t.text("preset", "Preset of the labels", "", where(!s.given, std::string(nameOf(facts.preset))));
  t.count("white_voxels", "Voxels labelled white", "", where(!s.given, facts.whiteVoxels));
  t.count("filled_voxels", "Voxels joined to them", "Ventricles and deep grey matter.",
          where(!s.given, facts.filledVoxels));
  t.count("grey_voxels", "Voxels labelled grey", "", where(!s.given, facts.greyVoxels));
  t.share("white_bare_share", "White matter without grey matter upon it",
          "Of its voxel faces to what is neither white nor insulated.", s.bareShare);
}

void describeTopology(Results& t, const SurfaceSummary& s, const CorticalSurfaces& made) {
  const geometry::MeshCondition condition =
      s.checks[0] ? s.checks[0]->condition : geometry::MeshCondition{};
  t.count("vertices", "Vertices", "Of each surface.", condition.vertices);
  t.count("faces", "Faces", "Of each surface.", condition.faces);
  Result& euler =
      t.count("euler_characteristic", "Euler characteristic",
              "Vertices - edges + faces of the white surface.", condition.eulerCharacteristic);
  if (condition.closedManifold()) {
    euler.exactly(2 - 2 * static_cast<double>(made.white.genus), Judgement::Look, "a sphere has 2");
  }
  t.count("components", "Pieces", "Of the white surface.", condition.components);
  t.flag("closed_manifold", "Closed manifold", "", condition.closedManifold());
  t.flag("manifold", "Manifold", "", condition.manifold());
  t.count("rim_edges", "Edges of the rim", "", condition.boundaryEdges);
  t.count("defects_corrected", "Topological defects corrected",
          "Handles that were cut and tunnels that were filled; topology.tsv lists them.",
          made.white.defects.size())
      .inHead()
      .compared();
  t.count("voxels_changed", "Voxels changed by that", "", made.white.voxelsChanged)
      .inHead()
      .compared();
  t.share("corrected_share", "Surface beside them",
          "Share of the white surface's area between voxels of which one was changed.",
          where(!s.given, made.white.correctedShare));
  t.count("genus", "Genus", "Of the white surface.", where(!s.given, made.white.genus));
}

void describeShape(Results& t, const SurfaceSummary& s) {
  for (std::size_t n = 0; n < s.checks.size(); ++n) {
    const bool known = s.checks[n].has_value();
    const SurfaceCheck check = s.checks[n].value_or(SurfaceCheck{});
    const std::string name = std::string("_") + kNames[n];
    const std::string of = std::string(" of the ") + kTitles[n];
    t.number("area" + name, "Area" + of, "mm^2", "", where(known, check.area)).inHead().compared();
    t.number("volume" + name, "Volume inside" + of.substr(3), "mm^3", "",
             known ? check.volume : std::nullopt);
    t.share("dihedral_above_60" + name, "Sharp edges" + of,
            "Share of edges whose faces' normals are more than 60 degrees apart.",
            where(known, check.evenness.dihedralAbove60));
    if (n == 2) {
      t.share("dihedral_above_60", "Sharp edges" + of, "The same number.",
              where(known, check.evenness.dihedralAbove60));
    }
    t.number("longest_edge" + name, "Longest edge" + of, "mm", "",
             where(known, check.evenness.longestEdge));
    t.number("least_face_area" + name, "Smallest face" + of, "mm^2", "",
             where(known, check.evenness.leastFace));
    t.number("highest_spike" + name, "Highest spike" + of, "mm",
             "Farthest that a vertex is from the mean of its neighbours.",
             where(known, check.evenness.highestSpike));
  }
  t.count("self_intersections", "Self-intersections",
          "Pairs of faces, by an exact test, over all surfaces.", s.meetings())
      .exactly(0, s.given ? Judgement::Look : Judgement::Doubt, "a surface does not cross itself");
  t.number("smallest_angle_p05_deg", "Smallest angle of faces, 5th percentile", "degrees",
           "Over the white surface.", s.smallestAngleDeg);
}

void describeThickness(Results& t, const SurfaceSummary& s, const CorticalSurfaces& made) {
  const bool known = s.thickness.has_value();
  const ThicknessMeans means = s.thickness.value_or(ThicknessMeans{});
  t.number("thickness_mean", "Mean thickness", "mm",
           "Over the area of the tissue's middle surface, whatever the number of faces. The mean "
           "over the tissue's voxels is greater: a thick column holds more voxels.",
           where(known, means.mean))
      .inHead()
      .compared();
  t.number("thickness_sd", "Standard deviation of the thickness", "mm", "Over the same area.",
           where(known, means.sd))
      .inHead();
  t.text("thickness_measure", "Measure of thickness",
         "trajectory: length of the path between the surfaces; nearest: as FreeSurfer.",
         where(known, means.measure));
  t.number("thickness_mean_trajectory", "Mean length of trajectories", "mm", "",
           where(known, means.trajectory));
  t.number("thickness_mean_nearest", "Mean of the nearest distances", "mm",
           "Both ways, as FreeSurfer.", where(known, means.nearest))
      .usual(2.3, 3.1, "95 % of 1,035 people of 6 to 64 years, ABIDE I by FreeSurfer")
      .inHead();
  t.count("vertices_without_grey", "Vertices without grey matter", "All surfaces coincide there.",
          where(known, made.noRibbon));
}

void describeMaking(Results& t, const SurfaceSummary& s, const CorticalSurfaces& made) {
  const bool grown = !s.given && s.hasGrey;
  t.number("edge_length", "Length of edges", "mm", "That the remeshing aims at.",
           where(!s.given, made.white.edgeLength));
  t.count("vertices_ended_at_bank", "Trajectories that end in a buried sulcus", "",
          where(grown, made.endedAtBank));
  t.count("trajectories_shortened", "Trajectories not followed", "Far longer than all around them.",
          where(grown, made.shortened));
  t.count("sulcal_links_recovered", "Grid links cut by buried sulci", "",
          where(grown, made.cutLinks));
  t.count("vertices_held_back_mid", "Middle vertices held back",
          "Short of half their way, so that faces do not meet.", where(grown, made.heldBackMid));
  t.count("vertices_held_back_pial", "Outer vertices held back", "Short of their whole way.",
          where(grown, made.heldBackPial));
  t.number("held_back_mean", "Mean distance they fall short", "mm", "Of the outer ones.",
           where(grown, made.heldBackMean));
  t.number("held_back_most", "Largest distance they fall short", "mm", "",
           where(grown, made.heldBackMost));
}

constexpr double kMostDoubtful = 0.1;

/// Of the white surface's area with grey matter upon it.
double doubtfulShare(const CorticalSurfaces& made) {
  const Eigen::VectorXd doubtful = doubtfulOf(made);
  if (doubtful.size() == 0) return kNaN;
  const Eigen::VectorXd areas =
      (made.thickness.array() > 0).select(geometry::vertexAreas(made.white.mesh), 0.0);
  return areas.sum() > 0 ? areas.dot(doubtful) / areas.sum() : kNaN;
}

void describeImage(Results& t, const SurfaceSummary& s, const CorticalSurfaces& made) {
  const ImagePlacement& image = made.image;
  const bool placed = s.hasImage && s.hasGrey;
  t.share("doubtful_share", "Cortex whose borders are in doubt",
          "Where the image leaves the white or the outer border more than half a voxel of standard "
          "deviation; doubt.shape.gii shows where.",
          where(placed, doubtfulShare(made)))
      .atMost(kMostDoubtful, Judgement::Look, "a tenth of the cortex")
      .inHead()
      .compared();
  t.count("vertices_without_white_edge", "Vertices without an edge of white matter",
          "The image shows none there, and the labels' border holds.",
          where(placed, image.missingWhite));
  t.count("vertices_without_outer_edge", "Vertices without an outer edge", "",
          where(placed, image.missingOuter));
  t.number("moved_by_image_white", "Mean displacement of the white border by the image", "mm", "",
           where(placed, image.movedWhite));
  t.number("moved_by_image_outer", "Mean displacement of the outer border by the image", "mm", "",
           where(placed, image.movedOuter));
  t.number("t2_moved", "Farthest way of the T2 onto the image", "mm",
           "How far the rigid motion that brings the T2 onto the image takes a corner of it.",
           s.secondMoved);
}

void describeSheet(Results& t, const SurfaceSummary& s, const SheetFacts& sheet) {
  const bool open = sheet.open || s.made == nullptr;
  t.flag("sheet", "Sheet", "Open surfaces, which end in rims.", sheet.open);
  t.count("rims", "Rims", "Of each surface.", where(open, sheet.rims));
  t.count("pockets_filled", "Pockets filled", "Pieces of other labels within the tissue.",
          where(open, sheet.pocketsFilled));
  t.count("holes_closed", "Holes closed", "", where(open, sheet.holesClosed));
  t.count("pieces_left_out", "Pieces left out", "Small beside the sheet's thickness.",
          where(open, sheet.piecesLeftOut));
  t.count("vertices_interpolated", "Vertices interpolated",
          "Thickness could not be measured there.", where(open, sheet.interpolated));
  t.count("vertices_cut_by_image", "Vertices cut by the image",
          "The image's edge may change their thickness.", where(open, sheet.cutByImage));
  t.number("thickness_mean_known", "Mean thickness where it is known", "mm", "",
           where(open, sheet.thicknessKnown));
}

void describeTimes(Results& t, bool made, const SurfaceTimes& seconds) {
  const auto time = [&](const char* key, const char* what, double value) {
    t.number(key, std::string("Time for ") + what, "s", "", where(made, value));
  };
  time("seconds_topology", "topology correction", seconds.topology);
  time("seconds_extraction", "extraction", seconds.extraction);
  time("seconds_remeshing", "remeshing", seconds.remeshing);
  time("seconds_interpolant", "the harmonic function and buried sulci", seconds.interpolant);
  time("seconds_trajectories", "trajectories", seconds.trajectories);
  time("seconds_image", "placing the borders by an image", seconds.image);
  time("seconds_growing", "growing middle and outer surface", seconds.growing);
  time("seconds_measures", "measures", seconds.measures);
}

}  // namespace

void describe(Results& t, const SurfaceSummary& s) {
  static const CorticalSurfaces none;
  const CorticalSurfaces& made = s.made ? *s.made : none;
  describeThickness(t, s, made);
  describeTissue(t, s);
  describeTopology(t, s, made);
  describeShape(t, s);
  describeImage(t, s, made);
  describeMaking(t, s, made);
  describeSheet(t, s, made.sheet);
  t.number("cerebrum_volume_ml", "Volume of the cerebrum", "ml",
           "Inside the pial surface, twice that of a single hemisphere.", s.cerebrumVolume)
      .within(kLeastCerebrum, kMostCerebrum, Judgement::Look,
              "Gilmore et al. 2007, J. Neurosci. 27:1255");
  t.count("regions", "Regions", "Of the atlas, in regions.tsv.", s.regions);
  describeTimes(t, !s.given, made.seconds);
}

}  // namespace explica::surface
