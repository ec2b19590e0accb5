// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/Annulus.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/Runs.h"
#include "Explica/Harmonic/LabelBoundary.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <sstream>

namespace explica::harmonic {

namespace {

using Code = std::uint8_t;
constexpr Code codeOf(Site site) {
  return static_cast<Code>(site);
}
constexpr Code kTissueCode = codeOf(Site::Tissue);  // as the fields of sites hold it

// Closest that a boundary may come to a voxel's centre, in voxels: moves it by no more than that
// and keeps 1 / fraction well inside single precision.
constexpr double kSmallestFraction = 1e-4;
// Room around the tissue within which boundaries are made from labels.
constexpr int kLabelMargin = 4;

/// Part of a volume's index space: voxel (0, 0, 0) of the box is voxel `first` of the grid.
struct Box {
  std::array<int, 3> first{}, size{};
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * size[1] * size[2];
  }
  [[nodiscard]] std::size_t linear(int i, int j, int k) const {
    return i + static_cast<std::size_t>(size[0]) * (j + static_cast<std::size_t>(size[1]) * k);
  }
};

/// Smallest box around voxels for which `wanted(row, i)`, widened.
Box boxAround(const Grid& grid, int margin,
              const std::function<void(std::size_t row, int& low, int& high)>& extentOfRow) {
  struct Extent {
    int low = 0, high = -1;
  };
  const std::size_t rows = static_cast<std::size_t>(grid.size[1]) * grid.size[2];
  std::vector<Extent> extents(rows);
  parallelFor(rows, 256,
              [&](std::size_t row) { extentOfRow(row, extents[row].low, extents[row].high); });
  std::array<int, 3> low = grid.size, high = {-1, -1, -1};
  for (std::size_t row = 0; row < rows; ++row) {
    if (extents[row].high < extents[row].low) continue;
    const int j = static_cast<int>(row % grid.size[1]), k = static_cast<int>(row / grid.size[1]);
    low = {std::min(low[0], extents[row].low), std::min(low[1], j), std::min(low[2], k)};
    high = {std::max(high[0], extents[row].high), std::max(high[1], j), std::max(high[2], k)};
  }
  Box box;
  for (int a = 0; a < 3; ++a) {
    if (high[a] < low[a]) return Box{};
    const int room = (a == 2 && grid.dimension() == 2) ? 1 : margin;
    // Beyond the volume one layer is enough: it is insulated.
    box.first[a] = std::max(low[a] - room, -1);
    box.size[a] = std::min(high[a] + room, grid.size[a]) - box.first[a] + 1;
  }
  return box;
}

/// Position of the zero between a (inside the tissue) and b, from four values in a row, in (0, 1].
/// The second difference is the smaller of both ends', so that a ridge beside the edge does no
/// harm.
double crossing(double before, double a, double b, double after) {
  const double linear = a / (a - b);
  const double atA = before - 2 * a + b, atB = a - 2 * b + after;
  double second = 0;
  if (atA * atB > 0) second = std::abs(atA) < std::abs(atB) ? atA : atB;
  double s = linear;
  for (int k = 0; k < 4; ++k) {
    const double value = a + (b - a) * s - 0.5 * second * s * (1 - s);
    const double slope = (b - a) - 0.5 * second * (1 - 2 * s);
    if (slope * (b - a) <= 0) return linear;
    s -= value / slope;
    if (!(s > 0 && s < 1)) return linear;
  }
  return s;
}

/// Numbers the tissue and makes its links; fractions stay 1.
/// @param cutBits  per voxel and direction whether a boundary cuts that link, the inner one where
///                 `innerBits` says so; both may be empty
void number(Annulus& annulus, const std::vector<Code>& sites,
            const std::vector<std::uint8_t>& cutBits, const std::vector<std::uint8_t>& innerBits) {
  const auto strides = annulus.strides();
  const std::size_t total = sites.size();
  const std::size_t sliceSize = static_cast<std::size_t>(annulus.size[0]) * annulus.size[1];
  const std::size_t slices = annulus.size[2];
  // The run of a tissue voxel: 0 even regular, 1 even irregular, 2 odd regular, 3 odd irregular.
  const auto runOf = [&](std::size_t p, int i, int j, int k) {
    bool regular = !annulus.planar && (cutBits.empty() || cutBits[p] == 0);
    for (int d = 0; regular && d < 6; ++d) {
      const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(signOf(d)) * strides[axisOf(d)];
      regular = sites[p + step] == kTissueCode;
    }
    return 2 * ((i + j + k) & 1) + (regular ? 0 : 1);
  };
  annulus.numberAt.assign(total, 0);
  std::vector<std::array<std::int32_t, 4>> counts(slices + 1, {0, 0, 0, 0});
  parallelFor(slices, 1, [&](std::size_t k) {
    std::size_t p = k * sliceSize;
    for (int j = 0; j < annulus.size[1]; ++j) {
      for (int i = 0; i < annulus.size[0]; ++i, ++p) {
        switch (static_cast<Site>(sites[p])) {
          case Site::Tissue: {
            const int run = runOf(p, i, j, static_cast<int>(k));
            annulus.numberAt[p] = run;
            ++counts[k][run];
            break;
          }
          case Site::Inner:
            annulus.numberAt[p] = kInner;
            break;
          case Site::Outer:
            annulus.numberAt[p] = kOuter;
            break;
          case Site::Insulated:
            annulus.numberAt[p] = kInsulated;
            break;
        }
      }
    }
  });
  std::int32_t next = 0;
  for (int run = 0; run < 4; ++run) {
    for (std::size_t k = 0; k < slices; ++k) {
      const std::int32_t here = counts[k][run];
      counts[k][run] = next;
      next += here;
    }
    annulus.runEnd[run] = next;
  }
  annulus.place.resize(next);
  annulus.links.resize(next);
  parallelFor(slices, 1, [&](std::size_t k) {
    auto cursor = counts[k];
    for (std::size_t p = k * sliceSize; p < (k + 1) * sliceSize; ++p) {
      if (sites[p] != kTissueCode) continue;
      const std::int32_t n = cursor[annulus.numberAt[p]]++;
      annulus.numberAt[p] = n;
      annulus.place[n] = static_cast<std::int32_t>(p);
    }
  });
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    const std::int32_t p = annulus.place[n];
    for (int d = 0; d < 6; ++d) {
      const bool cut = !cutBits.empty() && (cutBits[p] >> d & 1);
      const bool leavesSlice = annulus.planar && axisOf(d) == 2;
      annulus.links[n][d] = leavesSlice ? kInsulated
                            : cut       ? (innerBits[p] >> d & 1 ? kInner : kOuter)
                                        : annulus.numberAt[p + signOf(d) * strides[axisOf(d)]];
    }
  });
  const std::int32_t irregulars =
      annulus.runEnd[1] - annulus.runEnd[0] + annulus.runEnd[3] - annulus.runEnd[2];
  annulus.fractions.assign(irregulars, {1, 1, 1, 1, 1, 1});
}

