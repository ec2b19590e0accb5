// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Page.h"

#include "Encoding.h"
#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Report/Chart.h"
#include "Explica/Report/SliceStack.h"

#include <gtest/gtest.h>

#include <zlib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <set>

namespace explica::report {
namespace {

std::string decodeBase64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t group = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<char>(group >> count));
    }
  }
  return bytes;
}

/// What the page's script does.
std::vector<std::int32_t> unpack(const nlohmann::json& packed) {
  const std::size_t n = packed.at("n");
  const int planes = packed.at("p");
  std::string bytes(n * planes, '\0');
  const std::string deflated = decodeBase64(packed.at("d"));
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                       reinterpret_cast<const Bytef*>(deflated.data()), deflated.size()),
            Z_OK);
  std::vector<std::int32_t> values(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::uint32_t folded = 0;
    for (int p = 0; p < planes; ++p)
      folded |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[p * n + i])) << (8 * p);
    values[i] = static_cast<std::int32_t>(folded >> 1) ^ -static_cast<std::int32_t>(folded & 1);
  }
  const std::size_t stride = packed.at("s");
  for (std::size_t i = stride; stride > 0 && i < n; ++i) values[i] += values[i - stride];
  return values;
}

TEST(PackedIntegers, ComeBack) {
  const std::vector<std::int32_t> values = {0, 5, -7, 300, -70000, 1 << 28, 3};
  for (const int stride : {0, 1, 3}) {
    EXPECT_EQ(unpack(packIntegers(values, stride)), values);
  }
}

/// The place of the brightest voxel of a stack, and how many are as bright.
std::pair<Point, int> brightestOf(const nlohmann::json& stack) {
  const std::vector<std::int32_t> grey = unpack(stack["grey"]);
  const int nx = stack["size"][0], ny = stack["size"][1];
  const auto most = std::max_element(grey.begin(), grey.end());
  const int at = static_cast<int>(most - grey.begin());
  Point place(at % nx, at / nx % ny, at / (nx * ny));
  for (int a = 0; a < 3; ++a) {
    place[a] = stack["low"][a].get<double>() + stack["voxel"].get<double>() * place[a];
  }
  return {place, static_cast<int>(std::count(grey.begin(), grey.end(), *most))};
}

TEST(SliceStack, HoldsTheImagesOwnVoxelsWhicheverWayItsAxesGo) {
  const TriangleMesh mesh = geometry::makeIcosphere(2, 9, Point(20, 22, 24));
  for (const bool turned : {false, true}) {
    Grid grid;
    grid.size = {30, 34, 32};
    grid.spacing = Vector::Constant(1.5);
    grid.origin = turned ? Vector(44.2, -1.3, 46.1) : Vector(-1.1, -1.3, 0.4);
    if (turned) grid.direction = Vector(-1, 1, -1).asDiagonal();  // left, anterior, inferior
    Volume<float> image(grid, 10.0F);
    const Point place = grid.toWorld(Vector(12, 16, 15));
    image(12, 16, 15) = 100;
    const auto stack = nlohmann::json::parse(sliceStackJson(image, {{&mesh, "white", "#f00"}}, {}));
    EXPECT_EQ(stack["voxel"], 1.5);
    const auto [found, count] = brightestOf(stack);
    EXPECT_EQ(count, 1) << "no voxel is smeared over two";
    EXPECT_NEAR((found - place).norm(), 0, 1e-9);
  }
}

