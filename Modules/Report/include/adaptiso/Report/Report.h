#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// An RGB colour.
using ReportColor = std::array<std::uint8_t, 3>;

/// The colour map viridis, dark violet at 0 to yellow at 1: ten samples of matplotlib's table,
/// linear in between. Values beyond 0 and 1 get the end's colour, NaN that of 0.
ReportColor viridis(double part);

/// The colour of surface number `n` in pictures and in the viewer: distinct with any colour
/// vision [Okabe2008], light enough for a black ground. The seventh is the first again.
ReportColor surfaceColor(std::size_t n);

/// Verdict at the top of a report.
enum class ReportVerdict {
    Passed,     ///< all that was required holds
    Failed,     ///< something that was required does not
    Done,       ///< nothing was to be judged
    Unfinished  ///< some of what was to be done is not done yet
};

enum class ReportOutcome {
    Passed,
    Failed,    ///< and it was required
    Noted,     ///< failed, but it was not required
    Undecided  ///< the question makes no sense here
};

/// A line of "what was read", "how": a name and its value.
using ReportFact = std::pair<std::string, std::string>;

struct ReportCheck {
    std::string subject;  ///< "inner_skull.stl"
    std::string name;     ///< "no self-intersection"
    ReportOutcome outcome = ReportOutcome::Passed;
    std::string finding;  ///< may be empty
};

struct ReportTable {
    std::string title;
    std::vector<std::string> columns;  ///< the first names the row
    std::vector<std::vector<std::string>> rows;
};

/// A place to look at.
struct ReportSpot {
    std::string what;       ///< "hole of 12 edges in outer_skull.stl"
    Vec3 pointMm;           ///< LPS
    bool isFailure = true;  ///< else worth a look, like the smallest gap of a sound model
    int rank = 0;           ///< 0: the worst of its kind; the first to be shown
};

struct ReportSurface {
    std::string name;
    TriangleMesh mesh;  ///< LPS mm; may be broken in any way
    /// A length for every vertex, to be shown in colour; empty: none.
    /// All surfaces share one scale.
    std::vector<double> valuesMm{};
    /// Closed and around the brain alone: neither it nor what it holds shows a face.
    bool isWithinSkull = false;
    std::optional<ReportColor> color{};  ///< default: surfaceColor() of its number
    /// Made by pointMarks(). Marks are the last surfaces, and are drawn with the one before them.
    bool areMarks = false;
};

/// A small octahedron at every point.
TriangleMesh pointMarks(const std::vector<Vec3>& points, double radiusMm);

/// The image that the surfaces belong to. The samples must live as long as the report.
struct ReportVolume {
    std::string name;  ///< the file's, without folder
    VolumeView view;
};

/// How often an image's values occur, in bins of equal width.
struct ReportHistogram {
    double lower = 0, upper = 0;
    std::vector<std::int64_t> counts;
    std::vector<double> marks;  ///< drawn in the colours of the surfaces of the same numbers
};

/// Report::frame of points whose file says none: sides are shown as in RAS, and said to be.
inline constexpr const char* kUnsaidFrame = "the file's own frame, which it does not say";

/// Content of a page. Texts are plain (they are escaped where needed) and hold
/// neither folders nor anything that names a patient: that is for the caller to see to.
struct Report {
    std::string program, version;
    std::string date;   ///< reportDate()
    std::string title;  ///< "Check of 3 surfaces"
    ReportVerdict verdict = ReportVerdict::Done;
    std::string headline;                  ///< "2 of 21 checks that are required failed"
    std::string frame = "scanner RAS mm";  ///< of the points: LPS with x and y turned round
    std::vector<ReportFact> inputs, options;
    std::vector<ReportCheck> checks;
    std::vector<ReportSpot> spots;
    std::vector<ReportTable> tables;
    std::vector<std::string> warnings;  ///< shown beside the verdict, whatever it is
    std::vector<std::string> notes;     ///< other remarks, and what is not shown: at the end
    std::vector<ReportSurface> surfaces;
    std::string valuesAre;  ///< their values, behind "mm": "from the other surface"
    /// The surfaces are the regions of one map: they touch, none holds another, and there may be
    /// hundreds. They are drawn together, opaque, and the viewer has a list of them to click.
    bool areRegions = false;
    std::optional<ReportVolume> volume;
    std::optional<ReportHistogram> histogram{};  ///< \pre lower < upper, with bins
    /// Neither page nor pictures show the image and the surfaces where the face may lie: below a
    /// plane that begins 45 mm below the top of an adult's head at the forehead, half way to the
    /// brows, and falls backwards by 42 degrees. Where the top of a head is not found they show
    /// neither at all.
    bool leavesOutFaces = false;
};

/// The options of rows that have a label, without those that are off, 0 or not given.
template <class Owner>
void addOptions(const Options<Owner>& rows, const std::type_identity_t<Owner>& owner,
                std::vector<ReportFact>& facts) {
    for (const Option<Owner>& row : rows) {
        const OptionValue value = row.valueOf(owner);
        const bool isOff =
            value == OptionValue{} || value == OptionValue{false} || value == OptionValue{0.0};
        if (row.facts.label.empty() || isOff) continue;
        facts.emplace_back(row.facts.label, valueText(value, row.facts.rule));
    }
}

/// Now, in UTC: "2026-11-21 09:20 UTC"; the time of SOURCE_DATE_EPOCH, where it is set.
std::string reportDate();

/// Size, voxel and format of an image, in words.
std::vector<ReportFact> imageFacts(const std::string& name, const std::string& format,
                                   const ImageGeometry& geometry);

}  // namespace adaptiso
