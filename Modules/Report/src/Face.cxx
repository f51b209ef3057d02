#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "Scene.h"
#include "Slices.h"

namespace adaptiso {
namespace {

constexpr double kBelowTopMm = 45, kFall = 0.9;  // of an adult's head
constexpr double kLengthMm = 180;                // of such a head, in its upper 50 mm
constexpr double kVaultMm = 50;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Samples of the image that are no air, thinned to about 2 mm, in RAS.
struct Sample {
    Vec3 point;
    double areaMm2;  ///< that it stands for in a layer of kLayerMm
    bool isAtBorder;
};
constexpr double kLayerMm = 2;

template <class Body>
void forEachTissueSample(const VolumeView& volume, const Body& body) {
    constexpr double kAir = 0.2;  // of the window; noise of air lies below, skin above
    const ImageGeometry& image = volume.geometry();
    const ValueRange window = greyWindow(volume);
    const double least = window.minimum + kAir * (window.maximum - window.minimum);
    Index3 step{1, 1, 1};
    const Vec3 spacing = image.spacingMm();
    double volumeMm3 = image.voxelVolumeMm3();
    for (int axis = 0; axis < 3; ++axis) {
        step[axis] = std::clamp<std::int64_t>(std::llround(2 / spacing[axis]), 1,
                                              std::max<std::int64_t>(image.size[axis] / 8, 1));
        volumeMm3 *= static_cast<double>(step[axis]);
    }
    dispatchPixelType(volume, [&](const auto& view) {
        for (std::int64_t k = 0; k < image.size[2]; k += step[2]) {
            for (std::int64_t j = 0; j < image.size[1]; j += step[1]) {
                for (std::int64_t i = 0; i < image.size[0]; i += step[0]) {
                    if (!(static_cast<double>(view.at(i, j, k)) >= least)) continue;
                    const Index3 at{i, j, k};
                    bool isAtBorder = false;
                    for (int axis = 0; axis < 3; ++axis) {
                        isAtBorder = isAtBorder || at[axis] < step[axis] ||
                                     at[axis] + step[axis] >= image.size[axis];
                    }
                    body(Sample{lpsToRas(image.toPhysical({double(i), double(j), double(k)})),
                                volumeMm3 / kLayerMm, isAtBorder});
                }
            }
        }
    });
}

/// The outermost layers, of 2 mm, in which enough of the samples lie.
std::pair<double, double> extent(const std::map<std::int64_t, double>& areas, double least) {
    double first = kFar, last = -kFar;
    for (const auto& [layer, area] : areas) {
        if (area < least) continue;
        first = std::min(first, kLayerMm * static_cast<double>(layer));
        last = std::max(last, kLayerMm * static_cast<double>(layer + 1));
    }
    return {first, last};
}

std::int64_t layerOf(double mm) {
    return static_cast<std::int64_t>(std::floor(mm / kLayerMm));
}

}  // namespace

Inside::Inside(const SceneMesh& surface) {
    if (surface.isEmpty()) return;
    box_ = boxOf(surface);
    for (int axis = 0; axis < 3; ++axis) {
        size_[axis] = static_cast<std::int64_t>(box_.maximum[axis] - box_.minimum[axis]) + 1;
    }
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(size_[0] * size_[1]));
    surface.forEachTriangle([&](const Triangle& t) {
        const Vec3 a = surface.point(t[0]) - box_.minimum, b = surface.point(t[1]) - box_.minimum,
                   c = surface.point(t[2]) - box_.minimum;
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (area == 0) return;
        const auto first = [](double p, double q, double r) {
            return std::max<std::int64_t>(0, std::llround(std::ceil(std::min({p, q, r}) - 0.5)));
        };
        const auto last = [](double p, double q, double r, std::int64_t size) {
            return std::min(size - 1,
                            std::int64_t{std::llround(std::floor(std::max({p, q, r}) - 0.5))});
        };
        for (std::int64_t j = first(a.y, b.y, c.y); j <= last(a.y, b.y, c.y, size_[1]); ++j) {
            for (std::int64_t i = first(a.x, b.x, c.x); i <= last(a.x, b.x, c.x, size_[0]); ++i) {
                const double x = double(i) + 0.5, y = double(j) + 0.5;
                const double u = ((b.x - x) * (c.y - y) - (b.y - y) * (c.x - x)) / area;
                const double v = ((c.x - x) * (a.y - y) - (c.y - y) * (a.x - x)) / area;
                if (u < 0 || v < 0 || u + v > 1) continue;
                crossings[static_cast<std::size_t>(j * size_[0] + i)].push_back(u * a.z + v * b.z +
                                                                                (1 - u - v) * c.z);
            }
        }
    });
    cells_.resize(crossings.size() * static_cast<std::size_t>(size_[2]));
    for (std::size_t column = 0; column < crossings.size(); ++column) {
        std::vector<double>& line = crossings[column];
        std::sort(line.begin(), line.end());
        if (line.size() % 2 != 0) continue;
        for (std::size_t n = 0; n + 1 < line.size(); n += 2) {
            for (auto k = static_cast<std::int64_t>(std::ceil(line[n] - 0.5));
                 k < size_[2] && double(k) + 0.5 <= line[n + 1]; ++k) {
                if (k >= 0) cells_[column * static_cast<std::size_t>(size_[2]) + k] = true;
            }
        }
    }
}

