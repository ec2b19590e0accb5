// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Inputs and outputs of another program (BrainStat, after SurfStat): ../shared/data/
// brainstat_oracles.  Multivariate statistics (k > 1), lattices of voxels and designs with more
// columns than people are not ours; its smoothing (statsmo) counts edges, ours millimetres.
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Clusters.h"
#include "Explica/Statistics/Distributions.h"
#include "Explica/Statistics/FalseDiscovery.h"
#include "Explica/Statistics/PlaceModel.h"
#include "Explica/Statistics/RandomField.h"
#include "Npz.h"

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <algorithm>
#include <map>
#include <numeric>

namespace explica::statistics {
namespace {

using testing::Array;
using testing::readNpz;
using Arrays = std::map<std::string, Array>;

constexpr double kTolerance = 1e-6;  // relative

std::filesystem::path oracles() {
  return std::filesystem::path(EXPLICA_REAL_DATA) / "brainstat_oracles";
}

#define NEEDS_ORACLES() \
  if (!std::filesystem::exists(oracles())) GTEST_SKIP() << "skipped: no real data"

Arrays oracle(const std::string& name) {
  return readNpz(oracles() / (name + ".npz"));
}

void expectClose(double ours, double theirs, double tolerance = kTolerance) {
  EXPECT_NEAR(ours, theirs, tolerance * std::max(std::abs(theirs), 1e-300));
}

Design designOf(const Eigen::MatrixXd& x) {
  Design design;
  design.matrix = x;
  for (Eigen::Index c = 0; c < x.cols(); ++c) design.columns.push_back("x" + std::to_string(c));
  return design;
}

/// They take more than a thousand degrees of freedom for infinitely many.
double dfAsTheirs(double df) {
  return df >= 1000 ? kInfinity : df;
}

double dfOf(const Arrays& in, const std::vector<bool>& mask) {
  if (!in.contains("in.dfs")) return dfAsTheirs(in.at("in.df").scalar());
  const Eigen::VectorXd dfs = in.at("in.dfs").vector();
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (!mask[v]) continue;
    sum += dfs[static_cast<Eigen::Index>(v)];
    ++count;
  }
  return dfAsTheirs(sum / count);
}

std::vector<bool> maskOf(const Arrays& in, Eigen::Index places) {
  std::vector<bool> mask(static_cast<std::size_t>(places), true);
  if (!in.contains("in.mask")) return mask;
  const Eigen::VectorXd values = in.at("in.mask").vector();
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = values[static_cast<Eigen::Index>(v)] != 0;
  return mask;
}

/// Faces counted from 0 with edges as theirs: ends in ascending order.
struct Surface {
  Faces faces;
  geometry::MeshTopology topology;
};
Surface surfaceOf(const Array& tri) {
  Surface surface;
  surface.faces = (tri.matrix().array() - 1).cast<std::int32_t>();
  std::map<std::pair<int, int>, int> number;
  const auto edge = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      number[edge(surface.faces(f, k), surface.faces(f, (k + 1) % 3))] = 0;
    }
  }
  surface.topology.edges.resize(static_cast<Eigen::Index>(number.size()), 2);
  int next = 0;
  for (auto& [ends, n] : number) {
    surface.topology.edges.row(next) << ends.first, ends.second;
    n = next++;
  }
  surface.topology.faceEdges.resize(surface.faces.rows(), 3);
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      surface.topology.faceEdges(f, k) =
          number[edge(surface.faces(f, k), surface.faces(f, (k + 1) % 3))];
    }
  }
  return surface;
}

