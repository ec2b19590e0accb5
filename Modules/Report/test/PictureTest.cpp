// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/FlatFigure.h"
#include "Explica/Report/Picture.h"

#include "Explica/Core/Errors.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Drawing.h"

#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

namespace explica::report {
namespace {

std::uint32_t bigEndianAt(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int b = 0; b < 4; ++b) value = value << 8 | static_cast<std::uint8_t>(bytes[at + b]);
  return value;
}

Picture gradient(int width, int height) {
  Picture p(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      p.pixel(x, y)[0] = static_cast<std::uint8_t>(x * 7);
      p.pixel(x, y)[1] = static_cast<std::uint8_t>(y * 5);
      p.pixel(x, y)[2] = static_cast<std::uint8_t>(x ^ y);
    }
  }
  return p;
}

/// Decodes the PNG files that we write: 8-bit RGB, one IDAT, the filters of PNG's specification.
Picture decode(const std::string& png) {
  Picture p(static_cast<int>(bigEndianAt(png, 16)), static_cast<int>(bigEndianAt(png, 20)));
  std::size_t at = 8;
  while (png.compare(at + 4, 4, "IDAT") != 0) at += 12 + bigEndianAt(png, at);
  const std::uint32_t length = bigEndianAt(png, at);
  const std::size_t stride = static_cast<std::size_t>(p.width) * 3;
  std::string rows((stride + 1) * p.height, '\0');
  uLongf size = rows.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                       reinterpret_cast<const Bytef*>(png.data() + at + 8), length),
            Z_OK);
  for (int y = 0; y < p.height; ++y) {
    const int filter = static_cast<std::uint8_t>(rows[y * (stride + 1)]);
    for (std::size_t b = 0; b < stride; ++b) {
      int value = static_cast<std::uint8_t>(rows[y * (stride + 1) + 1 + b]);
      const int a = b >= 3 ? p.rgb[y * stride + b - 3] : 0;
      const int above = y > 0 ? p.rgb[(y - 1) * stride + b] : 0;
      const int c = b >= 3 && y > 0 ? p.rgb[(y - 1) * stride + b - 3] : 0;
      if (filter == 1) value += a;
      if (filter == 2) value += above;
      if (filter == 3) value += (a + above) / 2;
      if (filter == 4) {
        const int estimate = a + above - c;
        const int da = std::abs(estimate - a), db = std::abs(estimate - above),
                  dc = std::abs(estimate - c);
        value += da <= db && da <= dc ? a : (db <= dc ? above : c);
      }
      p.rgb[y * stride + b] = static_cast<std::uint8_t>(value);
    }
  }
  return p;
}

TEST(Png, ComesBackBitByBit) {
  const Picture p = gradient(37, 23);
  EXPECT_EQ(decode(encodePng(p)).rgb, p.rgb);
}

TEST(Png, ChunksCarryTheirChecksums) {
  const std::string png = encodePng(gradient(5, 4));
  for (std::size_t at = 8; at < png.size();) {
    const std::uint32_t length = bigEndianAt(png, at);
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(png.data() + at + 4), length + 4);
    EXPECT_EQ(bigEndianAt(png, at + 8 + length), static_cast<std::uint32_t>(sum));
    at += 12 + length;
  }
}

/// Pixels of the first frame of a GIF that we wrote, as palette indices, by a plain LZW decoder.
std::vector<int> firstGifFrame(const std::string& gif, std::size_t pixels) {
  std::size_t at = gif.find('\x2c') + 10;
  while (gif.compare(at - 10, 5, std::string("\x2c\x00\x00\x00\x00", 5)) != 0)
    at = gif.find('\x2c', at - 9) + 10;
  const int codeSize = static_cast<std::uint8_t>(gif[at++]);
  std::string data;
  while (gif[at] != 0) {
    const auto length = static_cast<std::uint8_t>(gif[at]);
    data.append(gif, at + 1, length);
    at += length + 1;
  }
  std::vector<std::vector<int>> table;
  const int clear = 1 << codeSize;
  int width = codeSize + 1;
  std::vector<int> out;
  std::vector<int> previous;
  std::size_t bit = 0;
  while (out.size() < pixels) {
    int code = 0;
    for (int b = 0; b < width; ++b, ++bit) code |= ((data[bit / 8] >> (bit % 8)) & 1) << b;
    if (code == clear) {
      table.assign(static_cast<std::size_t>(clear) + 2, {});
      for (int i = 0; i < clear; ++i) table[i] = {i};
      width = codeSize + 1;
      previous.clear();
      continue;
    }
    if (code == clear + 1) break;
    std::vector<int> entry;
    if (code < static_cast<int>(table.size())) {
      entry = table[code];
    } else {
      entry = previous;
      entry.push_back(previous.front());
    }
    if (!previous.empty() && table.size() < 4096) {
      previous.push_back(entry.front());
      table.push_back(previous);
      if (table.size() == (std::size_t{1} << width) && width < 12) ++width;
    }
    out.insert(out.end(), entry.begin(), entry.end());
    previous = entry;
  }
  return out;
}

