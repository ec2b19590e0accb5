// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Summary.h"

namespace explica::sphere {
namespace {

constexpr const char* kOneToOne = "the map is one to one";

}  // namespace

void describe(Results& t, const SphereSummary& s) {
  const SphereDistortion& d = s.distortion;
  t.count("turned_over", "Faces turned over", "By an exact test of what is written.", d.turnedOver)
      .exactly(0, Judgement::Doubt, kOneToOne)
      .inHead();
  t.number("areal_log2_mean", "Change of areas, mean of |log2|", "", "Over the surface's area.",
           d.arealMean)
      .inHead();
  t.number("areal_log2_max", "Change of areas, largest |log2|", "", "", d.arealMax);
  t.number("stretch_median", "Largest over smallest stretch, median", "",
           "Over the surface's area; 1 where angles are kept.", d.stretchMedian)
      .inHead();
  t.number("stretch_p95", "Largest over smallest stretch, 95th percentile", "", "", d.stretchP95)
      .inHead();
  t.count("vertices_moved_by_rounding", "Vertices moved after rounding",
          "So that no face is turned over in single precision.", s.moved);
  t.count("iterations", "Iterations", "Of all levels.", s.iterations);
  t.text("stop_reason", "Why it ended", "", s.stopReason);
}

void describe(Results& t, const SphereRegistration& r) {
  const auto areal = [&](auto measure) {
    return r.arealLog2.size() > 0 ? std::optional(measure(r.arealLog2.array().abs()))
                                  : std::nullopt;
  };
  t.number("folding_correlation_before", "Correlation of sulcal depth before", "", "",
           r.before.sulc);
  t.number("folding_correlation_after", "Correlation of sulcal depth with the template", "", "",
           r.after.sulc)
      .after("folding_correlation_before")
      .inHead();
  t.number("curvature_correlation_before", "Correlation of mean curvature before", "", "",
           r.before.curvature);
  t.number("curvature_correlation_after", "Correlation of mean curvature with the template", "", "",
           r.after.curvature)
      .after("curvature_correlation_before")
      .inHead();
  t.count("turned_over", "Faces turned over", "By an exact test of what is written.",
          r.rounding.turnedAfter)
      .exactly(0, Judgement::Doubt, kOneToOne)
      .inHead();
  t.count("faces_mended", "Faces turned over before they were mended", "", r.rounding.turnedBefore);
  t.count("vertices_mended", "Vertices moved for that", "", r.rounding.moved.size());
  t.number("areal_log2_mean", "Change of areas, mean of |log2|", "", "Over the vertices.",
           areal([](const auto& a) { return a.mean(); }))
      .inHead();
  t.number("areal_log2_max", "Change of areas, largest |log2|", "", "",
           areal([](const auto& a) { return a.maxCoeff(); }));
  t.number("rotation_degrees", "Rotation nearest to the map", "degrees", "",
           Eigen::AngleAxisd(r.rotation).angle() * 180 / kPi);
  t.count("iterations", "Iterations", "Of all levels.", r.iterations);
}

}  // namespace explica::sphere