TEST(Oracles, LinearModelsHaveTheirCoefficientsAndResiduals) {
  NEEDS_ORACLES();
  for (const char* name : {"linmod_05", "linmod_11"}) {
    const Arrays in = oracle(name);
    const Array &y = in.at("in.Y"), &b = in.at("out.coef"), &sse = in.at("out.SSE");
    const Design design = designOf(in.at("in.M").matrix());
    const Eigen::Index n = y.extent(0), places = y.extent(1), variates = y.extent(2);
    ModelMaps maps(design.matrix.cols(), places * variates, 0);
    fitPlaces(design, {}, y.matrix(n), 0, maps);
    const Eigen::MatrixXd theirs = b.matrix(b.extent(0)), squares = sse.matrix();
    for (Eigen::Index v = 0; v < places; ++v) {
      for (Eigen::Index k = 0; k < variates; ++k) {
        const Eigen::Index column = v * variates + k, square = (k + 1) * (k + 2) / 2 - 1;
        for (Eigen::Index c = 0; c < theirs.rows(); ++c) {
          expectClose(maps.coefficients(c, column), theirs(c, column), 1e-9);
        }
        expectClose(maps.variance[column] * static_cast<double>(n - design.matrix.cols()),
                    squares(square, v), 1e-9);
      }
    }
  }
}

TEST(Oracles, AWholeBrainsResidualsAreAsRoughAlongEveryEdge) {
  NEEDS_ORACLES();
  const Arrays in = oracle("linmod_13");
  const Eigen::MatrixXd y = in.at("in.Y").matrix();
  const Design design = designOf(in.at("in.M").vector());
  ModelMaps maps(1, y.cols(), 0);
  fitPlaces(design, {}, y, 0, maps);
  const Eigen::VectorXd theirs = in.at("out.coef").vector(), sse = in.at("out.SSE").vector();
  for (Eigen::Index v = 0; v < y.cols(); ++v) {
    expectClose(maps.coefficients(0, v), theirs[v]);
    expectClose(maps.variance[v] * 9, sse[v]);
  }
  const Surface surface = surfaceOf(in.at("in.tri"));
  const Eigen::VectorXd rough = edgeRoughness(
      design.matrix, maps.coefficients, surface.topology.edges,
      [&](std::size_t person, std::span<double> values) {
        for (std::size_t v = 0; v < values.size(); ++v) {
          values[v] = y(static_cast<Eigen::Index>(person), static_cast<Eigen::Index>(v));
        }
      });
  const Eigen::VectorXd resl = in.at("out.resl").vector();
  ASSERT_EQ(rough.size(), resl.size());
  // Differences of vectors of length 1, to whose round-off the smallest are known.
  for (Eigen::Index e = 0; e < resl.size(); ++e) {
    if (std::isnan(resl[e]))
      EXPECT_TRUE(std::isnan(rough[e]));  // where all thicknesses are 0
    else
      EXPECT_NEAR(rough[e], resl[e], kTolerance * resl[e]);
  }
}

/// What they start from: coefficients, residual sums of squares and degrees of freedom.  People
/// whose X has the same X^T X and whose values have these residuals.
TEST(Oracles, TOfContrasts) {
  NEEDS_ORACLES();
  for (const char* name : {"statt_05", "statt_07", "statt_09", "statt_11"}) {
    const Arrays in = oracle(name);
    const Eigen::MatrixXd x = in.at("in.X").matrix(), b = in.at("in.coef").matrix();
    const Eigen::VectorXd sse = in.at("in.SSE").vector();
    const auto df = static_cast<Eigen::Index>(in.at("in.df").scalar());
    const Eigen::Index p = x.cols();
    Design design = designOf(Eigen::MatrixXd::Zero(p + df, p));
    design.matrix.topRows(p) = Eigen::HouseholderQR<Eigen::MatrixXd>(x)
                                   .matrixQR()
                                   .topRows(p)
                                   .template triangularView<Eigen::Upper>();
    Eigen::MatrixXd y = design.matrix * b;
    y.row(p) += sse.cwiseSqrt().transpose();
    const Contrast contrast{"c", "c", in.at("out.c").vector()};
    ModelMaps maps(p, y.cols(), 1);
    fitPlaces(design, {contrast}, y, 0, maps);
    for (Eigen::Index v = 0; v < y.cols(); ++v) {
      expectClose(maps.contrasts[0].effect[v], in.at("out.ef").vector()[v]);
      expectClose(maps.contrasts[0].error[v], in.at("out.sd").vector()[v]);
      expectClose(maps.contrasts[0].statistic[v], in.at("out.t").vector()[v]);
    }
  }
}

