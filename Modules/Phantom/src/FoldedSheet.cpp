// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Phantom/FoldedSheet.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::phantom {
namespace {

constexpr int kPiecesPerWave = 4096;   // of the curve's integral
constexpr double kMostVertices = 4e6;  // of a sheet

/// x and z of the sine-generated curve at arc length s: one wave is integrated, the others repeat
/// it.
class Meander {
 public:
  Meander(double turn, double wave) : wave_(wave), x_(kPiecesPerWave + 1), z_(kPiecesPerWave + 1) {
    const double ds = wave / kPiecesPerWave;
    for (int k = 0; k < kPiecesPerWave; ++k) {
      const double angle = turn * std::sin(2 * kPi * (k + 0.5) / kPiecesPerWave);
      x_[k + 1] = x_[k] + ds * std::cos(angle);
      z_[k + 1] = z_[k] + ds * std::sin(angle);
    }
  }

  [[nodiscard]] double x(double s) const {
    const double whole = std::floor(s / wave_);
    return whole * x_.back() + between(x_, s / wave_ - whole);
  }
  [[nodiscard]] double z(double s) const { return between(z_, s / wave_ - std::floor(s / wave_)); }

 private:
  static double between(const std::vector<double>& values, double share) {
    const double at = share * kPiecesPerWave;
    const int k = std::clamp(static_cast<int>(at), 0, kPiecesPerWave - 1);
    return values[k] + (at - k) * (values[k + 1] - values[k]);
  }

  double wave_;
  std::vector<double> x_, z_;
};

void check(const FoldedSheetOptions& o) {
  const auto refuse = [](bool bad, const char* sentence) {
    if (bad) throw InvalidInput(sentence);
  };
  refuse(!(o.length > 0) || !(o.width > 0) || !(o.edge > 0),
         "length, width and edge: must be above 0 mm");
  refuse(o.waves < 2, "waves: must be 2 or more");
  refuse(!(o.turn >= 0 && o.turn <= 2.1), "turn: must lie in 0 to 2.1 rad, or folds would touch");
  refuse(!(o.winding >= 0 && 2 * kPi * o.winding < o.width),
         "winding: must be 0 or more, and less than the width over 2 pi");
  refuse(o.edge > o.length / (8 * o.waves) || o.edge > o.width / 8,
         "edge: a fold and the width need eight edges each");
  refuse((o.length / o.edge) * (o.width / o.edge) > kMostVertices,
         "edge: so short that the sheet has more than four million vertices");
}

}  // namespace

FoldedSheet makeFoldedSheet(const FoldedSheetOptions& o) {
  check(o);
  const double wave = o.length / o.waves;
  const Meander meander(o.turn, wave);
  const int across = 2 * static_cast<int>(std::lround(o.length / o.edge / 2));
  const int along = 2 * static_cast<int>(std::lround(o.width / o.edge / 2));
  FoldedSheet sheet;
  sheet.mesh.positions.resize(static_cast<Eigen::Index>(across + 1) * (along + 1), 3);
  sheet.mesh.faces.resize(2 * static_cast<Eigen::Index>(across) * along, 3);
  const auto vertex = [&](int i, int j) { return j * (across + 1) + i; };
  const double slack = 1e-9 * o.edge;
  Eigen::Index face = 0;
  for (int j = 0; j <= along; ++j) {
    const double y = o.width * j / along;
    const double shift = o.winding * std::sin(2 * kPi * j / along);
    for (int i = 0; i <= across; ++i) {
      const double s = o.length * i / across;
      sheet.mesh.positions.row(vertex(i, j))
          << meander.x(s + shift) - meander.x(o.length / 2 + shift),
          y - o.width / 2, meander.z(s + shift);
      const double toSide = std::min(s, o.length - s);
      const double toEnd = std::min(y, o.width - y);
      if (toSide >= wave / 2 - slack && toEnd >= o.width / 8 - slack) {
        sheet.region.push_back(vertex(i, j));
      }
      if (i == across || j == along) continue;
      const int a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1),
                d = vertex(i + 1, j + 1);
      // Diagonals alternate, so that no direction is preferred.
      const bool rising = (i + j) % 2 == 1;
      sheet.mesh.faces.row(face++) << a, b, rising ? d : c;
      sheet.mesh.faces.row(face++) << (rising ? a : b), d, c;
    }
  }
  sheet.centre = sheet.mesh.positions.row(vertex(across / 2, along / 2)).transpose();
  return sheet;
}

}  // namespace explica::phantom
