#include "adaptiso/Report/Pictures.h"

#include "Scene.h"
#include "SlicePictures.h"
#include "SurfacePictures.h"

namespace adaptiso {

std::vector<Picture> drawPictures(const Report& report) {
    std::vector<Picture> pictures;
    const auto add = [&](std::optional<Picture> picture) {
        if (picture) pictures.push_back(std::move(*picture));
    };
    const Scene scene = makeScene(report);
    if (!scene.isEmpty() && (!scene.face || scene.hasTriangles())) {
        add(spotPicture(report, scene));
        for (const int axis : {2, 1, 0}) add(contourPicture(report, scene, axis));
        if (report.areRegions) {
            add(regionsPicture(scene));
        } else {
            for (std::size_t n = 0; n < scene.surfaces.size(); ++n) add(sixSidesPicture(scene, n));
        }
    }
    return pictures;
}

}  // namespace adaptiso