/// They start from the sums of squares of two models; where the larger leaves less, people whose
/// values have just these.
TEST(Oracles, FOfNestedModels) {
  NEEDS_ORACLES();
  int compared = 0;
  for (const char* name : {"statf_01", "statf_05"}) {
    const Arrays in = oracle(name);
    const Eigen::VectorXd small = in.at("in.slm1SSE").vector(),
                          large = in.at("in.slm2SSE").vector();
    const Eigen::VectorXd f = in.at("out.t").vector();
    constexpr Eigen::Index kTested = 10, kRest = 30;
    Design design = designOf(Eigen::MatrixXd::Identity(kTested + kRest, kTested));
    const Contrast contrast{"f", "f", Eigen::MatrixXd::Identity(kTested, kTested)};
    for (Eigen::Index v = 0; v < small.size(); ++v) {
      if (!(small[v] > large[v]) || large[v] == 0) continue;
      Eigen::MatrixXd y(kTested + kRest, 1);
      y.topRows(kTested).setConstant(std::sqrt((small[v] - large[v]) / kTested));
      y.bottomRows(kRest).setConstant(std::sqrt(large[v] / kRest));
      ModelMaps maps(kTested, 1, 1);
      fitPlaces(design, {contrast}, y, 0, maps);
      expectClose(maps.contrasts[0].statistic[0], f[v]);
      ++compared;
    }
  }
  EXPECT_GT(compared, 60);
}

/// statq_09 is left out: of one degree of freedom, where their table of the tail ends at t = 100
/// and so lacks a P of 0.003.
TEST(Oracles, FalseDiscoveryRate) {
  NEEDS_ORACLES();
  for (const char* name : {"statq_01", "statq_05", "statq_07", "statq_13"}) {
    const Arrays in = oracle(name);
    const Eigen::VectorXd t = in.at("in.t").vector(), theirs = in.at("out.Q").vector();
    const std::vector<bool> mask = maskOf(in, t.size());
    const double df = dfOf(in, mask);
    Eigen::VectorXd p(t.size());
    for (Eigen::Index v = 0; v < t.size(); ++v) {
      p[v] = mask[static_cast<std::size_t>(v)] ? tTail(t[v], df) : kNaN;
    }
    const Eigen::VectorXd q = falseDiscoveryRate(p);
    double worst = 0;
    for (Eigen::Index v = 0; v < t.size(); ++v) {
      const double ours = std::isnan(q[v]) ? 1 : q[v];
      worst = std::max(worst, std::abs(ours - theirs[v]) / theirs[v]);
    }
    EXPECT_LT(worst, 1e-6) << name;
  }
}