/// A box voxel's subscripts in the whole volume.
std::array<int, 3> voxelAt(const Annulus& annulus, std::size_t p) {
  const std::size_t row = p / annulus.size[0];
  return {static_cast<int>(p % annulus.size[0]) + annulus.first[0],
          static_cast<int>(row % annulus.size[1]) + annulus.first[1],
          static_cast<int>(row / annulus.size[1]) + annulus.first[2]};
}

/// Removes pieces of tissue that miss one side (they become insulated); counts what remains.
void keepSpanningPieces(Annulus& annulus, std::vector<Code>& sites) {
  const std::array<std::int32_t, 3> strides = annulus.strides();
  std::vector<std::uint8_t> seen(sites.size(), 0);
  std::vector<std::int32_t> piece;
  bool anyInner = false, anyOuter = false;
  for (std::size_t start = 0; start < sites.size(); ++start) {
    if (sites[start] != kTissueCode || seen[start]) continue;
    piece.assign(1, static_cast<std::int32_t>(start));
    seen[start] = 1;
    bool inner = false, outer = false;
    for (std::size_t head = 0; head < piece.size(); ++head) {
      for (int d = 0; d < (annulus.planar ? 4 : 6); ++d) {
        const std::int32_t q = piece[head] + signOf(d) * strides[axisOf(d)];
        switch (static_cast<Site>(sites[q])) {
          case Site::Tissue:
            if (!seen[q]) {
              seen[q] = 1;
              piece.push_back(q);
            }
            break;
          case Site::Inner:
            inner = true;
            break;
          case Site::Outer:
            outer = true;
            break;
          case Site::Insulated:
            break;
        }
      }
    }
    anyInner |= inner;
    anyOuter |= outer;
    if (inner && outer) {
      ++annulus.components;
      continue;
    }
    for (const std::int32_t p : piece) sites[p] = codeOf(Site::Insulated);
    if (annulus.droppedComponents == 0) annulus.firstDropped = voxelAt(annulus, start);
    annulus.droppedVoxels += piece.size();
    ++annulus.droppedComponents;
  }
  if (annulus.components == 0) {
    if (annulus.droppedVoxels == 0) throw InvalidInput("no tissue voxel was found");
    if (anyInner && anyOuter) {
      throw InvalidInput(
          "no connected piece of tissue touches both the inner and the outer region");
    }
    throw InvalidInput(std::string("the tissue touches only the ") +
                       (anyInner   ? "inner"
                        : anyOuter ? "outer"
                                   : "insulated") +
                       " region; it must lie between an inner and an outer one");
  }
}

/// Voxel faces between the inner and the outer region.
struct Contacts {
  std::vector<std::size_t> inner;  ///< of each face the box voxel on the inner side, ascending
  std::size_t boundary = 0;        ///< voxel faces between tissue and either region
};

Contacts contactsOf(const Annulus& annulus, const std::vector<Code>& sites) {
  constexpr Code kIn = codeOf(Site::Inner), kOut = codeOf(Site::Outer);
  const auto strides = annulus.strides();
  std::vector<Contacts> bySlice(annulus.size[2]);
  const auto look = [&](std::size_t p, std::size_t q, Contacts& found) {
    const Code s = sites[p], t = sites[q];
    if (s == t) return;
    if ((s == kIn && t == kOut) || (s == kOut && t == kIn)) {
      found.inner.push_back(s == kIn ? p : q);
    } else {
      found.boundary += (s == kTissueCode && (t == kIn || t == kOut)) ||
                        (t == kTissueCode && (s == kIn || s == kOut));
    }
  };
  parallelFor(bySlice.size(), 1, [&](std::size_t k) {
    std::size_t p = k * strides[2];
    for (int j = 0; j < annulus.size[1]; ++j) {
      for (int i = 0; i < annulus.size[0]; ++i, ++p) {
        if (i + 1 < annulus.size[0]) look(p, p + 1, bySlice[k]);
        if (j + 1 < annulus.size[1]) look(p, p + strides[1], bySlice[k]);
        if (!annulus.planar && k + 1 < bySlice.size()) look(p, p + strides[2], bySlice[k]);
      }
    }
  });
  Contacts all;
  for (const Contacts& some : bySlice) {
    all.inner.insert(all.inner.end(), some.inner.begin(), some.inner.end());
    all.boundary += some.boundary;
  }
  std::sort(all.inner.begin(), all.inner.end());
  return all;
}

