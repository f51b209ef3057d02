// A mesh with even triangles, as many as asked for: this library's own remesher on a surface of
// genus 0. For meshes that peerSimplify is to simplify.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "../RunBenchmark.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/MeshIO/MeshFile.h"

int main(int argc, char** argv) {
    using namespace adaptiso;
    CLI::App app("Remeshes a closed surface of genus 0 evenly", "remeshEvenly");
    std::string input, output;
    RemeshOptions options;
    app.add_option("mesh", input, "A closed mesh of genus 0")->required();
    app.add_option("--vertices", options.vertices, "Vertices of the result")->required();
    app.add_option("-o,--output", output, "Write it to FILE, as it lies")->required();
    return benchmarks::runBenchmark(app, argc, argv, [&] {
        const Remeshed made = remeshForBem(readMesh(input).mesh, options);
        if (!made.findings.empty()) {
            throw InvalidInput(input + ": " + made.findings.front().what);
        }
        MeshWriteOptions write;
        write.frame = CoordinateFrame::Lps;
        writeMesh(made.mesh, output, write);
        std::cout << made.mesh.triangles.size() << " triangles\n";
    });
}
