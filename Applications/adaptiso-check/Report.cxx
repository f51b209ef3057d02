#include <algorithm>
#include <iomanip>
#include <limits>
#include <ostream>
#include <string>
#include <string_view>

#include "Common/CommonFrame.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "Common/ReportOutput.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Run.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfaceChecks/CheckJson.h"
#include "adaptiso/SurfacePipeline/SurfaceJson.h"

namespace adaptiso::checker {
namespace {

/// Why a file can't be read, without the folders of its name.
std::string errorText(const SurfaceRun& surface) {
    const std::string path = surface.file.string();
    const bool namesIt = surface.error.starts_with(path);
    return namesIt ? baseName(surface.file) + surface.error.substr(path.size()) : surface.error;
}

Json surfaceJson(const SurfaceRun& surface) {
    if (!surface.error.empty()) {
        return {{"file", baseName(surface.file)}, {"error", errorText(surface)}, {"passed", false}};
    }
    Json json{{"file", baseName(surface.file)}, {"error", nullptr}};
    json.update(verdictJson(surface.checks));
    json["format"] = surface.format->name;
    json["coordinates"] = frameJson(surface.frame);
    json["pointsIn"] = frameJson(surface.points);
    json.update(factsJson(surface.facts));
    json["isosurface"] = surface.deviation ? deviationJson(*surface.deviation, {}) : Json();
    return json;
}

Json nestingJson(const CheckRun& run) {
    if (!run.options.isNested) return nullptr;
    Json pairs = Json::array();
    for (const NestingRun& pair : run.nesting) {
        Json json{{"inner", baseName(run.surfaces[pair.inner].file)},
                  {"outer", baseName(run.surfaces[pair.outer].file)}};
        json.update(nestingJson(pair.report, pair.checks, run.toNestingFrame));
        pairs.push_back(json);
    }
    return {{"pointsIn", frameJson(run.nestingFrame)}, {"pairs", pairs}};
}

Json volumeJson(const CheckRun& run) {
    if (!run.volume) return nullptr;
    return {
        {"file", baseName(run.options.volume)},
        {"format", run.volume->format},
        {"sizeVoxels", run.volume->geometry.size},
        {"spacingMm", vector(run.volume->geometry.spacingMm())},
        {"preprocessing", preprocessingJson(run.options.preprocessing, run.volume->geometry.size)}};
}

Json optionsJson(const CheckOptions& options) {
    Json json{{"inputCoordinates", inputCoordinatesJson(options.inputCoordinates)},
              {"nested", options.isNested},
              {"iso", orNull(options.isovalue)}};
    json.update(valuesJson(ruleOptions(), options.inUse()));
    json.update(valuesJson(pairOptions(), options));
    json["threads"] = orNull(options.common.threads);
    json["strict"] = options.common.isStrict;
    return json;
}

std::string_view word(const Check& check) {
    return check.outcome == Outcome::Passed      ? "ok"
           : check.outcome == Outcome::Undecided ? "-"
           : check.isRequired                    ? "FAILED"
                                                 : "noted";
}

bool isForPrinter(const CheckRun& run) {
    return run.options.profile == Profile::Print;
}

/// The checks of a surface without those of solvers, where a print is asked for.
std::vector<Check> shownChecks(const SurfaceRun& surface, const CheckRun& run) {
    std::vector<Check> shown = surface.checks;
    std::erase_if(shown, [&](const Check& check) {
        return isForPrinter(run) && !check.isRequired &&
               (check.key == "solidAngle" || check.key == "minAngle");
    });
    return shown;
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

void printSpread(std::ostream& out, std::string_view name, const Spread& spread, int digits) {
    out << "  " << std::left << std::setw(24) << name << formatLength(spread.minimum, digits)
        << " / " << formatLength(spread.median, digits) << " / "
        << formatLength(spread.maximum, digits) << '\n';
}

void printFacts(std::ostream& out, const SurfaceFacts& facts, bool isForPrinter) {
    const auto genus = facts.topology.genus();
    out << "  area " << formatMeasure(facts.areaMm2) << " mm2";
    if (facts.volumeMm3) out << ", volume " << formatMeasure(*facts.volumeMm3) << " mm3";
    out << ", " << counted(std::ssize(facts.topology.components), "component");
    if (genus) out << ", genus " << *genus;
    out << '\n';
    if (facts.shape.triangles == 0 || isForPrinter) return;
    out << "  of triangles            smallest / median / largest\n";
    printSpread(out, "smallest angle, degrees", facts.shape.angleDeg, 2);
    printSpread(out, "aspect ratio", facts.shape.aspectRatio, 2);
    printSpread(out, "edge, mm", facts.shape.edgeMm, 3);
}

/// "144 x 180.2 x 152.1 mm, 1 shell, 2 handles, thinnest wall 0.42 mm"
std::string printText(const SurfaceFacts& facts) {
    std::string text = formatSizeMm(facts.size.extentMm) + ", " +
                       counted(std::ssize(facts.topology.components), "shell");
    if (const auto genus = facts.topology.genus()) text += ", " + counted(*genus, "handle");
    if (!facts.walls || !facts.walls->hasWall()) return text;
    return text + ", thinnest wall " + wallText(*facts.walls);
}

void printSurface(std::ostream& out, const SurfaceRun& surface, const CheckRun& run) {
    out << oneLine(surface.file.string()) << ": ";
    if (!surface.error.empty()) {
        out << "NOT READ\n";
        return;
    }
    out << surface.format->name << ", " << frameText(surface.frame) << ", "
        << formatCount(surface.facts.topology.triangles) << " triangles, "
        << formatCount(surface.facts.topology.vertices) << " vertices\n";
    printChecks(out, shownChecks(surface, run));
    printFacts(out, surface.facts, isForPrinter(run));
    if (run.options.measuresWalls) out << "  to print: " << printText(surface.facts) << '\n';
    printVerdict(out, surface.checks, run);
}

ReportOutcome outcomeOf(const Check& check) {
    return check.outcome == Outcome::Passed      ? ReportOutcome::Passed
           : check.outcome == Outcome::Undecided ? ReportOutcome::Undecided
           : check.isRequired                    ? ReportOutcome::Failed
                                                 : ReportOutcome::Noted;
}

void addChecks(const std::string& subject, const std::vector<Check>& checks, Report& report) {
    for (const Check& check : checks) {
        report.checks.push_back(
            {subject, std::string(check.name), outcomeOf(check), check.finding});
    }
}

std::string nameOf(const CheckRun& run, std::size_t number) {
    return baseName(run.surfaces[number].file);
}

std::string pairName(const CheckRun& run, const NestingRun& pair) {
    return nameOf(run, pair.inner) + " in " + nameOf(run, pair.outer);
}

void addVerdict(const CheckRun& run, Report& report) {
    const auto unreadable =
        std::count_if(run.surfaces.begin(), run.surfaces.end(),
                      [](const SurfaceRun& surface) { return !surface.error.empty(); });
    const auto failures = std::count_if(
        report.checks.begin(), report.checks.end(),
        [](const ReportCheck& check) { return check.outcome == ReportOutcome::Failed; });
    const std::string profile(toString(run.options.profileInUse()));
    const std::size_t count = run.surfaces.size();
    report.title = count == 1 ? "Check of " + nameOf(run, 0)
                              : "Check of " + std::to_string(count) +
                                    (run.options.isNested ? " nested surfaces" : " surfaces");
    report.verdict = run.hasPassed() ? ReportVerdict::Passed : ReportVerdict::Failed;
    if (run.hasPassed()) {
        report.headline = "Everything that the profile \"" + profile + "\" requires holds.";
        const std::int64_t notes = notedCount(run.notes);
        if (notes > 0) {
            report.headline += " " + formatCount(notes) +
                               (notes == 1 ? " thing is" : " things are") +
                               " unusual of a head model: worth a look.";
        }
        return;
    }
    if (failures > 0) {
        report.headline =
            counted(failures, "check") + " that the profile \"" + profile + "\" requires failed.";
    }
    if (unreadable > 0) {
        report.headline += std::string(report.headline.empty() ? "" : " ") +
                           formatCount(unreadable) + " of " +
                           formatCount(std::ssize(run.surfaces)) +
                           (count == 1 ? " file" : " files") + " could not be read.";
    }
}

void addInputs(const CheckRun& run, Report& report) {
    for (const SurfaceRun& surface : run.surfaces) {
        // the message begins with the whole path
        const std::string path = surface.file.string();
        report.inputs.push_back(
            {"Surface", surface.error.empty()
                            ? fileText(surface.file, *surface.format, surface.frame)
                            : baseName(surface.file) + ": " +
                                  (surface.error.starts_with(path + ": ")
                                       ? surface.error.substr(path.size() + 2)
                                       : std::string("could not be read"))});
    }
    if (!run.volume) return;
    const std::vector<ReportFact> facts =
        imageFacts(baseName(run.options.volume), run.volume->format, run.volume->geometry);
    report.inputs.insert(report.inputs.end(), facts.begin(), facts.end());
}

void addRules(const CheckRun& run, Report& report) {
    const CheckOptions& options = run.options;
    report.options = {{"Nested", options.isNested ? "yes, from inside to outside" : "no"}};
    CheckRules rules = options.inUse();
    if (!options.isNested) rules.minGapMm.reset();
    addOptions(ruleOptions(), rules, report.options);
    if (options.isovalue) report.options.push_back({"Isovalue", formatNumber(*options.isovalue)});
}

ReportTable surfaceTable(const CheckRun& run) {
    ReportTable table{"Surfaces",
                      {"Surface", "Triangles", "Vertices", "Pieces", "Genus", "Area, mm²",
                       "Volume, mm³", "Smallest angle", "Median edge, mm"},
                      {}};
    if (run.options.measuresWalls) table.columns.push_back("To print");
    for (const SurfaceRun& surface : run.surfaces) {
        if (!surface.error.empty()) continue;
        const SurfaceFacts& facts = surface.facts;
        const auto genus = facts.topology.genus();
        table.rows.push_back({baseName(surface.file), formatCount(facts.topology.triangles),
                              formatCount(facts.topology.vertices),
                              formatCount(std::ssize(facts.topology.components)),
                              genus ? formatCount(*genus) : "–", formatMeasure(facts.areaMm2),
                              facts.volumeMm3 ? formatMeasure(*facts.volumeMm3) : "–",
                              formatFixed(facts.shape.angleDeg.minimum, 2) + "°",
                              formatLength(facts.shape.edgeMm.median, 2)});
        if (run.options.measuresWalls) table.rows.back().push_back(printText(facts));
    }
    return table;
}

ReportTable nestingTable(const CheckRun& run) {
    ReportTable table{"How they lie in each other",
                      {"Surfaces", "Relation", "Smallest gap, mm", "Crossing pairs"},
                      {}};
    for (const NestingRun& pair : run.nesting) {
        const bool hasGap = pair.report.gap.triangleA >= 0;
        table.rows.push_back({pairName(run, pair), std::string(toString(pair.report.relation)),
                              hasGap ? formatLength(pair.report.gap.nearest.distanceMm, 3) : "–",
                              formatCount(pair.report.crossingPairs)});
    }
    return table;
}

const TriangleMesh* meshOf(const ShownSurfaces& shown, std::size_t number) {
    for (const ShownSurfaces::Shown& surface : shown.surfaces) {
        if (surface.number == number) return &surface.mesh;
    }
    return nullptr;
}

constexpr std::size_t kMostMembers = 1000;

const Check* failed(const std::vector<Check>& checks, std::string_view key) {
    const auto found = std::find_if(checks.begin(), checks.end(),
                                    [&](const Check& check) { return check.key == key; });
    return found != checks.end() && found->hasFailed() ? &*found : nullptr;
}

/// The spots of one surface.
class SurfaceSpots {
public:
    SurfaceSpots(const SurfaceRun& surface, const TriangleMesh& mesh)
        : surface_(surface), mesh_(mesh), in_(" in " + baseName(surface.file)) {}

    std::vector<ReportSpot> find() && {
        addCrossings();
        addHoles();
        addExamples("manifoldEdges", TopologyDefect::NonManifoldEdge,
                    "edge in more than two triangles");
        addExamples("manifoldVertices", TopologyDefect::NonManifoldVertex,
                    "vertex whose triangles are not one fan");
        addExamples("consistentOrientation", TopologyDefect::InconsistentEdge, "flipped triangle");
        addExamples("noDegenerateTriangles", TopologyDefect::DegenerateTriangle,
                    "triangle without area");
        addExamples("noUnusedVertices", TopologyDefect::UnusedVertex, "vertex that nothing uses");
        addDuplicates();
        addComponents();
        addSliver();
        addThinWall();
        addDeviation();
        return std::move(spots_);
    }

private:
    void addCrossings() {
        const Check* check = failed(surface_.checks, "noSelfIntersections");
        if (!check) return;
        SpotClusters clusters(mesh_);
        const auto& pairs = surface_.facts.intersections.pairs;
        for (std::size_t n = 0; n < std::min(pairs.size(), kMostMembers); ++n) {
            clusters.add(middleOf(mesh_, pairs[n][0]));
        }
        clusters.tell("crossing triangles" + in_, check->isRequired, spots_);
    }

    void addHoles() {
        const Check* check = failed(surface_.checks, "closed");
        if (!check || surface_.facts.isSoup()) return;
        const std::vector<Hole> holes = findHoles(mesh_);
        for (std::size_t n = 0; n < std::min(holes.size(), kMostSpotsOfAKind); ++n) {
            spots_.push_back({"hole of " + formatCount(holes[n].edges) + " edges, " +
                                  formatLength(holes[n].lengthMm, 1) + " mm round," + in_,
                              holes[n].middleMm, check->isRequired, static_cast<int>(n)});
        }
    }

    void addExamples(std::string_view key, TopologyDefect defect, const std::string& what) {
        const Check* check = failed(surface_.checks, key);
        if (!check) return;
        SpotClusters clusters(mesh_);
        for (const TopologyExample& example : surface_.facts.topology.examples) {
            if (example.defect == defect) clusters.add(placeOf(example));
        }
        clusters.tell(what + in_, check->isRequired, spots_);
    }

    Vec3 placeOf(const TopologyExample& example) const {
        Vec3 sum;
        int found = 0;
        for (const VertexId v : example.vertices) {
            if (v < 0 || v >= std::ssize(mesh_.points)) continue;
            sum += mesh_.points[v];
            ++found;
        }
        return found > 0 ? 1.0 / found * sum : Vec3{std::numeric_limits<double>::quiet_NaN(), 0, 0};
    }

    void addDuplicates() {
        if (const Check* check = failed(surface_.checks, "noDuplicateTriangles")) {
            SpotClusters clusters(mesh_);
            for (const std::int64_t t : surface_.facts.duplicates.triangles) {
                clusters.add(middleOf(mesh_, t));
            }
            clusters.tell("triangle that is there twice" + in_, check->isRequired, spots_);
        }
        const Check* check = failed(surface_.checks, "noDuplicateVertices");
        if (!check || surface_.facts.isSoup()) return;
        SpotClusters clusters(mesh_);
        for (const VertexId v : surface_.facts.duplicates.vertices) clusters.add(mesh_.points[v]);
        clusters.tell("vertex that is there twice" + in_, check->isRequired, spots_);
    }

    /// Loose pieces, which are all but the largest one, or one for each of the file's solids; and
    /// those that are the wrong way round.
    void addComponents() {
        std::vector<SurfaceComponent> pieces = surface_.facts.topology.components;
        const Check* outward = failed(surface_.checks, "outward");
        if (outward && surface_.facts.insideOut) {
            const std::vector<std::int64_t>& wrong = *surface_.facts.insideOut;
            for (std::size_t n = 0; n < std::min(wrong.size(), kMostSpotsOfAKind); ++n) {
                const SurfaceComponent& piece = pieces[static_cast<std::size_t>(wrong[n])];
                spots_.push_back({"piece of " + formatCount(piece.triangles) +
                                      " triangles that is inside out" + in_,
                                  mesh_.points[piece.firstVertex], outward->isRequired,
                                  static_cast<int>(n)});
            }
        }
        const Check* check = failed(surface_.checks, "oneComponent");
        if (!check || surface_.facts.isSoup()) return;
        std::stable_sort(pieces.begin(), pieces.end(),
                         [](const auto& a, const auto& b) { return a.triangles > b.triangles; });
        const std::size_t solids = surface_.facts.solids;
        const std::size_t end = std::min(pieces.size(), solids - 1 + kMostSpotsOfAKind);
        for (std::size_t n = solids; n < end; ++n) {
            spots_.push_back(
                {"loose piece of " + formatCount(pieces[n].triangles) + " triangles" + in_,
                 mesh_.points[pieces[n].firstVertex], check->isRequired,
                 static_cast<int>(n - solids)});
        }
    }

    void addSliver() {
        const Check* check = failed(surface_.checks, "minAngle");
        if (!check) return;
        const Spread& angles = surface_.facts.shape.angleDeg;
        spots_.push_back({"smallest angle, " + formatFixed(angles.minimum, 2) + " degrees," + in_,
                          middleOf(mesh_, angles.triangleOfMinimum), check->isRequired});
    }

    /// Also where it is thick enough: it is what a print breaks at.
    void addThinWall() {
        const std::optional<WallReport>& walls = surface_.facts.walls;
        if (!walls || !walls->hasWall()) return;
        const Check* check = failed(surface_.checks, "minWall");
        spots_.push_back({"thinnest wall, " + wallText(*walls) + "," + in_,
                          wallPoint(*walls, mesh_), check && check->isRequired});
    }

    void addDeviation() {
        if (!surface_.deviation) return;
        const Check* check = failed(surface_.checks, "onIsosurface");
        const Vec3& ras = surface_.deviation->maxPointMm;
        spots_.push_back({"farthest from the isosurface, " +
                              formatLength(surface_.deviation->maxMm, 2) + " mm," + in_,
                          {-ras.x, -ras.y, ras.z},
                          check && check->isRequired});
    }

    const SurfaceRun& surface_;
    const TriangleMesh& mesh_;
    std::string in_;
    std::vector<ReportSpot> spots_;
};

/// Where the checks that failed say to look: holes, crossings, slivers and others. Defects near
/// each other are one spot; of many, the first. \param mesh  of the surface, LPS mm
std::vector<ReportSpot> spotsOf(const SurfaceRun& surface, const TriangleMesh& mesh) {
    return SurfaceSpots(surface, mesh).find();
}

/// The spots of two nested surfaces; the smallest gap is always listed.
std::vector<ReportSpot> spotsOf(const NestingRun& pair, const std::string& innerName,
                                const std::string& outerName, const TriangleMesh& inner,
                                const TriangleMesh& outer) {
    std::vector<ReportSpot> spots;
    const NestingReport& report = pair.report;
    const std::string names = innerName + " and " + outerName;
    NearestPoints nearest;
    if (report.gap.triangleA >= 0) {
        nearest = triangleDistance(cornersOf(inner, report.gap.triangleA),
                                   cornersOf(outer, report.gap.triangleB));
    }
    if (const Check* check = failed(pair.checks, "noCrossing")) {
        SpotClusters clusters(inner);
        for (std::size_t n = 0; n < std::min(report.pairs.size(), kMostMembers); ++n) {
            const bool isNearest = n == 0 && report.gap.triangleA >= 0;
            clusters.add(isNearest ? nearest.pointA : middleOf(inner, report.pairs[n][0]));
        }
        clusters.tell(
            names + (report.relation == NestingRelation::Identical ? " are the same surface"
                                                                   : " cross"),
            check->isRequired, spots);
    }
    if (const Check* check = failed(pair.checks, "strictlyNested");
        check && report.firstNotInside >= 0) {
        spots.push_back({innerName + " is not inside " + outerName,
                         inner.points[report.firstNotInside], check->isRequired});
    }
    if (report.gap.triangleA < 0 || report.crossingPairs > 0) return spots;
    const Check* check = failed(pair.checks, "minGap");
    spots.push_back(
        {"smallest gap, " + formatLength(nearest.distanceMm, 2) + " mm, between " + names,
         nearest.pointA, check && check->isRequired});
    return spots;
}

void addSpots(const CheckRun& run, const ShownSurfaces& shown, Report& report) {
    const auto add = [&](const std::vector<ReportSpot>& spots) {
        report.spots.insert(report.spots.end(), spots.begin(), spots.end());
    };
    for (const NestingRun& pair : run.nesting) {
        const TriangleMesh *inner = meshOf(shown, pair.inner), *outer = meshOf(shown, pair.outer);
        if (!inner || !outer) continue;
        add(spotsOf(pair, nameOf(run, pair.inner), nameOf(run, pair.outer), *inner, *outer));
    }
    for (const ShownSurfaces::Shown& surface : shown.surfaces) {
        add(spotsOf(run.surfaces[surface.number], surface.mesh));
    }
    // what fails first, and of that one of every kind
    std::stable_sort(report.spots.begin(), report.spots.end(),
                     [](const ReportSpot& a, const ReportSpot& b) {
                         return std::pair(!a.isFailure, a.rank) < std::pair(!b.isFailure, b.rank);
                     });
}

/// "ball.stl: closed, manifoldEdges; inner.stl in outer.stl: noCrossing"; one surface is not named.
std::string saysText(const CheckRun& run) {
    std::string text;
    const auto add = [&](const std::string& subject, const std::vector<Check>& checks) {
        std::string failed;
        for (const Check& check : checks) {
            if (check.breaksProfile()) addPart(failed, check.key);
        }
        if (!failed.empty()) addPart(text, (subject.empty() ? "" : subject + ": ") + failed, "; ");
    };
    for (const SurfaceRun& surface : run.surfaces) {
        const std::string name = run.surfaces.size() == 1 ? "" : baseName(surface.file);
        add(name, surface.checks);
        if (!surface.error.empty())
            addPart(text, (name.empty() ? "" : name + ": ") + "not read", "; ");
    }
    for (const NestingRun& pair : run.nesting) add(pairName(run, pair), pair.checks);
    return text.empty() ? "all that is required holds" : text;
}

}  // namespace

std::string jsonReport(const CheckRun& run) {
    Json surfaces = Json::array();
    for (const SurfaceRun& surface : run.surfaces) surfaces.push_back(surfaceJson(surface));
    return run.json("adaptiso-check/1", {{"options", optionsJson(run.options)},
                                         {"volume", volumeJson(run)},
                                         {"surfaces", surfaces},
                                         {"nesting", nestingJson(run)},
                                         {"plausibility", notesJson(run.notes)},
                                         {"result", resultJson(saysText(run))}});
}

void printReport(std::ostream& out, const CheckRun& run) {
    for (const SurfaceRun& surface : run.surfaces) printSurface(out, surface, run);
    for (const NestingRun& pair : run.nesting) {
        out << oneLine(run.surfaces[pair.inner].file.string()) << " in "
            << oneLine(run.surfaces[pair.outer].file.string()) << " ("
            << frameText(run.nestingFrame) << ")\n";
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

Report makeReport(const CheckRun& run, ShownSurfaces& shown) {
    Report report;
    for (const NestingRun& pair : run.nesting) addChecks(pairName(run, pair), pair.checks, report);
    for (const SurfaceRun& surface : run.surfaces) {
        addChecks(baseName(surface.file), shownChecks(surface, run), report);
    }
    addNotes(run.notes, report);
    addVerdict(run, report);
    addInputs(run, report);
    addRules(run, report);
    report.tables.push_back(surfaceTable(run));
    if (!run.nesting.empty()) report.tables.push_back(nestingTable(run));
    addSpots(run, shown, report);
    report.warnings = linesOf(run.warnings);
    for (const SurfaceRun& surface : run.surfaces) {
        if (!surface.points || surface.points == CoordinateFrame::Ras) continue;
        report.notes.push_back(
            "Points in the table of checks are as the files have them, those of " +
            baseName(surface.file) + " in " + std::string(toString(*surface.points)) + ".");
    }
    for (const std::string& note : shown.notes) {
        if (std::find(report.warnings.begin(), report.warnings.end(), note) ==
            report.warnings.end()) {
            report.notes.push_back(note);
        }
    }
    if (shown.frame == CoordinateFrame::TkRas) report.frame = "FreeSurfer's tkRAS mm";
    if (!shown.frame) report.frame = kUnsaidFrame;
    for (ShownSurfaces::Shown& surface : shown.surfaces) {
        report.surfaces.push_back({nameOf(run, surface.number), std::move(surface.mesh), {}});
    }
    if (shown.image) {
        report.volume = ReportVolume{baseName(run.options.volume), shown.image->volume.view()};
    }
    return report;
}

}  // namespace adaptiso::checker
