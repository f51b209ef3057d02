#include "PeerRun.h"

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "../HeapMeter.h"
#include "../RunBenchmark.h"
#include "PeerFiles.h"

namespace adaptiso::benchmarks {
namespace {

struct Arguments {
    std::string volume;
    std::string mesh;
    bool metersHeap = false;
    PeerTask task;
};

void declareOptions(CLI::App& app, const PeerProgram& program, Arguments& arguments) {
    PeerTask& task = arguments.task;
    app.add_option("volume", arguments.volume, "A volume of peerVolume's")->required();
    app.add_option("--method", task.method, "What to run")
        ->check(CLI::IsMember(program.methods))
        ->required();
    app.add_option("--iso", task.isovalue, "Isovalue")->required();
    app.add_option("--triangles", task.triangles, "Triangles to make");
    app.add_option("--max-error", task.maxErrorVoxels, "Bound of the distance, voxels (ours)");
    app.add_option("--adaptivity", task.adaptivity, "0 to 1 (OpenVDB)")->check(CLI::Range(0., 1.));
    app.add_option("--block", task.blockSize, "Cells a side of a block (ours; default 4)");
    app.add_option("--border", task.border, "open or closed (ours; default closed)")
        ->transform(CLI::CheckedTransformer(
            std::map<std::string, Border>{{"open", Border::Open}, {"closed", Border::Closed}}));
    app.add_option("--threads", task.threads, "Default 2")->check(CLI::Range(1, 1024));
    app.add_option("--mesh", arguments.mesh, "Write the mesh to FILE");
    app.add_flag("--meter-heap", arguments.metersHeap, "Count heap bytes instead of seconds");
}

/// A line of /proc/self/status that is given in kB, as bytes.
std::int64_t statusBytes(const std::string& key) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with(key + ":")) return 1024 * std::stoll(line.substr(key.size() + 1));
    }
    return 0;
}

void forgetPeakResident() {
    constexpr int kResetPeak = 5;  // proc(5), clear_refs
    std::ofstream("/proc/self/clear_refs") << kResetPeak;
}

double cpuSeconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

nlohmann::ordered_json run(const PeerProgram& program, const Arguments& arguments) {
    const Volume volume = readVolumeFile(arguments.volume);
    const auto work = program.prepare(volume, arguments.task);
    nlohmann::ordered_json report{{"program", program.name}, {"method", arguments.task.method}};
    PeerSurface surface;
    if (arguments.metersHeap) {
        report["peakHeapBytes"] = peakHeapBytes([&] { surface = work(); });
    } else {
        using Clock = std::chrono::steady_clock;
        forgetPeakResident();
        const std::int64_t residentBefore = statusBytes("VmRSS");
        const double cpuBefore = cpuSeconds();
        const Clock::time_point begin = Clock::now();
        surface = work();
        const std::chrono::duration<double> elapsed = Clock::now() - begin;
        report["seconds"] = elapsed.count();
        report["cpuSeconds"] = cpuSeconds() - cpuBefore;
        report["peakResidentBytes"] = statusBytes("VmHWM") - residentBefore;
    }
    const TriangleMesh mesh = surface.toMesh();
    report["triangles"] = mesh.triangles.size();
    report["points"] = mesh.points.size();
    if (surface.boundMm) report["boundMm"] = *surface.boundMm;
    if (surface.mcTriangles) report["mcTriangles"] = *surface.mcTriangles;
    if (!arguments.mesh.empty()) writeMeshFile(arguments.mesh, mesh);
    return report;
}

}  // namespace

int runPeer(int argc, char** argv, const PeerProgram& program) {
    CLI::App app("Runs one method once and says what it cost", program.name);
    Arguments arguments;
    declareOptions(app, program, arguments);
    return runBenchmark(app, argc, argv,
                        [&] { std::cout << run(program, arguments).dump() << '\n'; });
}

}  // namespace adaptiso::benchmarks
