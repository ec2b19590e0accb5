// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Exit codes that scripts rely on.
enum ExitCode { kDone = 0, kUsage = 1, kBadInput = 2, kStoppedEarly = 3, kEnvironment = 4 };

/// What every command offers, whatever it does.
struct CommonOptions {
  std::optional<std::string> out;
  bool force = false;
  std::optional<std::string> config;
  std::optional<int> threads;
  std::optional<double> maxTime;
  std::optional<int> maxMemory;
  std::vector<std::string> accept;
  bool dryRun = false;
  bool quiet = false;
  bool verbose = false;
  std::optional<std::string> log;
  bool privateRecord = false;
  bool report = false;
};

template <class Visitor>
void describe(CommonOptions& o, Visitor&& visit) {
  visit(Field{"out", "", "folder for the results; made if absent, refused if not empty"}, o.out);
  visit(Field{"force", "", "write into a folder that is not empty, replacing earlier results"},
        o.force);
  visit(Field{"config", "", "JSON file with option values; the command line wins"}, o.config);
  visit(Field{"threads", "", "processors to use (default: all that this process may)", 1, 4096},
        o.threads);
  visit(Field{"max-time", "s", "ask for an end after this time, with what was reached", kAboveZero,
              1e9},
        o.maxTime);
  visit(Field{"max-memory", "MB", "memory at most", 64, 1 << 30}, o.maxMemory);
  visit(Field{"accept", "",
              "go on although files contradict each other: hemisphere (left and right together), "
              "mesh (data of another surface)"},
        o.accept);
  visit(Field{"dry-run", "", "resolve and check everything, print the options, write nothing"},
        o.dryRun);
  visit(Field{"quiet", "", "say nothing but warnings and errors"}, o.quiet);
  visit(Field{"verbose", "", "say more"}, o.verbose);
  visit(Field{"log", "", "file to which every message goes, with times"}, o.log);
  visit(Field{"private", "", "leave host, user and absolute paths out of the record"},
        o.privateRecord);
  visit(Field{"report", "", "write report.html, a page on the results, too"}, o.report);
}

/// How a command ended.
struct Outcome {
  int exitCode = kDone;
  Termination termination = Termination::NotRun;
  bool abandoned = false;         ///< asked to end while there was nothing worth writing
  bool plausible = true;          ///< false if a number lies outside of its limits
  std::vector<std::string> head;  ///< its first results, in words
  std::filesystem::path record;   ///< its provenance.json; empty if it writes none
};

/// The number of threads and what decided it: --threads, EXPLICA_NTHREADS, SLURM_CPUS_PER_TASK,
/// NSLOTS, PBS_NCPUS, OMP_NUM_THREADS, ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS, affinity; the first
/// that is set wins.
/// @throws UsageError  a setting that is not a positive whole number
struct ThreadChoice {
  int count = 0;
  std::string because;
};
[[nodiscard]] ThreadChoice chooseThreads(std::optional<int> requested);

/// Does all of a program's work: finds the command, parses, runs, reports errors on standard error.
/// @return the exit code
int runMain(int argc, char** argv);

}  // namespace explica::app
