#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Numbers.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/Pipeline/BemChecks.h"
#include "adaptiso/Pipeline/BemFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// How far a vertex may lie from where it was: float's rounding at 500 mm from the origin, with
/// room; an error of frame or unit is larger by far.
constexpr double kRoundingMm = 1e-3;

struct FileKind {
    const char* extension;
    CoordinateFrame frame;
    double unitMm;
};

std::vector<FileKind> writtenKinds(const BemModel& model, const BemFileOptions& options) {
    std::vector<FileKind> kinds{
        {".surf", model.tkRasVolume ? CoordinateFrame::TkRas : CoordinateFrame::Ras, 1},
        {".tri", options.frame, options.unit == OpenMeegUnit::Metres ? 1000.0 : 1.0}};
    if (options.writesGifti) kinds.push_back({".gii", options.frame, 1});
    if (options.writesVtp) kinds.push_back({".vtp", options.frame, 1});
    return kinds;
}

double farthestMm(const TriangleMesh& a, const TriangleMesh& b) {
    if (a.points.size() != b.points.size() || a.triangles != b.triangles) {
        return std::numeric_limits<double>::infinity();
    }
    double farthest = 0;
    for (std::size_t v = 0; v < a.points.size(); ++v) {
        const double mm = norm(a.points[v] - b.points[v]);
        if (!(mm <= farthest)) farthest = mm;
    }
    return farthest;
}

/// Files of one kind: the same answers as of the model, and the same places.
void checkKind(const FileKind& kind, const fs::path& folder, BemModel& model) {
    const std::vector<TriangleMesh>& surfaces = model.meshes;
    // to LPS, for the places of findings; tkRAS and scanner RAS of a file are told by the frame
    const AffineTransform toLps = inverse(lpsToFrame(kind.frame, model.tkRasVolume));
    std::vector<TriangleMesh> stored;
    double farthest = 0;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        stored.push_back(readMesh(folder / bemFileName(n, kind.extension)).mesh);
        for (Vec3& p : stored.back().points) p = kind.unitMm * p;
        farthest = std::max(farthest, farthestMm(transformed(stored.back(), toLps), surfaces[n]));
    }
    const ModelChecks asked = askOfModel(stored, model.options.minGapsMm());
    const auto broken =
        std::find_if(asked.checks.begin(), asked.checks.end(),
                     [](const ModelCheck& answer) { return answer.check.breaksProfile(); });
    const bool isSame = farthest <= kRoundingMm;
    BemCheck check{std::string("*") + kind.extension + ": the same when read back", true, "", {}};
    if (broken != asked.checks.end()) {
        check.isPassed = false;
        check.detail = broken->subject + ": " + std::string(broken->check.name) + ": " +
                       broken->check.finding + " (in the file's coordinates)";
        check.pointMm = toLps(broken->pointMm);
    } else if (!isSame) {
        check.isPassed = false;
        check.detail = "a vertex lies " + formatNumber(farthest) + " mm from where it should";
        check.pointMm = surfaces.front().points.front();
    }
    if (!check.isPassed) {
        model.findings.push_back({check.name + ": " + check.detail, *check.pointMm});
    }
    model.checks.push_back(std::move(check));
}

}  // namespace

void checkBemFiles(const fs::path& folder, const BemFileOptions& options, BemModel& model) {
    for (const FileKind& kind : writtenKinds(model, options)) checkKind(kind, folder, model);
    readOpenMeegModel(folder / "model.geom", folder / "model.cond");  // throws where a rule breaks
    model.checks.push_back({"model.geom, model.cond: keep OpenMEEG's rules", true, "", {}});
}

}  // namespace adaptiso
