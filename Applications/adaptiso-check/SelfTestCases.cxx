#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <utility>

#include "Common/ChildProcess.h"
#include "Common/CommonOptions.h"
#include "Common/RunApp.h"
#include "Phantoms.h"
#include "SelfTest.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshQuality/Nesting.h"
#include "adaptiso/MeshQuality/SurfaceDistance.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"
#include "adaptiso/SurfaceChecks/Checks.h"

namespace adaptiso::checker::selftest {
namespace {

namespace fs = std::filesystem;

/// Another copy of the mesh.
void addCopy(TriangleMesh& mesh, const Vec3& shiftMm) {
    const std::size_t points = mesh.points.size(), triangles = mesh.triangles.size();
    for (std::size_t n = 0; n < points; ++n) mesh.points.push_back(mesh.points[n] + shiftMm);
    const auto offset = static_cast<VertexId>(points);
    for (std::size_t n = 0; n < triangles; ++n) {
        const auto [a, b, c] = mesh.triangles[n];
        mesh.triangles.push_back({a + offset, b + offset, c + offset});
    }
}

/// A copy mirrored through the first vertex, which both share.
void addMirrorImage(TriangleMesh& mesh) {
    const std::size_t points = mesh.points.size(), triangles = mesh.triangles.size();
    for (std::size_t n = 1; n < points; ++n) {
        mesh.points.push_back(2 * mesh.points.front() - mesh.points[n]);
    }
    const auto mirrored = [&](VertexId v) {
        return v == 0 ? v : v + static_cast<VertexId>(points) - 1;
    };
    for (std::size_t n = 0; n < triangles; ++n) {  // a point reflection turns triangles round
        const auto [a, b, c] = mesh.triangles[n];
        mesh.triangles.push_back({mirrored(a), mirrored(c), mirrored(b)});
    }
}

/// The first triangle cut in three from a point close to its first corner.
void addSlivers(TriangleMesh& mesh) {
    const Triangle t = mesh.triangles.front();
    const Vec3 corner = mesh.points[t[0]];
    const VertexId added = std::ssize(mesh.points);
    mesh.points.push_back(corner +
                          0.001 * ((mesh.points[t[1]] - corner) + (mesh.points[t[2]] - corner)));
    mesh.triangles.front() = {added, t[1], t[2]};
    mesh.triangles.push_back({t[0], t[1], added});
    mesh.triangles.push_back({t[0], added, t[2]});
}

/// A defect, the check that has to find it (Check::key), and how a sound mesh gets it.
struct Defect {
    const char* name;
    std::string_view key;
    void (*plant)(TriangleMesh& mesh);
};

/// One for each check of a single surface but genusZero, which a ring fails. Meshes are closed,
/// sound, one piece of genus 0, 60 mm wide, without normals.
constexpr Defect kDefects[] = {
    {"a coordinate that is no number", "finiteCoordinates",
     [](TriangleMesh& m) { m.points.front().x = std::numeric_limits<double>::quiet_NaN(); }},
    {"a vertex number beyond the last", "indicesInRange",
     [](TriangleMesh& m) {
         m.triangles.push_back({0, 1, std::ssize(m.points)});
     }},
    {"a triangle missing", "closed", [](TriangleMesh& m) { m.triangles.pop_back(); }},
    {"a fin on an edge", "manifoldEdges",
     [](TriangleMesh& m) {
         const Triangle t = m.triangles.front();
         m.points.push_back(m.points[t[0]] + Vec3{100, 0, 0});
         m.triangles.push_back({t[0], t[1], std::ssize(m.points) - 1});
     }},
    {"two balls touching at a vertex", "manifoldVertices", addMirrorImage},
    {"a triangle turned round", "consistentOrientation",
     [](TriangleMesh& m) { std::swap(m.triangles.front()[1], m.triangles.front()[2]); }},
    {"inside out", "outward", [](TriangleMesh& m) { flipOrientation(m); }},
    {"a second piece", "oneComponent",
     [](TriangleMesh& m) {
         addCopy(m, {100, 0, 0});
     }},
    {"a triangle without area", "noDegenerateTriangles",
     [](TriangleMesh& m) {
         const Triangle t = m.triangles.front();
         m.triangles.push_back({t[0], t[0], t[1]});
     }},
    {"a triangle twice", "noDuplicateTriangles",
     [](TriangleMesh& m) { m.triangles.push_back(Triangle(m.triangles.front())); }},
    {"two vertices at one place", "noDuplicateVertices",
     [](TriangleMesh& m) {
         m.points.push_back(Vec3(m.points[m.triangles.front()[0]]));
         m.triangles.front()[0] = std::ssize(m.points) - 1;
     }},
    {"a vertex of no triangle", "noUnusedVertices",
     [](TriangleMesh& m) {
         m.points.push_back({7, 7, 7});
     }},
    {"two balls that cross", "noSelfIntersections",
     [](TriangleMesh& m) {
         addCopy(m, {10, 0, 0});
     }},
    {"slivers", "minAngle", addSlivers},
    {"metres taken for millimetres", "plausibleSize",
     [](TriangleMesh& m) {
         for (Vec3& p : m.points) p = 0.001 * p;
     }},
};

/// How far a surface of triangles may lie from the solid's: the chord of a cell's diagonal on the
/// sharpest bend, once for the samples (distances are not linear across a bend) and once for the
/// triangles; the rounding of the samples; and the bound that the method promises.
double allowedMm(const Solid& solid, const ImageGeometry& geometry, Method method) {
    const Vec3 voxelMm = geometry.spacingMm();
    const double chordMm = squaredNorm(voxelMm) / (8 * solid.smallestRadiusMm);
    const double boundMm =
        method == Method::Adaptive
            ? AdaptiveOptions::kDefaultMaxErrorVoxels * std::min({voxelMm.x, voxelMm.y, voxelMm.z})
            : 0;
    return 2 * chordMm + 0.5 / kDistancePerMm + boundMm;
}

/// The middle of the solid that a closed mesh encloses.
Vec3 centreOf(const TriangleMesh& mesh) {
    double volume = 0;
    Vec3 sum;
    const Vec3 apex = mesh.points.front();
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.points[t[0]] - apex, b = mesh.points[t[1]] - apex,
                   c = mesh.points[t[2]] - apex;
        const double part = dot(a, cross(b, c)) / 6;
        volume += part;
        sum += (0.25 * part) * (a + b + c);
    }
    return apex + (1 / volume) * sum;
}

/// How far the farthest vertex, or middle of a triangle, lies from the solid's surface.
double farthestMm(const TriangleMesh& mesh, const Solid& solid) {
    double farthest = 0;
    for (const Vec3& p : mesh.points) farthest = std::max(farthest, std::abs(solid.depthMm(p)));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 middle = (1.0 / 3) * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]);
        farthest = std::max(farthest, std::abs(solid.depthMm(middle)));
    }
    return farthest;
}

