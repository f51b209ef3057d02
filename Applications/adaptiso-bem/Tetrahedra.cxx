#include "Tetrahedra.h"

#include <fstream>
#include <iterator>
#include <utility>

#include "Common/ToolProcess.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Numbers.h"
#include "adaptiso/HeadModel/Tetrahedra.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void runMesher(const std::string& mesher, const std::vector<std::string>& arguments,
               const fs::path& folder, const fs::path& result) {
    const ToolResult done = runTool(mesher, arguments, folder);
    std::error_code error;
    if (done.isGood() && fs::file_size(result, error) > 0 && !error) return;
    throw FileError(mesher + ": made no tetrahedra (" + done.reason() +
                    "); try another element size, or the other mesher");
}

TetrahedralMesh byTetgen(const BemModel& model, double elementMm, const fs::path& folder) {
    std::ofstream(folder / "head.poly", std::ios::binary) << tetgenInput(model.meshes, elementMm);
    runMesher("tetgen", {"-pq1.4/10aAQ", "head.poly"}, folder, folder / "head.1.ele");
    return decodeTetgen(bytesOf(folder / "head.1.node"), bytesOf(folder / "head.1.ele"), "tetgen");
}

TetrahedralMesh byGmsh(const BemModel& model, double elementMm, const fs::path& folder) {
    std::vector<std::string> files;
    for (const TriangleMesh& mesh : model.meshes) {
        files.push_back("surface" + std::to_string(files.size() + 1) + ".stl");
        writeMesh(mesh, folder / files.back(), {CoordinateFrame::Lps, {}, "", {}});
    }
    std::ofstream(folder / "head.geo", std::ios::binary) << gmshInput(files, elementMm);
    runMesher("gmsh", {"-3", "-nt", "1", "-format", "msh22", "-o", "head.msh", "head.geo"}, folder,
              folder / "head.msh");
    return decodeGmsh(bytesOf(folder / "head.msh"), "gmsh");
}

void addCheck(BemModel& model, const std::string& name, bool isPassed, const std::string& detail) {
    model.checks.push_back({"tetrahedra: " + name, isPassed, detail, {}});
    if (isPassed) return;
    const Vec3 place = model.meshes.front().points.front();
    model.checks.back().pointMm = place;
    model.findings.push_back({"tetrahedra: " + name + ": " + detail, place});
}

void check(BemModel& model) {
    const TetrahedraReport& report = model.tetrahedra->report;
    addCheck(model, "each of a tissue", report.unlabelled == 0,
             formatCount(report.unlabelled) + " have none");
    addCheck(model, "none flat or inverted", report.flat == 0, formatCount(report.flat) + " are");
    for (std::size_t n = 0; n < report.counts.size(); ++n) {
        // meshers keep the surfaces: what they round is far below
        constexpr double kShare = 1e-4;
        const double off = std::abs(report.volumesMm3[n] - report.expectedMm3[n]);
        addCheck(model,
                 "volume within " + bemSurfaceName(n, report.counts.size()) +
                     (n > 0 ? " as between the surfaces" : " as the surface's"),
                 report.counts[n] > 0 && off <= kShare * report.expectedMm3[n],
                 formatFixed(report.volumesMm3[n] / 1000, 2) + " cm3, must be " +
                     formatFixed(report.expectedMm3[n] / 1000, 2));
    }
    model.notes.push_back(
        "tetrahedra: " + formatCount(std::ssize(model.tetrahedra->mesh.tetrahedra)) + " of " +
        formatCount(std::ssize(model.tetrahedra->mesh.points)) + " points by " +
        model.tetrahedra->mesher + "; least dihedral angle " +
        formatFixed(report.leastDihedralDeg, 1) + " deg (5 % below " +
        formatFixed(report.p5DihedralDeg, 1) + "), radius by shortest edge up to " +
        formatFixed(report.mostRadiusEdge, 1) + " (95 % below " +
        formatFixed(report.p95RadiusEdge, 2) + ")");
}

}  // namespace

void requireMesher(const std::string& mesher) {
    if (mesher.empty() || isInstalled(mesher)) return;
    throw FileError("--tetrahedra " + mesher + ": " + mesher +
                    " is not installed; on Debian: apt install " + mesher);
}

void makeTetrahedra(BemRun& run, const BemHooks& hooks) {
    BemModel& model = run.model;
    hooks.stage("tetrahedra", [&] {
        const ScratchFolder folder;
        BemTetrahedra made;
        made.mesher = run.options.mesher;
        made.mesh = made.mesher == "tetgen" ? byTetgen(model, run.options.elementMm, folder.path())
                                            : byGmsh(model, run.options.elementMm, folder.path());
        made.report = checkTetrahedra(made.mesh, model.meshes);
        model.tetrahedra = std::move(made);
        check(model);
    });
}

}  // namespace adaptiso
