#include "Pipeline.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <span>
#include <string_view>
#include <utility>

#include "Common/Batch.h"
#include "Common/CommonFrame.h"
#include "Common/ImageOptions.h"
#include "Common/Json.h"
#include "Common/Naming.h"
#include "Common/PreprocessingOptions.h"
#include "Common/RunApp.h"
#include "Common/Warnings.h"
#include "Run.h"
#include "SelfTest.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/PortableMath.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso::checker {
namespace {

namespace fs = std::filesystem;

void checkOutputs(const CheckOptions& options) {
    std::vector<fs::path> inputs = options.files;
    inputs.push_back(options.volume);
    OutputPlan(inputs).check(options.common, options.report);
}

/// The isosurface of a volume, to hold others against.
struct Isosurface {
    double isovalue = 0;
    double voxelMm = 0;  ///< the side of a cube as large as a voxel
    TriangleMesh mesh;   ///< by marching cubes, closed at the volume's border; LPS mm
};

/// \throws InvalidInput  the volume has no surface at `isovalue`
Isosurface extractIsosurface(const VolumeView& volume, double isovalue) {
    Isosurface isosurface;
    isosurface.isovalue = isovalue;
    isosurface.voxelMm = portable::cubeRoot(volume.geometry().voxelVolumeMm3());
    ExtractionOptions extract;
    extract.isovalue = isovalue;
    extract.method = Method::MarchingCubes;
    extract.computeNormals = false;
    isosurface.mesh = extractSurface(volume, SpanSpaceIndex::build(volume, {}), extract).mesh;
    if (!(surfaceArea(isosurface.mesh) > 0)) {
        const ValueRange range = valueRange(volume);
        throw InvalidInput("there is no surface; the range is " + formatShort(range.minimum) +
                           " to " + formatShort(range.maximum));
    }
    return isosurface;
}

/// How far the surface lies from the isosurface: points spread over its area, and its vertices.
/// \param mesh  LPS mm; triangles with a corner that is not finite are left out
/// \return empty when nothing with area is left
std::optional<DistanceStatistics> isosurfaceDeviation(const TriangleMesh& mesh,
                                                      const Isosurface& isosurface) {
    TriangleMesh finite;
    finite.points = mesh.points;
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(finite.triangles),
                 [&](const Triangle& t) {
                     return std::all_of(t.begin(), t.end(), [&](VertexId v) {
                         return std::isfinite(squaredNorm(mesh.points[v]));
                     });
                 });
    if (!(surfaceArea(finite) > 0)) return std::nullopt;
    return surfaceDistance(finite, isosurface.mesh, {.isSymmetric = false}).aToB;
}

/// Fills a run.
class Checker {
public:
    explicit Checker(CheckRun& run) : options_(run.options), run_(run) {}

    void check() {
        readImage();
        for (const fs::path& file : options_.files) {
            checkFile(file);
            // surfaces that lie in each other are needed together, others one at a time
            if (options_.isNested) continue;
            assessPlausibility();
            measureDeviations();
            keepForReport();
            meshes_.clear();
        }
        if (options_.isNested) {
            checkNested();
            assessPlausibility();
            measureDeviations();
            keepForReport();
        }
    }

    /// Surfaces for the report, filled by check(); empty unless a report is wanted.
    ShownSurfaces& shown() { return shown_; }

private:
    struct Loaded {
        std::size_t number;  ///< of the file
        NamedMesh mesh;
    };

    void readImage() {
        if (options_.volume.empty()) return;
        std::optional<ReadVolume> read;
        run_.stage("read", [&] { read = adaptiso::readImage(options_.volume, options_.read); });
        image_ = read->volume.view().geometry();
        run_.volume = VolumeSummary{read->format, *image_};
        if (options_.report.isWanted()) shown_.image = *read;
        warnOfVolume(read->warnings);
        if (!options_.isovalue) return;
        run_.stage("extract", [&] {
            const Preprocessed prepared =
                preprocessImage(std::move(read->volume), options_.preprocessing, options_.volume);
            warnOfVolume(prepared.warnings);
            isosurface_ =
                naming("--iso " + formatNumber(*options_.isovalue) + ": " + volumeName(),
                       [&] { return extractIsosurface(prepared.volume, *options_.isovalue); });
        });
    }

