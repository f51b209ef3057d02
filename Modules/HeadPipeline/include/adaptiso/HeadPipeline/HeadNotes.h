#pragma once

#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/HeadModel/Plausibility.h"
#include "adaptiso/Json/Json.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// A plausibility note, formatted for output. It never fails a run.
struct ReportedNote {
    HeadNote note;        ///< places in LPS mm
    std::string subject;  ///< "inner_skull", "inner_skull in outer_skull"
    /// Frame of the reported places; empty if the file does not say it.
    std::optional<CoordinateFrame> frame = CoordinateFrame::Ras;
    std::vector<Vec3> placesMm{};
    bool isWarned = false;  ///< a warning of the run holds the finding
};

/// How many are noted.
std::int64_t notedCount(std::span<const ReportedNote> notes);

/// " at 1.0, 2.0, 3.0" of the first place, or nothing.
std::string placeText(const ReportedNote& note);

/// Lines of all notes, in the columns of the checks.
void printNotes(std::ostream& out, std::span<const ReportedNote> notes);

/// List of {name, of, outcome, finding, pointsIn, pointsMm}.
Json notesJson(std::span<const ReportedNote> notes);

/// Adds the notes to a page's checks, and the places of those that are noted to its spots. A
/// finding that a warning of the run holds is not repeated.
void addNotes(std::span<const ReportedNote> notes, Report& report);

}  // namespace adaptiso
