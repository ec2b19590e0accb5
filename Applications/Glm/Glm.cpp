// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Application/Command.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Statistics/Combat.h"
#include "Explica/Statistics/PlaceBlocks.h"
#include "Observations.h"
#include "ResultPage.h"
#include "Results.h"
#include "Settings.h"

#include <algorithm>
#include <numeric>

namespace explica::app {
namespace {

void declare(Declaration& d, GlmSettings& s) {
  d.synopsis("linear models of many people at every vertex or region, and which effects are real")
      .description(
          R"(Fits y = X b + e at every vertex of people's maps, or for every column of a table of regions, and tests contrasts of b by t or F. The model is a formula as in R: 'thickness ~ group * age + sex' has main effects and their interaction, columns with words are categorical (their first level by alphabet is what others are compared with), numbers are centred, C(scanner) takes numbers for names, 0 + leaves the intercept out, (1 | person) is a random intercept for repeated measures. Without --contrast each term is tested.

A vertex where somebody has no value (NaN) is fitted to the others. Multiple comparisons: q is the false discovery rate; with a surface, p_field is family-wise by random field theory, peaks and clusters; with --permutations, p_fwe is family-wise by shuffling the residuals of the model without the effect (Freedman and Lane), of peaks, cluster extents and masses and, with --tfce, of threshold-free cluster enhancement. Vertices with a missing value are left out of permutations.

Maps are best smoothed before (explica smooth): random field theory assumes a smooth field.)")
      .reference(
          "Worsley, Marrett, Neelin, Vandal, Friston, Evans 1996, Human Brain Mapping 4:58-73")
      .reference("Winkler, Ridgway, Webster, Smith, Nichols 2014, NeuroImage 92:381-397")
      .reference("Smith, Nichols 2009, NeuroImage 44:83-98")
      .reference("Johnson, Li, Rabinovic 2007, Biostatistics 8:118-127")
      .example(
          "explica glm --maps maps.tsv --table participants.tsv --model 'thickness ~ group + age + "
          "sex' --contrast 'thinner=group[patient] - group[control]' --surface lh.pial "
          "--permutations 10000 --tfce --out thinner",
          "Where patients' cortex is thinner")
      .input("LIST", FileKind::Table,
             "list of maps (a row a person, columns file, or left and right), or table of regions",
             s.regions)
      .inputOption("maps", FileKind::Table, "list of maps, instead of LIST", s.maps)
      .inputOption("table", FileKind::Table, "what is known of people (default: LIST itself)",
                   s.table)
      .inputOption("surface", FileKind::Surface,
                   "surface whose vertices the maps are on; left and right if there are two",
                   s.surfaces)
      .inputOption("mask", FileKind::VertexData, "vertices to analyse: not 0; one a surface",
                   s.masks)
      .inputOption("atlas", FileKind::VertexLabel, "names of the regions of peaks; one a surface",
                   s.atlases)
      .oneByOne("surface")
      .oneByOne("mask")
      .oneByOne("atlas")
      .category("Model")
      .option("model", "formula: 'thickness ~ group * age + sex'", s.model)
      .require("model")
      .option("contrast",
              "NAME=EXPRESSION of columns, as 'x=group[b] - group[a]'; ';' between several "
              "is an F test",
              s.contrasts)
      .option("columns", "columns of the table to analyse; * stands for any characters", s.columns)
      .option("person", "column that names people (default, too: the first)", s.person)
      .option("subset", "leave out people of one list only, instead of refusing them", s.subset)
      .option("site",
              "differences between sites: columns of the model, random intercepts, or taken "
              "off before by ComBat",
              s.site)
      .option("site-column", "column that names sites", s.siteColumn)
      .category("Inference")
      .option(
          {"threshold", "", "two-sided P of single vertices that forms clusters", kAboveZero, 0.5},
          s.threshold)
      .option({"permutations", "", "shuffles for family-wise P; 0: none", 0, 1e7}, s.permutations)
      .option("tfce", "threshold-free cluster enhancement, by permutations", s.tfce)
      .option({"seed", "", "of the shuffles", 0, 2147483647}, s.seed)
      .option("blocks",
              "column of people who may take each other's place only (default: that of the "
              "random intercept)",
              s.blocks)
      .option("exchange",
              "what is shuffled: people within blocks, whole blocks of one size, or signs",
              s.exchange)
      .category("Reading")
      .option({"block-memory", "MB",
               "of people's values at a time; permutations and ComBat need all at once", 1, 1e6},
              s.blockMegabytes)
      .needs({"seed", "exchange", "blocks", "tfce"}, {"permutations"})
      .needs({"threshold", "atlas"}, {"surface"})
      .needs({"site-column"}, {"site=fixed", "site=random", "site=combat"})
      .output("*.shape.gii", FileKind::VertexData,
              "of each contrast: effect, t or f, p, q, ci95, d, partial_r, p_field, p_fwe, tfce, "
              "tfce_p_fwe")
      .output("clusters.tsv", FileKind::Table, "with a surface: clusters with peak, size and P")
      .output("regions.tsv", FileKind::Table, "of a table of regions: each one's numbers")
      .output("design.tsv", FileKind::Table, "the design matrix, a row a person")
      .output("report.html", FileKind::Report, "the results as a page")
      .results<GlmSummary>();
}

/// The formula with what --site adds to it.
statistics::Formula formulaOf(const GlmSettings& s) {
  auto formula = statistics::parseFormula(s.model);
  if (s.site == SiteModel::Fixed) {
    formula.categorical.insert(s.siteColumn);
    const statistics::Term term = {s.siteColumn};
    if (std::find(formula.terms.begin(), formula.terms.end(), term) == formula.terms.end()) {
      formula.terms.push_back(term);
    }
  } else if (s.site == SiteModel::Random) {
    if (formula.randomIntercept) {
      throw UsageError("--site random: the model has the random intercept of '" +
                       *formula.randomIntercept + "' already; use --site fixed");
    }
    formula.randomIntercept = s.siteColumn;
  }
  return formula;
}

std::vector<statistics::Contrast> contrastsOf(const GlmSettings& s,
                                              const statistics::Design& design) {
  std::vector<statistics::Contrast> contrasts;
  for (const std::string& text : s.contrasts) {
    contrasts.push_back(statistics::parseContrast(text, design));
  }
  if (!contrasts.empty()) return contrasts;
  for (auto& contrast : statistics::contrastsOfTerms(design)) {
    if (s.site != SiteModel::Fixed || contrast.name != s.siteColumn) contrasts.push_back(contrast);
  }
  return contrasts;
}

/// Each person's word in a column.
statistics::Levels levelsIn(const std::string& column, const Observations& o) {
  std::vector<std::size_t> rows(o.people.size());
  std::iota(rows.begin(), rows.end(), 0);
  return statistics::levelsOf(o.about, column, rows);
}

/// ComBat keeps what the model's own columns explain, which must not be the sites' differences.
void harmonise(const GlmSettings& s, const Observations& o, const statistics::Design& design,
               Eigen::MatrixXd& values) {
  if (s.site != SiteModel::Combat) return;
  const statistics::Levels sites = levelsIn(s.siteColumn, o);
  std::vector<std::string> names;
  for (const std::string& site : sites.names) names.push_back(s.siteColumn + "[" + site + "]");
  std::vector<Eigen::Index> kept;
  for (std::size_t c = 0; c < design.columns.size(); ++c) {
    if (design.columns[c] == "intercept") continue;
    kept.push_back(static_cast<Eigen::Index>(c));
    names.push_back(design.columns[c]);
  }
  const Eigen::MatrixXd covariates = design.matrix(Eigen::all, kept);
  statistics::requireFullRank(statistics::withSites(sites.of, covariates), names);
  statistics::combat(values, covariates, sites.of);
}

statistics::PlaceBlocks planBlocks(const GlmSettings& s, const Observations& o) {
  const statistics::PlaceBlocks blocks{static_cast<Eigen::Index>(o.people.size()), o.places,
                                       static_cast<std::size_t>(s.blockMegabytes) << 20};
  if (blocks.single() || (s.permutations == 0 && s.site != SiteModel::Combat)) return blocks;
  const auto needed = static_cast<std::size_t>(blocks.people * blocks.places) * 8 / (1 << 20) + 1;
  throw InvalidInput("permutations and ComBat need all values at once: " + std::to_string(needed) +
                     " MB; give --block-memory " + std::to_string(needed));
}

void sayWhoIsLeftOut(Context& context, const Observations& o, const statistics::Design& design) {
  if (!design.dropped.empty()) {
    context.warn(std::to_string(design.dropped.size()) +
                 " people have no value in a column of the model and are left out: " +
                 joined(design.dropped, ", ", [&](std::size_t row) { return o.people[row]; }));
  }
  if (!o.leftOut.empty()) context.warn("in one list only, left out: " + joined(o.leftOut));
}

void fit(Context& context, const GlmSettings& s, const Observations& o,
         const statistics::PlaceBlocks& blocks, GlmResults& r) {
  statistics::forEachBlock(
      blocks, o.reader,
      [&](Eigen::Index first, Eigen::MatrixXd& values) {
        harmonise(s, o, r.design, values);
        statistics::fitPlaces(r.design, r.contrasts, values, first, r.maps);
        if (blocks.single()) r.values = std::move(values);
      },
      context.monitor());
  if (!o.surface) return;
  statistics::PersonReader fitted = o.reader;
  if (r.values.size() > 0) {
    fitted = [&](std::size_t person, std::span<double> values) {
      Eigen::Map<Eigen::RowVectorXd>(values.data(), r.values.cols()) = r.values.row(person);
    };
  }
  const auto roughness = statistics::edgeRoughness(r.design.matrix, r.maps.coefficients,
                                                   o.surface->topology.edges, fitted);
  r.smoothness = statistics::smoothnessOf(*o.surface, roughness);
}

/// @return  false if permutations were interrupted
bool inferAll(Context& context, const GlmSettings& s, const Observations& o, GlmResults& r) {
  const statistics::InferenceOptions options{
      .clusterP = s.threshold,
      .permutations = {.count = s.permutations,
                       .seed = static_cast<std::uint64_t>(s.seed),
                       .exchange = s.exchange,
                       .blocks = s.blocks ? levelsIn(*s.blocks, o).of : r.design.groups,
                       .tfce = s.tfce}};
  bool complete = true;
  for (std::size_t k = 0; k < r.contrasts.size(); ++k) {
    r.inferences.push_back(statistics::infer(
        r.design, r.contrasts[k], r.maps.contrasts[k], r.values, o.surface ? &*o.surface : nullptr,
        r.smoothness ? &*r.smoothness : nullptr, options, context.monitor()));
    complete = complete && !r.inferences.back().interrupted;
    if (!r.maps.contrasts[k].statistic.array().isNaN().all()) continue;
    context.warn("contrast '" + r.contrasts[k].name +
                 "' can be tested nowhere: no degrees of freedom are left for it" +
                 (r.design.groups.empty()
                      ? ""
                      : ", as it varies between groups of people and these are too few"));
  }
  return complete;
}

/// @return  whether all is written: without the page, whose pictures take seconds, after a stop
bool writeAll(Context& context, const GlmSettings& s, const Observations& o,
              const GlmResults& results) {
  auto step = context.step("write");
  writeTextFile(context.output("design.tsv"), designTable(o, results));
  if (o.placeNames.empty())
    writeMaps(context, o, results);
  else
    writeTextFile(context.output("regions.tsv"), regionTable(o, results));
  if (o.surface) writeTextFile(context.output("clusters.tsv"), clusterTable(o, results));
  context.results(summaryOf(s, o, results));
  try {
    const StopScope abandoned(&context.monitor());
    const std::string page = resultPage(s, o, results);
    writeTextFile(context.output("report.html"), page);
  } catch (const Interrupted&) {
    return false;
  }
  return true;
}

Termination run(Context& context, const GlmSettings& s) {
  if (s.tfce && (s.permutations == 0 || s.surfaces.empty())) {
    throw UsageError("--tfce needs --permutations and --surface");
  }
  Observations o = readObservations(context, s);
  auto design = statistics::buildDesign(formulaOf(s), o.about);
  auto contrasts = contrastsOf(s, design);
  if (contrasts.empty()) throw UsageError("the model has nothing to test");
  sayWhoIsLeftOut(context, o, design);
  keepPeople(o, design.rows);
  const auto blocks = planBlocks(s, o);
  const Eigen::Index columns = design.matrix.cols();
  const std::size_t count = contrasts.size();
  GlmResults results{std::move(design),
                     std::move(contrasts),
                     statistics::ModelMaps(columns, o.places, count),
                     {},
                     {},
                     {}};
  bool complete = true;
  {
    auto step = context.step("fit");
    fit(context, s, o, blocks, results);
  }
  const StopScope kept(nullptr);  // models are written without the permutations, too
  {
    auto step = context.step("inference");
    complete = inferAll(context, s, o, results);
    if (!complete) step.termination(causeOf(Termination::Interrupted));
  }
  complete = writeAll(context, s, o, results) && complete;
  return complete ? Termination::NotRun : Termination::Interrupted;
}

}  // namespace

Command glmCommand() {
  return makeCommand<GlmSettings>("glm", declare, run);
}

}  // namespace explica::app