    void warnOfVolume(const std::vector<Warning>& warnings) {
        addWarnings(run_.warnings, warnings, volumeName());
    }

    std::string volumeName() const { return baseName(options_.volume); }

    /// Reads one file and asks the questions of one surface. Points stay as stored, so that what
    /// touches in the file touches here; but voxel indices say nothing of mm and become RAS.
    void checkFile(const fs::path& file) {
        const std::size_t number = run_.surfaces.size();
        run_.surfaces.emplace_back().file = file;
        SurfaceRun& surface = run_.surfaces.back();
        Loaded loaded{number, {file, {}}};
        try {
            run_.stage("read", [&] { readSurface(loaded.mesh, surface); });
        } catch (const Error& error) {
            addUnread(surface, error.what());
            return;
        } catch (const std::bad_alloc&) {
            addUnread(surface, file.string() + ": too large for this machine's memory");
            return;
        }
        std::vector<Solid> solids;
        run_.stage("check", [&] {
            TriangleMesh& mesh = loaded.mesh.file.mesh;
            solids = separateSolids(mesh, loaded.mesh.file.solids);
            surface.facts = measureSurface(mesh, sizeLimitsOf(options_.profileInUse()),
                                           options_.maxPairs, solids);
            if (surface.facts.topology.count(TopologyDefect::IndexOutOfRange) > 0) {
                replaceBadIndices(mesh);
            }
        });
        if (options_.measuresWalls) {
            run_.stage("walls", [&] {
                measureWallsOf(loaded.mesh.file.mesh, options_.wallLimitMm(), surface.facts,
                               solids);
            });
        }
        tellSolids(surface, loaded.mesh.file.solids.size());
        surface.checks = judgeSurface(surface.facts, options_);
        warnOfWalls(surface);
        warnOfSize(surface);
        meshes_.push_back(std::move(loaded));
    }

    void tellSolids(const SurfaceRun& surface, std::size_t count) {
        if (count < 2) return;
        const bool areApart = surface.facts.solids > 1;
        run_.warnings.push_back(
            {"several-solids",
             "it holds " + std::to_string(count) + " solids, " +
                 (areApart ? "each checked alone"
                           : "checked as one surface; each is where all are closed"),
             baseName(surface.file)});
    }

    void warnOfWalls(const SurfaceRun& surface) {
        const std::optional<WallReport>& walls = surface.facts.walls;
        if (!walls || !walls->hasWall() || walls->leastMm >= options_.wallLimitMm()) return;
        run_.warnings.push_back(
            {"thin-walls",
             formatMeasure(walls->thinAreaMm2) + " mm2 of wall are thinner than " +
                 formatNumber(options_.wallLimitMm()) + " mm; a printer may leave holes there",
             baseName(surface.file)});
    }

    /// A size that may be of another unit, and limits that fit no surface of this size.
    void warnOfSize(const SurfaceRun& surface) {
        const auto size = std::ranges::find(surface.checks, "plausibleSize", &Check::key);
        const bool isDoubtful = size != surface.checks.end() &&
                                size->outcome == Outcome::Undecided &&
                                surface.facts.size.verdict != SizeVerdict::Unknown;
        if (isDoubtful) {
            run_.warnings.push_back({"size-doubtful", size->finding, baseName(surface.file)});
        }
        const double diagonalMm = norm(surface.facts.size.extentMm);
        for (const auto& [name, limit] :
             {std::pair{"--min-gap", options_.minGapMm}, std::pair{"--max-off", options_.maxOffMm},
              std::pair{"--min-wall", options_.minWallMm}}) {
            if (!limit) continue;
            const auto warning = boundOverSize(name, *limit, diagonalMm, baseName(surface.file));
            if (warning) run_.warnings.push_back(*warning);
        }
    }

