// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../Table.h"
#include "Explica/Pipeline/FolderReport.h"
#include "GivenMaps.h"
#include "ResultFolder.h"

namespace explica::pipeline {

/// Places on the page that flags lead to.
inline constexpr const char* kTissuePlace = "tissues";
inline constexpr const char* kOutlinePlace = "surfaces-on-image";
inline constexpr const char* kCrossingPlace = "crossing-places";
inline constexpr const char* kLayerPlace = "layers";
inline constexpr const char* kPatchPlace = "view3d";
inline constexpr const char* kDistortionPlace = "distortion";
inline constexpr const char* kProfilePlace = "profiles";
inline constexpr const char* kFlatPlace = "flat";

/// Close-ups of a kind on one page.
inline constexpr std::size_t kMostPlaces = 7;

/// Heading of the histograms of thickness, on surfaces or in voxels.
inline constexpr const char* kThicknessCharts = "Thickness";

/// What a reader must know before trusting the results, the worst first.
void flagSteps(ResultFolder& results);

/// Input, date and version.
void showHead(ResultFolder& results);

/// "explica 0.1.0, commit 77527f6"
[[nodiscard]] std::string versionOf(const StepFolder& step);

/// The table of a dozen numbers.
void findNumbers(ResultFolder& results);

/// Slices of tissue classes, or of the labels that a surface was made from.
void showTissues(ResultFolder& results, const FolderReportOptions& options);

/// White and pial outlines on the image, and the hemispheres in all their shapes with their maps
/// for the view in three dimensions.
void showSurfaces(ResultFolder& results, const FolderReportOptions& options,
                  const std::vector<GivenMap>& maps);

/// The labels of a file for the view in three dimensions; none where there is no such file.
void addLabels(report::Evolution& evolution, const std::string& title,
               const std::filesystem::path& file);

/// The reader's maps that fit.
void addGiven(report::Evolution& evolution, const std::string& side,
              const std::vector<GivenMap>& maps);

/// The unfolding: what the interactive view plays, before and after, curves and histograms.
void showUnfolding(ResultFolder& results, const StepFolder& step,
                   const std::vector<GivenMap>& maps);

/// Slices through the places where faces of the surface cross before a step changes it, unless the
/// page has them on an image.
void showCrossings(ResultFolder& results, const StepFolder& step,
                   const FolderReportOptions& options);

/// The inflation: what the interactive view plays.
void showInflation(ResultFolder& results, const StepFolder& step);

/// Frames that a step has written, thinned to what a page can hold, or else its surface and `end`,
/// the file in which it was written at the end; none if that is empty.
struct ShownFrames {
  std::vector<TriangleMesh> meshes;
  std::vector<std::string> titles;  ///< "frame 12, visibility 0.834"
};
[[nodiscard]] ShownFrames framesOf(const StepFolder& step, const std::string& end = {},
                                   std::size_t most = 26);

/// The maps of a file for the view in three dimensions, known in the region alone or, if that is
/// empty, everywhere; none where there is no such file.
void addMaps(report::Evolution& evolution, const std::filesystem::path& file,
             const std::vector<std::int32_t>& region = {});

/// Layers of the tissue in slices, and the thickness layer by layer.
void showLayers(ResultFolder& results, const StepFolder& step, const FolderReportOptions& options);

/// What a page calls a map of an unfolding: "flux after" is how directly it faces the viewpoint.
[[nodiscard]] std::string mapWords(const std::string& name);

/// Histogram of the thickness in voxels: a thick column counts more often than on a surface.
void chartThickness(ResultFolder& results, const StepFolder& step);

/// Curves over an unfolding's iterations, and histograms of its maps.
void chartUnfolding(ResultFolder& results, const StepFolder& step);

/// Histograms of a file's maps, those of before behind those of after.
/// @param region  vertices that count; empty: all
void chartMaps(ResultFolder& results, const StepFolder& step, const char* file, const char* id,
               const std::vector<std::int32_t>& region);

/// A table as it is, its numbers to a few digits; of a long one the first rows.
void tabulate(ResultFolder& results, const Table& table, const std::string& title,
              const std::string& caption);

/// Sampled maps and labels on the surface, and the table of points.
void showSampled(ResultFolder& results, const StepFolder& step);

/// Thickness, area and volume of each region.
void tabulateRegions(ResultFolder& results, const StepFolder& step);

/// Profiles over depth or layers, by region, and their course over time.
void showProfiles(ResultFolder& results, const StepFolder& step);

/// A flat map: its picture, the patch with its maps in the view in three dimensions, stacks of
/// depths, the table of regions, histograms of the distortion.
void showFlat(ResultFolder& results, const StepFolder& step, const std::vector<GivenMap>& maps);

/// Volumes on the grid of a flat map, depth by depth.
void showFlatStacks(ResultFolder& results, const StepFolder& step);

/// Pictures that a command has drawn itself: SVG and PNG files of its folder.
void showOwnPictures(ResultFolder& results, const StepFolder& step);

/// Volume, thickness and mass of a heart over its frames.
void chartBeat(ResultFolder& results, const StepFolder& step);

}  // namespace explica::pipeline
