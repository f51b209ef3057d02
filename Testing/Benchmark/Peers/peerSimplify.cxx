// Makers of fewer triangles, on a mesh of any origin: this library's simplify(),
// vtkQuadricDecimation with its own defaults, and meshopt_simplify without a limit of error or with
// one.
#include <meshoptimizer.h>
#include <tbb/global_control.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../HeapMeter.h"
#include "../RunBenchmark.h"
#include "../VtkThreads.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/VtkAdaptor/VtkAdaptor.h"

namespace adaptiso::benchmarks {
namespace {

struct Arguments {
    std::string mesh, method, output;
    std::int64_t triangles = 0;
    double maxError = 0;
    int threads = 2;
    bool metersHeap = false;
};

/// What is made, in the maker's own memory; turned into a mesh after the clock has stopped.
using Made = std::function<TriangleMesh()>;

std::function<Made()> ours(const TriangleMesh& mesh, const Arguments& arguments) {
    return [&mesh, &arguments]() -> Made {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(arguments.threads));
        SimplifyOptions options;
        if (arguments.triangles > 0) options.maxTriangles = arguments.triangles;
        if (arguments.maxError > 0) options.maxErrorMm = arguments.maxError;
        auto result = std::make_shared<Simplified>(simplify(mesh, options));
        std::cerr << "bound " << result->statistics.errorBoundMm << ", crossing before "
                  << result->statistics.crossingTriangles.size() << '\n';
        return [result] { return result->mesh; };
    };
}

std::function<Made()> quadric(const TriangleMesh& mesh, const Arguments& arguments) {
    setVtkThreads(arguments.threads);
    const vtkSmartPointer<vtkPolyData> data = toVtkPolyData(mesh);
    const double part =
        1 - static_cast<double>(arguments.triangles) / static_cast<double>(mesh.triangles.size());
    return [data, part]() -> Made {
        vtkNew<vtkQuadricDecimation> filter;
        filter->SetInputData(data);
        filter->SetTargetReduction(part);
        filter->Update();
        const vtkSmartPointer<vtkPolyData> result = filter->GetOutput();
        return [result] { return fromVtkPolyData(result); };
    };
}

std::function<Made()> meshoptimizer(const TriangleMesh& mesh, const Arguments& arguments) {
    auto points = std::make_shared<std::vector<float>>();
    for (const Vec3& p : mesh.points) {
        for (int a = 0; a < 3; ++a) points->push_back(static_cast<float>(p[a]));
    }
    auto corners = std::make_shared<std::vector<unsigned>>();
    for (const Triangle& t : mesh.triangles) {
        for (const VertexId v : t) corners->push_back(static_cast<unsigned>(v));
    }
    const std::size_t wanted = 3 * static_cast<std::size_t>(arguments.triangles);
    float scale = meshopt_simplifyScale(points->data(), points->size() / 3, 3 * sizeof(float));
    const float error =
        arguments.maxError > 0 ? static_cast<float>(arguments.maxError) / scale : 1e30F;
    return [points, corners, wanted, error]() -> Made {
        auto kept = std::make_shared<std::vector<unsigned>>(corners->size());
        kept->resize(meshopt_simplify(kept->data(), corners->data(), corners->size(),
                                      points->data(), points->size() / 3, 3 * sizeof(float), wanted,
                                      error));
        return [points, kept] {
            std::vector<VertexId> number(points->size() / 3, -1);
            TriangleMesh made;
            for (std::size_t n = 0; n < kept->size(); n += 3) {
                Triangle triangle{};
                for (std::size_t c = 0; c < 3; ++c) {
                    VertexId& at = number[(*kept)[n + c]];
                    if (at < 0) {
                        at = std::ssize(made.points);
                        const float* p = points->data() + 3 * std::size_t{(*kept)[n + c]};
                        made.points.push_back({p[0], p[1], p[2]});
                    }
                    triangle[c] = at;
                }
                made.triangles.push_back(triangle);
            }
            return made;
        };
    };
}

nlohmann::ordered_json run(const Arguments& arguments) {
    MeshFile file = readMesh(arguments.mesh);
    TriangleMesh& mesh = file.mesh;
    mesh.normals = {};  // the others don't take them along
    const auto work = arguments.method == "adaptiso"  ? ours(mesh, arguments)
                      : arguments.method == "quadric" ? quadric(mesh, arguments)
                                                      : meshoptimizer(mesh, arguments);
    nlohmann::ordered_json report{{"method", arguments.method}, {"before", mesh.triangles.size()}};
    Made made;
    if (arguments.metersHeap) {
        const auto peak = peakHeapBytes([&] { made = work(); });
        report["peakHeapBytes"] = peak;
        report["bytesPerTriangle"] =
            static_cast<double>(peak) / static_cast<double>(mesh.triangles.size());
    } else {
        const auto begin = std::chrono::steady_clock::now();
        const double cpu = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
        made = work();
        report["seconds"] =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        report["cpuSeconds"] = static_cast<double>(std::clock()) / CLOCKS_PER_SEC - cpu;
    }
    const TriangleMesh result = made();
    report["triangles"] = result.triangles.size();
    if (!arguments.output.empty()) {
        MeshWriteOptions options;
        options.frame = file.frame.value_or(CoordinateFrame::Lps);
        options.isInFrame = true;
        writeMesh(result, arguments.output, options);
    }
    return report;
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    CLI::App app("Simplifies a mesh once and says what it cost", "peerSimplify");
    Arguments arguments;
    app.add_option("mesh", arguments.mesh, "A mesh")->required();
    app.add_option("--method", arguments.method, "adaptiso, quadric or meshoptimizer")
        ->check(CLI::IsMember({"adaptiso", "quadric", "meshoptimizer"}))
        ->required();
    app.add_option("--triangles", arguments.triangles, "Triangles to make");
    app.add_option("--max-error", arguments.maxError, "Bound of the distance");
    app.add_option("--threads", arguments.threads, "Default 2")->check(CLI::Range(1, 1024));
    app.add_option("-o,--output", arguments.output, "Write the mesh to FILE, as it lies");
    app.add_flag("--meter-heap", arguments.metersHeap, "Count heap bytes instead of seconds");
    return runBenchmark(app, argc, argv, [&] { std::cout << run(arguments).dump() << '\n'; });
}