    void readSurface(NamedMesh& mesh, SurfaceRun& surface) {
        const std::size_t number = run_.surfaces.size() - 1;
        mesh.file = readMesh(mesh.path,
                             {.keepsFaults = true,
                              .inputCoordinates = statedFrame(options_.inputCoordinates, number)});
        std::erase_if(mesh.file.warnings,
                      [&](const Warning& w) { return w.code == "several-solids"; });
        addWarnings(run_.warnings, mesh.file.warnings, baseName(mesh.path));
        if (image_ && !mesh.file.frame) {
            throw InvalidInput(
                mesh.path.string() +
                ": does not say its coordinate frame, so where it lies in the image is not known" +
                kStateIt);
        }
        freeMemory(mesh.file.mesh.normals);  // not looked at
        surface.format = mesh.file.format;
        surface.frame = mesh.file.frame;
        if (mesh.file.frame == CoordinateFrame::Voxel) {
            bringToOneFrame({&mesh, 1}, image_);
            mesh.file.mesh = toFrame(mesh.file.mesh, CoordinateFrame::Ras);
            mesh.file.frame = CoordinateFrame::Ras;
            mesh.file.volume.reset();
        }
        surface.points = mesh.file.frame;
    }

    void addUnread(SurfaceRun& surface, const std::string& message) {
        surface.error = message;
        run_.progress.clear();
        printError(kProgram, message);
    }

    /// Surfaces of one frame are taken as stored.
    bool areInOneFrame() const {
        return std::all_of(meshes_.begin(), meshes_.end(), [&](const Loaded& loaded) {
            return loaded.mesh.file.frame == meshes_.front().mesh.file.frame &&
                   (loaded.mesh.file.frame || areOfOneFormat(loaded.mesh, meshes_.front().mesh)) &&
                   loaded.mesh.file.volume == meshes_.front().mesh.file.volume;
        });
    }

    /// Moves all meshes to LPS, or that of a stand-in volume.
    CommonFrame moveToOneFrame() {
        std::vector<NamedMesh> meshes;
        for (Loaded& loaded : meshes_) meshes.push_back(std::move(loaded.mesh));
        CommonFrame common = bringToOneFrame(meshes, image_);
        for (std::size_t n = 0; n < meshes.size(); ++n) {
            meshes_[n].mesh = std::move(meshes[n]);
            meshes_[n].mesh.file.frame = CoordinateFrame::Lps;
            meshes_[n].mesh.file.volume.reset();
        }
        addWarnings(run_.warnings, common.warnings);
        return common;
    }

    void checkNested() {
        if (meshes_.size() < 2) return;
        run_.stage("nesting", [&] {
            run_.nestingFrame = meshes_.front().mesh.file.frame;
            if (!areInOneFrame()) {
                const CommonFrame common = moveToOneFrame();
                run_.nestingFrame = common.known();
                run_.toNestingFrame = lpsToFrame(common.frame, common.volume);
            }
            for (std::size_t n = 0; n + 1 < meshes_.size(); ++n) {
                checkPair(meshes_[n], meshes_[n + 1]);
            }
        });
    }

    void checkPair(const Loaded& inner, const Loaded& outer) {
        NestingRun& pair = run_.nesting.emplace_back();
        pair.inner = inner.number;
        pair.outer = outer.number;
        pair.report = checkNesting(inner.mesh.file.mesh, outer.mesh.file.mesh,
                                   {.maxPairs = options_.maxPairs});
        pair.checks =
            judgeNesting(pair.report, inner.mesh.path.filename().string(),
                         outer.mesh.path.filename().string(), run_.toNestingFrame, options_);
    }

    /// Checks the plausibility of a head model's boundary, or of all of them.
    void assessPlausibility() {
        if (options_.profileInUse() != Profile::Bem || meshes_.empty()) return;
        run_.stage("plausibility", [&] {
            std::vector<NamedMesh> meshes;
            for (const Loaded& loaded : meshes_) meshes.push_back(loaded.mesh);
            const CommonFrame common = bringToOneFrame(meshes, image_);
            const AffineTransform toFrame = lpsToFrame(common.frame, common.volume);
            std::vector<TriangleMesh> surfaces;
            for (NamedMesh& mesh : meshes) surfaces.push_back(std::move(mesh.file.mesh));
            PlausibilityOptions asked;
            asked.areNested = options_.isNested;
            asked.areHeadLayers = options_.isNested && surfaces.size() == 3;
            // in a stand-in's tkRAS nothing says where the image is
            if (common.frame == CoordinateFrame::Ras) asked.image = image_;
            for (HeadNote& note : judgePlausibility(surfaces, asked)) {
                std::string subject = nameOf(meshes_[note.surface]);
                if (note.next) subject += " in " + nameOf(meshes_[*note.next]);
                ReportedNote reported{std::move(note), std::move(subject), common.known(), {}};
                for (const Vec3& p : reported.note.pointsMm)
                    reported.placesMm.push_back(toFrame(p));
                run_.notes.push_back(std::move(reported));
            }
        });
    }

