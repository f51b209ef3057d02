#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "PageParts.h"
#include "Scene.h"
#include "Support/Meshes.h"

namespace adaptiso {
namespace {

/// A head of 190 x 150 x 180 mm round the origin (RAS), with or without a nose at (0, 105, -40), in
/// an image of 2 mm whose border is `topMm` above the origin.
struct Head {
    Head(bool hasNose, double topMm) {
        geometry.size = {100, 125, static_cast<std::int64_t>((topMm + 100) / 2)};
        geometry.indexToPhysical = Mat3::diagonal(-2, -2, 2);  // RAS
        geometry.originMm = lpsToRas({-99, -110, -100});
        std::vector<std::uint8_t> samples;
        for (std::int64_t k = 0; k < geometry.size[2]; ++k) {
            for (std::int64_t j = 0; j < geometry.size[1]; ++j) {
                for (std::int64_t i = 0; i < geometry.size[0]; ++i) {
                    const Vec3 p = lpsToRas(geometry.toPhysical({double(i), double(j), double(k)}));
                    const bool isHead = std::hypot(p.x / 75, p.y / 95, p.z / 90) < 1 ||
                                        (hasNose && norm(p - Vec3{0, 95, -40}) < 15);
                    samples.push_back(isHead ? 100 : 0);
                }
            }
        }
        image = Volume::fromSamples(std::move(samples), geometry);
        report.volume = ReportVolume{"head", image->view()};
        report.leavesOutFaces = true;
    }

    ImageGeometry geometry;
    std::optional<Volume> image;
    Report report;
};

TEST(FaceCut, LeavesNothingOfTheFaceInTheImage) {
    const Head nose(true, 100), none(false, 100);
    const Scene a = makeScene(nose.report), b = makeScene(none.report);
    EXPECT_FALSE(a.face->hidesAll());
    EXPECT_TRUE(a.face->hides({0, 105, -40}));
    EXPECT_FALSE(a.face->hides({0, 0, 60}));
    EXPECT_FALSE(a.face->hides({0, -90, 0}));
    // heads that differ in the face alone give the same bytes
    EXPECT_NE(niftiOf(nose.image->view(), 8'000'000), niftiOf(none.image->view(), 8'000'000));
    EXPECT_EQ(niftiOf(nose.image->view(), 8'000'000, a.face.get()),
              niftiOf(none.image->view(), 8'000'000, b.face.get()));
}

TEST(FaceCut, HidesAllWhereTheTopIsCutOff) {
    const Head cut(true, 40);
    const Scene scene = makeScene(cut.report);
    EXPECT_TRUE(scene.face->hidesAll());
    EXPECT_TRUE(scene.face->hides({0, 0, 0}));
}

TEST(FaceCut, SurfacesEndWhereTheFaceBegins) {
    Head head(true, 100);
    head.report.surfaces.push_back({"skin", testing::icosphere(5, {}, 88)});
    head.report.surfaces.push_back({"brain", testing::icosphere(4, {}, 60)});
    head.report.surfaces.back().isWithinSkull = true;
    const Scene scene = makeScene(head.report);
    EXPECT_LT(scene.surfaces[0].mesh.triangleCount(), 20'480);
    EXPECT_GT(scene.surfaces[0].mesh.triangleCount(), 5'000);
    scene.surfaces[0].mesh.forEachTriangle([&](const Triangle& t) {
        for (const VertexId v : t) EXPECT_FALSE(scene.face->hides(scene.surfaces[0].mesh.point(v)));
    });
    EXPECT_EQ(scene.surfaces[1].mesh.triangleCount(), 5'120);
    EXPECT_FALSE(scene.face->hides({0, 40, -40}));  // in the brain
}

TEST(FaceCut, WithoutAHeadNothingIsShown) {
    Report report;
    report.leavesOutFaces = true;
    report.surfaces.push_back({"ball", testing::icosphere(3, {}, 10)});
    const Scene scene = makeScene(report);
    EXPECT_TRUE(scene.face->hidesAll());
    EXPECT_FALSE(scene.hasTriangles());
}

}  // namespace
}  // namespace adaptiso
