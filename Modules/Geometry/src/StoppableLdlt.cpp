// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/StoppableLdlt.h"

#include "Explica/Core/StopScope.h"

#include <vector>

namespace explica::geometry {
namespace {

constexpr int kRows = 64;  // between two checkpoints: the last of 164,000 take 2 ms each

}  // namespace

void StoppableLdlt::compute(const Eigen::SparseMatrix<double>& matrix) {
  analyzePattern(matrix);
  Eigen::SparseMatrix<double> upper(matrix.rows(), matrix.cols());
  upper.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
  m_info = factoriseRows(upper) ? Eigen::Success : Eigen::NumericalIssue;
  m_factorizationIsOk = true;
}

/// Up-looking [Davis2005]: row k of L solves L(0:k, 0:k) D y = upper(0:k, k); which of its entries
/// are not zero are the paths in the elimination tree from those of the matrix's column to k.
bool StoppableLdlt::factoriseRows(const Eigen::SparseMatrix<double>& upper) {
  const int size = static_cast<int>(upper.rows());
  const int* const begin = m_matrix.outerIndexPtr();
  int* const rows = m_matrix.innerIndexPtr();
  double* const values = m_matrix.valuePtr();
  m_diag.resize(size);
  m_nonZerosPerCol.setZero(size);
  std::vector<double> y(size, 0.0);
  std::vector<int> seen(size, -1), pattern(size), path(size);
  for (int k = 0; k < size; ++k) {
    if (k % kRows == 0) checkpoint();
    int first = size;  // pattern[first ...] are the columns of row k, each before its ancestors
    double pivot = 0;
    seen[k] = k;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(upper, k); entry; ++entry) {
      int i = static_cast<int>(entry.index());
      if (i == k) pivot += entry.value();
      if (i >= k) continue;
      y[i] += entry.value();
      int length = 0;
      for (; seen[i] != k; i = m_parent[i]) {
        path[length++] = i;
        seen[i] = k;
      }
      while (length > 0) pattern[--first] = path[--length];
    }
    for (; first < size; ++first) {
      const int i = pattern[first];
      const double yi = y[i], factor = yi / m_diag[i];
      y[i] = 0;
      const int end = begin[i] + m_nonZerosPerCol[i]++;
      for (int p = begin[i]; p < end; ++p) y[rows[p]] -= values[p] * yi;
      pivot -= factor * yi;
      rows[end] = k;
      values[end] = factor;
    }
    m_diag[k] = pivot;
    if (pivot == 0) return false;
  }
  return true;
}

}  // namespace explica::geometry