TEST(Gif, DecodesToColoursNearThePicture) {
  const Picture p = gradient(300, 200);  // long enough for the code table to fill and be cleared
  const std::string gif = encodeGif({p, p}, 10);
  const std::vector<int> indices = firstGifFrame(gif, 60000);
  ASSERT_EQ(indices.size(), 60000u);
  constexpr std::size_t kTable = 13;  // where the colours begin
  double sum = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      sum +=
          std::abs(static_cast<std::uint8_t>(gif[kTable + 3 * indices[i] + c]) - p.rgb[3 * i + c]);
    }
  }
  // 256 colours for a box of three even components: 256^(1/3) steps of 40 levels, 10 off in the
  // mean.
  EXPECT_LT(sum / 180000, 12);
}

TEST(Gif, KeepsFewColoursAsTheyAreAndWithoutPatterns) {
  Picture p(40, 30);
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 30; ++y) p.pixel(x, y)[1] = 77;
  }
  const std::string gif = encodeGif({p}, 10);
  const std::vector<int> indices = firstGifFrame(gif, 1200);
  ASSERT_EQ(indices.size(), 1200u);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    EXPECT_EQ(static_cast<std::uint8_t>(gif[13 + 3 * indices[i] + 1]), p.rgb[3 * i + 1]);
    EXPECT_EQ(indices[i], indices[i % 40 < 20 ? 0 : 20]);
  }
}

TEST(Films, RefuseFramesOfDifferentSize) {
  EXPECT_THROW((void)encodeGif({gradient(4, 4), gradient(5, 4)}, 10), InvalidInput);
  EXPECT_THROW((void)encodeGif({}, 10), InvalidInput);
}

TEST(ColourMaps, GrowLighterStepByStep) {
  for (const ColourMap map : {ColourMap::Sequential, ColourMap::Heat, ColourMap::Grey}) {
    double before = -1;
    for (int s = 0; s <= 100; ++s) {
      const Colour c = colourAt(map, s / 100.0);
      const double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
      ASSERT_GT(luminance, before);
      before = luminance;
    }
  }
}

TEST(ColourMaps, AreWithoutStepsBetweenTheEntriesOfTheirTable) {
  constexpr int kFine = 4096;  // eight an entry
  double last = -1;
  for (int s = 0; s <= kFine; ++s) {
    const Colour c = colourAt(ColourMap::Sequential, static_cast<double>(s) / kFine);
    const double light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    EXPECT_GT(light, last) << s;
    last = light;
  }
}

TEST(ColourMaps, DivergingIsLightestInTheMiddle) {
  const auto luminance = [](double t) {
    const Colour c = colourAt(ColourMap::Diverging, t);
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  };
  EXPECT_GT(luminance(0.5), luminance(0.3));
  EXPECT_GT(luminance(0.3), luminance(0.0));
  EXPECT_GT(luminance(0.7), luminance(1.0));
  EXPECT_GT(colourAt(ColourMap::Diverging, 0)[2], colourAt(ColourMap::Diverging, 0)[0]);
}

TEST(ColourScale, TakesADivergingMapOnlyWhereSignsMatter) {
  EXPECT_EQ(scaleFor(Eigen::VectorXd::LinSpaced(100, 1, 4), "thickness", "mm").map,
            ColourMap::Sequential);
  const ColourScale both = scaleFor(Eigen::VectorXd::LinSpaced(100, -2, 4), "flux", "");
  EXPECT_EQ(both.map, ColourMap::Diverging);
  EXPECT_DOUBLE_EQ(both.low, -both.high);
  const ColourScale constant = scaleFor(Eigen::VectorXd::Constant(10, 3.0), "x", "");
  EXPECT_LT(constant.low, constant.high);
}

TEST(Drawing, LineCoversItsWidth) {
  Picture p(40, 40);
  drawSegments(p, {{{5, 20}, {35, 20}}}, {0, 0, 0}, 4);
  double dark = 0;
  for (int y = 0; y < 40; ++y) dark += (255 - p.pixel(20, y)[0]) / 255.0;
  EXPECT_NEAR(dark, 4, 0.6);
  EXPECT_EQ(p.pixel(20, 5)[0], 255);
}

