// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Shuffler.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace explica::statistics {
namespace {

/// Random numbers by their place in a stream: SplitMix64 [Steele2014].
class Stream {
 public:
  Stream(std::uint64_t seed, std::uint64_t number) : state_(mix(seed) ^ mix(~number)) {}

  std::uint64_t next() { return mix(state_ += kGolden); }

  /// Uniform in [0, bound): draws of the incomplete last round are thrown away.
  std::uint64_t below(std::uint64_t bound) {
    const std::uint64_t rest = (0 - bound) % bound;
    std::uint64_t draw = next();
    while (draw < rest) draw = next();
    return draw % bound;
  }

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

std::vector<std::vector<std::int32_t>> members(Eigen::Index people,
                                               const std::vector<int>& blocks) {
  std::map<int, std::vector<std::int32_t>> found;
  for (std::int32_t i = 0; i < people; ++i) {
    found[blocks.empty() ? 0 : blocks[i]].push_back(i);
  }
  std::vector<std::vector<std::int32_t>> lists;
  for (auto& [block, list] : found) lists.push_back(std::move(list));
  return lists;
}

/// Permutation number `code` of n things, in the order of the factorial number system; `code` is
/// what remains for the next set.
std::vector<std::int32_t> decode(std::size_t n, std::uint64_t& code) {
  std::vector<std::int32_t> left(n), order;
  std::iota(left.begin(), left.end(), 0);
  for (std::size_t k = n; k > 0; --k) {
    const auto place = static_cast<std::ptrdiff_t>(code % k);
    code /= k;
    order.push_back(left[place]);
    left.erase(left.begin() + place);
  }
  return order;
}

std::vector<std::int32_t> shuffled(std::size_t n, Stream& stream) {
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t k = n; k > 1; --k) std::swap(order[k - 1], order[stream.below(k)]);
  return order;
}

}  // namespace

Shuffler::Shuffler(Eigen::Index people, const std::vector<int>& blocks, Exchange exchange,
                   std::int64_t count, std::uint64_t seed)
    : people_(people), signs_(exchange == Exchange::Signs), count_(count + 1), seed_(seed) {
  std::map<std::size_t, Set> wholes;  // blocks that move as they are, by size; of signs all
  for (const auto& block : members(people, blocks)) {
    if (exchange == Exchange::Whole || (signs_ && !blocks.empty())) {
      wholes[signs_ ? 0 : block.size()].push_back(block);
      continue;
    }
    Set& set = sets_.emplace_back();
    for (const std::int32_t person : block) set.push_back({person});
  }
  for (auto& [size, set] : wholes) sets_.push_back(std::move(set));
  if (possible() <= static_cast<double>(count_)) {
    exhaustive_ = true;
    count_ = std::llround(possible());
  }
}

double Shuffler::possible() const {
  double product = 1;
  for (const Set& set : sets_) {
    const auto units = static_cast<double>(set.size());
    product *= signs_ ? std::exp2(units) : std::round(std::tgamma(units + 1));
  }
  return product;
}

void Shuffler::draw(std::int64_t number, std::span<std::int32_t> order,
                    std::span<float> signs) const {
  std::iota(order.begin(), order.end(), 0);
  std::fill(signs.begin(), signs.end(), 1.0F);
  if (number == 0) return;
  auto code = static_cast<std::uint64_t>(number);
  Stream stream(seed_, code);
  for (const Set& set : sets_) {
    if (signs_) {
      for (const Unit& unit : set) {
        const bool flip = exhaustive_ ? code % 2 == 1 : stream.below(2) == 1;
        code /= 2;
        for (const std::int32_t i : unit) signs[i] = flip ? -1.0F : 1.0F;
      }
      continue;
    }
    const auto from = exhaustive_ ? decode(set.size(), code) : shuffled(set.size(), stream);
    for (std::size_t u = 0; u < set.size(); ++u) {
      const Unit& source = set[from[u]];
      for (std::size_t i = 0; i < source.size(); ++i) {
        order[set[u][i]] = source[i];
      }
    }
  }
}

Eigen::MatrixXd Shuffler::invariant() const {
  std::vector<Unit> orbits;
  if (!signs_) {
    for (const Set& set : sets_) {
      for (std::size_t i = 0; i < set.front().size(); ++i) {
        orbits.emplace_back();
        for (const Unit& unit : set) orbits.back().push_back(unit[i]);
      }
    }
  }
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(people_, static_cast<Eigen::Index>(orbits.size()));
  for (std::size_t k = 0; k < orbits.size(); ++k) {
    for (const std::int32_t i : orbits[k]) {
      basis(i, static_cast<Eigen::Index>(k)) = 1 / std::sqrt(static_cast<double>(orbits[k].size()));
    }
  }
  return basis;
}

}  // namespace explica::statistics