TEST(SliceStack, NamesItsPlacesAndTheShapesThatItCuts) {
  const TriangleMesh white = geometry::makeIcosphere(3, 9.123);
  Grid grid;
  grid.size = {40, 40, 40};
  grid.origin = Vector::Constant(-20);
  const Volume<float> image(grid, 1.0F);
  const auto stack = nlohmann::json::parse(sliceStackJson(
      image, {{&white, "white surface", "#f00", "left", "white"}}, {{Point(1, 2, 3), "here"}}));
  EXPECT_EQ(stack["places"][0]["at"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(stack["surfaces"][0]["part"], "left");
  EXPECT_EQ(stack["surfaces"][0]["shape"], "white");
}

TEST(SliceStack, RefusesSurfacesWithoutVertices) {
  const TriangleMesh none;
  EXPECT_THROW((void)sliceStackJson(Volume<float>(Grid{}), {{&none, "", ""}}, {}), InvalidInput);
}

Evolution movingSphere() {
  std::vector<TriangleMesh> frames;
  for (int f = 0; f < 4; ++f) {
    TriangleMesh sphere = geometry::makeIcosphere(3, 30);
    for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
      if (sphere.positions(v, 2) > 15) sphere.positions(v, 2) += 0.7 * f;
    }
    frames.push_back(std::move(sphere));
  }
  return evolutionOf(frames);
}

TEST(Evolution, FindsWhatMoved) {
  const Evolution evolution = movingSphere();
  ASSERT_FALSE(evolution.moved.empty());
  for (const std::int32_t v : evolution.moved) EXPECT_GT(evolution.mesh.positions(v, 2), 15);
}

TEST(Evolution, FramesComeBackWithinAQuantisationStep) {
  const Evolution evolution = movingSphere();
  const auto json = nlohmann::json::parse(evolutionJson(evolution));
  const std::vector<std::int32_t> start = unpack(json["positions"]);
  const double unit = json["unit"];
  std::vector<std::int32_t> now;
  for (const std::int32_t v : evolution.moved) {
    for (int c = 0; c < 3; ++c) now.push_back(start[3 * v + c]);
  }
  for (std::size_t f = 0; f < evolution.frames.size(); ++f) {
    const std::vector<std::int32_t> change = unpack(json["frames"][f]);
    for (std::size_t i = 0; i < now.size(); ++i) {
      now[i] += change[i];
      const double x = json["low"][i % 3].get<double>() + unit * now[i];
      ASSERT_NEAR(x, evolution.frames[f](i / 3, i % 3), 0.51 * unit);
    }
  }
}

TEST(Evolution, RefusesFramesOfDifferentFaces) {
  EXPECT_THROW((void)evolutionOf({geometry::makeIcosphere(1), geometry::makeIcosphere(2)}),
               InvalidInput);
}

TEST(ReportPage, ShowsAFailedStepAndEscapesItsWords) {
  ReportContent content;
  content.title = "sub-01 <left>";
  ReportStep step;
  step.name = "unfold";
  step.state = StepState::Failed;
  step.message = "pial.surf.gii: <no> faces & \"more\"";
  content.steps.push_back(step);
  const std::string page = reportPage(content);
  EXPECT_NE(page.find("badge bad'>failed"), std::string::npos);
  EXPECT_NE(page.find("&lt;no&gt; faces &amp; &quot;more&quot;"), std::string::npos);
  EXPECT_EQ(page.find("<no>"), std::string::npos);
}

/// What stands at the head before the checks that are folded away.
std::string verdictOf(const std::vector<FlagLevel>& levels) {
  ReportContent content;
  for (const FlagLevel level : levels) content.flags.push_back({level, "what", "why"});
  const std::string page = reportPage(content);
  const std::size_t begin = page.find("class='verdict");
  return page.substr(begin, page.find("<details>", begin) - begin);
}

TEST(ReportPage, SaysTheWorstAsVerdictWithThreeReasonsAtMost) {
  using enum FlagLevel;
  EXPECT_NE(verdictOf({Good, Remark, Good}).find("Right.</b> 2 of 2 checks"), std::string::npos);
  EXPECT_EQ(verdictOf({Good, Remark, Remark}).find("<li>"), std::string::npos)
      << "a remark is no reason";
  EXPECT_NE(verdictOf({Remark}).find("Right."), std::string::npos);
  const std::string look = verdictOf({Good, Notice, Remark});
  EXPECT_NE(look.find("Look at it before you use it.</b> 1 of 2"), std::string::npos);
  const std::string bad = verdictOf({Notice, Notice, Good, Notice, Bad});
  EXPECT_NE(bad.find("Do not use it as it is"), std::string::npos);
  EXPECT_LT(bad.find("badge bad"), bad.find("badge notice")) << "the worst first";
  std::size_t reasons = 0;
  for (std::size_t at = bad.find("<li>"); at != std::string::npos; at = bad.find("<li>", at + 1)) {
    ++reasons;
  }
  EXPECT_EQ(reasons, 3u);
  EXPECT_EQ(reportPage({}).find("Right."), std::string::npos) << "nothing judged is not right";
}

TEST(ReportPage, ListsItsPartsAndNoneThatIsNotThere) {
  ReportContent content;
  content.findings = {{""}, {{"Mean thickness", "mm", {"2.6"}, "", "1 to 5 mm (Fischl 2000)"}}};
  const std::string page = reportPage(content);
  EXPECT_NE(page.find("<a href='#numbers'>"), std::string::npos);
  EXPECT_EQ(page.find("<a href='#slices'>"), std::string::npos);
  EXPECT_NE(page.find("<td class='expected'>1 to 5 mm (Fischl 2000)"), std::string::npos);
}

TEST(ReportPage, NumbersStandUnderTheirStepAndOnceWhereBothSidesShareThem) {
  ReportContent content;
  content.findings = {{"left", "right"},
                      {{"Brain volume", "ml", {"1740"}, "", "", "Segment"},
                       {"Faces turned over", "", {"0", "1"}, "", "", "Sphere"},
                       {"Area", "", {"2", "3"}, "", "", "Sphere"}}};
  const std::string page = reportPage(content);
  EXPECT_NE(page.find("<td colspan='2'>1740</td>"), std::string::npos);
  EXPECT_NE(page.find("<td colspan='1'>0</td><td colspan='1'>1</td>"), std::string::npos);
  const std::size_t heading = page.find(">Sphere</th>");
  EXPECT_LT(page.find(">1740<"), heading);
  EXPECT_LT(heading, page.find("Faces turned over"));
  EXPECT_EQ(page.find(">Sphere</th>", heading + 1), std::string::npos) << "named once";
}

TEST(ReportPage, NamesNothingToFetch) {
  ReportContent content;
  content.title = "page";
  content.evolutions.push_back(movingSphere());
  content.views.push_back({"white", "White", "white square", {{"left", Picture(8, 8)}}, {}, {}});
  const std::string page = reportPage(content);
  for (const char* fetching :
       {" src='http", " src=\"http", "<link rel=\"stylesheet", "import(", "@import", "url(http"}) {
    EXPECT_EQ(page.find(fetching), std::string::npos) << fetching;
  }
  EXPECT_EQ(page, reportPage(content));
}

TEST(Evolution, ShapesComeBackWithinAQuantisationStep) {
  Evolution evolution = movingSphere();
  const Positions larger = 1.3 * evolution.mesh.positions;
  evolution.shapes = {{"as it is", {}}, {"larger", larger}};
  const auto json = nlohmann::json::parse(evolutionJson(evolution));
  EXPECT_TRUE(unpack(json["shapes"][0]["shift"]).empty());
  const std::vector<std::int32_t> start = unpack(json["positions"]);
  const std::vector<std::int32_t> shift = unpack(json["shapes"][1]["shift"]);
  ASSERT_EQ(shift.size(), start.size());
  const double unit = json["unit"];
  for (std::size_t i = 0; i < shift.size(); ++i) {
    const double x = json["low"][i % 3].get<double>() + unit * (start[i] + shift[i]);
    ASSERT_NEAR(x, larger(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)),
                0.51 * unit);
  }
}

