#include <algorithm>
#include <cmath>
#include <limits>

#include "BemFileKinds.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/HeadPipeline/BemChecks.h"
#include "adaptiso/HeadPipeline/BemFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// How far a vertex may lie from where it was: float's rounding at 500 mm from the origin, with
/// room; an error of frame or unit is larger by far.
constexpr double kRoundingMm = 1e-3;

/// Between corners of the same triangles: STL files number vertices anew.
double farthestMm(const TriangleMesh& a, const TriangleMesh& b) {
    if (a.points.size() != b.points.size() || a.triangles.size() != b.triangles.size()) {
        return std::numeric_limits<double>::infinity();
    }
    double farthest = 0;
    for (std::size_t t = 0; t < a.triangles.size(); ++t) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const double mm =
                norm(a.points[a.triangles[t][corner]] - b.points[b.triangles[t][corner]]);
            if (!(mm <= farthest)) farthest = mm;
        }
    }
    return farthest;
}

/// Files of one kind: the same answers as of the model, and the same places.
void checkKind(const BemFileKind& kind, const fs::path& folder, BemModel& model) {
    const AffineTransform toLps = inverse(kind.fromLps);
    std::vector<TriangleMesh> stored = kind.read(folder);
    double farthest =
        stored.size() == kind.meshes.size() ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < stored.size() && farthest <= kRoundingMm; ++n) {
        for (Vec3& p : stored[n].points) p = kind.unitMm * p;
        farthest = std::max(farthest, farthestMm(transformed(stored[n], toLps), *kind.meshes[n]));
    }
    BemCheck check{kind.name + ": the same when read back", true, "", {}};
    if (!(farthest <= kRoundingMm)) {
        check.isPassed = false;
        check.detail = "a vertex lies " + formatNumber(farthest) + " mm from where it should";
        check.pointMm = model.meshes.front().points.front();
    } else if (kind.keepsPromises) {
        const ModelChecks asked = askOfModel(stored, kind.gapsMm);
        const auto broken =
            std::find_if(asked.checks.begin(), asked.checks.end(),
                         [](const ModelCheck& answer) { return answer.check.breaksProfile(); });
        if (broken != asked.checks.end()) {
            check.isPassed = false;
            check.detail = broken->subject + ": " + std::string(broken->check.name) + ": " +
                           broken->check.finding + " (in the file's coordinates)";
            check.pointMm = toLps(broken->pointMm);
        }
    }
    if (!check.isPassed) {
        model.findings.push_back({check.name + ": " + check.detail, *check.pointMm});
    }
    model.checks.push_back(std::move(check));
}

}  // namespace

void checkBemFiles(const fs::path& folder, const BemFileOptions& options, BemModel& model) {
    for (const BemFileKind& kind : bemFileKinds(model, options)) checkKind(kind, folder, model);
    readOpenMeegModel(folder / "model.geom", folder / "model.cond");  // throws where a rule breaks
    model.checks.push_back({"model.geom, model.cond: keep OpenMEEG's rules", true, "", {}});
}

}  // namespace adaptiso
