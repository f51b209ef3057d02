#include "adaptiso/SurfaceChecks/Checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

namespace {

constexpr CheckRule kFinite{"finiteCoordinates",
                            "finite coordinates",
                            "no coordinate is NaN or infinite",
                            true,
                            true,
                            true};
constexpr CheckRule kIndices{"indicesInRange",
                             "indices in range",
                             "every triangle names vertices that are there",
                             true,
                             true,
                             true};
constexpr CheckRule kClosed{
    "closed", "closed", "no edge lies in one triangle only; a triangle soup is named as such",
    true,     true,     false};
constexpr CheckRule kEdges{"manifoldEdges",
                           "edges manifold",
                           "no edge lies in more than two triangles",
                           true,
                           true,
                           false};
constexpr CheckRule kVertices{"manifoldVertices",
                              "vertices manifold",
                              "the triangles round every vertex are one fan",
                              true,
                              true,
                              false};
constexpr CheckRule kOriented{"consistentOrientation",
                              "orientation consistent",
                              "triangles at an edge run along it in opposite directions",
                              true,
                              true,
                              true};
constexpr CheckRule kOutward{"outward",
                             "facing outward",
                             "triangles are counter-clockwise seen from outside; those of a "
                             "cavity's wall, seen from the cavity",
                             true,
                             true,
                             true};
constexpr CheckRule kOneComponent{
    "oneComponent", "one component", "all triangles hang together by shared vertices",
    true,           false,           false};
constexpr CheckRule kGenus{"genusZero", "genus 0", "there is no handle", true, false, false};
constexpr CheckRule kDegenerate{
    "noDegenerateTriangles",
    "no degenerate triangle",
    "no triangle names a vertex twice, or has an altitude of 1e-9 of its longest edge or less",
    true,
    true,
    false};
constexpr CheckRule kDuplicateTriangles{
    "noDuplicateTriangles",
    "no duplicate triangle",
    "no two triangles have their corners at the same three places, but for walls that two solids "
    "of a file share",
    true,
    true,
    true};
constexpr CheckRule kDuplicateVertices{"noDuplicateVertices",
                                       "no duplicate vertex",
                                       "no two vertices lie at the same place",
                                       true,
                                       false,
                                       false};
constexpr CheckRule kUnused{"noUnusedVertices",
                            "no unused vertex",
                            "every vertex is named by a triangle",
                            true,
                            false,
                            false};
constexpr CheckRule kCrossings{"noSelfIntersections",
                               "no self-intersection",
                               "no two triangles intersect, as said below",
                               true,
                               true,
                               false};
constexpr CheckRule kLeastAngle{
    "minAngle", "smallest angle", "no angle is below `--min-angle` (1 degree)", true, false, false};
constexpr CheckRule kSize{
    "plausibleSize",
    "size plausible in mm",
    "bem: every side of the bounding box is 50 mm or more (as in MNE), none above 500 mm; else: "
    "the longest side is 1 to 2000 mm; a shorter one, as of a micro-CT, is undecided, and fails "
    "below a micron and where `--profile print` is given",
    true,
    true,
    false};
constexpr CheckRule kMinWall{"minWall",
                             "walls",
                             "measured with `--min-wall` or `--profile print`: no wall is thinner "
                             "than `--min-wall` (0.8 mm)",
                             false,
                             false,
                             false};
constexpr CheckRule kSolidAngle{"solidAngle",
                                "MNE's solid angle",
                                "MNE's criterion: from the mean of all vertices, the surface "
                                "covers the whole sphere to within 1e-5",
                                true,
                                false,
                                false};
constexpr CheckRule kDeviation{"onIsosurface",
                               "on the isosurface",
                               "with `--iso`: the mean distance from the isosurface is half a "
                               "voxel or less; with `--max-off`: the maximum is as much or less",
                               true,
                               true,
                               true};
constexpr CheckRule kNoCrossing{
    "noCrossing",
    "no crossing",
    "with `--nested`: no triangle of one surface meets one of the next, touching included",
    true,
    true,
    true};
constexpr CheckRule kNested{"strictlyNested",
                            "strictly nested",
                            "with `--nested`: the surface lies inside the next",
                            true,
                            true,
                            true};
constexpr CheckRule kMinGap{
    "minGap", "gap", "with `--nested`: the gap to the next is `--min-gap` (0.5 mm) or more",
    true,     false, false};

constexpr std::array kCheckRules{kFinite,
                                 kIndices,
                                 kClosed,
                                 kEdges,
                                 kVertices,
                                 kOriented,
                                 kOutward,
                                 kOneComponent,
                                 kGenus,
                                 kDegenerate,
                                 kDuplicateTriangles,
                                 kDuplicateVertices,
                                 kUnused,
                                 kCrossings,
                                 kLeastAngle,
                                 kSize,
                                 kMinWall,
                                 kSolidAngle,
                                 kDeviation,
                                 kNoCrossing,
                                 kNested,
                                 kMinGap};

std::string at(const Vec3& p) {
    return formatFixed(p.x, 2) + ", " + formatFixed(p.y, 2) + ", " + formatFixed(p.z, 2);
}

/// "triangle 3", "vertices 4, 5"
std::string named(const TopologyExample& example) {
    if (example.triangle >= 0) return "triangle " + std::to_string(example.triangle);
    std::string text = example.vertices[1] < 0 ? "vertex " : "vertices ";
    for (std::size_t n = 0; n < 3 && example.vertices[n] >= 0; ++n) {
        text += (n > 0 ? ", " : "") + std::to_string(example.vertices[n]);
    }
    return text;
}

/// Asks the questions of one surface.
class SurfaceJudge {
public:
    SurfaceJudge(const SurfaceFacts& facts, const CheckRules& rules)
        : facts_(facts), rules_(rules) {}

