// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Drawing.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::report {
namespace {

/// Strokes of a glyph: polylines separated by spaces, each a list of points, two characters a
/// point: column 0..4 and row, 0..6 above the baseline, a and b one and two below it.
struct Glyph {
  char character;
  const char* strokes;
};

// Codes beyond ASCII stand for signs of units: 1 is a superscript two, 2 a degree, 3 a superscript
// minus, 4 a superscript three.
constexpr Glyph kGlyphs[] = {
    {'0', "103041453616050110"},
    {'1', "152620 1030"},
    {'2', "05163645440040"},
    {'3', "051636454433 23334241301001"},
    {'4', "30360242"},
    {'5', "460603334241301001"},
    {'6', "453616050110304142331302"},
    {'7', "064610"},
    {'8', "13040516364544331302011030414233"},
    {'9', "011030414536160504133344"},
    {'A', "002640 1232"},
    {'B', "00063645443303 3342413000"},
    {'C', "4536160501103041"},
    {'D', "00062644422000"},
    {'E', "46060040 0333"},
    {'F', "460600 0333"},
    {'G', "45361605011030414323"},
    {'H', "0006 4046 0343"},
    {'I', "2026 1030 1636"},
    {'J', "0110304146"},
    {'K', "0006 4602 1340"},
    {'L', "060040"},
    {'M', "0006234640"},
    {'N', "00064046"},
    {'O', "103041453616050110"},
    {'P', "00063645443303"},
    {'Q', "103041453616050110 2240"},
    {'R', "00063645443303 2340"},
    {'S', "453616050413334241301001"},
    {'T', "2026 0646"},
    {'U', "060110304146"},
    {'V', "062046"},
    {'W', "0610233046"},
    {'X', "0046 0640"},
    {'Y', "062346 2320"},
    {'Z', "06460040"},
    {'a', "4440 4334140301103041"},
    {'b', "0600 0314344341301001"},
    {'c', "4334140301103041"},
    {'d', "4640 4334140301103041"},
    {'e', "02424334140301103041"},
    {'f', "46362520 1434"},
    {'g', "444a3b1b0a 4334140301103041"},
    {'h', "0600 0314344340"},
    {'i', "2420 2626"},
    {'j', "242a1b0b 2626"},
    {'k', "0600 3402 2340"},
    {'l', "2620"},
    {'m', "0400 03142320 23344340"},
    {'n', "0400 0314344340"},
    {'o', "103041433414030110"},
    {'p', "040b 0314344341301001"},
    {'q', "444b 4334140301103041"},
    {'r', "0400 03143443"},
    {'s', "43341403123241301001"},
    {'t', "26213041 1434"},
    {'u', "0401103041 4440"},
    {'v', "042044"},
    {'w', "0410233044"},
    {'x', "0044 0440"},
    {'y', "0420 441b"},
    {'z', "04440040"},
    {'.', "2020"},
    {',', "201a"},
    {'-', "1333"},
    {'+', "0343 2125"},
    {'/', "0046"},
    {'(', "36252130"},
    {')', "16252110"},
    {'[', "36262030"},
    {']', "16262010"},
    {'%', "0046 0516150405 3142413031"},
    {':', "2020 2323"},
    {'_', "0a4a"},
    {'=', "0242 0444"},
    {'*', "2125 1135 1531"},
    {'|', "2026"},
    {'<', "450341"},
    {'>', "054301"},
    {'^', "152635"},
    {'\'', "2624"},
    {'!', "2622 2020"},
    {'?', "05163645442322 2020"},
    {1, "0626250323"},
    {2, "0515160605"},
    {3, "0525"},
    {4, "062615241303"},
};

constexpr double kRows = 6;       // capitals' height in rows
constexpr double kGap = 2;        // between glyphs, columns
constexpr double kSpace = 3;      // a space's width, columns
constexpr double kStroke = 0.13;  // stroke width, of the capitals' height

const char* strokesOf(char character) {
  for (const Glyph& glyph : kGlyphs) {
    if (glyph.character == character) return glyph.strokes;
  }
  return strokesOf('?');
}

/// One code a glyph: UTF-8 signs of units become the table's codes, others '?'.
std::string glyphCodes(std::string_view text) {
  std::string codes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte < 0x80) {
      codes.push_back(text[i]);
      continue;
    }
    const std::string_view rest = text.substr(i);
    std::size_t length = 1;
    while (i + length < text.size() &&
           (static_cast<unsigned char>(text[i + length]) & 0xc0) == 0x80)
      ++length;
    const std::string_view sign = rest.substr(0, length);
    char code = '?';
    if (sign == "\u00b2") code = 1;
    if (sign == "\u00b0") code = 2;
    if (sign == "\u207b") code = 3;
    if (sign == "\u00b3") code = 4;
    if (sign == "\u2212" || sign == "\u2013") code = '-';
    if (sign == "\u00b9") code = '\'';
    codes.push_back(code);
    i += length - 1;
  }
  return codes;
}