    static std::string nameOf(const Loaded& loaded) { return loaded.mesh.path.filename().string(); }

    void measureDeviations() {
        if (!isosurface_ || meshes_.empty()) return;
        run_.stage("isosurface", [&] {
            moveToOneFrame();
            for (const Loaded& loaded : meshes_) {
                SurfaceRun& surface = run_.surfaces[loaded.number];
                surface.deviation = isosurfaceDeviation(loaded.mesh.file.mesh, *isosurface_);
                if (surface.deviation) {
                    surface.deviation->maxPointMm =
                        lpsToFrame(CoordinateFrame::Ras, {})(surface.deviation->maxPointMm);
                }
                surface.checks.push_back(
                    judgeDeviation(surface.deviation, isosurface_->voxelMm, options_));
            }
        });
    }

    /// The meshes, in one frame; as checked where theirs says nothing of the image. They are not
    /// needed any more.
    void keepForReport() {
        if (!options_.report.isWanted()) return;
        std::vector<NamedMesh> meshes;
        for (Loaded& loaded : meshes_) meshes.push_back(std::move(loaded.mesh));
        const CommonFrame common = bringToOneFrame(meshes, image_);
        shown_.frame = common.known();
        for (std::string& line : linesOf(common.warnings)) shown_.notes.push_back(std::move(line));
        for (std::size_t n = 0; n < meshes.size(); ++n) {
            shown_.surfaces.push_back({meshes_[n].number, std::move(meshes[n].file.mesh)});
        }
    }

    const CheckOptions& options_;
    CheckRun& run_;
    ShownSurfaces shown_;
    std::optional<ImageGeometry> image_;
    std::optional<Isosurface> isosurface_;
    std::vector<Loaded> meshes_;
};

void printFailed(const std::string& subject, const std::vector<Check>& checks) {
    for (const Check& check : checks) {
        if (!check.breaksProfile()) continue;
        printError(kProgram, "check failed: " + subject + ": " + std::string(check.name) +
                                 (check.finding.empty() ? "" : ": ") + check.finding);
    }
}

/// Prints failed checks on stderr, for runs that print no table.
void printFailed(const CheckRun& run) {
    for (const SurfaceRun& surface : run.surfaces) {
        printFailed(surface.file.string(), surface.checks);
    }
    for (const NestingRun& pair : run.nesting) {
        printFailed(run.surfaces[pair.inner].file.string() + " in " +
                        run.surfaces[pair.outer].file.string(),
                    pair.checks);
    }
}

Verdict verdictOf(const CheckRun& run) {
    const auto unread = std::ranges::find_if(
        run.surfaces, [](const SurfaceRun& surface) { return !surface.error.empty(); });
    if (unread != run.surfaces.end()) return {kExitBadInput, unread->error};
    return {run.hasPassed() ? kExitOk : kExitCheckFailed};
}

/// True where a check failed that adaptiso-mend mends. False for several solids, which it joins.
bool isForMending(const SurfaceRun& surface) {
    constexpr std::string_view kMended[] = {
        "finiteCoordinates",    "indicesInRange",        "closed",  "manifoldEdges",
        "manifoldVertices",     "consistentOrientation", "outward", "noDegenerateTriangles",
        "noDuplicateTriangles", "noSelfIntersections"};
    return surface.facts.solids == 1 &&
           std::ranges::any_of(surface.checks, [&](const Check& check) {
               return check.breaksProfile() && std::ranges::count(kMended, check.key) > 0;
           });
}