std::int64_t failedChecks(const std::vector<Check>& checks) {
    return std::count_if(checks.begin(), checks.end(),
                         [](const Check& check) { return check.breaksProfile(); });
}

bool hasFailed(const std::vector<Check>& checks, std::string_view key) {
    const auto found = std::find_if(checks.begin(), checks.end(),
                                    [&](const Check& check) { return check.key == key; });
    if (found == checks.end()) throw InternalError("there is no check " + std::string(key));
    return found->hasFailed();
}

class Runner {
public:
    explicit Runner(const std::function<void(const std::string&)>& progress)
        : progress_(progress) {}

    SelfTest run() {
        for (const Method method : {Method::Adaptive, Method::MarchingCubes}) {
            measureBall(method);
            measureTorus(method);
            measureNested(method);
            measureBearingBalls(method);
        }
        compareThreads();
        writeAndRead();
        findDefects();
        refuseDamaged();
        return std::move(test_);
    }

private:
    /// Runs `work`, whose measurements are of `subject`; what it throws is one that failed.
    template <class Work>
    void about(const std::string& subject, Work&& work) {
        subject_ = subject;
        progress_(subject);
        try {
            work();
        } catch (const std::exception& error) {
            Measurement& failed = test_.measurements.emplace_back();
            failed.subject = subject;
            failed.quantity = "was measured";
            failed.error = oneLine(error.what());
        }
    }

