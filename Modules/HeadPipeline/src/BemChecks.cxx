#include "adaptiso/HeadPipeline/BemChecks.h"

#include <algorithm>
#include <utility>

namespace adaptiso {
namespace {

CheckRules bemRules(std::optional<double> minGapMm = std::nullopt) {
    CheckRules rules;
    rules.profile = Profile::Bem;
    rules.minGapMm = minGapMm;
    rules.maxPairs = 1;
    return rules;
}

SurfaceFacts factsOf(const TriangleMesh& surface) {
    return measureSurface(surface, sizeLimitsOf(Profile::Bem), 1);
}

/// Coordinates in findings are to be read by people: scanner RAS, as the program prints elsewhere.
std::vector<TriangleMesh> inScannerRas(const std::vector<TriangleMesh>& surfaces) {
    std::vector<TriangleMesh> moved;
    for (const TriangleMesh& surface : surfaces) {
        moved.push_back(toFrame(surface, CoordinateFrame::Ras));
    }
    return moved;
}

void addToReport(const SurfaceFacts& facts, BemSurface& surface) {
    surface.topology = facts.topology;
    surface.shape = facts.shape;
    surface.crossingPairs = facts.intersections.pairCount;
    surface.areaMm2 = facts.areaMm2;
    surface.volumeMm3 = facts.volumeMm3.value_or(0);
    surface.solidAngleShare = facts.solidAngle.share;
    surface.extentMm = facts.size.extentMm;
}

}  // namespace

std::vector<Check> checkHeadSurface(const TriangleMesh& surface) {
    return judgeSurface(factsOf(surface), bemRules());
}

ModelChecks checkHeadSurfaces(std::span<const TriangleMesh> surfaces,
                              std::span<const double> gapsMm) {
    ModelChecks result;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        result.facts.push_back(factsOf(surfaces[n]));
        const SurfaceFacts& facts = result.facts.back();
        for (Check& check : judgeSurface(facts, bemRules())) {
            const Vec3 place = placeOfFinding(check, facts, surfaces[n]);
            result.checks.push_back({bemSurfaceName(n, surfaces.size()), std::move(check), place});
        }
    }
    for (std::size_t n = 0; n + 1 < surfaces.size(); ++n) {
        result.nesting.push_back(checkNesting(surfaces[n], surfaces[n + 1], {.maxPairs = 1}));
        const NestingReport& report = result.nesting.back();
        for (Check& check :
             judgeNesting(report, bemSurfaceName(n, surfaces.size()),
                          bemSurfaceName(n + 1, surfaces.size()), {}, bemRules(gapsMm[n]))) {
            result.checks.push_back({bemSurfaceName(n, surfaces.size()) + " in " +
                                         bemSurfaceName(n + 1, surfaces.size()),
                                     std::move(check), report.gap.nearest.pointA});
        }
    }
    return result;
}

void checkModel(BemModel& model, const BemHooks& hooks) {
    hooks.stage("check", [&] {
        const ModelChecks result =
            checkHeadSurfaces(inScannerRas(model.meshes), model.options.minGapsMm());
        const AffineTransform toLps = inverse(lpsToFrame(CoordinateFrame::Ras, {}));
        for (std::size_t n = 0; n < model.meshes.size(); ++n) {
            addToReport(result.facts[n], model.surfaces[n]);
        }
        model.gaps.clear();
        for (const NestingReport& report : result.nesting) {
            const NearestPoints& nearest = report.gap.nearest;
            model.gaps.push_back(
                {nearest.distanceMm, toLps(nearest.pointA), toLps(nearest.pointB)});
        }
        for (const auto& [subject, check, pointMm] : result.checks) {
            const bool isPassed = !check.breaksProfile();
            model.addCheck({subject, std::string(check.name), isPassed, check.finding,
                            isPassed ? std::nullopt : std::optional(toLps(pointMm))});
        }
    });
}

void assessPlausibility(BemModel& model, const BemHooks& hooks) {
    hooks.stage("check", [&] {
        PlausibilityOptions options;
        options.image = model.image;
        options.usual = UsualHead(model.options.boundaries.ageYears);
        const AffineTransform toRas = lpsToFrame(CoordinateFrame::Ras, {});
        std::vector<Warning> warnings;
        for (HeadNote& note : judgePlausibility(model.meshes, options)) {
            std::string subject = bemSurfaceName(note.surface, model.meshes.size());
            if (note.next) subject += " in " + bemSurfaceName(*note.next, model.meshes.size());
            ReportedNote reported{std::move(note), std::move(subject), CoordinateFrame::Ras, {}};
            reported.isWarned = reported.note.isNoted && !reported.note.warning.empty();
            for (const Vec3& p : reported.note.pointsMm) reported.placesMm.push_back(toRas(p));
            const std::string finding = reported.subject + ": " + reported.note.finding;
            if (reported.note.isImpossible) {
                model.findings.push_back({finding + "; no head has such a " +
                                              std::string(reported.note.name) +
                                              ": are the surfaces, or the voxels' size, right?",
                                          reported.note.pointsMm.front()});
            } else if (reported.isWarned) {
                warnings.push_back({std::string(reported.note.warning),
                                    finding + ", at " + rasText(reported.note.pointsMm.front())});
            }
            model.plausibility.push_back(std::move(reported));
        }
        if (model.hasModel()) addWarnings(model.warnings, warnings, "");  // else beside the point
    });
}

}  // namespace adaptiso