TEST(Drawing, WhatLiesBesideThePictureLeavesItAndWhatLeavesItIsCut) {
  Picture p(40, 30);
  const Picture white = p;
  drawSegments(p, {}, {0, 0, 0}, 4);
  drawSegments(p, {{{-30, -30}, {-9, 200}}, {{60, 5}, {90, 5}}}, {0, 0, 0}, 4);
  EXPECT_EQ(p.rgb, white.rgb);
  drawSegments(p, {{{-50, 10}, {200, 10}}, {{20, -9}, {20, 99}}}, {0, 0, 0}, 4);
  for (const auto& [x, y] : {std::pair{0, 10}, {39, 10}, {20, 0}, {20, 29}}) {
    EXPECT_EQ(p.pixel(x, y)[0], 0) << x << " " << y;
  }
  EXPECT_EQ(p.pixel(5, 5)[0], 255);
}

TEST(Drawing, TextHasInkWhereItSaysItHasWidth) {
  Picture p(300, 40);
  drawText(p, "thickness [mm\u00b2] -0.25", {10, 30}, 14, {0, 0, 0});
  const int end = 10 + static_cast<int>(textWidth("thickness [mm\u00b2] -0.25", 14));
  int lastInk = 0;
  for (int x = 0; x < 300; ++x) {
    for (int y = 0; y < 40; ++y) {
      if (p.pixel(x, y)[0] < 128) lastInk = x;
    }
  }
  EXPECT_NEAR(lastInk, end, 3);
}

TEST(Drawing, ARimSetsTextOffFromADarkGround) {
  Picture dark(120, 40, {20, 20, 60});
  drawTextWithRim(dark, "V1", {60, 30}, 16, {0, 0, 0}, {1, 1, 1}, TextAnchor::Middle);
  int light = 0, black = 0;
  for (int x = 0; x < 120; ++x) {
    for (int y = 0; y < 40; ++y) {
      light += dark.pixel(x, y)[0] > 240;
      black += dark.pixel(x, y)[2] < 10;
    }
  }
  EXPECT_GT(light, 100);
  EXPECT_GT(black, 40);
}

TEST(LabelColours, AreTheTablesOwnWhereItHasAny) {
  const Colour own = colourOfLabel(3, {60 / 255.0F, 20 / 255.0F, 220 / 255.0F, 1});
  EXPECT_EQ(encodeSrgb(own[0]), 60);
  EXPECT_EQ(encodeSrgb(own[2]), 220);
  EXPECT_EQ(colourOfLabel(3, {0, 0, 0, 0}), colourOfLabel(3));
  EXPECT_EQ(colourOfLabel(-1), colourOfLabel(0));  // an annotation's vertices without a region
}

/// A plane of two halves, painted plainly.
TEST(FlatFigure, OutlinesCarryTheColoursOfTheRegionsOnTheirSides) {
  const TriangleMesh plane = geometry::makeRectangle(40, 40, 40, 40);
  SurfacePaint paint;
  paint.values = Eigen::VectorXd::Zero(plane.vertexCount());
  paint.scale = {ColourMap::Grey, -1, 0.2, "x", ""};
  FlatMarks marks;
  const Colour red = {1, 0, 0}, blue = {0, 0, 1};
  marks.lines.push_back({{20, 5, 0}, {20, 35, 0}, red, blue});  // upwards: left is left
  marks.names.emplace_back(Point(1, 20, 0), "a long name at the rim");
  const Picture picture = flatFigure(plane, paint, marks, 450);
  int reds = 0, blues = 0, lastRed = 0, firstBlue = picture.width;
  for (int x = 0; x < 450; ++x) {
    const std::uint8_t* p = picture.pixel(x, 120);
    if (p[0] > 200 && p[2] < 60) {
      ++reds;
      lastRed = x;
    }
    if (p[2] > 200 && p[0] < 60) {
      ++blues;
      firstBlue = std::min(firstBlue, x);
    }
  }
  EXPECT_GE(reds, 1);
  EXPECT_GE(blues, 1);
  EXPECT_LT(lastRed, firstBlue);
  for (int y = 0; y < 430; ++y) EXPECT_GT(picture.pixel(0, y)[0], 60) << "a name is cut off";
}

/// Red pixels of some rows.
int redsIn(const Picture& picture, int firstRow, int lastRow) {
  int count = 0;
  for (int y = firstRow; y < lastRow; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* p = picture.pixel(x, y);
      count += p[0] > 200 && p[2] < 60;
    }
  }
  return count;
}

