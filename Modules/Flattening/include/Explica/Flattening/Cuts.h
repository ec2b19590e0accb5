// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Results.h"
#include "Explica/Core/Termination.h"
#include "Explica/Flattening/Opening.h"
#include "Explica/Flattening/Selection.h"

#include <map>
#include <string>
#include <vector>

namespace explica::flattening {

/// How far relief cuts are to go.
struct CutOptions {
  double edgeStrain = 0.12;  ///< mean edge strain that the map is to have, on some 3,000 vertices
  int most = 12;             ///< cuts at most
};

template <class Visitor>
void describe(CutOptions& options, Visitor&& visit) {
  visit(Field{"strain", "", "mean edge strain to reach with automatic cuts, as few as that takes",
              1e-3, 1},
        options.edgeStrain);
  visit(Field{"most", "", "automatic cuts at most", 0, 100}, options.most);
}

/// A relief cut.
struct Cut {
  CutPath path;       ///< vertices of the disc, from the rim or an earlier cut inwards
  double length = 0;  ///< mm
  double depth = 0;   ///< mean of the fold depth along it: 1 is a standard deviation inwards
  std::string name;   ///< of the template's cut that it follows; empty: found
};

/// Relief cuts, and what they give.
struct CutPlan {
  std::vector<Cut> cuts;       ///< in the order of their finding: the ones that relieve most first
  double strainBefore = kNaN;  ///< edge strain of the map without them, on some 3,000 vertices
  double edgeStrain = kNaN;    ///< with them
  std::vector<CutPath> found;  ///< the same on the vertices of the search, for going on from here
  /// TargetReached: the strain asked for; MaxIterations: as many cuts as allowed; Stalled: no
  /// further cut relieves anything; Interrupted: as many as were found until then.
  Termination termination = Termination::NotRun;

  [[nodiscard]] double length() const;  ///< of all cuts, mm
};

void describe(Results& t, const CutPlan& plan);

/// Relief cuts of a disc that is curved too much to be laid flat as it is.
///
/// A conformal map that keeps lengths along the rim scales all others by exp(u), where u is 0 on
/// the rim and its Laplacian is the Gaussian curvature [BenChen2008]: the peaks of |u| are where
/// distances suffer most, and where cuts can end [Gu2002 cut to where a map stretches most].  From
/// the two highest and the three under which most of |u| lies the cheapest way to the rim or an
/// earlier cut is tried, where a millimetre costs 2^(-depth): a standard deviation deeper in the
/// folds costs half as much.  The one is taken that lowers the map's edge strain most for its
/// length and a tenth of the square root of the area (so that few long cuts are found and not many
/// short ones), until the strain asked for is reached; the last one ends where it is.
///
/// Ways are found on some 20,000 vertices and then again on all, strains are those of flatten() on
/// some 3,000 that keep the distances of the rest.
///
/// Deterministic, and the same for any number of threads.  Holes are left alone.
/// @param depth   of the disc's vertices (foldDepth of the whole surface)
/// @param resume  go on after these cuts, which an interrupted search of the same disc left: the
///                result equals that of a search which never stopped
[[nodiscard]] CutPlan findCuts(const Disc& disc, const Eigen::VectorXd& depth,
                               const CutOptions& options = {}, const Monitor& monitor = {},
                               const CutPlan* resume = nullptr);

/// A template's cut on the sphere.
struct CutLine {
  std::string name;
  Positions points;  ///< N x 3, mm, the inner end last
};

/// Cuts that are labelled on a template's vertices: key 1 is the medial wall, each further key of
/// the table a cut from the wall, or from a cut of a smaller key, inwards.
/// @param sphere  the template's
/// @throws InvalidInput  a cut that touches neither the wall nor an earlier cut
[[nodiscard]] std::vector<CutLine> cutLines(const TriangleMesh& sphere, const VertexKeys& keys,
                                            const std::map<Label, std::string>& names);

/// Cuts of a disc along a template's: each the cheapest way from the rim or an earlier cut to the
/// vertex nearest to the line's inner end, where a millimetre costs 2^(d/h), d the distance from
/// the line on the sphere and h the mean edge of the disc there.  A line that has no way left of
/// its own is left out.
/// @param places  of the disc's vertices on a sphere in register with the template's, mm
/// @param depth   of the disc's vertices (foldDepth of the whole surface)
[[nodiscard]] CutPlan cutsAlong(const Disc& disc, const Positions& places,
                                const std::vector<CutLine>& lines, const Eigen::VectorXd& depth);

}  // namespace explica::flattening
