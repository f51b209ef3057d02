// CGAL (GPL) beside this library: this program alone of the benchmarks links it.
//
//   peerCgal envelope MESH BOUND -o OUT   edge collapse, as far as an envelope of BOUND mm allows
//   peerCgal wrap MESH ALPHA OFFSET -o OUT   Alpha Wrap, of any triangles
//   peerCgal distance A B [--error MM]    the Hausdorff distance, each way
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Polyhedral_envelope_filter.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/alpha_wrap_3.h>
#include <CGAL/version.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../RunBenchmark.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace adaptiso::benchmarks {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Json = nlohmann::ordered_json;

/// \pre a 2-manifold \throws InvalidInput otherwise
CgalMesh toCgal(const TriangleMesh& mesh) {
    CgalMesh cgal;
    std::vector<CgalMesh::Vertex_index> vertices;
    for (const Vec3& p : mesh.points) vertices.push_back(cgal.add_vertex({p.x, p.y, p.z}));
    for (const auto& [a, b, c] : mesh.triangles) {
        if (cgal.add_face(vertices[a], vertices[b], vertices[c]) == CgalMesh::null_face()) {
            throw InvalidInput("peerCgal: the mesh is no oriented 2-manifold");
        }
    }
    return cgal;
}

/// Triangles one by one: for distances any will do.
CgalMesh soup(const TriangleMesh& mesh) {
    CgalMesh cgal;
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        const Corners c = cornersOf(mesh, t);
        const auto add = [&](const Vec3& p) { return cgal.add_vertex({p.x, p.y, p.z}); };
        const auto first = add(c[0]), second = add(c[1]);
        cgal.add_face(first, second, add(c[2]));
    }
    return cgal;
}

TriangleMesh fromCgal(CgalMesh& cgal) {
    cgal.collect_garbage();
    TriangleMesh mesh;
    for (const auto v : cgal.vertices()) {
        const auto& p = cgal.point(v);
        mesh.points.push_back({p.x(), p.y(), p.z()});
    }
    for (const auto face : cgal.faces()) {
        Triangle triangle{};
        std::size_t corner = 0;
        for (const auto v : cgal.vertices_around_face(cgal.halfedge(face))) {
            triangle[corner++] = v.idx();
        }
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

double cpuSeconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Writes a result in the frame of the file that it was made of.
Json write(CgalMesh& cgal, const MeshFile& of, const std::string& output, double seconds) {
    const TriangleMesh result = fromCgal(cgal);
    MeshWriteOptions options;
    options.frame = of.frame.value_or(CoordinateFrame::Ras);
    options.isInFrame = true;
    options.saysFrame = of.frame.has_value();
    writeMesh(result, output, options);
    return {{"version", CGAL_VERSION_STR},
            {"cpuSeconds", seconds},
            {"triangles", result.triangles.size()}};
}

Json envelope(const std::string& input, double boundMm, const std::string& output) {
    namespace sms = CGAL::Surface_mesh_simplification;
    const MeshFile file = readMesh(input);
    CgalMesh cgal = toCgal(file.mesh);
    const double begin = cpuSeconds();
    // with the filter that CGAL's example of the envelope has under it
    const sms::Polyhedral_envelope_filter<Kernel, sms::Bounded_normal_change_filter<>> filter(
        boundMm);
    sms::edge_collapse(cgal, sms::Count_stop_predicate<CgalMesh>(0),
                       CGAL::parameters::filter(filter));
    const double seconds = cpuSeconds() - begin;
    return write(cgal, file, output, seconds);
}

Json wrap(const std::string& input, double alphaMm, double offsetMm, const std::string& output) {
    const MeshFile file = readMesh(input);
    std::vector<Kernel::Point_3> points;
    for (const Vec3& p : file.mesh.points) points.emplace_back(p.x, p.y, p.z);
    std::vector<std::array<std::size_t, 3>> triangles;
    for (const auto& [a, b, c] : file.mesh.triangles) {
        triangles.push_back({static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                             static_cast<std::size_t>(c)});
    }
    CgalMesh cgal;
    const double begin = cpuSeconds();
    CGAL::alpha_wrap_3(points, triangles, alphaMm, offsetMm, cgal);
    return write(cgal, file, output, cpuSeconds() - begin);
}

Json distance(const std::string& a, const std::string& b, double errorMm) {
    const CgalMesh cgalA = soup(readMesh(a).mesh), cgalB = soup(readMesh(b).mesh);
    const double begin = cpuSeconds();
    const auto from = [&](const CgalMesh& one, const CgalMesh& other) {
        return CGAL::Polygon_mesh_processing::bounded_error_Hausdorff_distance<
            CGAL::Sequential_tag>(one, other, errorMm);
    };
    const double aToB = from(cgalA, cgalB), bToA = from(cgalB, cgalA);
    return {{"version", CGAL_VERSION_STR},
            {"cpuSeconds", cpuSeconds() - begin},
            {"errorMm", errorMm},
            {"aToB", aToB},
            {"bToA", bToA}};
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("CGAL's edge collapse in an envelope, its Alpha Wrap and Hausdorff distance",
                 "peerCgal");
    std::string first, second, output;
    double boundMm = 0, errorMm = 1e-4, alphaMm = 0, offsetMm = 0;
    CLI::App* collapse = app.add_subcommand("envelope", "Collapse edges within a distance");
    collapse->add_option("mesh", first, "A closed 2-manifold")->required();
    collapse->add_option("bound", boundMm, "mm")->required();
    collapse->add_option("-o,--output", output, "The result, in the mesh's frame")->required();
    CLI::App* wrapped = app.add_subcommand("wrap", "Alpha Wrap of any triangles");
    wrapped->add_option("mesh", first)->required();
    wrapped->add_option("alpha", alphaMm, "mm")->required();
    wrapped->add_option("offset", offsetMm, "mm")->required();
    wrapped->add_option("-o,--output", output, "The result, in the mesh's frame")->required();
    CLI::App* measure = app.add_subcommand("distance", "Hausdorff distance, each way, mm");
    measure->add_option("a", first)->required();
    measure->add_option("b", second)->required();
    measure->add_option("--error", errorMm, "mm (default 1e-4)");
    app.require_subcommand(1);
    return runBenchmark(app, argc, argv, [&] {
        const Json report = collapse->parsed()  ? envelope(first, boundMm, output)
                            : wrapped->parsed() ? wrap(first, alphaMm, offsetMm, output)
                                                : distance(first, second, errorMm);
        std::cout << report.dump() << '\n';
    });
}
