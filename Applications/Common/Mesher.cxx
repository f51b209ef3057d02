#include "Common/Mesher.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "Common/ChildProcess.h"
#include "Common/OptionValues.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void run(const std::string& mesher, const std::vector<std::string>& arguments,
         const ScratchFolder& folder, const char* result) {
    const ChildResult done = runChild(mesher, arguments, folder.path());
    std::error_code error;
    if (done.isGood() && fs::file_size(folder.path() / result, error) > 0 && !error) return;
    throw FileError(mesher + ": made no tetrahedra (" + done.reason() +
                    "); try another element size, or the other mesher");
}

TetrahedralMesh byTetgen(const MesherInput& input, double elementMm) {
    ScratchFolder folder;
    writeText(folder.place("head.poly"), tetgenInput(input, elementMm));
    const fs::path nodes = folder.place("head.1.node"), elements = folder.place("head.1.ele");
    for (const char* name : {"head.1.face", "head.1.edge", "head.1.smesh"}) folder.place(name);
    // radius by shortest edge 1.4 and dihedral angles of 10 degrees where the walls allow them
    run("tetgen", {"-pq1.4/10aAQ", "head.poly"}, folder, "head.1.ele");
    return decodeTetgen(bytesOf(nodes), bytesOf(elements), "tetgen");
}

TetrahedralMesh byGmsh(const MesherInput& input, double elementMm) {
    ScratchFolder folder;
    writeText(folder.place("walls.msh"), gmshWalls(input));
    writeText(folder.place("head.geo"), gmshScript(input, "walls.msh", elementMm));
    const fs::path made = folder.place("head.msh");
    run("gmsh", {"-3", "-nt", "1", "-format", "msh22", "-o", "head.msh", "head.geo"}, folder,
        "head.msh");
    return decodeGmsh(bytesOf(made), "gmsh");
}

}  // namespace

void declareMesherOptions(CLI::App& app, MesherOptions& options, const std::string& files,
                          const char* heading) {
    const OptionGroup group(app, heading);
    group.choice<std::string>(
        "--tetrahedra", options.mesher, {{"tetgen", "tetgen"}, {"gmsh", "gmsh"}},
        "Fill the space between the walls with tetrahedra by this program, which "
        "must be installed: " +
            files);
    group.number(
        "--element-size", "MM", options.elementMm, {.least = 0.5, .most = 50, .unit = "mm"},
        "Longest edge of an equilateral tetrahedron (default: 5); at the walls elements are "
        "as small as their triangles");
}

void requireMesher(const MesherOptions& options) {
    if (!options.isAsked()) return;
    temporaryFolder();  // there must be one
    if (isInstalled(options.mesher)) return;
    throw FileError("--tetrahedra " + options.mesher + ": " + options.mesher +
                    " is not installed; on Debian: apt install " + options.mesher);
}

TetrahedralMesh runMesher(const MesherInput& input, const MesherOptions& options) {
    return options.mesher == "tetgen" ? byTetgen(input, options.elementMm)
                                      : byGmsh(input, options.elementMm);
}

}  // namespace adaptiso
