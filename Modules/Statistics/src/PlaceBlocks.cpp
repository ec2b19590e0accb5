// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/PlaceBlocks.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::statistics {
namespace {

constexpr std::size_t kPeopleAtOnce = 64;  // between words of progress

}  // namespace

Eigen::Index PlaceBlocks::atOnce() const {
  const auto column = sizeof(double) * static_cast<std::size_t>(std::max<Eigen::Index>(people, 1));
  return std::clamp<Eigen::Index>(static_cast<Eigen::Index>(bytes / column), 1,
                                  std::max<Eigen::Index>(places, 1));
}

void forEachBlock(const PlaceBlocks& blocks, const PersonReader& reader,
                  const std::function<void(Eigen::Index, Eigen::MatrixXd&)>& body,
                  const Monitor& monitor) {
  const auto people = static_cast<std::size_t>(blocks.people);
  for (Eigen::Index first = 0; first < blocks.places; first += blocks.atOnce()) {
    Eigen::MatrixXd values(blocks.people, std::min(blocks.atOnce(), blocks.places - first));
    for (std::size_t begin = 0; begin < people; begin += kPeopleAtOnce) {
      monitor.progress(
          (static_cast<double>(first) + static_cast<double>(begin) / static_cast<double>(people) *
                                            static_cast<double>(values.cols())) /
              static_cast<double>(blocks.places),
          "reading people");
      parallelFor(std::min(kPeopleAtOnce, people - begin), 1, [&](std::size_t k) {
        Eigen::VectorXd all(blocks.places);
        reader(begin + k, {all.data(), static_cast<std::size_t>(all.size())});
        values.row(begin + k) = all.segment(first, values.cols()).transpose();
      });
    }
    body(first, values);
  }
}

}  // namespace explica::statistics