    void add(const std::string& quantity, const std::string& unit, double expected,
             double tolerance, double measured, int digits) {
        test_.measurements.push_back(
            {subject_, quantity, unit, expected, tolerance, measured, digits, ""});
    }
    void addCount(const std::string& quantity, double expected, double measured) {
        add(quantity, "", expected, 0, measured, 0);
    }

    void addYes(const std::string& quantity, bool measured) {
        addCount(quantity, 1, measured ? 1 : 0);
        test_.measurements.back().isYesNo = true;
    }

    fs::path place(const std::string& ending) {
        return folder_.place(std::to_string(++files_) + ending);
    }

    fs::path writeImage(const std::string& bytes) {
        const fs::path path = place(".nii");
        std::ofstream file(path, std::ios::binary);
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file.close();
        if (!file) throw FileError("the folder of temporary files: can't be written");
        return path;
    }

    static TriangleMesh extract(const VolumeView& volume, double isovalue, Method method,
                                double minAngleDeg = 0) {
        ExtractionOptions options;
        options.adaptive.minAngleDeg = minAngleDeg;
        options.isovalue = isovalue;
        options.method = method;
        options.computeNormals = false;
        return extractSurface(volume, options).mesh;
    }

    TriangleMesh writtenAndRead(const TriangleMesh& mesh, const std::string& ending) {
        const fs::path path = place(ending);
        writeMesh(mesh, path, {});
        const MeshFile file = readMesh(path);
        return fromFrame(file.mesh, file.frame.value_or(CoordinateFrame::Ras));
    }

    /// As the programs do it, from the image's file to the mesh's.
    TriangleMesh throughFiles(const VolumeView& phantom, double isovalue, Method method) {
        const ReadVolume read = readVolume(writeImage(niftiFile(phantom)));
        return writtenAndRead(extract(read.volume, isovalue, method), ".vtp");
    }

    /// That adaptiso-check finds nothing wrong with a surface of so many pieces and handles.
    void addSound(const TriangleMesh& mesh, int pieces, int genus) {
        const CheckRules options;
        const SurfaceFacts facts =
            measureSurface(mesh, sizeLimitsOf(options.profileInUse()), options.maxPairs);
        addCount("checks failed", 0,
                 static_cast<double>(failedChecks(judgeSurface(facts, options))));
        addCount("crossing triangles", 0, static_cast<double>(facts.intersections.pairCount));
        addCount("pieces", pieces, static_cast<double>(facts.topology.components.size()));
        addCount("genus", genus, static_cast<double>(facts.topology.genus().value_or(-1)));
    }

    void addSolid(const Solid& solid, const ImageGeometry& geometry, Method method,
                  const TriangleMesh& mesh) {
        const double allowed = allowedMm(solid, geometry, method);
        addSound(mesh, 1, solid.genus);
        add("farthest from the solid", "mm", 0, allowed, farthestMm(mesh, solid), 3);
        // a layer as thick as the surface may be off
        add("volume", "mm3", solid.volumeMm3, solid.areaMm2 * allowed, enclosedVolume(mesh), 0);
        const Vec3 centre = centreOf(mesh);
        add("centre, to the right", "mm", -solid.centreMm.x, allowed, -centre.x, 3);
        add("centre, to the front", "mm", -solid.centreMm.y, allowed, -centre.y, 3);
        add("centre, upwards", "mm", solid.centreMm.z, allowed, centre.z, 3);
    }

    std::string named(const std::string& name, Method method) {
        return name + ", " + std::string(toString(method));
    }

    void measureBall(Method method) {
        about(named("ball of 40 mm", method), [&] {
            const Solid solid = ball({-12, 7, 31}, 20);
            const ImageGeometry geometry = obliqueGeometry({54, 54, 34}, {0.9, 0.9, 1.5}, solid);
            const TriangleMesh mesh =
                throughFiles(distanceScan(solid, geometry), kDistanceSurface, method);
            addSolid(solid, geometry, method, mesh);
        });
    }

