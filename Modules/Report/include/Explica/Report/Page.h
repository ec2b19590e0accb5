// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Evolution.h"
#include "Explica/Report/Mosaic.h"
#include "Explica/Report/Picture.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::report {

/// How a step of the work went.
enum class StepState { Done, StoppedEarly, Interrupted, Failed, Missing };

/// What one command did.
struct ReportStep {
  std::string name;  ///< "thickness"
  StepState state = StepState::Done;
  std::string message;  ///< why it failed or stopped; empty if it is done
  std::string commandLine;
  std::string version;  ///< of the software
  double seconds = 0;
  std::vector<std::pair<std::string, std::string>> numbers;  ///< name in words, value
  std::vector<std::pair<std::string, std::string>> options;  ///< resolved, defaults included
  std::vector<std::string> warnings;
};

/// Something that a reader must know before trusting the result.
enum class FlagLevel {
  Good,
  Remark,  ///< said on the way, of no weight for the verdict
  Notice,  ///< the verdict is "look at"
  Bad      ///< the verdict is "do not use"
};
struct ReportFlag {
  FlagLevel level = FlagLevel::Good;
  std::string what;
  std::string why;
  std::string see = {};  ///< id of the picture, mosaic or chart that shows it; may be empty
};

/// Pictures by which a reader sees in a moment what the verdict says.
struct ReportGlance {
  std::string see;                     ///< id of the figure with more of it
  std::string title;                   ///< "Surfaces on the image"
  std::string guide;                   ///< what right and wrong look like
  std::vector<MosaicTile> tiles = {};  ///< slices, beside each other
  std::vector<std::pair<std::string, std::string>> outlines =
      {};                                                   ///< name and colour, of the tiles
  std::vector<std::pair<std::string, Picture>> views = {};  ///< surfaces, each with its name
  std::optional<ColourScale> scale = {};
};

/// What was measured: a table of few numbers, a column for each hemisphere or for the one result.
struct ReportFindings {
  struct Row {
    std::string what;                 ///< "Mean thickness", without unit
    std::string unit;                 ///< "mm"; may be empty
    std::vector<std::string> values;  ///< one a column, or one for all, as they are to be read
    std::string meaning = {};         ///< one sentence of definition; may be empty
    std::string expected = {};        ///< "1 to 5 mm (Fischl 2000)"; may be empty
    std::string group = {};           ///< heading over this and the rows after it; may be empty
  };
  std::vector<std::string> columns;
  std::vector<Row> rows;
};

/// A picture that lies in a file already.
struct ReportDrawing {
  std::string id;
  std::string title;
  std::string caption;
  std::string mediaType;  ///< "image/svg+xml", "image/png"
  std::string bytes;
  std::string guide = {};  ///< given: shown in the head of the page, with what right and wrong are
  int panels = 1;          ///< beside each other; on a narrow page they stand below each other
};

/// Views of surfaces beside each other, all to one scale, with one bar or legend in text.
struct ReportViews {
  std::string id;
  std::string title;
  std::string caption;
  struct View {
    std::string title;  ///< "left, lateral"
    Picture picture;
  };
  std::vector<View> views;
  std::optional<ColourScale> scale;
  std::vector<LegendEntry> legend;
};

/// Slices of a volume with outlines that can be switched off; where there is an `after`, the reader
/// can change to and fro between the two, or let them flicker.
struct ReportMosaic {
  std::string id;
  std::string title;
  std::string caption;
  SliceMosaic slices;
  std::optional<SliceMosaic> after = {};         ///< the same slices of another image
  std::array<std::string, 2> states = {"", ""};  ///< what the two images are
};

/// Slices to scroll through; sliceStackJson of SliceStack.h makes the data.
struct ReportSlices {
  std::string id;
  std::string title;
  std::string caption;
  std::vector<std::pair<std::string, std::string>> outlines = {};  ///< name and colour
  std::string json;
};

/// An SVG element of Chart.h.
struct ReportChart {
  std::string id;
  std::string svg;
  std::string group = {};  ///< heading over the charts of a group, which follow each other
};

/// Rows of words and numbers.
struct ReportTable {
  std::string id;
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`
};

/// Everything that a page shows, in the order in which it is shown.
struct ReportContent {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< "Input", "T1.mgz"; for the head
  std::vector<ReportFlag> flags;                           ///< in any order
  std::vector<ReportGlance> glance;                        ///< four at most
  ReportFindings findings;
  std::vector<Evolution> evolutions;  ///< the reader chooses among several by their titles
  std::optional<ReportSlices> slices;
  std::vector<ReportMosaic> mosaics;
  std::vector<ReportViews> views;
  std::vector<ReportDrawing> drawings;
  std::vector<ReportChart> charts;
  std::vector<ReportTable> tables;
  std::vector<ReportStep> steps;
};

/// One self-contained HTML page: styles, script, pictures and 3D data inside; opens from the file
/// system without any network request.  It answers in this order: is it right (a verdict, by the
/// worst flag, and at most three reasons), what was found, see for yourself, how it was made.
[[nodiscard]] std::string reportPage(const ReportContent& content);

}  // namespace explica::report
