// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusAssembly.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace explica::harmonic {

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

void checkGrid(const Grid& grid) {
  for (int a = 0; a < 3; ++a) {
    if (!(grid.spacing[a] > 0) || !std::isfinite(grid.spacing[a])) {
      throw InvalidInput("the voxel size along axis " + std::to_string(a) + " is " +
                         std::to_string(grid.spacing[a]) + " mm; it must be positive");
    }
    if (grid.size[a] < 1) throw InvalidInput("the volume is empty");
  }
}

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

namespace {

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

}  // namespace

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

}  // namespace explica::harmonic
