// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DoSteps.h"

#include "Explica/Application/Command.h"
#include "Explica/Application/CortexTemplate.h"
#include "Explica/Application/Execute.h"
#include "Explica/Application/ManyRuns.h"
#include "Explica/Application/Part.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Provenance/Record.h"
#include "StepValues.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>

namespace explica::app {
namespace {

using report::StepState;

class Steps {
 public:
  Steps(Context& context, const RunSettings& s, const std::vector<pipeline::PlannedStep>& plan)
      : context_(context),
        s_(s),
        plan_(plan),
        state_(context.output(pipeline::kRunStateName)),
        ends_(plan.size(), Termination::NotRun),
        failures_(plan.size()) {
    for (const auto& step : plan)
      notes_.push_back({step.name, step.command, StepState::Missing, ""});
  }

  StepsDone run() {
    doInOrder(context_, "");
    doSides();
    StepsDone done;
    for (std::size_t n = 0; n < plan_.size(); ++n) {
      if (!reachedGoal(ends_[n])) done.worst = ends_[n];
      if (failures_[n] && !done.failure) done.failure = failures_[n];
    }
    if (ended_) {
      if (!s_.resume)
        std::ranges::for_each(plan_, [&](const auto& step) { context_.dropCommand(step.name); });
      std::rethrow_exception(done.failure);
    }
    pipeline::writeRunState(state_, notes_);
    done.notes = std::move(notes_);
    return done;
  }

 private:
  /// The steps whose names end so after the command's.
  void doInOrder(Context& context, const std::string& ending) {
    for (std::size_t n = 0; n < plan_.size(); ++n) {
      if (plan_[n].name == plan_[n].command + ending && !ended_) doStep(context, n);
    }
  }

  void doSides() {
    const std::array<const char*, 2> endings = {"-L", "-R"};
    const bool both = std::ranges::all_of(endings, [&](const char* ending) {
      return std::ranges::any_of(plan_,
                                 [&](const auto& step) { return step.name.ends_with(ending); });
    });
    if (!both) return;
    makeTemplate();
    std::vector<Part> sides;
    for (std::size_t side = 0; side < endings.size(); ++side) {
      sides.emplace_back(context_, [this] { return ended_.load(); });
    }
    const auto doSide = [&](std::size_t side) {
      const StopScope kept(nullptr);  // what is reached is written
      doInOrder(sides[side].context(), endings[side]);
    };
    if (context_.given("max-memory")) {
      for (std::size_t side = 0; side < endings.size(); ++side) doSide(side);
    } else {
      parallelTasks(endings.size(), doSide);
    }
    for (Part& side : sides) side.join();
  }

  /// Before both sides ask for it.
  void makeTemplate() {
    const auto user = std::ranges::find(plan_, "register", &pipeline::PlannedStep::command);
    if (user == plan_.end()) return;
    try {
      static_cast<void>(
          findTemplate(context_, user->values->at("template").get<std::string>(), "CortexLeft"));
    } catch (const Error&) {        // NOLINT(bugprone-empty-catch): the step that needs it says so
    } catch (const Interrupted&) {  // NOLINT(bugprone-empty-catch): so do the steps left out
    }
  }

  void doStep(Context& context, std::size_t n) {
    const pipeline::PlannedStep& step = plan_[n];
    if (const std::string* missing = missingNeed(step)) {
      setNote(n, StepState::Missing, "needs " + *missing);
      return;
    }
    if (context.monitor().shouldStop()) {
      setNote(n, StepState::Interrupted, "the run was stopped before it");
      ends_[n] = Termination::Interrupted;
      return;
    }
    try {
      const Outcome outcome = outcomeOf(context, step);
      const bool done = outcome.exitCode == kDone || reachedGoal(outcome.termination);
      ends_[n] = outcome.termination;
      setNote(n, done                             ? StepState::Done
                 : context.monitor().shouldStop() ? StepState::Interrupted
                                                  : StepState::StoppedEarly);
    } catch (const Error& fault) {
      fail(context, n, fault);
    } catch (...) {
      failures_[n] = std::current_exception();
      ended_ = true;
    }
  }

  [[nodiscard]] Outcome outcomeOf(Context& context, const pipeline::PlannedStep& step) const {
    const Command* command = findCommand(step.command);
    if (command == nullptr)
      throw EnvironmentError("explica " + step.command + " is not part of this build");
    const provenance::Json values = stepValues(context, s_, step);
    std::optional<Outcome> outcome;
    if (s_.resume) outcome = context.reuseCommand(*command, step.name, values);
    if (outcome) {
      context.info(step.name + ": kept, nothing that it depends on has changed");
    } else {
      outcome = context.runCommand(*command, step.name, values);
    }
    if (outcome->abandoned) context.dropCommand(step.name);  // what an earlier run left
    if (!outcome->plausible) passFlagsOn(context, "step", context.outputFolder() / step.name);
    return *outcome;
  }

  void fail(Context& context, std::size_t n, const Error& fault) {
    // An earlier run's results of this step are of other inputs or options.
    context.dropCommand(plan_[n].name);
    failures_[n] = std::current_exception();
    if (!s_.resume) {  // a run that cannot be resumed leaves nothing
      ended_ = true;
      return;
    }
    // What does not depend on it goes on; the report says what failed, and so does the end.
    setNote(n, StepState::Failed,
            context.isPrivate() ? provenance::textWithoutFolders(fault.what()) : fault.what());
    context.warn(plan_[n].name + ": " + fault.what());
  }

  /// The first step that this one needs and that has no outputs.
  [[nodiscard]] const std::string* missingNeed(const pipeline::PlannedStep& step) const {
    for (const std::string& need : step.needs) {
      for (const auto& [name, command, state, message] : notes_) {
        if (name == need && state != StepState::Done && state != StepState::StoppedEarly)
          return &need;
      }
    }
    return nullptr;
  }

  void setNote(std::size_t n, StepState state, const std::string& message = {}) {
    const std::lock_guard<std::mutex> lock(mutex_);
    notes_[n].state = state;
    notes_[n].message = message;
    if (s_.resume) pipeline::writeRunState(state_, notes_);
  }

  Context& context_;
  const RunSettings& s_;
  const std::vector<pipeline::PlannedStep>& plan_;
  std::filesystem::path state_;
  std::vector<pipeline::StepNote> notes_;
  std::vector<Termination> ends_;
  std::vector<std::exception_ptr> failures_;
  std::mutex mutex_;
  std::atomic<bool> ended_ = false;  ///< by a failure
};

}  // namespace

StepsDone doSteps(Context& context, const RunSettings& s,
                  const std::vector<pipeline::PlannedStep>& plan) {
  return Steps(context, s, plan).run();
}

}  // namespace explica::app