    std::vector<Check> judge() && {
        judgeTopology();
        judgePieces();
        judgeTriangles();
        judgeMeasures();
        return std::move(checks_);
    }

private:
    void add(const CheckRule& rule, Outcome outcome, std::string finding) {
        checks_.push_back({rule.key, rule.name, rule.isRequiredBy(rules_.profileInUse()), outcome,
                           std::move(finding)});
    }
    void add(const CheckRule& rule, bool holds, std::string finding) {
        add(rule, holds ? Outcome::Passed : Outcome::Failed, std::move(finding));
    }
    /// Passes without a finding, or fails with one.
    void addUnless(const CheckRule& rule, bool isBad, const std::string& finding) {
        add(rule, !isBad, isBad ? finding : "");
    }

    std::string firstOf(TopologyDefect defect) const {
        const auto& examples = facts_.topology.examples;
        const auto found = std::find_if(examples.begin(), examples.end(),
                                        [&](const auto& e) { return e.defect == defect; });
        if (found == examples.end()) return "";
        std::string text = "; first: " + named(*found);
        const bool hasPlace =
            std::isfinite(squaredNorm(found->pointMm)) && defect != TopologyDefect::IndexOutOfRange;
        return hasPlace ? text + " at " + at(found->pointMm) : text;
    }

    void addDefect(const CheckRule& rule, TopologyDefect defect, const std::string& one,
                   const std::string& many) {
        const std::int64_t count = facts_.topology.count(defect);
        addUnless(rule, count > 0, counted(count, one, many) + firstOf(defect));
    }

    void judgeTopology() {
        addDefect(kFinite, TopologyDefect::NonFiniteVertex, "vertex is NaN or infinite",
                  "vertices are NaN or infinite");
        addDefect(kIndices, TopologyDefect::IndexOutOfRange,
                  "triangle names a vertex that is not there",
                  "triangles name vertices that are not there");
        if (facts_.isSoup()) {
            add(kClosed, false,
                "a triangle soup: no two triangles share a vertex, " +
                    counted(facts_.duplicates.vertexCount, "vertex repeats", "vertices repeat") +
                    " the place of another; merge vertices at the same place");
        } else if (facts_.holes.empty()) {
            addDefect(kClosed, TopologyDefect::BoundaryEdge, "boundary edge", "boundary edges");
        } else {
            const Hole& longest = facts_.holes.front();
            add(kClosed, false,
                counted(facts_.topology.count(TopologyDefect::BoundaryEdge), "boundary edge") +
                    ", " + counted(std::ssize(facts_.holes), "hole") + "; the longest, " +
                    formatLength(longest.lengthMm, 1) + " mm round and " +
                    formatLength(longest.spanMm, 1) + " mm wide, around " + at(longest.middleMm));
        }
        addDefect(kEdges, TopologyDefect::NonManifoldEdge, "edge in more than two triangles",
                  "edges in more than two triangles");
        addDefect(kVertices, TopologyDefect::NonManifoldVertex,
                  "vertex whose triangles are not one fan",
                  "vertices whose triangles are not one fan");
        addDefect(kOriented, TopologyDefect::InconsistentEdge,
                  "edge whose triangles are wound opposite ways (flipped triangles)",
                  "edges whose triangles are wound opposite ways (flipped triangles)");
        judgeOutward();
    }

