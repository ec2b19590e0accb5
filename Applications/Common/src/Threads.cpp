// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"

#include <sched.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace explica::app {
namespace {

int positiveNumber(std::string_view text, const std::string& source) {
  int value = 0;
  // OMP_NUM_THREADS may be a list, one number per nesting level: the first counts.
  const std::string_view first = text.substr(0, text.find(','));
  const auto end = std::from_chars(first.data(), first.data() + first.size(), value);
  if (end.ec != std::errc() || end.ptr != first.data() + first.size() || value < 1) {
    throw UsageError(source + ": '" + std::string(text) + "' is not a positive whole number");
  }
  return value;
}

}  // namespace

ThreadChoice chooseThreads(std::optional<int> requested) {
  if (requested) return {positiveNumber(std::to_string(*requested), "threads"), "--threads"};
  for (const char* name : {"EXPLICA_NTHREADS", "SLURM_CPUS_PER_TASK", "NSLOTS", "PBS_NCPUS",
                           "OMP_NUM_THREADS", "ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS"}) {
    const char* text = std::getenv(name);
    if (text && *text) return {positiveNumber(text, name), name};
  }
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return {CPU_COUNT(&allowed), "affinity"};
  return {1, "default"};
}

}  // namespace explica::app