double rowOf(char c) {
  return c == 'a' ? -1 : (c == 'b' ? -2 : c - '0');
}

/// Columns that a glyph's strokes span.
std::pair<int, int> extentOf(const char* strokes) {
  int low = 4;
  int high = 0;
  for (const char* p = strokes; *p != '\0'; ++p) {
    if (*p == ' ') continue;
    low = std::min(low, *p - '0');
    high = std::max(high, *p - '0');
    ++p;
  }
  return {low, high};
}

/// Pixels of a picture, ends included; none where `right` is below `left` or `bottom` below `top`.
struct PixelBox {
  int left, right, top, bottom;

  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - top) * (right - left + 1) + (x - left);
  }
  [[nodiscard]] std::size_t size() const {
    return right < left || bottom < top ? 0 : index(right, bottom) + 1;
  }
};

PixelBox pixelsOf(const Eigen::AlignedBox2d& box, double margin, const Picture& picture) {
  const auto low = [&](double x) { return std::max(0, static_cast<int>(std::floor(x - margin))); };
  const auto high = [&](double x, int count) {
    return std::min(count - 1, static_cast<int>(std::ceil(x + margin)));
  };
  return {low(box.min().x()), high(box.max().x(), picture.width), low(box.min().y()),
          high(box.max().y(), picture.height)};
}

}  // namespace

void drawSegments(Picture& picture, const std::vector<Segment2>& segments, const Colour& colour,
                  double width) {
  const double half = 0.5 * width;
  Eigen::AlignedBox2d all;
  for (const Segment2& s : segments) all.extend(s.from).extend(s.to);
  if (all.isEmpty()) return;
  const PixelBox box = pixelsOf(all, half + 1, picture);
  // Coverage of the whole drawing first, so that joints and crossings do not darken twice.
  std::vector<std::uint8_t> coverage(box.size(), 0);
  for (const Segment2& s : segments) {
    const PixelBox part = pixelsOf(Eigen::AlignedBox2d(s.from).extend(s.to), half + 1, picture);
    const Eigen::Vector2d along = s.to - s.from;
    const double squared = along.squaredNorm();
    for (int y = part.top; y <= part.bottom; ++y) {
      for (int x = part.left; x <= part.right; ++x) {
        const Eigen::Vector2d p = Eigen::Vector2d(x + 0.5, y + 0.5) - s.from;
        const double t = squared > 0 ? std::clamp(p.dot(along) / squared, 0.0, 1.0) : 0.0;
        const double inside = half + 0.5 - (p - t * along).norm();
        if (inside <= 0) continue;
        std::uint8_t& c = coverage[box.index(x, y)];
        c = std::max(c, static_cast<std::uint8_t>(std::lround(255 * std::min(inside, 1.0))));
      }
    }
  }
  for (int y = box.top; y <= box.bottom; ++y) {
    for (int x = box.left; x <= box.right; ++x) {
      const std::uint8_t covered = coverage[box.index(x, y)];
      if (covered == 0) continue;
      const float share = covered / 255.0f;
      for (int c = 0; c < 3; ++c) {
        std::uint8_t& byte = picture.rgb[3 * (static_cast<std::size_t>(y) * picture.width + x) + c];
        byte = encodeSrgb((1 - share) * decodeSrgb(byte) + share * colour[c]);
      }
    }
  }
}