bool Inside::holds(const Vec3& rasMm) const {
    Index3 at;
    for (int axis = 0; axis < 3; ++axis) {
        const double place = rasMm[axis] - box_.minimum[axis];
        if (!(place >= 0 && place < static_cast<double>(size_[axis]))) return false;
        at[axis] = static_cast<std::int64_t>(place);
    }
    return cells_[static_cast<std::size_t>((at[1] * size_[0] + at[0]) * size_[2] + at[2])];
}

FaceCut::FaceCut(const Report& report, const std::vector<SceneMesh>& surfaces) {
    if (report.volume) {
        findIn(report.volume->view);
    } else {
        findIn(surfaces);
    }
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        if (report.surfaces[n].isWithinSkull) staying_.emplace_back(surfaces[n]);
    }
}

void FaceCut::take(const Vault& vault) {
    constexpr double kShortestMm = 90, kLongestMm = 235;
    const double length = vault.frontMm - vault.backMm;
    if (!(length >= kShortestMm && length <= kLongestMm)) {
        reason_ = "nothing there has the size of a head";
        return;
    }
    // a headrest lengthens the head; it must not lower the plane
    constexpr double kLeast = 0.5, kMost = 1.1;
    plane_ = Plane{vault.topMm, vault.frontMm, std::clamp(length / kLengthMm, kLeast, kMost)};
}

void FaceCut::findIn(const VolumeView& volume) {
    constexpr double kCapMm2 = 800;      // of a head's cap 1.5 mm below its top
    constexpr double kCutMm2 = 1500;     // more than that at the image's border: the top is cut off
    constexpr double kProfileMm2 = 100;  // of a head across, within the slab, in a layer
    std::map<std::int64_t, double> byHeight, byDepth;
    forEachTissueSample(volume,
                        [&](const Sample& s) { byHeight[layerOf(s.point.z)] += s.areaMm2; });
    const double top = extent(byHeight, kCapMm2).second;
    double atBorder = 0;
    forEachTissueSample(volume, [&](const Sample& s) {
        if (s.point.z < top - kVaultMm) return;
        byDepth[layerOf(s.point.y)] += s.areaMm2;
        if (s.isAtBorder && s.point.z > top - 3 * kLayerMm) atBorder += s.areaMm2;
    });
    if (atBorder > kCutMm2) {
        reason_ = "the top of the head is not in the image";
        return;
    }
    const auto [back, front] = extent(byDepth, kProfileMm2);
    take({top, front, back});
}

void FaceCut::findIn(const std::vector<SceneMesh>& surfaces) {
    constexpr double kCutMm2 = 3000;  // the upper 2 mm of a sphere of 85 mm have 1,070
    double top = -kFar;
    for (const SceneMesh& surface : surfaces) top = std::max(top, boxOf(surface).maximum.z);
    double front = -kFar, back = kFar, flatMm2 = 0;
    for (const SceneMesh& surface : surfaces) {
        surface.forEachTriangle([&](const Triangle& t) {
            bool isAtTop = true;
            for (const VertexId v : t) {
                const Vec3 p = surface.point(v);
                isAtTop = isAtTop && p.z > top - 2;
                if (p.z < top - kVaultMm) continue;
                front = std::max(front, p.y);
                back = std::min(back, p.y);
            }
            if (!isAtTop) return;
            flatMm2 += 0.5 * norm(areaVector2(surface.point(t[0]), surface.point(t[1]),
                                              surface.point(t[2])));
        });
    }
    if (flatMm2 > kCutMm2) {
        reason_ = "the surfaces have no top of a head";
        return;
    }
    take({top, front, back});
}

bool FaceCut::hides(const Vec3& p) const {
    if (plane_ &&
        p.z >= plane_->topMm - plane_->scale * (kBelowTopMm + kFall * (plane_->frontMm - p.y))) {
        return false;
    }
    return std::none_of(staying_.begin(), staying_.end(),
                        [&](const Inside& inside) { return inside.holds(p); });
}

double FaceCut::belowTopMm() const {
    return plane_ ? plane_->scale * kBelowTopMm : 0;
}

}  // namespace adaptiso