/// --max-hole for a border that may be wider than what adaptiso-mend closes by itself.
std::string holeOption(const SurfaceFacts& facts) {
    constexpr double kLeft = 0.99;  // new surface reaches beyond the border a little
    if (facts.holes.empty()) return {};
    double spanMm = 0;
    for (const Hole& hole : facts.holes) spanMm = std::max(spanMm, hole.spanMm);
    const double diagonalMm = norm(facts.size.extentMm);
    if (spanMm < kLeft * MendOptions::kHoleOfDiagonal * diagonalMm) return {};
    const double enoughMm = spanMm / kLeft;
    return " --max-hole " +
           (enoughMm > 10 ? formatNumber(std::ceil(enoughMm)) : formatBound(enoughMm, 2));
}

/// \param more  options of adaptiso-mend, a blank before each
std::string mendingCommand(const fs::path& file, const std::string& more) {
    const std::string name = file.filename().string();
    const auto isWritten = [&](const MeshFormat& format) {
        return std::ranges::count(format.extensions, file.extension().string()) > 0;
    };
    const bool keepsFormat = std::ranges::any_of(meshFormats(), isWritten);
    return "adaptiso-mend " + shellQuoted(file.string()) + more + " -o " +
           shellQuoted("mended-" + (keepsFormat ? name : name + ".vtp"));
}

/// The command for the first surface with faults that adaptiso-mend mends; if there is none, for
/// the first that crosses the surface inside it or lies too near to it. Empty if there is neither.
std::string mendingCommand(const CheckRun& run) {
    const auto found = std::ranges::find_if(run.surfaces, isForMending);
    if (found != run.surfaces.end()) {
        return mendingCommand(found->file, holeOption(found->facts));
    }
    for (const NestingRun& pair : run.nesting) {
        const NestingRelation relation = pair.report.relation;
        if (relation != NestingRelation::Nested && relation != NestingRelation::Crossing) continue;
        if (std::ranges::none_of(pair.checks, &Check::breaksProfile)) continue;
        const double gapMm = run.options.minGapMm.value_or(CheckRules::kLeastGapMm);
        return mendingCommand(run.surfaces[pair.outer].file,
                              " --around " + shellQuoted(run.surfaces[pair.inner].file.string()) +
                                  " --gap " + formatNumber(gapMm));
    }
    return {};
}

/// A run for each of many surfaces, or of many heads. \return, \throws as runBatch()
int runCheckBatch(const CheckOptions& options) {
    BatchProgram program{kProgram, "", {"--volume"}, {"--report", "--pictures"}};
    program.keepsRecords = false;
    const auto nameOf = [](const fs::path& file) { return file.filename().string(); };
    return runBatch(program, findBatchItems(options.batch, options.files, nameOf, options.isNested),
                    options.batch, options.common);
}

}  // namespace

bool CheckRun::hasUnreadable() const {
    return std::any_of(surfaces.begin(), surfaces.end(),
                       [](const SurfaceRun& surface) { return !surface.error.empty(); });
}

bool CheckRun::hasFailedCheck() const {
    const auto fails = [](const auto& subject) { return !allHold(subject.checks); };
    return std::ranges::any_of(surfaces, fails) || std::ranges::any_of(nesting, fails);
}

bool CheckRun::hasPassed() const {
    return !hasUnreadable() && !hasFailedCheck();
}

int runCheck(const CheckOptions& options) {
    if (options.isSelfTest) return runSelfTest(options);
    if (options.batch.isRequested()) return runCheckBatch(options);
    CheckRun run(options);
    checkOutputs(options);
    Checker checker(run);
    checker.check();

    if (options.report.isWanted()) {
        run.writePage([&] { return makeReport(run, checker.shown()); });
    }
    run.verdict = verdictOf(run);
    if (run.hasFailedCheck() && options.report.page.empty()) {
        run.next = "--report check.html shows where";
    }
    const std::string mending = mendingCommand(run);
    if (!mending.empty()) addPart(run.next, mending, "; ");
    run.deliver([&] { return jsonReport(run); }, [&](std::ostream& out) { printReport(out, run); });
    if (options.common.isQuiet || options.common.wantsJsonOnStdout()) printFailed(run);
    if (run.hasUnreadable()) run.verdict.error.clear();  // printed above
    return run.end("the checks are done");
}

}  // namespace adaptiso::checker