    void measureTorus(Method method) {
        about(named("torus of 40 and 16 mm", method), [&] {
            const Solid solid = ring({25, -40, -8}, 20, 8);
            const ImageGeometry geometry = obliqueGeometry({84, 84, 60}, {0.8, 0.8, 1}, solid);
            TriangleMesh mesh =
                throughFiles(distanceScan(solid, geometry), kDistanceSurface, method);
            addSolid(solid, geometry, method, mesh);
            test_.shown.push_back({subject_, std::move(mesh)});
        });
    }

    /// Spheres about one point, as skull and skin lie about a brain: one image, an isovalue each.
    void measureNested(Method method) {
        about(named("nested spheres", method), [&] {
            constexpr double kInnerMm = 30, kOuterMm = 34;
            const Solid solid = ball({0, 0, 0}, kInnerMm);
            const ImageGeometry geometry = obliqueGeometry({60, 60, 60}, {1.25, 1.25, 1.25}, solid);
            const Volume phantom = distanceScan(solid, geometry);
            const TriangleMesh inner = throughFiles(phantom, kDistanceSurface, method);
            const TriangleMesh outer = throughFiles(
                phantom, kDistanceSurface - kDistancePerMm * (kOuterMm - kInnerMm), method);
            const double allowed = 2 * allowedMm(solid, geometry, method);
            const NestingReport report = checkNesting(inner, outer);
            addYes("one lies in the other", report.isStrictlyNested());
            addCount("crossing triangles", 0, static_cast<double>(report.crossingPairs));
            add("smallest gap", "mm", kOuterMm - kInnerMm, allowed, report.gap.nearest.distanceMm,
                3);
            const DistanceStatistics apart = surfaceDistance(inner, outer).combined;
            add("mean distance", "mm", kOuterMm - kInnerMm, allowed, apart.meanMm, 3);
            add("largest distance", "mm", kOuterMm - kInnerMm, allowed, apart.maxMm, 3);
        });
    }

    void measureBearingBalls(Method method) {
        about(named("two bearing balls in CT", method), [&] {
            constexpr double kDiameterMm = 10;
            constexpr double kToleranceMm = 0.05;  // a tenth of a voxel, as makers of CT are asked
            const Volume phantom = bearingBalls(kDiameterMm);
            TriangleMesh mesh = throughFiles(phantom, kBallSurface, method);
            addSound(mesh, 2, 0);
            for (const SurfaceComponent& piece : checkTopology(mesh).components) {
                add("diameter of the ball as large", "mm", kDiameterMm, kToleranceMm,
                    std::cbrt(6 * piece.signedVolumeMm3 / std::numbers::pi), 3);
            }
            test_.shown.push_back({subject_, std::move(mesh)});
        });
    }

    void compareThreads() {
        about("torus, one thread and all", [&] {
            const Solid solid = ring({0, 0, 0}, 20, 8);
            const Volume phantom =
                distanceScan(solid, obliqueGeometry({84, 84, 60}, {0.8, 0.8, 1}, solid));
            const TriangleMesh byAll = extract(phantom, kDistanceSurface, Method::Adaptive);
            CommonOptions one;
            one.threads = 1;
            const ThreadLimit limit(one);
            addYes("same surface", extract(phantom, kDistanceSurface, Method::Adaptive) == byAll);
        });
    }

    /// A surface without a fault, not even a sliver, to plant defects in.
    static TriangleMesh faultless(const Solid& solid) {
        constexpr double kMinAngleDeg = 10;
        const Volume phantom = distanceScan(solid, obliqueGeometry({80, 80, 76}, {1, 1, 1}, solid));
        return extract(phantom, kDistanceSurface, Method::Adaptive, kMinAngleDeg);
    }
    static TriangleMesh plainBall() { return faultless(ball({0, 0, 0}, 30)); }

    void writeAndRead() {
        const TriangleMesh ball = plainBall();
        for (const MeshFormat& format : meshFormats()) {
            about("ball written and read, " + std::string(format.name), [&] {
                const TriangleMesh read =
                    writtenAndRead(ball, std::string(format.extensions.front()));
                addCount("triangles", static_cast<double>(ball.triangles.size()),
                         static_cast<double>(read.triangles.size()));
                // single precision keeps 2 nm at 30 mm
                add("volume", "mm3", enclosedVolume(ball), surfaceArea(ball) * 2e-6,
                    enclosedVolume(read), 2);
            });
        }
    }