/// Places where they touch: faces and first voxel of each piece of the contacts' inner voxels that
/// hangs together by faces, edges or corners; largest first.
std::vector<std::pair<std::size_t, std::size_t>> placesOf(const Annulus& annulus,
                                                          const std::vector<std::size_t>& inner) {
  std::vector<std::size_t> voxels = inner;
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  const auto strides = annulus.strides();
  const auto find = [&](std::size_t p) {
    const auto at = std::lower_bound(voxels.begin(), voxels.end(), p);
    return at != voxels.end() && *at == p ? static_cast<std::int32_t>(at - voxels.begin()) : -1;
  };
  DisjointSets pieces(voxels.size());
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    for (int n = 14; n < 27; ++n) {  // the later half of the neighbours
      const std::int32_t beside =
          find(voxels[v] + (n % 3 - 1) + (n / 3 % 3 - 1) * strides[1] + (n / 9 - 1) * strides[2]);
      if (beside >= 0) pieces.join(static_cast<std::int32_t>(v), beside);
    }
  }
  std::map<std::int32_t, std::size_t> faces;
  for (const std::size_t p : inner) ++faces[pieces.root(find(p))];
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (const auto& [root, count] : faces) places.emplace_back(count, voxels[root]);
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  return places;
}

constexpr const char* kTouches = "no tissue between the inner and the outer region at ";

/// Says in which slices a ring is open.
void warnOfOpenRings(const Annulus& annulus, const Contacts& contacts, const Monitor& monitor) {
  constexpr std::size_t kMost = 12;  // slices that are listed
  std::set<int> slices;
  for (const std::size_t p : contacts.inner) {
    slices.insert(static_cast<int>(p / annulus.strides()[2]) + annulus.first[2]);
  }
  std::ostringstream text;
  text << kTouches << contacts.inner.size() << " voxel faces, first at voxel "
       << voxelText(voxelAt(annulus, contacts.inner[0])) << ": the ring is open in slice"
       << (slices.size() > 1 ? "s" : "");
  if (slices.size() > kMost) {
    text << ' ' << *slices.begin() << " to " << *slices.rbegin();
  } else {
    for (const int k : slices) text << (k == *slices.begin() ? " " : ", ") << k;
  }
  monitor.warn(text.str());
}

/// Tells holes in the tissue from its ends.  Where a sheet of tissue ends, as cortex does around
/// the medial wall and a ventricle at its base, the regions touch on more area than that of a disc
/// whose radius is the tissue's thickness.
void noteContacts(Annulus& annulus, const std::vector<Code>& sites, const Monitor& monitor) {
  const Contacts contacts = contactsOf(annulus, sites);
  annulus.directContacts = contacts.inner.size();
  if (contacts.inner.empty()) return;
  if (annulus.planar) return warnOfOpenRings(annulus, contacts, monitor);
  // Voxel faces have 3/2 of the area of a surface that has all directions; two boundaries.
  constexpr double kStaircase = 1.5;
  const auto tissue = static_cast<double>(std::count(sites.begin(), sites.end(), kTissueCode));
  const double thickness = 2 * kStaircase * tissue / static_cast<double>(contacts.boundary);
  const double disc = kPi * thickness * thickness;  // voxel faces
  std::size_t faces = 0;
  std::string largest;
  for (const auto& [count, first] : placesOf(annulus, contacts.inner)) {
    if (static_cast<double>(count) >= kStaircase * disc) {
      ++annulus.ends;
      continue;
    }
    if (annulus.holes++ == 0) largest = voxelText(voxelAt(annulus, first));
    faces += count;
  }
  if (!isWorthAWarning(faces, contacts.boundary)) return;
  monitor.warn("the tissue has " + std::to_string(annulus.holes) +
               (annulus.holes == 1 ? " hole: " : " holes: ") + kTouches + std::to_string(faces) +
               " voxel face" + (faces == 1 ? "" : "s") + ", " +
               (annulus.holes == 1 ? "" : "most of them ") + "at voxel " + largest);
}

/// Where a boundary lies on the link from box voxel p, s its subscripts, in direction d: fraction
/// of the spacing.
using PlaceInBox =
    std::function<double(std::int32_t p, const std::array<int, 3>& s, int d, bool inner)>;

