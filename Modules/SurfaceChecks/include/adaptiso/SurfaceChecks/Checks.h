#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshQuality/InsideTest.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Shape.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/MeshQuality/Walls.h"
#include "adaptiso/SurfaceChecks/Solids.h"

namespace adaptiso {

/// Measures of one surface, for the checks below.
struct SurfaceFacts {
    TopologyReport topology;
    std::int64_t repeatedIndexTriangles = 0;  ///< of the degenerate ones, those that name a vertex
                                              ///< twice
    DuplicateReport duplicates;
    SelfIntersections intersections;
    std::size_t solids = 1;  ///< each was looked at alone
    /// Triangles that lie on one of another solid: these walls are neither duplicates nor cross.
    std::int64_t sharedWallTriangles = 0;
    std::vector<Hole> holes;  ///< of a soup none
    Vec3 firstCrossingMm;     ///< the middle of the first triangle that crosses another
    ShapeReport shape;
    SizeReport size;
    SolidAngleCriterion solidAngle;
    /// Numbers of the pieces that are the wrong way round, or of a solid in the material of
    /// another; empty if that is undefined: the surface is open, not manifold, not oriented, or not
    /// finite; or undecided: findInsideOutPieces() says when.
    std::optional<std::vector<std::int64_t>> insideOut;
    std::optional<WallReport> walls;  ///< empty unless measured: measureWallsOf()
    double areaMm2 = 0;               ///< of the triangles with finite corners
    std::optional<double> volumeMm3;  ///< empty unless closed, manifold and oriented

    /// Every triangle has its corners for itself, though they lie at places of others.
    bool isSoup() const;
};

/// Gives triangles that name missing points a new point instead, added at the end, that is not
/// finite: no number of a triangle changes, and measures leave them out.
void replaceBadIndices(TriangleMesh& mesh);

/// Triangles that name missing points are counted, and left out of all other measures.
/// \param maxPairs  of triangles that cross, to list
/// \param solids    as separateSolids() gives them: duplicates are sought in each, one may fill
///                  another's cavity, and walls that two share may lie on each other. Empty: the
///                  mesh is one surface
SurfaceFacts measureSurface(const TriangleMesh& mesh, const SizeLimits& sizeLimits,
                            std::int64_t maxPairs, std::span<const Solid> solids = {});

/// Measures facts.walls, if the surface is closed, manifold, and faces outward.
/// \param solids  as measureSurface() takes them: the walls of each
void measureWallsOf(const TriangleMesh& mesh, double limitMm, SurfaceFacts& facts,
                    std::span<const Solid> solids = {});

/// The thinnest wall: "0.42 mm", "below 0.01 mm". \pre walls.hasWall()
std::string wallText(const WallReport& walls);

/// Use of a surface, which determines the required checks.
enum class Profile {
    Bem,    ///< a boundary of a head model
    Print,  ///< a solid to print or to compute with
    View    ///< to look at
};

/// "bem", "print", "view"
std::string_view toString(Profile profile);

/// Plausible sizes of a surface for this use.
SizeLimits sizeLimitsOf(Profile profile);

/// Options of the checks.
struct CheckRules {
    bool isNested = false;              ///< they lie in each other, the innermost first
    std::optional<Profile> profile;     ///< default: Bem when nested, else Print
    std::optional<double> minGapMm;     ///< default: kLeastGapMm, required of Bem only
    std::optional<double> minAngleDeg;  ///< default: kLeastAngleDeg, required of Bem only
    std::optional<double> maxOffMm;     ///< default: half a voxel on the mean
    bool measuresWalls = false;         ///< costs more than all other checks of a surface
    std::optional<double> minWallMm;    ///< default: kDefaultMinWallMm, and not required
    std::int64_t maxPairs = 1000;       ///< of triangles that cross, to list

    static constexpr double kLeastGapMm = 0.5;   // thinner than any bone of the skull
    static constexpr double kLeastAngleDeg = 1;  // slivers that only bad remeshing leaves

    /// Two lines of the usual nozzle of 0.4 mm, the least that guides for filament printers name.
    static constexpr double kDefaultMinWallMm = 0.8;

    double wallLimitMm() const { return minWallMm.value_or(kDefaultMinWallMm); }

    Profile profileInUse() const {
        return profile.value_or(isNested ? Profile::Bem : Profile::Print);
    }
    /// The same with every default filled in, for reports: the checks ask what was given.
    CheckRules inUse() const;
};

/// What is required: a row for each.
const Options<CheckRules>& ruleOptions();
/// --max-pairs
const Options<CheckRules>& pairOptions();

enum class Outcome {
    Passed,
    Failed,
    Undecided  ///< makes no sense of this surface: the genus of an open one
};

/// A row of the table of checks.
struct CheckRule {
    std::string_view key;      ///< of the report: "noSelfIntersections"
    std::string_view name;     ///< for people: "no self-intersection"
    std::string_view meaning;  ///< when it holds
    bool bem, print, view;     ///< profiles that require it

    bool isRequiredBy(Profile profile) const;
};

/// All checks, in the order of adaptiso-check's README.md.
std::span<const CheckRule> checkRules();

/// A check of a surface, or of two, and its outcome.
struct Check {
    std::string_view key;   ///< of the report: "selfIntersections"
    std::string_view name;  ///< for people: "no self-intersection"
    bool isRequired = false;
    Outcome outcome = Outcome::Passed;
    std::string finding;  ///< result and place; may be empty when passed

    bool hasFailed() const { return outcome == Outcome::Failed; }
    bool breaksProfile() const { return isRequired && hasFailed(); }
};

/// True if no required check failed.
bool allHold(const std::vector<Check>& checks);

/// The checks of one surface.
std::vector<Check> judgeSurface(const SurfaceFacts& facts, const CheckRules& rules);

/// A place of what a check found, if it has one; else of some defect, else the middle of the box.
/// \param facts  of `mesh`, which the check judged
Vec3 placeOfFinding(const Check& check, const SurfaceFacts& facts, const TriangleMesh& mesh);

/// Checks that the surface lies on the isosurface.
/// \param deviation  empty if the surface has no area to measure
Check judgeDeviation(const std::optional<DistanceStatistics>& deviation, double voxelMm,
                     const CheckRules& rules);

/// The checks of two surfaces of which one should lie in the other.
/// \param inner, outer  their names
/// \param toFrame       takes points of the report to the frame of the output
std::vector<Check> judgeNesting(const NestingReport& report, const std::string& inner,
                                const std::string& outer, const AffineTransform& toFrame,
                                const CheckRules& rules);

}  // namespace adaptiso
