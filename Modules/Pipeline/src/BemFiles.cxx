#include "adaptiso/Pipeline/BemFiles.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "BemReadme.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/ExportFreeSurfer.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::optional<ImageGeometry> volumeOf(CoordinateFrame frame, const BemModel& model) {
    return frame == CoordinateFrame::TkRas ? model.tkRasVolume : std::nullopt;
}

void writeGeneral(const TriangleMesh& surface, const fs::path& path, const BemModel& model,
                  const BemFileOptions& options) {
    MeshWriteOptions write;
    write.frame = options.frame;
    write.volume = volumeOf(write.frame, model);
    writeMesh(surface, path, write);
}

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

std::vector<std::string_view> bemFileNames() {
    return {"inner_skull.surf", "outer_skull.surf", "outer_skin.surf", "inner_skull.tri",
            "outer_skull.tri",  "outer_skin.tri",   "inner_skull.gii", "outer_skull.gii",
            "outer_skin.gii",   "inner_skull.vtp",  "outer_skull.vtp", "outer_skin.vtp",
            "model.geom",       "model.cond",       "report.json",     "spots.png",
            "README.md"};
}

std::string bemFileName(std::size_t surface, const char* extension) {
    return bemSurfaceName(surface) + extension;
}

void writeBemFiles(const BemModel& model, const BemFileOptions& options, const std::string& maker,
                   const std::function<fs::path(const std::string&)>& place) {
    std::vector<std::string> triangleFiles;
    for (std::size_t n = 0; n < model.meshes.size(); ++n) {
        const TriangleMesh& mesh = model.meshes[n];
        writeFreeSurferSurface(mesh, place(bemFileName(n, ".surf")), model.tkRasVolume,
                               model.tkRasName);
        triangleFiles.push_back(bemFileName(n, ".tri"));
        writeOpenMeegSurface(mesh, place(triangleFiles.back()), options.frame, options.unit,
                             volumeOf(options.frame, model));
        if (options.writesGifti) {
            writeGeneral(mesh, place(bemFileName(n, ".gii")), model, options);
        }
        if (options.writesVtp) {
            writeGeneral(mesh, place(bemFileName(n, ".vtp")), model, options);
        }
    }
    writeText(place("model.geom"), openMeegGeometry(triangleFiles));
    writeText(place("model.cond"),
              openMeegConductivities(model.meshes.size(), model.options.conductivities));
    writeText(place("README.md"), bemReadme(model, options, maker));
}

}  // namespace adaptiso