/// Sites of the box to the annulus.
Annulus assemble(const Grid& grid, const Box& box, std::vector<Code> sites,
                 const PlaceInBox& placeOnLink, const AnnulusOptions& options,
                 const Monitor& monitor) {
  Annulus annulus;
  annulus.grid = grid;
  annulus.first = box.first;
  annulus.size = box.size;
  annulus.model = options.boundary;
  annulus.planar = options.perSlice || grid.dimension() == 2;
  if (options.openEnds && grid.dimension() == 3) {
    int low = box.size[2], high = -1;
    const std::size_t sliceSize = static_cast<std::size_t>(box.size[0]) * box.size[1];
    for (int k = 0; k < box.size[2]; ++k) {
      const auto begin = sites.begin() + static_cast<std::ptrdiff_t>(k * sliceSize);
      if (std::find(begin, begin + static_cast<std::ptrdiff_t>(sliceSize), kTissueCode) !=
          begin + static_cast<std::ptrdiff_t>(sliceSize)) {
        low = std::min(low, k);
        high = std::max(high, k);
      }
    }
    for (int k = 0; k < box.size[2]; ++k) {
      if (k >= low && k <= high) continue;
      std::fill_n(sites.begin() + static_cast<std::ptrdiff_t>(k * sliceSize), sliceSize,
                  codeOf(Site::Insulated));
    }
  }
  noteContacts(annulus, sites, monitor);
  keepSpanningPieces(annulus, sites);
  number(annulus, sites, {}, {});
  if (options.boundary == BoundaryModel::Staircase) return annulus;

  parallelFor(annulus.count(), 1 << 12, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    const std::int32_t row = annulus.irregular(n);
    if (row < 0) return;
    const auto s = annulus.boxSubscripts(n);
    for (int d = 0; d < 6; ++d) {
      const std::int32_t link = annulus.links[n][d];
      if (link != kInner && link != kOuter) continue;
      const double fraction = placeOnLink(annulus.place[n], s, d, link == kInner);
      annulus.fractions[row][d] = static_cast<float>(std::clamp(fraction, kSmallestFraction, 1.0));
    }
  });
  return annulus;
}

std::string listed(const std::vector<Label>& labels) {
  std::ostringstream text;
  for (std::size_t k = 0; k < labels.size(); ++k) text << (k ? ", " : "") << labels[k];
  return text.str();
}

void checkGrid(const Grid& grid) {
  for (int a = 0; a < 3; ++a) {
    if (!(grid.spacing[a] > 0) || !std::isfinite(grid.spacing[a])) {
      throw InvalidInput("the voxel size along axis " + std::to_string(a) + " is " +
                         std::to_string(grid.spacing[a]) + " mm; it must be positive");
    }
    if (grid.size[a] < 1) throw InvalidInput("the volume is empty");
  }
}

/// Goes through the tissue in the order of the box's voxels.
class TissueCursor {
 public:
  /// Stands at the first tissue voxel from box voxel p on.
  TissueCursor(const Annulus& annulus, std::int32_t p) : annulus_(annulus) {
    const auto place = annulus.place.begin();
    for (int run = 0; run < 4; ++run) {
      const std::int32_t begin = run == 0 ? 0 : annulus.runEnd[run - 1];
      next_[run] = static_cast<std::int32_t>(
          std::lower_bound(place + begin, place + annulus.runEnd[run], p) - place);
    }
  }
  /// Calls visit(number, box voxel) for what comes before box voxel p, run by run.
  template <class Visit>
  void upTo(std::int32_t p, const Visit& visit) {
    for (int run = 0; run < 4; ++run) {
      std::int32_t n = next_[run];
      for (; n < annulus_.runEnd[run] && annulus_.place[n] < p; ++n) visit(n, annulus_.place[n]);
      next_[run] = n;
    }
  }

 private:
  const Annulus& annulus_;
  std::array<std::int32_t, 4> next_{};
};

/// A volume made of the box's voxels, `outside` beyond it: `inTissue(j, k)` gives for a row of the
/// grid the function of a tissue voxel's number and i, `offTissue(code)` the value elsewhere.
///
/// Tissue is a small part of the box, and its numbers come in four runs in storage order: each row
/// takes from every run what is its own, and no other voxel is looked at.
template <class T, class InTissue, class OffTissue>
VolumeOnDemand<T> onGrid(const Annulus& annulus, T outside, const InTissue& inTissue,
                         const OffTissue& offTissue) {
  VolumeOnDemand<T> values;
  values.grid = annulus.grid;
  values.elsewhere = outside;
  const std::array<int, 3>& first = annulus.first;
  const std::array<int, 3> last = {std::min(first[0] + annulus.size[0], annulus.grid.size[0]),
                                   std::min(first[1] + annulus.size[1], annulus.grid.size[1]),
                                   std::min(first[2] + annulus.size[2], annulus.grid.size[2])};
  values.begin = annulus.grid.linear(0, 0, std::max(first[2], 0));
  values.end = annulus.grid.linear(0, 0, last[2]);
  const bool blankOffTissue = offTissue(kInner) == outside && offTissue(kOuter) == outside &&
                              offTissue(kInsulated) == outside;
  values.fill = [=, &annulus](std::size_t voxel, std::size_t count, T* to) {
    std::fill_n(to, count, outside);
    std::optional<TissueCursor> cursor;
    const std::size_t end = voxel + count;
    while (voxel < end) {
      const std::array<int, 3> at = annulus.grid.subscripts(voxel);
      const int rowEnd =
          static_cast<int>(std::min<std::size_t>(annulus.grid.size[0], at[0] + (end - voxel)));
      const int rowBegin = std::max(at[0], first[0]), rowLast = std::min(rowEnd, last[0]);
      if (rowBegin < rowLast && at[1] >= first[1] && at[1] < last[1] && at[2] >= first[2] &&
          at[2] < last[2]) {
        const std::int32_t row =  // box voxel of the grid's i = 0, which may lie before the box
            annulus.size[0] * (at[1] - first[1] + annulus.size[1] * (at[2] - first[2])) - first[0];
        if (!blankOffTissue) {
          const std::int32_t* number = annulus.numberAt.data() + (row + rowBegin);
          T* const here = to + (rowBegin - at[0]);
          for (int t = 0; t < rowLast - rowBegin; ++t) here[t] = offTissue(number[t]);
        }
        if (!cursor) cursor.emplace(annulus, row + rowBegin);
        const auto value = inTissue(at[1], at[2]);
        cursor->upTo(row + rowLast, [&](std::int32_t n, std::int32_t p) {
          to[p - row - at[0]] = value(n, p - row);
        });
      }
      voxel += rowEnd - at[0];
      to += rowEnd - at[0];
    }
  };
  return values;
}

}  // namespace