double textWidth(std::string_view text, double size) {
  double columns = 0;
  for (const char c : glyphCodes(text)) {
    if (c == ' ') {
      columns += kSpace;
      continue;
    }
    const auto [low, high] = extentOf(strokesOf(c));
    columns += high - low + kGap;
  }
  return std::max(0.0, columns - kGap) * size / kRows;
}

namespace {

/// The strokes of a line of text.
std::vector<Segment2> textSegments(std::string_view text, const Eigen::Vector2d& position,
                                   double size, TextAnchor anchor) {
  const double unit = size / kRows;
  double x = position.x();
  if (anchor == TextAnchor::Middle) x -= 0.5 * textWidth(text, size);
  if (anchor == TextAnchor::Right) x -= textWidth(text, size);
  std::vector<Segment2> segments;
  for (const char code : glyphCodes(text)) {
    if (code == ' ') {
      x += kSpace * unit;
      continue;
    }
    const char* strokes = strokesOf(code);
    const auto [low, high] = extentOf(strokes);
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    bool drawing = false;
    for (const char* p = strokes; *p != '\0'; ++p) {
      if (*p == ' ') {
        drawing = false;
        continue;
      }
      const Eigen::Vector2d at(x + (*p - '0' - low) * unit, position.y() - rowOf(p[1]) * unit);
      if (drawing) segments.push_back({last, at});
      last = at;
      drawing = true;
      ++p;
    }
    x += (high - low + kGap) * unit;
  }
  return segments;
}

double strokeWidth(double size) {
  return std::max(1.0, kStroke * size);
}

}  // namespace

void drawText(Picture& picture, std::string_view text, const Eigen::Vector2d& position, double size,
              const Colour& colour, TextAnchor anchor) {
  drawSegments(picture, textSegments(text, position, size, anchor), colour, strokeWidth(size));
}

void drawTextWithRim(Picture& picture, std::string_view text, const Eigen::Vector2d& position,
                     double size, const Colour& colour, const Colour& rim, TextAnchor anchor) {
  const std::vector<Segment2> segments = textSegments(text, position, size, anchor);
  drawSegments(picture, segments, rim, strokeWidth(size) + kRim * size);
  drawSegments(picture, segments, colour, 1.15 * strokeWidth(size));
}

std::vector<double> roundTicks(double low, double high, double least) {
  const double raw = (high - low) / 5;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  const double lead = raw / power;
  const double step =
      std::max(power * (lead < 1.5 ? 1 : (lead < 3.5 ? 2 : (lead < 7.5 ? 5 : 10))), least);
  // No step that values so near to each other could take.
  if (!(step > 1e-12 * std::max(std::abs(low), std::abs(high)))) return {low, high};
  std::vector<double> ticks;
  for (double x = std::ceil(low / step - 1e-9) * step; x <= high + 1e-9 * step; x += step) {
    ticks.push_back(x);
  }
  return ticks;
}

std::string tickText(double value, double range) {
  if (std::abs(value) < 1e-9 * std::abs(range)) value = 0;
  const double magnitude = std::max(std::abs(value), std::abs(range));
  if (value != 0 && (magnitude >= 1e5 || std::abs(range) < 1e-3)) return printed("%.2g", value);
  int digits = std::clamp(
      2 - static_cast<int>(std::floor(std::log10(std::max(std::abs(range), 1e-12)))), 0, 4);
  // No more than three digits say anything, unless neighbours would then be the same.
  constexpr double kFinest = 0.05;  // of the range: no ticks are nearer
  const auto unit = [](int decimals) { return std::pow(10.0, -decimals); };
  while (digits > 0 && std::abs(value) >= 1000 * unit(digits) &&
         unit(digits - 1) <= kFinest * std::abs(range)) {
    --digits;
  }
  std::string text = printed("%.*f", digits, value);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

std::string unitText(std::string_view unit) {
  constexpr std::array kRaised = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                  "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text;
  bool raised = false;
  for (const char c : unit) {
    const bool digit = c >= '0' && c <= '9';
    if (raised && c == '-') {
      text += "\u207b";
    } else if (raised && digit) {
      text += kRaised[c - '0'];
    } else if (c == '^') {
      raised = true;
    } else {
      raised = false;
      text += c;
    }
  }
  return text;
}

}  // namespace explica::report