    void judgeOutward() {
        if (!facts_.insideOut && facts_.topology.isWatertight() &&
            facts_.topology.count(TopologyDefect::NonFiniteVertex) == 0) {
            return add(kOutward, false,
                       "not decided: too many of " +
                           formatCount(std::ssize(facts_.topology.components)) +
                           " components lie beside, within or across each other");
        }
        if (!facts_.insideOut) {
            return add(kOutward, Outcome::Undecided,
                       "only a closed, manifold, oriented and finite surface has an outside");
        }
        const std::size_t pieces = facts_.topology.components.size(),
                          wrong = facts_.insideOut->size();
        if (pieces == 1) {
            return addUnless(kOutward, wrong > 0,
                             "inside out: all triangles are flipped, facing inward");
        }
        const auto count = static_cast<std::int64_t>(wrong);
        addUnless(kOutward, wrong > 0,
                  counted(count, "component is", "components are") + " inside out" +
                      (facts_.solids > 1 ? " or in another solid's material" : "") + ", of " +
                      formatCount(static_cast<std::int64_t>(pieces)) + "; first: component " +
                      (wrong > 0 ? std::to_string(facts_.insideOut->front()) : ""));
    }

    /// " of 1,280, 80, ... triangles", or nothing where there is no component.
    std::string largestComponents() const {
        constexpr std::size_t kShown = 5;
        std::vector<std::int64_t> sizes;
        for (const SurfaceComponent& component : facts_.topology.components) {
            sizes.push_back(component.triangles);
        }
        std::sort(sizes.begin(), sizes.end(), std::greater<>());
        std::string text;
        for (std::size_t n = 0; n < std::min(kShown, sizes.size()); ++n) {
            text += (n > 0 ? ", " : " of ") + formatCount(sizes[n]);
        }
        if (sizes.size() > kShown) text += ", ...";
        return text.empty() ? text : text + " triangles";
    }

    std::string duplicatesText() const {
        const DuplicateReport& duplicates = facts_.duplicates;
        std::string text;
        if (duplicates.triangleCount > 0) {
            text =
                counted(duplicates.triangleCount, "triangle lies", "triangles lie") + " on another";
        }
        if (!duplicates.triangles.empty()) {
            text += "; first: triangle " + std::to_string(duplicates.triangles[0]);
        }
        if (facts_.sharedWallTriangles > 0) {
            addPart(text,
                    counted(facts_.sharedWallTriangles, "triangle is", "triangles are") +
                        " of walls that two solids share",
                    "; ");
        }
        return text;
    }

    void judgePieces() {
        const std::int64_t components = std::ssize(facts_.topology.components);
        std::string pieces = counted(components, "component") + largestComponents();
        if (rules_.profile == Profile::Print &&
            components > static_cast<std::int64_t>(facts_.solids)) {
            pieces += "; each is printed: adaptiso-mend --largest --fill-cavities leaves one";
        }
        addUnless(kOneComponent, components != 1, pieces);

        const auto genus = facts_.topology.genus();
        if (!genus) {
            add(kGenus, Outcome::Undecided,
                "only a closed, manifold and oriented surface has a genus");
        } else {
            addUnless(kGenus, *genus != 0,
                      "genus " + std::to_string(*genus) + ": " + counted(*genus, "handle"));
        }
    }

