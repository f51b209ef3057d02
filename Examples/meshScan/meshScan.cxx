// meshScan IMAGE MESH: the surface between dark and bright (Otsu's isovalue) of a scan.
#include <cstdio>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/ImageIO/SampleStatistics.h"
#include "adaptiso/MeshIO/MeshFile.h"

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fputs("usage: meshScan IMAGE MESH\n", stderr);
        return 2;
    }
    try {
        const adaptiso::ReadVolume scan = adaptiso::readVolume(argv[1]);
        for (const adaptiso::Warning& warning : scan.warnings) {
            std::fprintf(stderr, "meshScan: warning: %s\n", warning.text.c_str());
        }
        const adaptiso::VolumeView& volume = scan.volume.view();
        adaptiso::ExtractionOptions options;
        options.isovalue = adaptiso::otsuThreshold(volume);
        const adaptiso::TriangleMesh all = adaptiso::extractSurface(volume, options).mesh;
        const adaptiso::TriangleMesh mesh = adaptiso::selectComponents(all, {.largestOnly = true});

        adaptiso::writeMesh(mesh, argv[2]);  // scanner RAS, the format by the name
        std::printf("%zu triangles at %g\n", mesh.triangles.size(), options.isovalue);
        return 0;
    } catch (const adaptiso::Error& error) {
        std::fprintf(stderr, "meshScan: %s\n", error.what());
        return 3;
    }
}
