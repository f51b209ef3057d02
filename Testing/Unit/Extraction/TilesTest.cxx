#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <tuple>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"

namespace adaptiso::testing {
namespace {

using Place = std::tuple<double, double, double>;

Place placeOf(const Vec3& p) {
    return {p.x, p.y, p.z};
}

void forEachTile(const Index3& counts, const std::function<void(const Index3&)>& f) {
    for (std::int64_t z = 0; z < counts[2]; ++z) {
        for (std::int64_t y = 0; y < counts[1]; ++y) {
            for (std::int64_t x = 0; x < counts[0]; ++x) f({x, y, z});
        }
    }
}

/// Calls f(window, index of its first sample) with a window of the volume that holds no more than
/// what the tile needs.
template <class F>
auto inWindow(const Volume& volume, const TileCut& cut, const Index3& tile, const F& f) {
    const IndexBox box = cut.samplesOf(tile);
    return dispatchPixelType(volume, [&]<class T>(const TypedVolumeView<T>& view) {
        std::vector<T> samples;
        for (std::int64_t k = box.first[2]; k < box.end[2]; ++k) {
            for (std::int64_t j = box.first[1]; j < box.end[1]; ++j) {
                for (std::int64_t i = box.first[0]; i < box.end[0]; ++i) {
                    samples.push_back(view.at(i, j, k));
                }
            }
        }
        ImageGeometry place;
        place.size = box.size();
        return f(Volume::fromSamples(std::move(samples), place), box.first);
    });
}

TriangleMesh tileOf(const Volume& volume, double isovalue, const TileCut& cut, const Index3& tile) {
    return inWindow(volume, cut, tile, [&](const Volume& window, const Index3& first) {
        return extractTile(window, first, volume.view().geometry(), isovalue, cut, tile);
    });
}

SimplifiedPart simplifiedTileOf(const Volume& volume, double isovalue, const TileCut& cut,
                                const Index3& tile, double maxErrorMm) {
    return inWindow(volume, cut, tile, [&](const Volume& window, const Index3& first) {
        return extractSimplifiedTile(window, first, volume.view().geometry(), isovalue, cut, tile,
                                     maxErrorMm, false);
    });
}

/// Adds a piece to a mesh; points with equal bits are one.
class Union {
public:
    void add(const TriangleMesh& piece) {
        for (const Triangle& t : piece.triangles) {
            Triangle named;
            for (int c = 0; c < 3; ++c) {
                const Vec3& p = piece.points[t[c]];
                const auto [at, isNew] = number_.try_emplace(placeOf(p), std::ssize(mesh.points));
                if (isNew) {
                    mesh.points.push_back(p);
                    mesh.normals.push_back(piece.normals[t[c]]);
                }
                named[c] = at->second;
            }
            mesh.triangles.push_back(named);
        }
    }
    TriangleMesh mesh;

private:
    std::map<Place, VertexId> number_;
};

/// The triangles by their corners' places, so that the order of neither shows.
std::multiset<std::array<Place, 3>> namesOf(const TriangleMesh& mesh) {
    std::multiset<std::array<Place, 3>> names;
    for (const Triangle& t : mesh.triangles) {
        std::array<Place, 3> corners{placeOf(mesh.points[t[0]]), placeOf(mesh.points[t[1]]),
                                     placeOf(mesh.points[t[2]])};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                    corners.end());
        names.insert(corners);
    }
    return names;
}

TriangleMesh wholeOfTiles(const Volume& volume, double isovalue, std::int64_t side) {
    const TileCut cut(volume.view().geometry().size, side);
    Union whole;
    forEachTile(cut.tiles(),
                [&](const Index3& tile) { whole.add(tileOf(volume, isovalue, cut, tile)); });
    return physicalMesh(whole.mesh, volume.view().geometry());
}

/// The edges of the open border, by their ends' places and normals.
auto bordersOf(const TriangleMesh& mesh) {
    std::set<std::array<Place, 4>> borders;
    for (const auto& [a, b] : borderOf(mesh).edges) {
        const Normal &m = mesh.normals[a], &n = mesh.normals[b];
        borders.insert({placeOf(mesh.points[a]), placeOf(mesh.points[b]), Place{m.x, m.y, m.z},
                        Place{n.x, n.y, n.z}});
    }
    return borders;
}

/// Both passes, as adaptiso-giant makes them.
TriangleMesh adaptiveOfTiles(const Volume& volume, double isovalue, std::int64_t side,
                             double maxErrorMm) {
    const ImageGeometry& geometry = volume.view().geometry();
    const TileCut cut(geometry.size, side);

    Union first;
    forEachTile(cut.tiles(), [&](const Index3& tile) {
        const SimplifiedPart part = simplifiedTileOf(volume, isovalue, cut, tile, maxErrorMm / 2);
        EXPECT_EQ(bordersOf(part.mesh), bordersOf(tileOf(volume, isovalue, cut, tile)));
        EXPECT_FALSE(part.isUnchanged);
        EXPECT_LE(part.errorBoundMm, maxErrorMm / 2);
        first.add(part.mesh);
    });
    expectSound(physicalMesh(first.mesh, geometry));
    Union second;
    forEachTile(cut.seams(), [&](const Index3& seam) {
        const SeamPart part = seamPartOf(first.mesh, cut, seam);
        const SimplifiedPart made =
            simplifyInBox(part.mesh, part.isFixed, geometry, cut.seamBox(seam), maxErrorMm / 2);
        EXPECT_FALSE(made.isUnchanged);
        second.add(ownTriangles(made, cut, seam));
    });
    return physicalMesh(second.mesh, geometry);
}

}  // namespace