    void judgeTriangles() {
        const TopologyReport& topology = facts_.topology;
        const std::int64_t degenerate = topology.count(TopologyDefect::DegenerateTriangle);
        const std::int64_t repeated = std::min(facts_.repeatedIndexTriangles, degenerate);
        std::string kinds;
        if (repeated > 0) kinds += counted(repeated, "names", "name") + " a vertex twice";
        if (degenerate > repeated) {
            addPart(kinds, counted(degenerate - repeated, "has", "have") + " zero area");
        }
        addUnless(kDegenerate, degenerate > 0,
                  counted(degenerate, "degenerate triangle: ", "degenerate triangles: ") + kinds +
                      firstOf(TopologyDefect::DegenerateTriangle));

        const DuplicateReport& duplicates = facts_.duplicates;
        add(kDuplicateTriangles, duplicates.triangleCount == 0, duplicatesText());
        addUnless(kDuplicateVertices, duplicates.vertexCount > 0,
                  counted(duplicates.vertexCount, "vertex lies", "vertices lie") +
                      " at the place of another" +
                      (duplicates.vertices.empty()
                           ? ""
                           : "; first: vertex " + std::to_string(duplicates.vertices[0])));
        addDefect(kUnused, TopologyDefect::UnusedVertex, "vertex that no triangle uses",
                  "vertices that no triangle uses");

        const SelfIntersections& crossings = facts_.intersections;
        std::string where;
        if (!crossings.pairs.empty()) {
            const auto& [a, b] = crossings.pairs.front();
            where = "; first: triangles " + std::to_string(a) + " and " + std::to_string(b) +
                    " near " + at(facts_.firstCrossingMm);
        }
        addUnless(kCrossings, !crossings.isClear(), crossingText(crossings) + where);
    }

    void judgeMeasures() {
        judgeAngle();
        judgeSizeInMm();
        const double share = facts_.solidAngle.share;
        addUnless(kSolidAngle, !facts_.solidAngle.isMet(),
                  "the solid angle from the vertices' mean is " + formatFixed(share, 6) +
                      " of the sphere, must be 1 to within 0.00001");
        if (rules_.measuresWalls) judgeWalls();
    }

    void judgeWalls() {
        if (!facts_.walls) {
            const std::string finding = "only a closed, manifold and outward surface has walls";
            if (rules_.minWallMm) {
                add(kMinWall, false, finding);
            } else {
                add(kMinWall, Outcome::Undecided, finding);
            }
        } else if (!facts_.walls->hasWall()) {
            add(kMinWall, Outcome::Undecided, "no two sides face each other");
        } else {
            const WallReport& walls = *facts_.walls;
            const double limit = rules_.wallLimitMm();
            const bool holds = walls.leastMm >= limit;
            std::string finding = "thinnest " + wallText(walls) + " at " + at(walls.pointMm);
            if (!holds) {
                finding += ", must be at least " + formatNumber(limit) + "; " +
                           formatFixed(100 * walls.thinShare(), 1) + " % of the area is thinner";
            }
            add(kMinWall, holds, finding);
        }
        checks_.back().isRequired |= rules_.minWallMm.has_value();
    }

    void judgeAngle() {
        const Spread& angles = facts_.shape.angleDeg;
        if (facts_.shape.triangles == 0) {
            return add(kLeastAngle, Outcome::Undecided, "there is no triangle to measure");
        }
        const double limit = rules_.minAngleDeg.value_or(CheckRules::kLeastAngleDeg);
        const bool holds = angles.minimum >= limit;
        std::string finding = formatFixed(angles.minimum, 2) + " degrees";
        if (!holds) {
            finding += " in triangle " + std::to_string(angles.triangleOfMinimum) +
                       ", must be at least " + formatNumber(limit);
        }
        add(kLeastAngle, holds, finding);
        checks_.back().isRequired |= rules_.minAngleDeg.has_value();
    }