TEST(ReportPage, OffersEveryPatchAndTheStatesOfAMosaic) {
  ReportContent content;
  for (const char* title : {"Unfold (left)", "Unfold (right)"}) {
    content.evolutions.push_back(movingSphere());
    content.evolutions.back().title = title;
  }
  MosaicTile tile{"x = 0 mm", {"L", "R", "A", "P"}, Picture(8, 8), {}};
  SliceMosaic mosaic;
  mosaic.rows = {{tile}};
  content.mosaics.push_back({"", "Bias", "", mosaic, mosaic, {"as it came", "corrected"}});
  content.mosaics.push_back({"", "Plain", "", mosaic});
  const std::string page = reportPage(content);
  const auto count = [&](const std::string& what) {
    int found = 0;
    for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("class=\"evolution\""), 2);
  EXPECT_EQ(count("data-title=\"Unfold (right)\""), 1);
  EXPECT_EQ(count("class='other'"), 1);
  EXPECT_EQ(count("corrected instead of as it came"), 1);
  content.evolutions.pop_back();
  EXPECT_LT(page.size(), 1.5 * static_cast<double>(reportPage(content).size()))
      << "one copy of the library for all patches";
}

TEST(ReportPage, FoldsWhatTheHeadShowsAndStepsThatAreDone) {
  ReportContent content;
  content.glance.push_back({"seen", "Thickness", "Right: even."});
  for (const char* id : {"seen", "other"}) content.views.push_back({id, id, "", {}, {}, {}});
  content.steps.emplace_back();
  EXPECT_NE(reportPage(content).find("<figure id='seen'><details>"), std::string::npos);
  EXPECT_NE(reportPage(content).find("<figure id='other'><details open>"), std::string::npos);
  EXPECT_NE(reportPage(content).find("<details><summary>Steps: 1<"), std::string::npos);
  content.steps.front().state = StepState::Failed;
  EXPECT_NE(reportPage(content).find("<details open><summary>Steps: 1<"), std::string::npos);
}