TEST(Oracles, ReselsOfSurfaces) {
  NEEDS_ORACLES();
  const Arrays in = oracle("statresl_03");
  const Surface surface = surfaceOf(in.at("in.tri"));
  const Eigen::MatrixXd resl = in.at("in.resl").matrix();
  const Eigen::VectorXd theirs = in.at("out.resels").vector(),
                        each = in.at("out.reselspvert").vector();
  const auto mask = maskOf(in, each.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::VectorXd perVertex = Eigen::VectorXd::Zero(each.size());
  for (Eigen::Index k = 0; k < resl.cols(); ++k) {  // they average over six fields
    const Resels resels = reselsOf(surface.faces, surface.topology, resl.col(k), mask);
    mean += Eigen::Map<const Eigen::Vector3d>(resels.byDimension.data()) / 6;
    perVertex += resels.perVertex / 6;
  }
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(mean[d], theirs[d], 1e-12);
  for (Eigen::Index v = 0; v < each.size(); ++v) EXPECT_NEAR(perVertex[v], each[v], 1e-12);
}

TEST(Oracles, EulerCharacteristicOfAMaskedHemisphere) {
  NEEDS_ORACLES();
  const Arrays in = oracle("statresl_11");
  const Surface surface = surfaceOf(in.at("in.tri"));
  const auto mask = maskOf(in, 10242);
  const Resels resels = reselsOf(surface.faces, surface.topology,
                                 Eigen::VectorXd::Zero(surface.topology.edges.rows()), mask);
  EXPECT_EQ(resels.byDimension[0], in.at("out.resels").scalar());
}

/// Their fields are rough and their t below 1, so that the maximum is above for certain.
TEST(Oracles, PeaksOfRoughFieldsAreCertain) {
  NEEDS_ORACLES();
  for (const char* name :
       {"statp_01", "statp_03", "statp_05", "statp_09", "statp_13", "statp_17", "statp_21"}) {
    const Arrays in = oracle(name);
    const Eigen::VectorXd t = in.at("in.t").vector(), theirs = in.at("out.pval.P").vector();
    const auto mask = maskOf(in, t.size());
    const Surface surface = surfaceOf(in.at("in.tri"));
    const Resels resels =
        reselsOf(surface.faces, surface.topology, in.at("in.resl").vector(), mask);
    const FieldKind kind{dfOf(in, mask), 0};
    for (Eigen::Index v = 0; v < t.size(); v += 7) {
      EXPECT_EQ(peakProbability(t[v], kind, resels), theirs[v]) << name << " " << v;
    }
  }
}

TEST(Oracles, PeaksAndClusters) {
  NEEDS_ORACLES();
  for (int number = 1; number <= 47; number += 2) {
    if (number > 11 && number < 37) continue;  // of several variates
    char name[32];
    std::snprintf(name, sizeof name, "statpeakc_%02d", number);
    const Arrays in = oracle(name);
    const Array& table = in.at("in.t");
    Eigen::VectorXd t = table.matrix().row(0);
    const auto mask = maskOf(in, t.size());
    const double lowest = t.minCoeff(), threshold = in.at("in.thresh").scalar();
    for (Eigen::Index v = 0; v < t.size(); ++v) {
      if (!mask[static_cast<std::size_t>(v)]) t[v] = lowest;
    }
    std::vector<std::vector<std::int32_t>> lists(static_cast<std::size_t>(t.size()));
    const Eigen::MatrixXd edges = in.at("in.edg").matrix();
    for (Eigen::Index e = 0; e < edges.rows(); ++e) {
      lists[static_cast<std::size_t>(edges(e, 0))].push_back(
          static_cast<std::int32_t>(edges(e, 1)));
      lists[static_cast<std::size_t>(edges(e, 1))].push_back(
          static_cast<std::int32_t>(edges(e, 0)));
    }
    geometry::IndexLists neighbours;
    neighbours.begin.push_back(0);
    for (const auto& list : lists) {
      neighbours.values.insert(neighbours.values.end(), list.begin(), list.end());
      neighbours.begin.push_back(static_cast<std::int32_t>(neighbours.values.size()));
    }
    const auto clusters = findClusters(neighbours, t, threshold, Eigen::VectorXd::Ones(t.size()));
    const Eigen::VectorXd sizes = in.at("out.clus.nverts").vector(),
                          ids = in.at("out.clusid").vector();
    ASSERT_EQ(static_cast<Eigen::Index>(clusters.size()), sizes.size()) << name;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      EXPECT_EQ(clusters[c].extent, sizes[static_cast<Eigen::Index>(c)]) << name;
      for (const auto v : clusters[c].vertices) {
        EXPECT_EQ(ids[v], ids[clusters[c].vertices[0]]) << name;
      }
    }
  }
}

