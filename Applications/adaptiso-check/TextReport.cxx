#include "TextReport.h"

#include <algorithm>
#include <iomanip>
#include <ostream>
#include <string>
#include <string_view>

#include "Common/Numbers.h"

namespace adaptiso {
namespace {

std::string_view word(const Check& check) {
    switch (check.outcome) {
        case Outcome::Passed:
            return "ok";
        case Outcome::Failed:
            return check.isRequired ? "FAILED" : "noted";
        case Outcome::Undecided:
            return "-";
    }
    return "";
}

void printChecks(std::ostream& out, const std::vector<Check>& checks) {
    for (const Check& check : checks) {
        out << "  " << std::left << std::setw(24) << check.name;
        if (check.finding.empty()) {
            out << word(check) << '\n';
        } else {
            out << std::setw(8) << word(check) << check.finding << '\n';
        }
    }
}

void printVerdict(std::ostream& out, const std::vector<Check>& checks, const CheckRun& run) {
    const auto failed = std::count_if(checks.begin(), checks.end(),
                                      [](const Check& check) { return check.breaksProfile(); });
    out << "  => " << (failed == 0 ? "passed" : "FAILED") << " as "
        << toString(run.options.profileInUse());
    if (failed > 0) {
        std::string_view separator = ": ";
        for (const Check& check : checks) {
            if (!check.breaksProfile()) continue;
            out << separator << check.name;
            separator = ", ";
        }
    }
    out << '\n';
}

std::string frameText(const std::optional<CoordinateFrame>& frame) {
    return frame ? std::string(toString(*frame)) : "frame not said";
}

void printSpread(std::ostream& out, std::string_view name, const Spread& spread, int digits) {
    out << "  " << std::left << std::setw(24) << name << formatLength(spread.minimum, digits)
        << " / " << formatLength(spread.median, digits) << " / "
        << formatLength(spread.maximum, digits) << '\n';
}

void printFacts(std::ostream& out, const SurfaceFacts& facts) {
    const auto genus = facts.topology.genus();
    out << "  area " << formatMeasure(facts.areaMm2) << " mm2";
    if (facts.volumeMm3) out << ", volume " << formatMeasure(*facts.volumeMm3) << " mm3";
    out << ", " << formatCount(std::ssize(facts.topology.components)) << " component"
        << (facts.topology.components.size() == 1 ? "" : "s");
    if (genus) out << ", genus " << *genus;
    out << '\n';
    if (facts.shape.triangles == 0) return;
    out << "  of triangles            smallest / median / largest\n";
    printSpread(out, "smallest angle, degrees", facts.shape.minAngleDeg, 2);
    printSpread(out, "aspect ratio", facts.shape.aspectRatio, 2);
    printSpread(out, "edge, mm", facts.shape.edgeMm, 3);
}

void printSurface(std::ostream& out, const SurfaceRun& surface, const CheckRun& run) {
    out << surface.file.string() << ": ";
    if (!surface.error.empty()) {
        out << "NOT READ\n";
        return;
    }
    out << surface.format->name << ", " << frameText(surface.frame) << ", "
        << formatCount(surface.facts.topology.triangles) << " triangles, "
        << formatCount(surface.facts.topology.vertices) << " vertices\n";
    printChecks(out, surface.checks);
    printFacts(out, surface.facts);
    printVerdict(out, surface.checks, run);
}

}  // namespace

void printReport(std::ostream& out, const CheckRun& run) {
    for (const SurfaceRun& surface : run.surfaces) printSurface(out, surface, run);
    for (const NestingRun& pair : run.nesting) {
        out << run.surfaces[pair.inner].file.string() << " in "
            << run.surfaces[pair.outer].file.string() << " (" << frameText(run.nestingFrame)
            << ")\n";
        printChecks(out, pair.checks);
        printVerdict(out, pair.checks, run);
    }
    if (!run.notes.empty()) {
        out << "plausibility (" << frameText(run.notes.front().frame)
            << "; what is unusual of adults' heads is noted, and may be right)\n";
        printNotes(out, run.notes);
    }
    printTimes(out, run.timer);
}

}  // namespace adaptiso
