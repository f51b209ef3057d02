#include "Common/Mesher.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
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

}  // namespace

void declareMesherOptions(CLI::App& app, MesherOptions& options, const std::string& files,
                          const char* heading) {
    const OptionGroup group(app, heading);
    group.choice<std::string>(
        "--tetrahedra", options.mesher, {{"tetgen", "tetgen"}, {"gmsh", "gmsh"}},
        "Fill the space between the walls with tetrahedra by this program, which "
        "must be installed: " +
            files);
    group.rows(elementOptions(), options);
}

void requireMesher(const MesherOptions& options) {
    if (!options.isRequested()) return;
    temporaryFolder();  // there must be one
    if (isInstalled(options.mesher)) return;
    throw FileError("--tetrahedra " + options.mesher + ": " + options.mesher +
                    " is not installed; on Debian: apt install " + options.mesher);
}

TetrahedralMesh runMesher(const MesherInput& input, const MesherOptions& options) {
    const MesherRun run = mesherRun(input, options);
    ScratchFolder folder;
    for (const auto& [name, text] : run.inputs) writeText(folder.place(name), text);
    for (const auto* names : {&run.results, &run.others}) {
        for (const std::string& name : *names) folder.place(name);
    }
    const ChildResult done = runChild(run.program, run.arguments, folder.path());
    std::vector<std::string> results;
    for (const std::string& name : run.results) results.push_back(bytesOf(folder.path() / name));
    const bool isMade = done.isGood() && !results.back().empty();
    return mesherResult(run.program, results, isMade ? std::nullopt : std::optional(done.reason()));
}

}  // namespace adaptiso