namespace {

/// What each label is to the tissue; labels are few, so a list of pairs serves.
class RoleTable {
 public:
  explicit RoleTable(const LabelRoles& roles)
      // If the outer labels are named, the rest belongs to neither side.
      : rest_(codeOf(roles.outer.empty() ? Site::Outer : Site::Insulated)) {
    if (roles.tissue.empty()) throw InvalidInput("no tissue label was given (--tissue)");
    if (roles.inner.empty()) throw InvalidInput("no inner label was given (--inner)");
    assign(roles.inner, Site::Inner);
    assign(roles.tissue, Site::Tissue);
    assign(roles.insulated, Site::Insulated);
    assign(roles.outer, Site::Outer);
  }

  [[nodiscard]] Code roleOf(Label value) const {
    for (const auto& [other, code] : table_) {
      if (other == value) return code;
    }
    return rest_;
  }

  /// @throws InvalidInput  a role none of whose labels is among those present
  void requirePresent(const std::set<Label>& present, const Monitor& monitor) const {
    std::vector<Label> missing;
    std::set<Code> filled;
    for (const auto& [value, code] : table_) {
      if (present.contains(value)) {
        filled.insert(code);
      } else {
        missing.push_back(value);
      }
    }
    if (missing.empty()) return;
    const std::string absent = "label " + listed(missing) + " is absent";
    if (std::all_of(table_.begin(), table_.end(),
                    [&](const auto& entry) { return filled.contains(entry.second); })) {
      monitor.warn(absent + "; the other labels of its list are used");
      return;
    }
    constexpr std::size_t kMostListed = 40;
    std::vector<Label> found(present.begin(), present.end());
    const bool many = found.size() > kMostListed;
    if (many) found.resize(kMostListed);
    throw InvalidInput(absent + "; the file has " + listed(found) + (many ? ", ..." : ""));
  }

 private:
  void assign(const std::vector<Label>& values, Site site) {
    for (const Label value : values) {
      for (const auto& [other, code] : table_) {
        if (other == value && code != codeOf(site)) {
          throw InvalidInput("label " + std::to_string(value) +
                             " is given two roles; each label has one");
        }
      }
      table_.emplace_back(value, codeOf(site));
    }
  }

  Code rest_;
  std::vector<std::pair<Label, Code>> table_;
};

std::set<Label> labelsIn(const Volume<Label>& labels) {
  const Grid& grid = labels.grid;
  const std::size_t sliceSize = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  std::vector<std::set<Label>> bySlice(grid.size[2]);
  parallelFor(grid.size[2], 1, [&](std::size_t k) {
    const std::size_t end = (k + 1) * sliceSize;
    for (std::size_t v = k * sliceSize; v < end; v = runEnd(labels.data.data(), v, end)) {
      bySlice[k].insert(labels[v]);
    }
  });
  std::set<Label> present;
  for (const auto& slice : bySlice) present.insert(slice.begin(), slice.end());
  return present;
}

Box boxAroundTissue(const Volume<Label>& labels, const RoleTable& roles) {
  const Grid& grid = labels.grid;
  return boxAround(grid, kLabelMargin, [&](std::size_t row, int& low, int& high) {
    const Label* line = labels.data.data() + row * grid.size[0];
    const std::size_t length = grid.size[0];
    low = grid.size[0];
    for (std::size_t i = 0, end = 0; i < length; i = end) {
      end = runEnd(line, i, length);
      if (roles.roleOf(line[i]) != kTissueCode) continue;
      low = std::min(low, static_cast<int>(i));
      high = static_cast<int>(end) - 1;
    }
  });
}

/// Roles of the box's voxels; beyond the image they are insulated.
std::vector<Code> sitesIn(const Box& box, const Volume<Label>& labels, const RoleTable& roles) {
  const Grid& grid = labels.grid;
  std::vector<Code> sites(box.count(), codeOf(Site::Insulated));
  parallelFor(box.size[2], 1, [&](std::size_t kk) {
    const int k = static_cast<int>(kk);
    for (int j = 0; j < box.size[1]; ++j) {
      const int gj = j + box.first[1], gk = k + box.first[2];
      if (gj < 0 || gk < 0 || gj >= grid.size[1] || gk >= grid.size[2]) continue;
      const Label* line = labels.data.data() + grid.linear(0, gj, gk);
      Code* to = sites.data() + box.linear(0, j, k);
      const std::size_t first = std::max(box.first[0], 0);
      const std::size_t length = std::min(box.first[0] + box.size[0], grid.size[0]);
      for (std::size_t i = first, end = 0; i < length; i = end) {
        end = runEnd(line, i, length);
        std::fill(to + i - box.first[0], to + end - box.first[0], roles.roleOf(line[i]));
      }
    }
  });
  return sites;
}

/// The inner boundary of sites, or the outer one.
LabelBoundary boundaryOf(const std::vector<Code>& sites, const Box& box, bool outer, int axes) {
  std::vector<std::uint8_t> side(sites.size());
  parallelFor(side.size(), 1 << 16, [&](std::size_t p) {
    const auto site = static_cast<Site>(sites[p]);
    if (site == Site::Insulated) {
      side[p] = 255;
    } else {
      side[p] = site == Site::Inner || (outer && site == Site::Tissue) ? 1 : 0;
    }
  });
  return LabelBoundary(side, box.size, axes);
}

}  // namespace