TEST(FlatFigure, OutlinesLieWhereTheSurfaceDoesNotUpsideDown) {
  const TriangleMesh plane = geometry::makeRectangle(40, 40, 40, 40);
  SurfacePaint paint;
  paint.values = Eigen::VectorXd::Zero(plane.vertexCount());
  paint.scale = {ColourMap::Grey, -1, 0.2, "x", ""};
  FlatMarks marks;
  const Colour red = {1, 0, 0};
  marks.lines.push_back({{20, 25, 0}, {20, 38, 0}, red, red});  // in the upper half
  const Picture picture = flatFigure(plane, paint, marks, 450);
  EXPECT_GT(redsIn(picture, 0, 225), 20);
  EXPECT_EQ(redsIn(picture, 225, 450), 0);
}

TEST(FlatFigure, DirectionsStandInTheCorner) {
  const TriangleMesh plane = geometry::makeRectangle(40, 40, 40, 40);
  SurfacePaint paint;
  paint.values = Eigen::VectorXd::Zero(plane.vertexCount());
  paint.scale = {ColourMap::Grey, -1, 0.2, "x", ""};
  FlatMarks marks;
  const Picture plain = flatPanel(plane, paint, marks, 450).picture();
  marks.directions.emplace_back(Eigen::Vector2d(0, 1), "A");
  const Picture picture = flatPanel(plane, paint, marks, 450).picture();
  const auto changed = [&](int fromX, int toX, int fromY, int toY) {
    int count = 0;
    for (int y = fromY; y < toY; ++y) {
      for (int x = fromX; x < toX; ++x) count += picture.pixel(x, y)[0] != plain.pixel(x, y)[0];
    }
    return count;
  };
  const int right = picture.width;
  EXPECT_GT(changed(right - 80, right, 380, 412), 20) << "the letter above";
  EXPECT_EQ(changed(right - 80, right, 415, 450), 0) << "and nothing below its foot";
  EXPECT_EQ(changed(0, right - 80, 0, 450), 0);
  marks.names.emplace_back(Point(39, 3, 0), "a name");
  const Picture named = flatPanel(plane, paint, marks, 450).picture();
  EXPECT_NE(named.rgb, picture.rgb);
  for (int y = 380; y < 450; ++y) {
    for (int x = right - 70; x < right; ++x) {
      ASSERT_EQ(named.pixel(x, y)[0], picture.pixel(x, y)[0]) << "names keep off the compass";
    }
  }
}

TEST(FlatFigure, ANameWithoutRoomIsLeftOut) {
  const TriangleMesh plane = geometry::makeRectangle(40, 40, 40, 40);
  SurfacePaint paint;
  paint.values = Eigen::VectorXd::Zero(plane.vertexCount());
  paint.scale = {ColourMap::Grey, -1, 0.2, "x", ""};
  FlatMarks marks;
  for (int n = 0; n < 7; ++n) marks.names.emplace_back(Point(20, 20, 0), "a name");
  const Picture seven = flatPanel(plane, paint, marks, 450).picture();
  marks.names.emplace_back(Point(20, 20, 0), "another");
  EXPECT_EQ(flatPanel(plane, paint, marks, 450).picture().rgb, seven.rgb);
}

TEST(Ticks, AreRoundAndWithinTheRange) {
  EXPECT_EQ(roundTicks(1, 4.3), (std::vector<double>{1, 1.5, 2, 2.5, 3, 3.5, 4}));
  EXPECT_EQ(roundTicks(0, 2, 1), (std::vector<double>{0, 1, 2})) << "counts";
  const double next = std::nextafter(2.5, 3);
  EXPECT_EQ(roundTicks(2.5, next), (std::vector<double>{2.5, next})) << "no end of ticks";
}

TEST(Ticks, HaveTheDigitsThatTheRangeNeeds) {
  EXPECT_EQ(tickText(2.5, 4), "2.5");
  EXPECT_EQ(tickText(0, 4), "0");
  EXPECT_EQ(tickText(-0.25, 1), "-0.25");
  EXPECT_EQ(tickText(60, 120), "60");
  EXPECT_EQ(tickText(2.3575, 0.67), "2.36");
  EXPECT_EQ(tickText(4.75, 0.18), "4.75");
  EXPECT_EQ(unitText("mm^-1"), "mm\u207b\u00b9");
  EXPECT_EQ(unitText("mm"), "mm");
}

}  // namespace
}  // namespace explica::report