TEST(Tiles, CoverEveryCellOnce) {
    const TileCut cut({100, 47, 17}, 32);
    EXPECT_EQ(cut.tiles(), (Index3{4, 2, 2}));
    for (int a = 0; a < 3; ++a) {
        std::int64_t next = -1;
        for (std::int64_t t = 0; t < cut.tiles()[a]; ++t) {
            Index3 tile{0, 0, 0};
            tile[a] = t;
            EXPECT_EQ(cut.cellsOf(tile).first[a], next);
            next = cut.cellsOf(tile).end[a];
        }
        EXPECT_EQ(next, cut.imageSize()[a]);
    }
    EXPECT_THROW(TileCut({10, 10, 10}, 33), InvalidInput);
    EXPECT_THROW(TileCut({10, 10, 10}, 0), InvalidInput);
    EXPECT_THROW(TileCut({26001, 10, 10}, 64), InvalidInput);
}

TEST(Tiles, SeamBoxesHoldEachPlaceOnce) {
    const TileCut cut({100, 47, 17}, 32);
    EXPECT_EQ(cut.seams(), (Index3{3, 1, 1}));
    for (double x = -1; x <= 100; x += 0.25) {
        const Index3 seam = cut.seamAt({x, 3, 3});
        const BoundingBox box = cut.seamBox(seam);
        EXPECT_TRUE(x >= box.minimum.x && x < box.maximum.x) << x;
        const IndexBox tiles = cut.tilesOfSeam(seam);
        const BoundingBox first = cut.boxOf(tiles.first);
        Index3 lastTile{tiles.end[0] - 1, tiles.end[1] - 1, tiles.end[2] - 1};
        EXPECT_GE(x, first.minimum.x);
        EXPECT_LE(x, cut.boxOf(lastTile).maximum.x);
    }
}

