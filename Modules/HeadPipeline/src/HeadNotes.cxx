#include "adaptiso/HeadPipeline/HeadNotes.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

std::int64_t notedCount(std::span<const ToldNote> notes) {
    return std::count_if(notes.begin(), notes.end(),
                         [](const ToldNote& told) { return told.note.isNoted; });
}

std::string placeText(const ToldNote& told) {
    if (told.placesMm.empty()) return "";
    const Vec3& p = told.placesMm.front();
    std::string text =
        "; at " + formatFixed(p.x, 1) + ", " + formatFixed(p.y, 1) + ", " + formatFixed(p.z, 1);
    const auto more = std::ssize(told.placesMm) - 1;
    return more > 0 ? text + " and " + formatCount(more) + " more" : text;
}

void printNotes(std::ostream& out, std::span<const ToldNote> notes) {
    for (const ToldNote& told : notes) {
        const HeadNote& note = told.note;
        out << "  " << std::left << std::setw(26) << note.name << std::setw(8)
            << (note.isNoted ? "noted" : "ok") << told.subject;
        if (!note.finding.empty()) out << ": " << note.finding;
        out << placeText(told) << '\n';
    }
}

Json notesJson(std::span<const ToldNote> notes) {
    Json list = Json::array();
    for (const ToldNote& told : notes) {
        Json points = Json::array();
        for (const Vec3& point : told.placesMm) points.push_back(vector(point));
        list.push_back({{"name", told.note.key},
                        {"of", told.subject},
                        {"outcome", told.note.isNoted ? "noted" : "passed"},
                        {"finding", told.note.finding},
                        {"pointsIn", told.frame ? Json(frameWord(*told.frame)) : Json(nullptr)},
                        {"pointsMm", points}});
    }
    return list;
}

void addNotes(std::span<const ToldNote> notes, Report& report) {
    for (const ToldNote& told : notes) {
        const HeadNote& note = told.note;
        report.checks.push_back({told.subject, std::string(note.name),
                                 note.isNoted ? ReportOutcome::Noted : ReportOutcome::Passed,
                                 told.isWarned ? "see the warning" : note.finding});
        if (!note.isNoted) continue;
        const auto places = std::ssize(note.pointsMm);
        for (std::int64_t n = 0; n < places; ++n) {
            std::string what = told.subject + ": " + std::string(note.name) + ", noted";
            if (places > 1) what += " (" + formatCount(n + 1) + " of " + formatCount(places) + ")";
            report.spots.push_back({what, note.pointsMm[n], false, static_cast<int>(n)});
        }
    }
}

}  // namespace adaptiso