namespace {

/// The box around the tissue and what its voxels are.
struct BoxOfSites {
  Grid grid;  ///< of the whole volume
  Box box;
  std::vector<Code> sites;
};

/// visit(place in the box, i, j, k of the grid) for each of its voxels, slices beside each other.
template <class Visit>
void forVoxels(const Box& box, const Visit& visit) {
  parallelFor(box.size[2], 1, [&](std::size_t k) {
    std::size_t p = box.linear(0, 0, static_cast<int>(k));
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i, ++p) {
        visit(p, i + box.first[0], j + box.first[1], static_cast<int>(k) + box.first[2]);
      }
    }
  });
}

BoxOfSites sitesOf(const Volume<Label>& labels, const LabelRoles& roles, const Monitor& monitor) {
  checkGrid(labels.grid);
  const RoleTable table(roles);
  table.requirePresent(labelsIn(labels), monitor);
  const Box box = boxAroundTissue(labels, table);
  return {labels.grid, box, sitesIn(box, labels, table)};
}

Annulus annulusOf(BoxOfSites found, const AnnulusOptions& options, const Monitor& monitor) {
  const auto& [grid, box, sites] = found;
  std::optional<LabelBoundary> innerBoundary, outerBoundary;
  if (options.boundary != BoundaryModel::Staircase) {
    const int axes = options.perSlice ? 2 : grid.dimension();
    parallelFor(2, 1, [&](std::size_t outer) {
      (outer == 1 ? outerBoundary : innerBoundary)
          .emplace(boundaryOf(sites, box, outer == 1, axes));
    });
  }
  const std::array<int, 3> strides = {1, box.size[0], box.size[0] * box.size[1]};
  const auto placeOnLink = [&](std::int32_t p, const std::array<int, 3>&, int d, bool inner) {
    const LabelBoundary& boundary = inner ? *innerBoundary : *outerBoundary;
    const int a = axisOf(d);
    return signOf(d) > 0 ? boundary.place(p, a) : 1 - boundary.place(p - strides[a], a);
  };
  return assemble(grid, box, std::move(found.sites), placeOnLink, options, monitor);
}

}  // namespace

Annulus annulusFromLabels(const Volume<Label>& labels, const LabelRoles& roles,
                          const AnnulusOptions& options, const Monitor& monitor) {
  return annulusOf(sitesOf(labels, roles, monitor), options, monitor);
}

Annulus annulusFromLabels(Volume<Label>&& labels, const LabelRoles& roles,
                          const AnnulusOptions& options, const Monitor& monitor) {
  BoxOfSites found = sitesOf(labels, roles, monitor);
  std::vector<Label>().swap(labels.data);
  return annulusOf(std::move(found), options, monitor);
}

namespace {

BoxOfSites boxOf(const Volume<Site>& sites, int margin) {
  checkGrid(sites.grid);
  const Grid& grid = sites.grid;
  const Box box = boxAround(grid, margin, [&](std::size_t row, int& low, int& high) {
    const Site* line = sites.data.data() + row * grid.size[0];
    low = grid.size[0];
    for (int i = 0; i < grid.size[0]; ++i) {
      if (line[i] != Site::Tissue) continue;
      low = std::min(low, i);
      high = i;
    }
  });
  if (box.count() == 0) throw InvalidInput("no tissue voxel was found");
  std::vector<Code> codes(box.count(), codeOf(Site::Insulated));
  forVoxels(box, [&](std::size_t p, int i, int j, int k) {
    if (grid.contains(i, j, k)) codes[p] = codeOf(sites(i, j, k));
  });
  return {grid, box, std::move(codes)};
}

}  // namespace

Annulus annulusFromSites(const Volume<Site>& sites, const AnnulusOptions& options,
                         const Monitor& monitor) {
  return annulusOf(boxOf(sites, kLabelMargin), options, monitor);
}

Annulus annulusFromSites(const Volume<Site>& sites, const Volume<float>& innerLevel,
                         const Volume<float>& outerLevel, const AnnulusOptions& options,
                         const Monitor& monitor) {
  if (!sameGrid(sites.grid, innerLevel.grid) || !sameGrid(sites.grid, outerLevel.grid)) {
    throw InvalidInput("the sites and the two level sets lie on different grids");
  }
  constexpr int kMargin = 2;
  auto [grid, box, codes] = boxOf(sites, kMargin);
  std::vector<float> inner(box.count(), 0), outer(box.count(), 0);
  forVoxels(box, [&](std::size_t p, int i, int j, int k) {
    // Beyond the volume its nearest voxel, so that the crossing's curvature sees no jump.
    const std::size_t v =
        grid.linear(std::clamp(i, 0, grid.size[0] - 1), std::clamp(j, 0, grid.size[1] - 1),
                    std::clamp(k, 0, grid.size[2] - 1));
    inner[p] = innerLevel[v];
    outer[p] = outerLevel[v];
  });
  const std::array<int, 3> strides = {1, box.size[0], box.size[0] * box.size[1]};
  const auto placeOnLink = [&](std::int32_t p, const std::array<int, 3>& s, int d, bool isInner) {
    const std::vector<float>& level = isInner ? inner : outer;
    const float outward = isInner ? 1.0F : -1.0F;  // makes the tissue's side positive
    const int a = axisOf(d), step = signOf(d) * strides[a];
    const double here = outward * level[p], there = outward * level[p + step];
    if (!(here > 0 && there <= 0)) return 0.5;
    const int twoOn = s[a] + 2 * signOf(d), oneBack = s[a] - signOf(d);
    const double linearBack = 2 * here - there, linearOn = 2 * there - here;
    const bool on = twoOn >= 0 && twoOn < box.size[a];
    const bool back = oneBack >= 0 && oneBack < box.size[a];
    return crossing(back ? outward * level[p - step] : linearBack, here, there,
                    on ? outward * level[p + 2 * step] : linearOn);
  };
  return assemble(grid, box, std::move(codes), placeOnLink, options, monitor);
}