    void judgeSizeInMm() {
        const SizeReport& size = facts_.size;
        if (size.verdict == SizeVerdict::Unknown) {
            return add(kSize, Outcome::Undecided, "there is no triangle to measure");
        }
        std::string finding = formatSizeMm(size.extentMm);
        // what is said to be for a printer is no micro-CT, nor is what is smaller than a micron
        constexpr double kMicronMm = 1e-3;
        const double longestMm = std::max({size.extentMm.x, size.extentMm.y, size.extentMm.z});
        const bool mayBeSmall = rules_.profileInUse() != Profile::Bem &&
                                rules_.profile != Profile::Print && longestMm >= kMicronMm;
        if (size.verdict == SizeVerdict::TooSmall && mayBeSmall) {
            const std::string unit =
                size.guess ? ", or in " + std::string(toString(*size.guess)) : std::string();
            return add(kSize, Outcome::Undecided, finding + ": of a micro-CT" + unit + "?");
        }
        if (size.verdict != SizeVerdict::Plausible) {
            finding += size.verdict == SizeVerdict::TooSmall ? ": too small" : ": too large";
            if (size.guess) finding += "; in " + std::string(toString(*size.guess)) + "?";
        }
        add(kSize, size.verdict == SizeVerdict::Plausible, finding);
    }

    const SurfaceFacts& facts_;
    const CheckRules& rules_;
    std::vector<Check> checks_;
};

Check makeCheck(const CheckRule& rule, Outcome outcome, const std::string& finding,
                const CheckRules& rules) {
    return {rule.key, rule.name, rule.isRequiredBy(rules.profileInUse()), outcome, finding};
}

constexpr const char* kNothingToMeasure = "a surface has no triangle to measure";
constexpr const char* kNotDecided =
    "not decided: hundreds of triangles lie near each one, more than are tested";

bool isOneEmpty(const NestingReport& report) {
    return report.innerVertices == 0 || report.outerVertices == 0;
}

std::string outsideText(const NestingReport& report, const std::string& inner,
                        const std::string& outer) {
    return foundText(report.innerVerticesNotInside, report.areSidesKnown) +
           (report.innerVerticesNotInside == 1 ? " vertex of " : " vertices of ") + inner +
           (report.innerVerticesNotInside == 1 ? " is" : " are") + " not inside " + outer +
           ": out by " + (report.isFarthestKnown ? "up to " : "at least ") +
           formatLength(report.farthestOutMm, 2) + " mm";
}

std::string relationText(const NestingReport& report, const std::string& inner,
                         const std::string& outer) {
    switch (report.relation) {
        case NestingRelation::Nested:
            return "";
        case NestingRelation::Crossing:
            return report.innerVerticesNotInside > 0 ? outsideText(report, inner, outer)
                   : !report.areSidesKnown
                       ? "not decided: more triangles lie beside their vertices than are tested"
                       : "all vertices of " + inner + " are inside " + outer +
                             ": a dent of that, or an edge between vertices, goes through";
        case NestingRelation::Swapped:
            return "swapped order: " + outer + " lies inside " + inner;
        case NestingRelation::Identical:
            return "identical: " + inner + " and " + outer +
                   " are the same surface; is one file given twice?";
        case NestingRelation::Apart:
            return "apart: " + inner + " lies wholly outside " + outer;
        case NestingRelation::Mixed:
            return outsideText(report, inner, outer) + "; " +
                   counted(report.outerVerticesInside, "vertex", "vertices") + " of " + outer +
                   (report.outerVerticesInside == 1 ? " lies" : " lie") + " inside " + inner;
        case NestingRelation::Unknown:
            return isOneEmpty(report)                  ? kNothingToMeasure
                   : report.innerVerticesNotInside > 0 ? outsideText(report, inner, outer)
                                                       : kNotDecided;
    }
    throw InternalError("relationText: unknown relation");
}

}  // namespace

bool CheckRule::isRequiredBy(Profile profile) const {
    return std::array{bem, print, view}[static_cast<std::size_t>(profile)];
}

std::span<const CheckRule> checkRules() {
    return kCheckRules;
}

bool allHold(const std::vector<Check>& checks) {
    return std::none_of(checks.begin(), checks.end(),
                        [](const Check& check) { return check.breaksProfile(); });
}

std::vector<Check> judgeSurface(const SurfaceFacts& facts, const CheckRules& rules) {
    return SurfaceJudge(facts, rules).judge();
}