TEST(ReportPage, GathersChartsUnderHeadingsAndOpensTheFirst) {
  ReportContent content;
  content.charts = {
      {"", "<svg>1</svg>", "Left"}, {"", "<svg>2</svg>", "Left"}, {"", "<svg>3</svg>", "Right"}};
  const std::string page = reportPage(content);
  const std::size_t left = page.find("<details open><summary><b>Left."),
                    right = page.find("<details><summary><b>Right.");
  ASSERT_NE(right, std::string::npos);
  EXPECT_LT(left, page.find("<svg>1</svg>"));
  EXPECT_LT(page.find("<svg>2</svg>"), right);
  EXPECT_LT(right, page.find("<svg>3</svg>"));
  EXPECT_EQ(page.find("<b>Left.", page.find("<svg>1</svg>")), std::string::npos);
}

TEST(Charts, SayWhenThereIsNothingToShow) {
  EXPECT_NE(histogramSvg(Eigen::VectorXd(), {"Thickness", "mm", ""}).find("no values"),
            std::string::npos);
  EXPECT_NE(curvesSvg({}, {"Visibility", "", ""}).find("no values"), std::string::npos);
}

TEST(Charts, KeepTheLegendOffTheCurvesAndTellThemApart) {
  std::vector<Series> series;
  for (int s = 0; s < 7; ++s)
    series.push_back({"curve " + std::to_string(s), {0, 1}, {1, 2.0 + s}});
  const std::string svg = curvesSvg(series, {"t", "", ""});
  std::set<std::string> strokes;
  for (std::size_t at = svg.find("<path class='line'"); at != std::string::npos;
       at = svg.find("<path class='line'", at + 1)) {
    strokes.insert(svg.substr(at, svg.find(" d=", at) - at));
  }
  EXPECT_EQ(strokes.size(), series.size());
  EXPECT_NE(svg.find("viewBox='0 0 460 314"), std::string::npos) << "three rows below the plot";
}

TEST(Charts, DrawOthersBehindAHistogram) {
  ChartText words{"t", "mm", ""};
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(100, 1, 2);
  EXPECT_EQ(histogramSvg(values, words).find("behind"), std::string::npos);
  words.behind = Eigen::VectorXd::LinSpaced(1000, 1, 4.5);
  words.behindName = "study";
  const std::string svg = histogramSvg(values, words);
  EXPECT_NE(svg.find("class='behind'"), std::string::npos);
  EXPECT_NE(svg.find("study, median 2.75"), std::string::npos);
  EXPECT_NE(svg.find(">4<"), std::string::npos) << "the axis holds both";
}