Annulus annulusFromSites(const Volume<Site>& sites, const PlaceOnLink& placeOnLink,
                         const AnnulusOptions& options, const Monitor& monitor) {
  auto [grid, box, codes] = boxOf(sites, 1);
  const auto inGrid = [&, first = box.first](std::int32_t, const std::array<int, 3>& s, int d,
                                             bool inner) {
    return placeOnLink({s[0] + first[0], s[1] + first[1], s[2] + first[2]}, d, inner);
  };
  return assemble(grid, box, std::move(codes), inGrid, options, monitor);
}

Annulus annulusFromLevels(const Volume<float>& inner, const Volume<float>& outer,
                          const LevelOptions& levels, const AnnulusOptions& options,
                          const Volume<std::uint8_t>& insulated, const Monitor& monitor) {
  checkGrid(inner.grid);
  if (!sameGrid(inner.grid, outer.grid)) {
    throw InvalidInput("the inner and the outer level set lie on different grids");
  }
  const Grid& grid = inner.grid;
  const bool haveInsulated = insulated.size() > 0;
  if (haveInsulated && !sameGrid(grid, insulated.grid)) {
    throw InvalidInput("the insulated region lies on another grid than the level sets");
  }
  // Sign that makes a level set negative inside.
  const auto signOfInside = [&](const Volume<float>& volume, const char* name) {
    std::size_t above = 0, borderAbove = 0, border = 0;
    for (std::size_t v = 0; v < volume.size(); ++v) {
      if (!std::isfinite(volume[v])) {
        throw InvalidInput(std::string("the ") + name +
                           " level set holds a value that is not finite");
      }
      const bool isAbove = volume[v] > levels.level;
      above += isAbove;
      const auto s = grid.subscripts(v);
      const bool onBorder =
          s[0] == 0 || s[1] == 0 || s[0] + 1 == grid.size[0] || s[1] + 1 == grid.size[1];
      border += onBorder;
      borderAbove += onBorder && isAbove;
    }
    if (above == 0 || above == volume.size()) {
      throw InvalidInput(std::string("the ") + name + " level set is nowhere equal to " +
                         std::to_string(levels.level) + "; all its values are on one side");
    }
    if (levels.inside == LevelInside::Above) return -1.0F;
    if (levels.inside == LevelInside::Below) return 1.0F;
    return 2 * borderAbove >= border ? 1.0F : -1.0F;
  };
  const float innerSign = signOfInside(inner, "inner");
  const float outerSign = signOfInside(outer, "outer");
  Volume<float> innerLevel(grid), outerLevel(grid);
  Volume<Site> sites(grid, Site::Outer);
  parallelFor(grid.voxelCount(), 1 << 16, [&](std::size_t v) {
    innerLevel[v] = innerSign * (inner[v] - static_cast<float>(levels.level));
    outerLevel[v] = outerSign * (outer[v] - static_cast<float>(levels.level));
    if (haveInsulated && insulated[v]) {
      sites[v] = Site::Insulated;
    } else if (innerLevel[v] <= 0) {
      sites[v] = Site::Inner;
    } else if (outerLevel[v] < 0) {
      sites[v] = Site::Tissue;
    }
  });
  return annulusFromSites(sites, innerLevel, outerLevel, options, monitor);
}

Annulus withCuts(const Annulus& annulus, const std::vector<Cut>& cuts) {
  const auto strides = annulus.strides();
  std::vector<Code> sites(annulus.numberAt.size(), kTissueCode);
  parallelFor(sites.size(), 1 << 16, [&](std::size_t p) {
    switch (annulus.numberAt[p]) {
      case kInner:
        sites[p] = codeOf(Site::Inner);
        break;
      case kOuter:
        sites[p] = codeOf(Site::Outer);
        break;
      case kInsulated:
        sites[p] = codeOf(Site::Insulated);
        break;
      default:
        break;
    }
  });
  std::vector<std::uint8_t> cutBits(sites.size(), 0), innerBits(sites.size(), 0);
  // Cuts that the annulus has already.
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    const std::int32_t p = annulus.place[n];
    for (int d = 0; d < (annulus.planar ? 4 : 6); ++d) {
      const std::int32_t q = p + signOf(d) * strides[axisOf(d)], link = annulus.links[n][d];
      if (sites[q] != kTissueCode || (link != kOuter && link != kInner)) continue;
      cutBits[p] |= 1U << d;
      if (link == kInner) innerBits[p] |= 1U << d;
    }
  });
  const auto ends = [&](const Cut& cut) {
    const std::int32_t p = annulus.place[cut.number];
    return std::array<std::int32_t, 2>{p, p + strides[cut.axis]};
  };
  for (const Cut& cut : cuts) {
    const auto [p, q] = ends(cut);
    if (sites[q] != kTissueCode) continue;
    const unsigned up = 1U << (2 * cut.axis + 1), down = 1U << (2 * cut.axis);
    cutBits[p] |= up;
    cutBits[q] |= down;
    innerBits[p] = cut.inner ? innerBits[p] | up : innerBits[p] & ~up;
    innerBits[q] = cut.inner ? innerBits[q] | down : innerBits[q] & ~down;
  }
  Annulus result = annulus;
  number(result, sites, cutBits, innerBits);
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    const std::int32_t old = annulus.irregular(static_cast<std::int32_t>(n));
    if (old < 0) return;
    result.fractions[result.irregular(result.numberAt[annulus.place[n]])] = annulus.fractions[old];
  });
  for (const Cut& cut : cuts) {
    const auto [p, q] = ends(cut);
    if (sites[q] != kTissueCode) continue;
    const auto put = [&](std::int32_t voxel, int direction, double fraction) {
      result.fractions[result.irregular(result.numberAt[voxel])][direction] =
          annulus.model == BoundaryModel::Staircase
              ? 1.0F
              : static_cast<float>(std::clamp(fraction, kSmallestFraction, 1 - kSmallestFraction));
    };
    put(p, 2 * cut.axis + 1, cut.fraction);
    put(q, 2 * cut.axis, cut.rest);
  }
  return result;
}