/// Euler characteristic densities at every value of their table; theirs are per mm of a field of
/// unit roughness, ours per resel.
TEST(Oracles, EulerCharacteristicDensities) {
  NEEDS_ORACLES();
  const double perResel = std::sqrt(4 * std::log(2.0));
  constexpr double kCancelled = 1e-14;  // theirs are differences of terms of order one
  for (const char* name : {"thresh_17", "thresh_41"}) {
    const Arrays in = oracle(name);
    const Array& rho = in.at("out.rho");
    const Eigen::VectorXd t = in.at("out.t").vector();
    const Eigen::MatrixXd theirs = rho.matrix();
    const bool isT = in.at("in.df").values.size() == 1;
    const FieldKind kind = isT ? FieldKind{in.at("in.df").scalar(), 0} : FieldKind{8, 7};
    for (Eigen::Index i = 0; i < t.size(); ++i) {
      if (t[i] <= 0) continue;
      const auto ours = eulerDensities(t[i], kind);
      EXPECT_NEAR(ours[1] / perResel, theirs(i, 1),
                  kTolerance * std::abs(theirs(i, 1)) + kCancelled)
          << name << t[i];
      EXPECT_NEAR(ours[2] / perResel / perResel, theirs(i, 2),
                  kTolerance * std::abs(theirs(i, 2)) + kCancelled)
          << name << t[i];
      // Theirs is Simpson's rule on the table; beyond its end nothing counts.
      EXPECT_NEAR(ours[0], theirs(i, 0), 2e-5) << name << t[i];
    }
  }
}

/// Where a quantity that falls along their table reaches a value, by straight lines.
double interpolated(const Eigen::VectorXd& x, const std::vector<double>& y, double at) {
  std::vector<double> rising = {y[0]}, place = {x[0]};
  for (std::size_t i = 1; i < y.size(); ++i) {
    if (!(y[i] > rising.back())) continue;
    rising.push_back(y[i]);
    place.push_back(x[static_cast<Eigen::Index>(i)]);
  }
  const auto next =
      static_cast<std::size_t>(std::lower_bound(rising.begin(), rising.end(), at) - rising.begin());
  const double share = (at - rising[next - 1]) / (rising[next] - rising[next - 1]);
  return place[next - 1] + share * (place[next] - place[next - 1]);
}

/// Heights of peaks at given P, read from our P at the values of their table as they read theirs.
TEST(Oracles, ThresholdsOfPeaks) {
  NEEDS_ORACLES();
  for (const char* name : {"thresh_17", "thresh_23", "thresh_41", "thresh_47"}) {
    const Arrays in = oracle(name);
    const Eigen::VectorXd t = in.at("out.t").vector();
    const Eigen::VectorXd volume = in.at("in.search_volume").vector(),
                          wanted = in.at("in.p_val_peak").vector(),
                          theirs = in.at("out.peak_threshold").vector();
    double voxels = 1;
    for (const double n : in.at("in.num_voxels").values) voxels *= n;
    const double fwhm = in.at("in.fwhm").scalar();
    Resels resels;
    resels.places = voxels;
    for (int d = 0; d < 3; ++d) {
      resels.byDimension[static_cast<std::size_t>(d)] = volume[d] / std::pow(fwhm, d);
    }
    const bool isT = in.at("in.df").values.size() == 1;
    const FieldKind kind = isT ? FieldKind{in.at("in.df").scalar(), 0} : FieldKind{8, 7};
    std::vector<double> bound;
    for (Eigen::Index i = 0; i < t.size(); ++i) {
      const auto rho = eulerDensities(t[i], kind);
      double expected = 0;
      for (std::size_t d = 0; d < 3; ++d) expected += resels.byDimension[d] * rho[d];
      bound.push_back(std::min(expected, voxels * rho[0]));
    }
    for (Eigen::Index k = 0; k < wanted.size(); ++k) {
      EXPECT_NEAR(interpolated(t, bound, wanted[k]), theirs[k], 1e-4 * std::abs(theirs[k]))
          << name << k;
    }
  }
}

/// The size that a single cluster exceeds with P 0.05, of a known roughness.
TEST(Oracles, ThresholdOfClusters) {
  NEEDS_ORACLES();
  const Arrays in = oracle("thresh_17");
  const FieldKind kind{in.at("in.df").scalar(), 0};
  const double fwhm = in.at("in.fwhm").scalar();
  const ClusterSizes sizes(tQuantile(0.001, kind.df), kind, 1, kInfinity);
  const double theirs = in.at("out.extent_threshold_1").scalar() / fwhm / fwhm;
  EXPECT_NEAR(sizes.single(theirs), 0.05, 1e-4);
}

}  // namespace
}  // namespace explica::statistics