TEST(Tiles, MakeTheSurfaceOfTheWholeVolume) {
    const ImageGeometry geometries[] = {obliqueGeometry({70, 50, 40}, {0.7, 1.1, 2}),
                                        mirroredGeometry({70, 50, 40}, {1, 1, 1}),
                                        shearedGeometry({70, 50, 40}, {1, 1, 1.5})};
    for (const ImageGeometry& geometry : geometries) {
        // reaches the volume's border, across tile walls
        const AnalyticVolume ball = sampled<float>(sphere({3, -2, 4}, 24), geometry);
        const TriangleMesh one =
            extractFrom(ball.volume, ball.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
        const TriangleMesh tiles = wholeOfTiles(ball.volume, ball.isovalue, 32);
        ASSERT_GT(one.triangles.size(), 1000u);
        EXPECT_EQ(tiles.points.size(), one.points.size());
        EXPECT_EQ(namesOf(tiles), namesOf(one));
        expectSound(tiles);
    }
}

TEST(Tiles, MakeTheSurfaceOfNoiseToo) {
    // every ambiguous case, values equal to the isovalue, fans on walls
    for (const int values : {2, 3, 5}) {
        const Volume noise = randomVolume<std::uint8_t>({37, 36, 51}, values, 11);
        const double isovalue = values == 2 ? 0.5 : 1;
        const TriangleMesh one =
            extractFrom(noise, isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
        const TriangleMesh tiles = wholeOfTiles(noise, isovalue, 32);
        EXPECT_EQ(tiles.points.size(), one.points.size());
        EXPECT_EQ(namesOf(tiles), namesOf(one));
    }
}

TEST(Tiles, NormalsAreThoseOfTheWholeVolume) {
    const AnalyticVolume ball =
        sampled<double>(sphere({}, 20), obliqueGeometry({50, 50, 50}, {1, 1.2, 0.9}));
    const TriangleMesh one =
        extractFrom(ball.volume, ball.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
    const TriangleMesh tiles = wholeOfTiles(ball.volume, ball.isovalue, 32);
    std::map<Place, Normal> at;
    for (std::size_t v = 0; v < one.points.size(); ++v) at[placeOf(one.points[v])] = one.normals[v];
    for (std::size_t v = 0; v < tiles.points.size(); ++v) {
        EXPECT_EQ(tiles.normals[v], at.at(placeOf(tiles.points[v])));
    }
}

TEST(Tiles, NeedNoMoreThanTheirOwnSamples) {
    const Volume noise = randomVolume<std::int16_t>({40, 40, 40}, 9, 3);
    const TileCut cut({40, 40, 40}, 32);
    const IndexBox box = cut.samplesOf({0, 0, 0});
    EXPECT_EQ(box.first, (Index3{0, 0, 0}));
    EXPECT_EQ(box.end, (Index3{18, 18, 18}));
    EXPECT_THROW(extractTile(noise, {1, 0, 0}, noise.view().geometry(), 4, cut, {0, 0, 0}),
                 InvalidInput);
}

TEST(Tiles, SimplifiedAreSoundAndWithinTheBound) {
    for (const ImageGeometry& geometry : {obliqueGeometry({70, 60, 50}, {1, 1, 1}),
                                          mirroredGeometry({70, 60, 50}, {1, 0.8, 1.3})}) {
        const AnalyticVolume ball = sampled<float>(sphere({2, 1, 3}, 22), geometry);
        const double maxErrorMm = 0.2;
        const TriangleMesh one =
            extractFrom(ball.volume, ball.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
        const TriangleMesh tiles = adaptiveOfTiles(ball.volume, ball.isovalue, 32, maxErrorMm);
        expectSound(tiles);
        EXPECT_LT(5 * tiles.triangles.size(), one.triangles.size());
        EXPECT_NEAR(enclosedVolume(tiles), enclosedVolume(one), 0.01 * enclosedVolume(one));
        EXPECT_LE(surfaceDistance(tiles, one).combined.maxMm, maxErrorMm);
    }
}

TEST(Tiles, AFlatCapAtTheVolumesBorderIsSimplified) {
    // the cap's triangles that touch a wall between tiles have no vertex of the full surface: the
    // proof of where they lie once began elsewhere, and found no way there past the border
    const AnalyticVolume ball =
        sampled<float>(sphere({45, 1, 3}, 40), obliqueGeometry({100, 90, 90}, {1, 1, 1}));
    const TriangleMesh one =
        extractFrom(ball.volume, ball.isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
    const TriangleMesh tiles = adaptiveOfTiles(ball.volume, ball.isovalue, 64, 0.15);
    expectSound(tiles);
    EXPECT_LT(15 * tiles.triangles.size(), one.triangles.size());
}

TEST(Tiles, FarFromTheFirstVoxelAreWhatTheyAreNearIt) {
    // single precision and numbers of blocks are a tile's own
    const ImageGeometry near = obliqueGeometry({64, 48, 48}, {1, 1, 1});
    const AnalyticVolume ball = sampled<float>(sphere({}, 20), near);
    ImageGeometry far = near;
    far.size = {20'064, 48, 48};
    const TileCut nearCut(near.size, 32), farCut(far.size, 32);
    const Index3 tile{1, 0, 0}, farTile{601, 0, 0};
    const SimplifiedPart part = simplifiedTileOf(ball.volume, ball.isovalue, nearCut, tile, 0.1);
    const SimplifiedPart moved =
        inWindow(ball.volume, nearCut, tile, [&](const Volume& window, const Index3& first) {
            return extractSimplifiedTile(window, {first[0] + 600 * 32, first[1], first[2]}, far,
                                         ball.isovalue, farCut, farTile, 0.1, false);
        });
    ASSERT_GT(part.mesh.triangles.size(), 100u);
    EXPECT_EQ(moved.mesh.triangles, part.mesh.triangles);
}

TEST(Tiles, WhatIsFarFromWhatMayChangeStaysToTheBit) {
    const ImageGeometry geometry = obliqueGeometry({130, 60, 60}, {1, 1, 1});
    const AnalyticVolume ball = sampled<float>(sphere({2, 1, 3}, 55), geometry);
    const TileCut cut(geometry.size, 64);
    Union tiles;
    forEachTile(cut.tiles(), [&](const Index3& tile) {
        tiles.add(simplifiedTileOf(ball.volume, ball.isovalue, cut, tile, 0.1).mesh);
    });
    const SeamPart part = seamPartOf(tiles.mesh, cut, {0, 0, 0});
    const SimplifiedPart made =
        simplifyInBox(part.mesh, part.isFixed, geometry, cut.seamBox({0, 0, 0}), 0.05);
    EXPECT_FALSE(made.isUnchanged);
    EXPECT_LT(made.mesh.triangles.size(), part.mesh.triangles.size());
    TriangleMesh fixed = part.mesh, kept = made.mesh;
    fixed.triangles.clear();
    kept.triangles.clear();
    for (std::size_t t = 0; t < part.isFixed.size(); ++t) {
        if (part.isFixed[t] != 0) fixed.triangles.push_back(part.mesh.triangles[t]);
    }
    for (std::size_t t = 0; t < made.isKept.size(); ++t) {
        if (made.isKept[t] != 0) kept.triangles.push_back(made.mesh.triangles[t]);
    }
    EXPECT_EQ(namesOf(kept), namesOf(fixed));
    EXPECT_EQ(borderOf(made.mesh).edges.size(), borderOf(part.mesh).edges.size());
}

TEST(Tiles, SimplifiedNoiseIsSound) {
    const Volume noise = randomVolume<std::uint8_t>({35, 20, 18}, 9, 5);
    const TriangleMesh tiles = adaptiveOfTiles(noise, 4.5, 32, 0.3);
    expectSound(tiles);
}

}  // namespace adaptiso::testing
