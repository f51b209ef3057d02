#include "ComparisonReport.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <thread>

#include "VtkThreads.h"

namespace adaptiso::benchmarks {
namespace {

std::string fileName(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

std::string processorName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown processor";
}

std::string_view toString(Border border) {
    return border == Border::Open ? "open" : "closed";
}

std::string methodName(const Candidate& candidate) {
    if (!candidate.method) {
        return candidate.computeNormals ? "FlyingEdges" : "FlyingEdges, no normals";
    }
    return std::string(toString(*candidate.method)) +
           (candidate.mergeWithinBlocks ? ", within blocks" : "") +
           (candidate.adjustVertices ? ", adjusted" : "");
}

std::string fixed(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

/// The fewest digits that read back as `value`.
std::string shortest(double value) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

template <class T, class Format>
std::string orDash(const std::optional<T>& value, const Format& format) {
    return value ? format(*value) : "-";
}

std::string megabytes(std::int64_t bytes) {
    return fixed(static_cast<double>(bytes) / 1e6, 1);
}

std::string peakCell(const Costs& costs) {
    const bool isOver = costs.boundBytes && costs.peakHeapBytes > *costs.boundBytes;
    return megabytes(costs.peakHeapBytes) + (isOver ? " (over)" : "");
}

std::vector<std::string> cells(const ComparisonRow& row) {
    const auto count = [](std::int64_t n) { return std::to_string(n); };
    const auto seconds = [](double s) { return fixed(s, 4); };
    const MeshFacts& facts = row.facts;
    const Costs& costs = row.costs;
    return {methodName(row.candidate),
            row.candidate.method ? count(row.candidate.blockSize) : "-",
            std::string(toString(row.candidate.border)),
            count(facts.triangles),
            fixed(facts.ratioToMc, 3),
            fixed(facts.meanVoxels, 4),
            fixed(facts.maxVoxels, 2),
            count(facts.boundaryEdges),
            count(facts.nonManifoldEdges),
            count(facts.inconsistentEdges),
            count(facts.degenerateTriangles),
            count(facts.crossingPairs),
            orDash(facts.statistics, [&](const auto& s) { return count(s.boxesChangingTopology); }),
            orDash(costs.indexSeconds, seconds),
            seconds(costs.extractSeconds),
            fixed(costs.extractToFlyingEdges, 2),
            fixed(costs.totalToFlyingEdges, 2),
            fixed(costs.extractToMc, 2),
            fixed(costs.extractToAsc, 2),
            peakCell(costs),
            megabytes(facts.meshBytes),
            orDash(costs.boundBytes, megabytes)};
}

const std::vector<std::string> kHeader{
    "method",       "block",          "border",         "triangles",    "ratio to mc",
    "mean (voxel)", "max (voxel)",    "boundary edges", "non-manifold", "inconsistent",
    "degenerate",   "crossing pairs", "topology boxes", "index s",      "extract s",
    "x FE",         "x FE, +index",   "x mc",           "x asc",        "peak MB",
    "mesh MB",      "bound MB"};

void writeLine(std::ostream& out, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) out << "| " << text << ' ';
    out << "|\n";
}

void writeRule(std::ostream& out) {
    for (std::size_t column = 0; column < kHeader.size(); ++column) {
        out << (column == 0 || column == 2 ? "|---" : "|---:");
    }
    out << "|\n";
}

std::string sizeText(const ImageGeometry& geometry) {
    const Vec3 spacingMm = geometry.spacingMm();
    return std::to_string(geometry.size[0]) + " x " + std::to_string(geometry.size[1]) + " x " +
           std::to_string(geometry.size[2]) + " voxels of " + fixed(spacingMm.x, 3) + " x " +
           fixed(spacingMm.y, 3) + " x " + fixed(spacingMm.z, 3) + " mm";
}

std::string threadText(const Comparison& comparison) {
    std::string text = std::to_string(comparison.threads) + " thread" +
                       (comparison.threads == 1 ? "" : "s") + " each";
    if (comparison.vtkBackend == "Sequential") text += " (VTK was built without threads)";
    return text;
}

nlohmann::ordered_json toJson(const ComparisonRow& row) {
    const auto orNull = [](const auto& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    const Candidate& candidate = row.candidate;
    const MeshFacts& facts = row.facts;
    const Costs& costs = row.costs;
    const auto statistic = [&](std::int64_t ExtractionStatistics::*member) {
        return facts.statistics ? nlohmann::ordered_json((*facts.statistics).*member)
                                : nlohmann::ordered_json();
    };
    return {{"method", candidate.method ? toString(*candidate.method) : "FlyingEdges"},
            {"computesNormals", candidate.computeNormals},
            {"mergeWithinBlocks", candidate.mergeWithinBlocks},
            {"adjustVertices", candidate.adjustVertices},
            {"blockSize", candidate.method ? nlohmann::ordered_json(candidate.blockSize)
                                           : nlohmann::ordered_json()},
            {"border", toString(candidate.border)},
            {"triangles", facts.triangles},
            {"ratioToMc", facts.ratioToMc},
            {"meanDistanceVoxels", facts.meanVoxels},
            {"maxDistanceVoxels", facts.maxVoxels},
            {"boundaryEdges", facts.boundaryEdges},
            {"nonManifoldEdges", facts.nonManifoldEdges},
            {"inconsistentEdges", facts.inconsistentEdges},
            {"degenerateTriangles", facts.degenerateTriangles},
            {"crossingPairs", facts.crossingPairs},
            {"boxesChangingTopology", statistic(&ExtractionStatistics::boxesChangingTopology)},
            {"blocksTotal", statistic(&ExtractionStatistics::blocksTotal)},
            {"blocksActive", statistic(&ExtractionStatistics::blocksActive)},
            {"indexNodesVisited", statistic(&ExtractionStatistics::indexNodesVisited)},
            {"indexSeconds", orNull(costs.indexSeconds)},
            {"extractSeconds", costs.extractSeconds},
            {"extractToFlyingEdges", costs.extractToFlyingEdges},
            {"totalToFlyingEdges", costs.totalToFlyingEdges},
            {"extractToMc", costs.extractToMc},
            {"extractToAsc", costs.extractToAsc},
            {"peakHeapBytes", costs.peakHeapBytes},
            {"meshBytes", facts.meshBytes},
            {"boundBytes", orNull(costs.boundBytes)}};
}

}  // namespace

void writeMarkdown(std::ostream& out, const Comparison& comparison,
                   const ComparisonContext& context) {
    out << "## " << fileName(context.input) << " at " << shortest(context.options.isovalue)
        << "\n\n"
        << (context.crop.empty() ? "" : "Samples " + context.crop + ". ")
        << sizeText(context.geometry) << ", " << adaptiso::toString(context.pixelType) << ". "
        << threadText(comparison) << ", VTK " << vtkVersionText() << " on " << comparison.vtkBackend
        << ". Medians of " << context.options.repeats << ".\n\n";
    writeLine(out, kHeader);
    writeRule(out);
    for (const ComparisonRow& row : comparison.rows) writeLine(out, cells(row));
}

void writeJson(std::ostream& out, const Comparison& comparison, const ComparisonContext& context) {
    const Vec3 spacingMm = context.geometry.spacingMm();
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const ComparisonRow& row : comparison.rows) rows.push_back(toJson(row));
    const nlohmann::ordered_json report{
        {"input", fileName(context.input)},
        {"commit", context.commit.empty() ? nlohmann::ordered_json()
                                          : nlohmann::ordered_json(context.commit)},
        {"crop",
         context.crop.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(context.crop)},
        {"processor", processorName()},
        {"processors", std::thread::hardware_concurrency()},
        {"compiler", __VERSION__},
        {"vtk", vtkVersionText()},
        {"vtkBackend", comparison.vtkBackend},
        {"threads", comparison.threads},
        {"repeats", context.options.repeats},
        {"isovalue", context.options.isovalue},
        {"pixelType", adaptiso::toString(context.pixelType)},
        {"size", context.geometry.size},
        {"midpointsMeanVoxels", comparison.midpointsMeanVoxels},
        {"spacingMm", {spacingMm.x, spacingMm.y, spacingMm.z}},
        {"rows", rows}};
    out << report.dump(2) << '\n';
}

}  // namespace adaptiso::benchmarks
