#include "Common/ProgramRun.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <system_error>

#include "Common/Log.h"
#include "Common/Naming.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace fs = std::filesystem;
namespace {

fs::path wholePath(const fs::path& path) {
    std::error_code error;
    fs::path whole = fs::weakly_canonical(fs::absolute(path, error), error);
    return whole.has_filename() ? whole : whole.parent_path();
}

bool hasJsonFile(const CommonOptions& common) {
    return common.wantsJson() && !common.wantsJsonOnStdout();
}

}  // namespace

OutputPlan::OutputPlan(std::span<const fs::path> inputs) {
    std::copy_if(inputs.begin(), inputs.end(), std::back_inserter(inputs_),
                 [](const fs::path& input) { return !input.empty(); });
}

void OutputPlan::add(const std::string& option, const fs::path& file, const fs::path& ownFolder) {
    if (!ownFolder.empty()) checkOutput(file, ownFolder);
    const auto isSame = [&](const fs::path& other) { return wholePath(other) == wholePath(file); };
    if (std::ranges::any_of(outputs_, isSame)) {
        throw UsageError(option + " " + file.string() + ": is the name of another output too");
    }
    outputs_.push_back(file);
}

void OutputPlan::checkFolder(const fs::path& folder) const {
    const fs::path whole = wholePath(folder);
    for (const fs::path& input : inputs_) {
        if (wholePath(input) == whole || wholePath(input).parent_path() == whole) {
            throw FileError(folder.string() + ": holds an input, which is never overwritten");
        }
    }
}

void OutputPlan::check(const CommonOptions& common, const ReportOptions& report) {
    if (hasJsonFile(common)) add("--json", common.json);
    if (isLogOpen()) add("--log", logFile());
    if (!report.page.empty()) add("--report", report.page);
    checkReportOutputs(report, inputs_);
    for (const fs::path& output : outputs_) {
        for (const fs::path& input : inputs_) checkNotInput(output, input);
        checkOutput(output);
    }
    if (hasJsonFile(common)) requireKind("--json", common.json, TextKind::Report);
    if (!report.page.empty()) requireKind("--report", report.page, TextKind::Page);
}

ProgramRun::ProgramRun(std::string program, const CommonOptions& common,
                       const ReportOptions& report, std::string consequence)
    : progress(common.isQuiet),
      program_(std::move(program)),
      common_(common),
      report_(report),
      consequence_(std::move(consequence)),
      threads_(common) {}

void ProgramRun::printNewWarnings() {
    progress.clear();
    printWarnings(program_, common_, std::span(warnings).subspan(printed_));
    printed_ = warnings.size();
}

AtomicOutput& ProgramRun::addOutput(const fs::path& file, const fs::path& ownFolder) {
    return outputs_.emplace_back(file, ownFolder);
}

std::vector<Picture> ProgramRun::writePage(const std::function<Report()>& make) {
    const auto makeWhole = [&] {
        Report report = make();
        report.warnings = linesOf(warnings);
        addStrictVerdict(report, common_, warnings, consequence_);
        return report;
    };
    ReportResult page =
        stage("report", [&] { return writeReport(makeWhole, program_, report_, outputs_); });
    pictures_ = std::move(page.folder);
    pageFailure_ = page.failure;
    return std::move(page.pictures);
}

std::string ProgramRun::json(const std::string& schema, const Json& own) const {
    Json report = reportHead(schema, program_, verdict, warnings);
    report.update(own);
    report["options"]["picture"] = pictureJson(report_.view);
    report["failedByWarnings"] = failsStrict();
    report["reportFailure"] = reportFailureJson(verdict.reportFailure);
    report["seconds"] = secondsJson(timer);
    report["peakMemoryMb"] = peakMemoryMb();
    return jsonText(report) + "\n";
}

void ProgramRun::settleVerdict() {
    if (verdict.error.empty()) verdict.failStrict(common_, warnings, consequence_);
    verdict.failReport(pageFailure_);
}

/// "Wrote brain.ply, page.html; next: adaptiso-check brain.ply"
void ProgramRun::printEnd(std::ostream& out, const AtomicFolder* folder) const {
    std::vector<std::string> written, toDo;
    if (folder != nullptr) written.push_back(folder->target().string() + "/");
    bool hasPage = false;
    for (const AtomicOutput& output : outputs_) {
        const fs::path& target = output.target();
        const bool isPicture =
            !report_.pictures.empty() && target.parent_path() == report_.pictures;
        const std::string name = isPicture ? report_.pictures.string() + "/" : target.string();
        if (written.empty() || written.back() != name) written.push_back(name);
        hasPage = hasPage || target == report_.page;
    }
    if (!next.empty()) toDo.push_back(next);
    if (hasPage) toDo.push_back("open " + shellQuoted(report_.page.string()) + " in a browser");
    if (written.empty() && toDo.empty()) return;
    constexpr std::size_t kMostNames = 4;
    const std::size_t more = written.size() > kMostNames ? written.size() - kMostNames : 0;
    written.resize(written.size() - more);
    std::string line = written.empty() ? "" : "Wrote " + joined(written, ", ");
    if (more > 0) line += " and " + std::to_string(more) + " more";
    if (!toDo.empty()) line += (line.empty() ? "Next: " : "; next: ") + joined(toDo, "; ");
    out << oneLine(line) << std::endl;
}

void ProgramRun::deliver(const std::function<std::string()>& makeJson,
                         const std::function<void(std::ostream&)>& printText,
                         AtomicFolder* folder) {
    settleVerdict();
    const std::string json = common_.wantsJson() ? makeJson() : "";
    if (hasJsonFile(common_)) addOutput(common_.json).writeText(json);
    printNewWarnings();
    printResults(common_, json, printText);
    if (folder != nullptr) {
        folder->commit(outputs_);
    } else {
        AtomicOutput::commit(outputs_);
    }
    if (!common_.wantsJsonOnStdout() && !common_.isQuiet) printEnd(std::cout, folder);
}

}  // namespace adaptiso
