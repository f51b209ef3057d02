#include "ModelFiles.h"

#include <algorithm>

#include "ModelReadme.h"
#include "adaptiso/HeadModel/ExportFreeSurfer.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::optional<ImageGeometry> volumeOf(CoordinateFrame frame, const BemRun& run) {
    return frame == CoordinateFrame::TkRas ? run.tkRasVolume : std::nullopt;
}

void writeGeneral(const TriangleMesh& surface, const fs::path& path, const BemRun& run) {
    MeshWriteOptions write;
    write.frame = run.options.frame;
    write.volume = volumeOf(write.frame, run);
    writeMesh(surface, path, write);
}

}  // namespace

std::string fileName(std::size_t surface, const char* extension) {
    return std::string(toString(static_cast<HeadSurface>(surface))) + extension;
}

std::vector<std::string_view> modelFileNames() {
    return {"inner_skull.surf", "outer_skull.surf", "outer_skin.surf", "inner_skull.tri",
            "outer_skull.tri",  "outer_skin.tri",   "inner_skull.gii", "outer_skull.gii",
            "outer_skin.gii",   "inner_skull.vtp",  "outer_skull.vtp", "outer_skin.vtp",
            "model.geom",       "model.cond",       "report.json",     "spots.png",
            "README.md"};
}

std::vector<fs::path> subjectPaths(const BemOptions& options) {
    std::vector<fs::path> paths;
    if (options.subject.empty()) return paths;
    for (std::size_t n = 0; n < options.surfaceCount(); ++n) {
        paths.push_back(options.subjectsDir / options.subject / "bem" / fileName(n, ".surf"));
    }
    return paths;
}

void writeModel(const std::vector<TriangleMesh>& surfaces, BemRun& run, AtomicFolder& folder) {
    const BemOptions& options = run.options;
    folder.fill([&] {
        std::vector<std::string> triangleFiles;
        for (std::size_t n = 0; n < surfaces.size(); ++n) {
            writeFreeSurferSurface(surfaces[n], folder.place(fileName(n, ".surf")), run.tkRasVolume,
                                   run.tkRasName);
            triangleFiles.push_back(fileName(n, ".tri"));
            writeOpenMeegSurface(surfaces[n], folder.place(triangleFiles.back()), options.frame,
                                 options.unit, volumeOf(options.frame, run));
            if (options.writesGifti) {
                writeGeneral(surfaces[n], folder.place(fileName(n, ".gii")), run);
            }
            if (options.writesVtp) {
                writeGeneral(surfaces[n], folder.place(fileName(n, ".vtp")), run);
            }
        }
        folder.writeText("model.geom", openMeegGeometry(triangleFiles));
        folder.writeText("model.cond",
                         openMeegConductivities(surfaces.size(), options.conductivities));
        folder.writeText("README.md", modelReadme(run));
    });
    run.files = folder.files();
}

std::vector<AtomicOutput> writeSubject(const std::vector<TriangleMesh>& surfaces, BemRun& run) {
    std::vector<AtomicOutput> outputs;
    run.subjectFiles = subjectPaths(run.options);
    for (std::size_t n = 0; n < run.subjectFiles.size(); ++n) {
        outputs.emplace_back(run.subjectFiles[n]).write([&](const fs::path& path) {
            writeFreeSurferSurface(surfaces[n], path, run.tkRasVolume, run.tkRasName);
        });
    }
    return outputs;
}

}  // namespace adaptiso
