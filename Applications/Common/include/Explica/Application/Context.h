// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Results.h"
#include "Explica/Core/Termination.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace explica::app {

class Command;
struct Outcome;

/// What a running command sees of the world: files to read and write, progress, and the account
/// that becomes summary.json and provenance.json.
class Context {
 public:
  /// Work in progress; ends with its scope.  Times, and takes note of how it went.
  class Step {
   public:
    Step(Context& context, std::string name);
    ~Step();
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;
    void iterations(int count);
    void termination(Termination termination);

   private:
    Context& context_;
    std::size_t entry_;
    double begin_;
  };

  /// Takes note of a file that is about to be read (hash, size, the record that made it) and gives
  /// its path back.  Files named by declared inputs are noted already: call this for others, such
  /// as those found inside a folder.
  /// @throws IOError  absent, unreadable or not a regular file
  std::filesystem::path input(const std::filesystem::path& path, std::string_view role = "file");

  /// Where to write an output; `name` is relative to --out and must match a declared output.
  /// Folders in it are made.  The file appears in --out when the command has ended well.
  [[nodiscard]] std::filesystem::path output(const std::string& name);

  /// The output directory as the user named it, for reading what an earlier run left there.
  [[nodiscard]] std::filesystem::path outputFolder() const;

  /// Begins a part of the work.  In a dry run the command ends here, so read and check all inputs
  /// before the first step.
  [[nodiscard]] Step step(std::string name);

  /// What a stage has measured, as its `describe(Results&, const Stage&)` lists it: values for
  /// summary.json, meanings for the record, judgements for verdict and exit code.  The stage is
  /// declared by `d.results<Stage>()`.
  template <class Stage>
  void results(const Stage& stage) {
    Results listed;
    describe(listed, stage);
    results(listed);
  }
  void results(const Results& listed);

  /// A number or text for summary.json that no stage describes; NaN becomes null.  A key that
  /// starts with "seconds" is a time.
  template <class T>
  void result(const std::string& key, const T& value) {
    using Number = std::conditional_t<std::is_same_v<T, bool>, bool, std::int64_t>;
    if constexpr (std::is_integral_v<T>) {
      result(key, Result::Value(static_cast<Number>(value)));
    } else {
      result(key, Result::Value(value));
    }
  }
  void result(const std::string& key, const Result::Value& value);
  /// Any JSON (include <nlohmann/json.hpp>).
  void result(const std::string& key, const nlohmann::ordered_json& value);

  /// Something about how an input was understood, for the record: the affine used, its codes, ...
  void note(const std::string& key, const nlohmann::ordered_json& value);

  /// Says that this command's numbers are compared with limits: summary.json gets `plausible` and
  /// `flags`.
  void judged();
  /// A number outside of its limits: {name, value, low, high, accepted, message}.  One that is not
  /// accepted is a warning and makes the exit code 3.  One that a step has found names it as
  /// `step`.
  void flag(const nlohmann::ordered_json& flag);

  /// Something that is cut, guessed or contradicted (provenance::kDoubts): adds to the number under
  /// that key of summary.json, which is there from the first call on, and warns if `count` is not 0
  /// and there is a sentence.
  void doubt(const char* key, std::size_t count, const std::string& sentence = {});

  /// Progress, warnings and stop requests, to hand to long work.
  [[nodiscard]] const Monitor& monitor() const;

  /// A line for the user (hidden by --quiet), a detail (shown by --verbose), a warning (recorded).
  void info(const std::string& message);
  void detail(const std::string& message);
  void warn(const std::string& message);

  /// True if the user set this option, on the command line or in the configuration file.
  [[nodiscard]] bool given(std::string_view name) const;
  [[nodiscard]] int threads() const;
  /// True if --private was given: hosts, users and folders shall not be told.
  [[nodiscard]] bool isPrivate() const;

  /// Runs another command as a step, into the folder `name` of this command's output, with the
  /// given option values (JSON as in --config).  Only for commands declared inPlace().
  Outcome runCommand(const Command& command, const std::string& name,
                     const nlohmann::ordered_json& options);

  /// Runs another command into a folder of its own, which has its own lock, summary and record: for
  /// commands that write nothing themselves and may run beside each other.
  Outcome runApart(const Command& command, const std::filesystem::path& out,
                   const nlohmann::ordered_json& options);

  /// The outcome of a step that an earlier run left in the folder `name`, if doing it again could
  /// only give the same: same version and commit, same options, same bytes of every input and
  /// output, and it ended by itself, not by a signal or clock.  Its record then counts as this
  /// run's.
  std::optional<Outcome> reuseCommand(const Command& command, const std::string& name,
                                      const nlohmann::ordered_json& options);

  /// Takes back what a step, of this run or an earlier one, left in the folder `name`: the outputs
  /// that its record lists.
  void dropCommand(const std::string& name);

  /// Runs another command into this command's --out.  Only for commands declared writesThrough().
  Outcome runThrough(const Command& command, const nlohmann::ordered_json& options);

  struct State;
  explicit Context(State& state) : state_(&state) {}

 private:
  friend class Part;
  State* state_;
};

}  // namespace explica::app