    void findDefects() {
        const TriangleMesh ball = plainBall();
        CheckRules options;
        options.profile = Profile::Bem;
        about("ball without a defect", [&] {
            const SurfaceFacts facts =
                measureSurface(ball, sizeLimitsOf(Profile::Bem), options.maxPairs);
            addCount("checks failed", 0,
                     static_cast<double>(failedChecks(judgeSurface(facts, options))));
        });
        const auto plant = [&](const std::string& name, std::string_view key,
                               const TriangleMesh& mesh) {
            about("defect: " + name, [&] {
                const SurfaceFacts facts =
                    measureSurface(mesh, sizeLimitsOf(Profile::Bem), options.maxPairs);
                addYes("found", hasFailed(judgeSurface(facts, options), key));
            });
        };
        for (const Defect& defect : kDefects) {
            TriangleMesh mesh = ball;
            mesh.normals = {};
            defect.plant(mesh);
            plant(defect.name, defect.key, std::move(mesh));
            if (defect.key == "oneComponent") {
                plant("a handle", "genusZero", faultless(ring({0, 0, 0}, 24, 10)));
            }
        }
        const auto nest = [&](const char* name, std::string_view key, const TriangleMesh& inner,
                              const TriangleMesh& outer) {
            about(std::string("defect: ") + name, [&] {
                const auto checks =
                    judgeNesting(checkNesting(inner, outer), "inner", "outer", {}, options);
                addYes("found", hasFailed(checks, key));
            });
        };
        TriangleMesh large = ball;
        for (Vec3& p : large.points) p = 1.2 * p;  // 6 mm outside
        const auto moved = [](TriangleMesh mesh, const Vec3& byMm) {
            for (Vec3& p : mesh.points) p += byMm;
            return mesh;
        };
        nest("inner surface through the outer", "noCrossing", moved(ball, {8, 0, 0}), large);
        nest("inner and outer swapped", "strictlyNested", large, ball);
        nest("a gap of 0.2 mm", "minGap", moved(ball, {5.8, 0, 0}), large);
    }

    template <class Work>
    void addRefused(const std::string& name, Work&& work) {
        about(name, [&] {
            bool isRefused = false;
            try {
                work();
            } catch (const FileError&) {
                isRefused = true;
            }
            addYes("refused", isRefused);
        });
    }

    void refuseDamaged() {
        const Solid solid = ball({0, 0, 0}, 8);
        const std::string image =
            niftiFile(distanceScan(solid, obliqueGeometry({24, 24, 24}, {1, 1, 1}, solid)));
        addRefused("image cut short",
                   [&] { readVolume(writeImage(image.substr(0, image.size() - 1000))); });
        addRefused("image whose axes are one line", [&] {
            std::string flat = image;
            for (std::size_t at = 280; at < 328; at += 16) {
                flat.replace(at + 4, 4, flat.substr(at, 4));
                flat.replace(at + 8, 4, flat.substr(at, 4));
            }
            readVolume(writeImage(flat));
        });
        addRefused("mesh cut short", [&] {
            const fs::path path = place(".ply");
            writeMesh(plainBall(), path, {});
            fs::resize_file(path, fs::file_size(path) - 100);
            readMesh(path);
        });
    }

    const std::function<void(const std::string&)>& progress_;
    ScratchFolder folder_;
    int files_ = 0;
    std::string subject_;
    SelfTest test_;
};

}  // namespace

bool SelfTest::hasPassed() const {
    return !measurements.empty() && failures() == 0;
}

std::size_t SelfTest::failures() const {
    return static_cast<std::size_t>(
        std::count_if(measurements.begin(), measurements.end(),
                      [](const Measurement& measurement) { return !measurement.hasPassed(); }));
}

SelfTest runSelfTestCases(const std::function<void(const std::string&)>& progress) {
    return Runner(progress).run();
}

}  // namespace adaptiso::checker::selftest
