#include "adaptiso/Pipeline/BemFiles.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "BemFileKinds.h"
#include "BemReadme.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

void writeText(const fs::path& path, const std::string& text) {
    errno = 0;
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (file) return;
    throw FileError(path.string() + ": can't be written" +
                    (errno == 0 ? std::string() : std::string(": ") + std::strerror(errno)));
}

}  // namespace

std::vector<std::string> bemFileNames() {
    std::vector<std::string> names{"model.geom",   "model.cond",    "report.json",
                                   "spots.png",    "README.md",     kFiffModel,
                                   kFiffDenseHead, kFiffSparseHead, kFieldTripFile};
    for (std::size_t n = 0; n < kHeadSurfaceCount; ++n) {
        const HeadSurface surface = headSurface(n, kHeadSurfaceCount);
        for (const char* extension : {".surf", ".tri", ".gii", ".vtp"}) {
            names.push_back(bemFileName(surface, extension));
        }
        for (std::string& name :
             std::array{simNibsName(surface), brainstormName(surface), curryName(surface)}) {
            names.push_back(std::move(name));
        }
    }
    return names;
}

std::string bemFileName(HeadSurface surface, const char* extension) {
    return std::string(toString(surface)) + extension;
}

void writeBemFiles(const BemModel& model, const BemFileOptions& options, const std::string& maker,
                   const std::function<fs::path(const std::string&)>& place) {
    std::vector<std::string> triangleFiles;
    for (std::size_t n = 0; n < model.meshes.size(); ++n) {
        triangleFiles.push_back(bemFileName(headSurface(n, model.meshes.size()), ".tri"));
    }
    for (const BemFileKind& kind : bemFileKinds(model, options)) kind.write(place);
    writeText(place("model.geom"), openMeegGeometry(triangleFiles));
    writeText(place("model.cond"),
              openMeegConductivities(model.meshes.size(), model.options.conductivities));
    writeText(place("README.md"), bemReadme(model, options, maker));
}

}  // namespace adaptiso