TEST(Charts, LogarithmicAxesLeaveOutZeroAndMarkPowersOfTen) {
  ChartText words{"t", "", "", true, {{2, "converged"}}};
  const std::string svg = curvesSvg({{"a", {0, 1, 2}, {0, 10, 1000}}}, words);
  for (const char* tick : {">10<", ">100<", ">1e+03<", ">converged<"}) {
    EXPECT_NE(svg.find(tick), std::string::npos) << tick;
  }
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  words.logarithmic = true;
  EXPECT_EQ(curvesSvg({{"a", {0, 1}, {-1, 10}}}, words).find(">100<"), std::string::npos);
}

TEST(Evolution, KeepsValuesThatCanBeReadUnderThePointer) {
  Evolution evolution = movingSphere();
  Eigen::VectorXd values = evolution.mesh.positions.col(0);
  values[3] = kNaN;
  evolution.maps.push_back({values, scaleFor(values, "x", "mm")});
  evolution.labels.push_back({"halves", {}, {{"lower", {1, 0, 0}}, {"upper", {0, 0, 1}}}});
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    evolution.labels[0].entries.push_back(evolution.mesh.positions(v, 2) > 0 ? 1 : -1);
  }
  const auto json = nlohmann::json::parse(evolutionJson(evolution));
  const auto& map = json["maps"][0];
  const auto packed = unpack(map["values"]);
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    if (v == 3) {
      EXPECT_EQ(packed[v], 65535);
    } else {
      EXPECT_NEAR(map["least"].get<double>() + map["step"].get<double>() * packed[v], values[v],
                  1e-3);
    }
  }
  EXPECT_EQ(unpack(json["labels"][0]["entries"]), evolution.labels[0].entries);
  EXPECT_EQ(unpack(json["region"]), evolution.moved);
  // The same faces, each with the same sense, in another order.
  const std::vector<std::int32_t> corners = unpack(json["faces"]);
  std::set<std::array<std::int32_t, 3>> drawn, given;
  for (std::size_t c = 0; c < corners.size(); c += 3) {
    drawn.insert({corners[c], corners[c + 1], corners[c + 2]});
  }
  for (Eigen::Index f = 0; f < evolution.mesh.faceCount(); ++f) {
    std::array<std::int32_t, 3> face = {evolution.mesh.faces(f, 0), evolution.mesh.faces(f, 1),
                                        evolution.mesh.faces(f, 2)};
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    given.insert(face);
  }
  EXPECT_EQ(drawn, given);
}

TEST(Chart, OneValueIsADotAndFramesAreWhole) {
  const std::string svg =
      curvesSvg({{"a", {0, 1}, {2, 3}}, {"b", {0, 1}, {2.5, kNaN}}}, {"t", "", ""});
  EXPECT_NE(svg.find("<circle"), std::string::npos);
  EXPECT_EQ(svg.find("<circle"), svg.rfind("<circle")) << "a curve needs no dot";
  EXPECT_EQ(svg.find(">0.2<"), std::string::npos) << "there is no frame between two frames";
  EXPECT_NE(curvesSvg({{"a", {0, 0.5, 1}, {2, 3, 4}}}, {"t", "", ""}).find(">0.2<"),
            std::string::npos);
}

TEST(Page, ADrawingWithAGuideStandsInTheHead) {
  ReportContent content;
  const auto lookOf = [&] {
    const std::string page = reportPage(content);
    return page.substr(std::min(page.find("id='look'"), page.size()));
  };
  EXPECT_EQ(reportPage(content).find("class='head'"), std::string::npos)
      << "words take the whole width where there is no picture";
  content.drawings = {{"", "Slices", "", "image/png", "x"},
                      {"", "Bull's-eye", "", "image/png", "y", "Right: even."}};
  EXPECT_NE(reportPage(content).find("class='head'"), std::string::npos);
  EXPECT_NE(reportPage(content).find("Right: even."), std::string::npos);
  EXPECT_NE(lookOf().find("Slices"), std::string::npos);
  EXPECT_EQ(lookOf().find("Bull"), std::string::npos);
}

TEST(Charts, DrawConstantsAndGaps) {
  EXPECT_NE(histogramSvg(Eigen::VectorXd::Constant(9, 2.0), {"t", "", ""}).find("<svg"),
            std::string::npos);
  const std::string svg = curvesSvg({{"a", {0, 1, 2}, {1, kNaN, 1}}}, {"t", "", ""});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace explica::report
