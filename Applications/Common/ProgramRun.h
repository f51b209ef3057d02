#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/Progress.h"
#include "Common/ReportOutput.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/Files/AtomicOutput.h"

namespace adaptiso {

/// The files that a run reads and writes, checked before it reads any of them.
class OutputPlan {
public:
    /// \param inputs  empty paths are ignored
    explicit OutputPlan(std::span<const std::filesystem::path> inputs);

    /// Adds the file that `option` names. \param ownFolder  as AtomicOutput takes it
    /// \throws UsageError  another output has the same name
    /// \throws FileError   a link lies below `ownFolder`
    void add(const std::string& option, const std::filesystem::path& file,
             const std::filesystem::path& ownFolder = {});

    /// Checks a folder that will be replaced whole. \throws FileError  it is or holds an input
    void checkFolder(const std::filesystem::path& folder) const;

    /// Adds the outputs of --json, --report and --pictures, then checks every file.
    /// \throws UsageError, FileError  an output would overwrite an input or cannot be written
    void check(const CommonOptions& common, const ReportOptions& report);

private:
    std::vector<std::filesystem::path> inputs_, outputs_;
};

/// One run of a program, which the programs' own runs derive from: progress, times, warnings,
/// outputs and verdict.
///
/// Outputs are written under temporary names; deliver() renames them all.
class ProgramRun {
public:
    /// \param program      "adaptiso-mesh"
    /// \param consequence  of --strict when there are warnings: "so no surface was written"; may
    ///                     be empty
    ProgramRun(std::string program, const CommonOptions& common, const ReportOptions& report,
               std::string consequence);

    ProgressLine progress;
    StageTimer timer;
    std::vector<Warning> warnings;  ///< each names its file
    Verdict verdict;                ///< final once deliver() makes the reports
    std::string next;  ///< command or viewer to go on with, for the last line of text; may be empty

    /// Runs `work` as a stage: shown as progress, timed under its name. Returns its result.
    template <class Work>
    decltype(auto) stage(std::string_view name, Work&& work) {
        progress.show(name);
        return timer.time(name, std::forward<Work>(work));
    }

    /// Prints the warnings added since the last call, unless --no-warnings.
    void printNewWarnings();

    /// --strict turns the warnings into a failure.
    bool failsStrict() const { return adaptiso::failsStrict(common_, warnings); }

    /// A file in its temporary place; valid until the next call.
    /// \param ownFolder  as AtomicOutput takes it
    AtomicOutput& addOutput(const std::filesystem::path& file,
                            const std::filesystem::path& ownFolder = {});
    /// Removes every output added so far.
    void dropOutputs() { outputs_.clear(); }

    /// Writes the page and the pictures if asked for (stage "report"). A failure becomes part of
    /// the verdict. \return the pictures
    std::vector<Picture> writePage(const std::function<Report()>& make);

    /// The report of --json: `own` between the keys that all programs share.
    std::string json(const std::string& schema, const Json& own) const;

    /// Adds --strict and a failed page to the verdict. An error of the run itself stays first.
    void settleVerdict();

    /// Settles the verdict, prints warnings and results, then renames all outputs, and `folder`
    /// with them, or none. A last line of text names what was written and what to do next.
    /// \param makeJson   called for --json
    /// \param printText  called unless --quiet or --json -
    /// \throws FileError
    void deliver(const std::function<std::string()>& makeJson,
                 const std::function<void(std::ostream&)>& printText,
                 AtomicFolder* folder = nullptr);

    /// Prints the verdict. \param written  "brain.ply is written" \return the exit code
    int end(const std::string& written) const { return printVerdict(program_, verdict, written); }

private:
    void printEnd(std::ostream& out, const AtomicFolder* folder) const;

    const std::string program_;
    const CommonOptions& common_;
    const ReportOptions& report_;
    const std::string consequence_;
    const ThreadLimit threads_;
    std::size_t printed_ = 0;  ///< of the warnings
    std::string pageFailure_;
    std::unique_ptr<PictureFolder> pictures_;  ///< outlives the outputs in it
    std::vector<AtomicOutput> outputs_;
};

}  // namespace adaptiso
