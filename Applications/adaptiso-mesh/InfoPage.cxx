#include "InfoPage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "Common/ReportOutput.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Preprocessing/Preprocess.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso::mesher {
namespace {

struct Candidate {
    double isovalue;
    std::string from;
};

/// Otsu's thresholds for two to four classes, without those that differ by less than 2 % of the
/// histogram's range.
std::vector<Candidate> candidatesOf(const ValueSummary& values) {
    std::vector<Candidate> candidates;
    const double near = 0.02 * (values.histogram->upper - values.histogram->lower);
    for (const std::vector<double>& thresholds : values.otsu) {
        for (const double value : thresholds) {
            const bool isNew = std::ranges::none_of(candidates, [&](const Candidate& c) {
                return std::abs(c.isovalue - value) < near;
            });
            if (!isNew) continue;
            candidates.push_back(
                {value, "Otsu, " + std::to_string(thresholds.size() + 1) + " classes"});
        }
    }
    return candidates;
}

/// The volume in larger voxels; empty where it is small, or its samples can't be blended.
std::optional<Volume> coarser(const VolumeView& volume, double& stepMm) {
    constexpr double kVoxels = 3e5;
    const auto count = static_cast<double>(volume.geometry().voxelCount());
    if (count <= 2 * kVoxels) return std::nullopt;
    stepMm = std::cbrt(volume.geometry().voxelVolumeMm3() * count / kVoxels);
    try {
        return resampleVolume(smoothVolume(volume, stepMm / 2).view(), stepMm,
                              Interpolation::Linear);
    } catch (const InvalidInput&) {
        return std::nullopt;
    }
}

/// The pieces at full resolution that the commands of the page keep.
TriangleMesh marchingCubes(const VolumeView& volume, double isovalue) {
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    return selectComponents(extractSurface(volume, options).mesh,
                            {.largestOnly = true, .fillCavities = true});
}

/// A slab of whole slices through the surface's middle that holds about `triangles` of it.
Volume slabThrough(const VolumeView& volume, const TriangleMesh& surface, double triangles) {
    std::vector<double> slices;
    slices.reserve(surface.points.size());
    for (const Vec3& p : surface.points) slices.push_back(volume.geometry().toIndex(p).z);
    std::ranges::sort(slices);
    const double share = std::min(1.0, triangles / static_cast<double>(surface.triangles.size()));
    const auto at = [&](double part) {
        return slices[static_cast<std::size_t>(part * static_cast<double>(slices.size() - 1))];
    };
    const std::int64_t size = volume.geometry().size[2];
    const auto first =
        std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(at(0.5 - share / 2))), 0,
                                 std::max<std::int64_t>(size - 2, 0));
    const auto end =
        std::clamp<std::int64_t>(static_cast<std::int64_t>(std::ceil(at(0.5 + share / 2))) + 1,
                                 std::min(first + 2, size), size);
    return cropVolume(volume, {{{}, {}, {first, end}}});
}

/// Triangles and file sizes by bound, estimated from a slab of the volume.
ReportTable boundsTable(const VolumeView& volume, const TriangleMesh& full, double isovalue) {
    constexpr double kProbeTriangles = 100'000;
    ReportTable table{"--max-error at isovalue " + formatShort(isovalue) + ", estimated",
                      {"Bound, mm", "Triangles", "STL file, MB"},
                      {}};
    const auto add = [&](const std::string& bound, double triangles) {
        const double digit = std::pow(10, std::max(0.0, std::floor(std::log10(triangles)) - 1));
        const double rounded = std::round(triangles / digit) * digit;  // two digits
        table.rows.push_back(
            {bound, formatCount(static_cast<long long>(rounded)), formatShort(50e-6 * rounded)});
    };
    const auto total = static_cast<double>(full.triangles.size());
    add("0 (--method mc)", total);
    const Volume slab = slabThrough(volume, full, kProbeTriangles);
    ExtractionOptions options;
    options.isovalue = isovalue;
    options.computeNormals = false;
    const double depth = static_cast<double>(slab.view().geometry().size[2]) - 1;
    const bool isPart = depth + 1 < static_cast<double>(volume.geometry().size[2]);
    const auto probe = [&] {
        const TriangleMesh mesh = selectComponents(
            extractSurface(slab.view(), options, Border::Open).mesh, {.largestOnly = true});
        std::int64_t count = 0;
        for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
            const double slice = slab.view().geometry().toIndex(middleOf(mesh, t)).z;
            // edges where the slab is cut stay short: they are no part of the surface
            if (!isPart || std::abs(slice - depth / 2) <= depth / 4) ++count;
        }
        return static_cast<double>(count);
    };
    options.method = Method::MarchingCubes;
    const double slabTotal = probe();
    if (slabTotal == 0) return table;
    options.method = Method::Adaptive;
    const double voxelMm =
        *requestedBoundMm(options, volume.geometry()) / AdaptiveOptions::kDefaultMaxErrorVoxels;
    for (const double voxels : {AdaptiveOptions::kDefaultMaxErrorVoxels, 0.25, 0.5, 1.0}) {
        const bool isDefault = voxels == AdaptiveOptions::kDefaultMaxErrorVoxels;
        options.adaptive.maxErrorMm = voxels * voxelMm;
        options.adaptive.leavesNoise = isDefault;
        add(formatShort(voxels * voxelMm) + (isDefault ? " (default)" : ""),
            total * probe() / slabTotal);
    }
    return table;
}

}  // namespace

Report infoReport(const std::string& name, const std::string& format, const VolumeView& volume,
                  const ValueSummary& values,
                  const std::function<std::string(const std::string&)>& commandWith) {
    Report report;
    report.title = "Isovalues of " + name;
    report.inputs = imageFacts(name, format, volume.geometry());
    report.volume = ReportVolume{name, volume};
    double stepMm = 0;
    const std::optional<Volume> preview = coarser(volume, stepMm);
    ReportTable table{
        "Isovalues to try", {"Isovalue", "From", "Triangles at full resolution", "Command"}, {}};
    report.histogram = ReportHistogram{
        values.histogram->lower, values.histogram->upper, values.histogram->counts, {}};
    std::optional<ReportTable> bounds;
    for (const Candidate& candidate : candidatesOf(values)) {
        const std::string value = formatShort(candidate.isovalue);
        TriangleMesh full = marchingCubes(volume, candidate.isovalue);
        if (full.triangles.empty()) continue;
        table.rows.push_back({value, candidate.from, formatCount(std::ssize(full.triangles)),
                              commandWith("--iso " + value + " --largest --fill-cavities")});
        if (!bounds) bounds = boundsTable(volume, full, candidate.isovalue);
        report.histogram->marks.push_back(candidate.isovalue);
        report.surfaces.push_back(
            {"isovalue " + value,
             preview ? marchingCubes(preview->view(), candidate.isovalue) : std::move(full)});
    }
    report.headline =
        "Isovalues to choose from. Outlines and surfaces have their isovalue's colour in the "
        "histogram" +
        (preview ? "; surfaces are drawn from voxels of " + formatFixed(stepMm, 1) + " mm." : ".");
    report.tables.push_back(std::move(table));
    if (bounds) {
        report.tables.push_back(std::move(*bounds));
        report.notes.push_back(
            "Numbers of triangles by bound are estimated from some slices in the middle.");
    }
    return report;
}

}  // namespace adaptiso::mesher