Check judgeDeviation(const std::optional<DistanceStatistics>& deviation, double voxelMm,
                     const CheckRules& rules) {
    if (!deviation) {
        return makeCheck(kDeviation, Outcome::Failed, "there is no area to measure", rules);
    }
    const bool holds =
        rules.maxOffMm ? deviation->maxMm <= *rules.maxOffMm : deviation->meanMm <= voxelMm / 2;
    std::string finding = "off by " + formatLength(deviation->meanMm, 3) + " mm on the mean, " +
                          formatLength(deviation->maxMm, 3) + " mm at most";
    if (!holds) {
        finding += rules.maxOffMm ? ", must be at most " + formatNumber(*rules.maxOffMm) + " mm"
                                  : ", the mean must be at most half a voxel of " +
                                        formatLength(voxelMm, 3) + " mm";
    }
    return makeCheck(kDeviation, holds ? Outcome::Passed : Outcome::Failed, finding, rules);
}

std::vector<Check> judgeNesting(const NestingReport& report, const std::string& inner,
                                const std::string& outer, const AffineTransform& toFrame,
                                const CheckRules& rules) {
    std::vector<Check> checks;
    const auto add = [&](const CheckRule& rule, bool holds, const std::string& finding) {
        checks.push_back(
            makeCheck(rule, holds ? Outcome::Passed : Outcome::Failed, finding, rules));
    };
    const std::string where = " at " + at(toFrame(report.gap.nearest.pointA));
    const std::string triangles = "triangles " + std::to_string(report.gap.triangleA) + " of " +
                                  inner + " and " + std::to_string(report.gap.triangleB) + " of " +
                                  outer;
    const bool meet = report.crossingPairs > 0;
    const bool areIdentical = report.relation == NestingRelation::Identical;
    add(kNoCrossing, !meet && report.isComplete,
        areIdentical ? "they lie on each other everywhere"
        : meet       ? pairsText(report.crossingPairs, report.isComplete) +
                     " of triangles cross or touch; first: " + triangles + where
        : report.isComplete ? ""
                            : kNotDecided);
    add(kNested, report.isStrictlyNested(), relationText(report, inner, outer));
    if (report.gap.triangleA < 0) {
        checks.push_back(makeCheck(kMinGap, Outcome::Undecided,
                                   isOneEmpty(report) ? kNothingToMeasure : kNotDecided, rules));
    } else {
        const double limit = rules.minGapMm.value_or(CheckRules::kLeastGapMm);
        const bool isWide = report.gap.nearest.distanceMm >= limit;
        const bool holds = isWide && report.gap.isComplete;
        add(kMinGap, holds,
            areIdentical
                ? "none: the two are the same surface"
                : "smallest " + formatLength(report.gap.nearest.distanceMm, 3) + " mm" + where +
                      (!isWide ? ", must be at least " + formatNumber(limit) + " mm"
                       : holds ? ""
                               : "; not decided: hundreds of triangles lie about as far from each "
                                 "one, more than are measured"));
    }
    checks.back().isRequired |= rules.minGapMm.has_value();
    return checks;
}

Vec3 placeOfFinding(const Check& check, const SurfaceFacts& facts, const TriangleMesh& mesh) {
    const auto isOf = [&](const CheckRule& rule, bool hasPlace) {
        return check.key == rule.key && hasPlace;
    };
    const auto middleOf = [&](std::int64_t triangle) {
        const auto& [a, b, c] = mesh.triangles[triangle];
        return (1.0 / 3) * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
    };
    const TopologyReport& topology = facts.topology;
    if (isOf(kCrossings, facts.intersections.pairCount > 0)) return facts.firstCrossingMm;
    if (isOf(kLeastAngle, facts.shape.triangles > 0)) {
        return middleOf(facts.shape.angleDeg.triangleOfMinimum);
    }
    if (isOf(kDuplicateVertices, !facts.duplicates.vertices.empty())) {
        return mesh.points[facts.duplicates.vertices.front()];
    }
    if (isOf(kDuplicateTriangles, !facts.duplicates.triangles.empty())) {
        return middleOf(facts.duplicates.triangles.front());
    }
    if (isOf(kOneComponent, topology.components.size() > 1)) {
        return mesh.points[topology.components[1].firstVertex];
    }
    if (!topology.examples.empty()) return topology.examples.front().pointMm;
    return boundingBox(mesh).middle();
}

}  // namespace adaptiso
