// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Annulus.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace explica::harmonic {
namespace {

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