std::string voxelText(const std::array<int, 3>& voxel) {
  std::ostringstream text;
  text << '(' << voxel[0] << ", " << voxel[1] << ", " << voxel[2] << ')';
  return text.str();
}

std::size_t countAtImageBorder(const Annulus& annulus) {
  const int axes = annulus.planar ? 2 : 3;
  const auto isAtBorder = [&](std::int32_t n) {
    const std::array<int, 3> s = annulus.boxSubscripts(n);
    for (int a = 0; a < axes; ++a) {
      const int at = s[a] + annulus.first[a], last = annulus.grid.size[a] - 1;
      if (last > 0 && (at == 0 || at == last)) return true;
    }
    return false;
  };
  return parallelSum(annulus.count(), 1 << 14, std::size_t{0},
                     [&](std::size_t begin, std::size_t end) {
                       std::size_t count = 0;
                       for (std::size_t n = begin; n < end; ++n) {
                         count += isAtBorder(static_cast<std::int32_t>(n));
                       }
                       return count;
                     });
}

VolumeOnDemand<float> spread(const Annulus& annulus, std::vector<double> values, float elsewhere,
                             std::optional<float> innerValue, std::optional<float> outerValue) {
  const auto kept = std::make_shared<const std::vector<double>>(std::move(values));
  const float inner = innerValue.value_or(elsewhere), outer = outerValue.value_or(elsewhere);
  const auto inTissue = [=](int, int) {
    return [=, of = kept->data()](std::int32_t n, int) {
      return std::isnan(of[n]) ? elsewhere : static_cast<float>(of[n]);
    };
  };
  return onGrid(annulus, outer, inTissue, [=](std::int32_t code) {
    return code == kInner ? inner : code == kOuter ? outer : elsewhere;
  });
}

VolumeOnDemand<Label> spreadLabels(const Annulus& annulus, std::vector<int> values) {
  const auto kept = std::make_shared<const std::vector<int>>(std::move(values));
  const auto inTissue = [=](int, int) {
    return [of = kept->data()](std::int32_t n, int) { return static_cast<Label>(of[n]); };
  };
  auto labels = onGrid(annulus, Label{0}, inTissue, [](std::int32_t) { return Label{0}; });
  labels.range = {0, 0};
  for (const Label value : *kept) {
    labels.range = {std::min((*labels.range)[0], value), std::max((*labels.range)[1], value)};
  }
  return labels;
}

VectorsOnDemand spreadPoints(const Annulus& annulus, std::vector<Eigen::Vector3f> offsets) {
  const auto kept = std::make_shared<const std::vector<Eigen::Vector3f>>(std::move(offsets));
  VectorsOnDemand components;
  for (int c = 0; c < 3; ++c) {
    const double origin = annulus.grid.origin[c];
    const Vector step =
        annulus.grid.direction.row(c).transpose().cwiseProduct(annulus.grid.spacing);
    const auto inTissue = [=](int j, int k) {
      const double row = origin + step[1] * j + step[2] * k;
      return [=, of = kept->data(), along = step[0]](std::int32_t n, int i) {
        const Eigen::Vector3f& offset = of[n];
        if (!std::isfinite(offset[0] + offset[1] + offset[2])) return 0.0F;
        return static_cast<float>(row + along * i + static_cast<double>(offset[c]));
      };
    };
    components[c] = onGrid(annulus, 0.0F, inTissue, [](std::int32_t) { return 0.0F; });
  }
  return components;
}

VolumeOnDemand<Label> maskOf(const Annulus& annulus, const std::vector<std::int32_t>& voxels) {
  std::vector<int> marked(annulus.count(), 0);
  for (const std::int32_t n : voxels) marked[n] = 1;
  return spreadLabels(annulus, std::move(marked));
}

Volume<std::uint8_t> maskOf(const Volume<Label>& labels, const std::vector<Label>& wanted) {
  Volume<std::uint8_t> volume(labels.grid, 0);
  parallelFor(labels.size(), 1 << 16, [&](std::size_t v) {
    volume[v] = std::find(wanted.begin(), wanted.end(), labels[v]) != wanted.end();
  });
  return volume;
}

}  // namespace explica::harmonic
