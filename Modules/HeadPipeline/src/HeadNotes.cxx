#include "adaptiso/HeadPipeline/HeadNotes.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

std::int64_t notedCount(std::span<const ReportedNote> notes) {
    return std::count_if(notes.begin(), notes.end(),
                         [](const ReportedNote& reported) { return reported.note.isNoted; });
}

std::string placeText(const ReportedNote& reported) {
    if (reported.placesMm.empty()) return "";
    const Vec3& p = reported.placesMm.front();
    std::string text =
        "; at " + formatFixed(p.x, 1) + ", " + formatFixed(p.y, 1) + ", " + formatFixed(p.z, 1);
    const auto more = std::ssize(reported.placesMm) - 1;
    return more > 0 ? text + " and " + formatCount(more) + " more" : text;
}

void printNotes(std::ostream& out, std::span<const ReportedNote> notes) {
    for (const ReportedNote& reported : notes) {
        const HeadNote& note = reported.note;
        out << "  " << std::left << std::setw(26) << note.name << std::setw(8)
            << (note.isNoted ? "noted" : "ok") << reported.subject;
        if (!note.finding.empty()) out << ": " << note.finding;
        out << placeText(reported) << '\n';
    }
}

Json notesJson(std::span<const ReportedNote> notes) {
    Json list = Json::array();
    for (const ReportedNote& reported : notes) {
        Json points = Json::array();
        for (const Vec3& point : reported.placesMm) points.push_back(vector(point));
        list.push_back(
            {{"name", reported.note.key},
             {"of", reported.subject},
             {"outcome", reported.note.isNoted ? "noted" : "passed"},
             {"finding", reported.note.finding},
             {"pointsIn", reported.frame ? Json(frameWord(*reported.frame)) : Json(nullptr)},
             {"pointsMm", points}});
    }
    return list;
}

void addNotes(std::span<const ReportedNote> notes, Report& report) {
    for (const ReportedNote& reported : notes) {
        const HeadNote& note = reported.note;
        report.checks.push_back({reported.subject, std::string(note.name),
                                 note.isNoted ? ReportOutcome::Noted : ReportOutcome::Passed,
                                 reported.isWarned ? "see the warning" : note.finding});
        if (!note.isNoted) continue;
        const auto places = std::ssize(note.pointsMm);
        for (std::int64_t n = 0; n < places; ++n) {
            std::string what = reported.subject + ": " + std::string(note.name) + ", noted";
            if (places > 1) what += " (" + formatCount(n + 1) + " of " + formatCount(places) + ")";
            report.spots.push_back({what, note.pointsMm[n], false, static_cast<int>(n)});
        }
    }
}

}  // namespace adaptiso
