#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/LabelPipeline/Masks.h"

namespace adaptiso {
namespace {

using std::int64_t;

constexpr int64_t kWordBits = 64;
constexpr int64_t kMaskGrain = int64_t{1} << 18;  // whole words of bits

/// Voxels that a mask takes, or finds taken.
struct Claim {
    int64_t voxels = 0, kept = 0, newlyShared = 0;
    std::map<Label, int64_t> lost;                        ///< by who has them
    int64_t fault = std::numeric_limits<int64_t>::max();  ///< the first voxel of another value

    void add(const Claim& more) {
        voxels += more.voxels;
        kept += more.kept;
        newlyShared += more.newlyShared;
        for (const auto& [label, count] : more.lost) lost[label] += count;
        fault = std::min(fault, more.fault);
    }
};

/// The value of a mask's voxels: the requested one, or the first that is not 0.
template <class S>
S insideOf(const TypedVolumeView<S>& view, const MaskSource& mask) {
    if (mask.value) return static_cast<S>(*mask.value);
    const S* const end = view.samples + view.geometry.voxelCount();
    const S* const first = std::find_if(view.samples, end, [](S sample) { return sample != S(0); });
    return first == end ? S(1) : *first;
}

/// Calls f(n, claim) for every voxel that the mask holds. \throws InvalidInput  it is no mask
template <class F>
Claim forEachInside(const VolumeView& image, const MaskSource& mask, const F& f) {
    return dispatchPixelType(image, [&]<class S>(const TypedVolumeView<S>& view) {
        const S inside = insideOf(view, mask);
        const int64_t count = view.geometry.voxelCount();
        std::vector<Claim> claims((count + kMaskGrain - 1) / kMaskGrain);
        parallelForPieces(count, kMaskGrain, [&](int64_t begin, int64_t end) {
            Claim& claim = claims[begin / kMaskGrain];
            for (int64_t n = begin; n < end; ++n) {
                const S sample = view.samples[n];
                if (sample == S(0)) continue;
                if (sample == inside) {
                    ++claim.voxels;
                    f(n, claim);
                } else if (!mask.value) {
                    claim.fault = n;
                    return;
                }
            }
        });
        Claim whole;
        for (const Claim& claim : claims) whole.add(claim);
        if (whole.fault < count) {
            const auto values = formatApart(
                {static_cast<double>(inside), static_cast<double>(view.samples[whole.fault])});
            throw InvalidInput(mask.file.string() + ": holds " + values[0] + " and " + values[1] +
                               " besides 0, so it is no mask, which has one value but 0; a label "
                               "map goes in alone (several make a batch)");
        }
        return whole;
    });
}

std::string sizeText(const Index3& size) {
    return std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " +
           std::to_string(size[2]);
}

/// Largest distance of a voxel's places in two images of one size.
double farthestMm(const ImageGeometry& a, const ImageGeometry& b) {
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 index;
        for (int axis = 0; axis < 3; ++axis) {
            index[axis] = (corner >> axis & 1) != 0 ? static_cast<double>(a.size[axis] - 1) : 0.0;
        }
        farthest = std::max(farthest, norm(a.toPhysical(index) - b.toPhysical(index)));
    }
    return farthest;
}

/// All masks have the voxels of `first`, as far as the digits of headers go.
void requireGrid(const MaskSource& mask, const ImageGeometry& own, const MaskSource& first,
                 const ImageGeometry& geometry) {
    constexpr double kMostVoxels = 1e-3;
    const std::string remedy = "; all masks need one grid: resample it";
    const std::string other = first.file.filename().string();
    if (own.size != geometry.size) {
        throw InvalidInput(mask.file.string() + ": has " + sizeText(own.size) + " voxels, " +
                           other + " " + sizeText(geometry.size) + remedy);
    }
    const double farthest = farthestMm(own, geometry);
    if (farthest > kMostVoxels * leastPlaneDistanceMm(geometry)) {
        throw InvalidInput(mask.file.string() + ": lies elsewhere than " + other + ", by up to " +
                           formatShort(farthest) + " mm" + remedy);
    }
}

/// Keeps what reading a mask warns of; what is the same of many once.
void addOnce(std::vector<Warning>& warnings, const std::vector<Warning>& more,
             const std::string& file) {
    for (Warning warning : more) {
        const bool isKnown = std::ranges::any_of(warnings, [&](const Warning& other) {
            return other.code == warning.code && other.text == warning.text;
        });
        if (isKnown) continue;
        if (warning.file.empty()) warning.file = file;
        warnings.push_back(std::move(warning));
    }
}

/// Reads masks of one map.
class MaskReader {
public:
    MaskReader(const std::vector<MaskSource>& masks, const ReadMask& read)
        : masks_(masks), read_(read) {}

    ReadVolume read(std::size_t n) {
        ReadVolume image = read_(masks_[n]);
        const ImageGeometry& own = image.volume.view().geometry();
        if (!first_) {
            first_ = n;
            geometry_ = own;
            format_ = image.format;
        }
        requireGrid(masks_[n], own, masks_[*first_], geometry_);
        addOnce(warnings_, image.warnings, masks_[n].file.filename().string());
        return image;
    }
    const ImageGeometry& geometry() const { return geometry_; }
    const std::string& format() const { return format_; }
    const std::vector<Warning>& warnings() const { return warnings_; }

private:
    const std::vector<MaskSource>& masks_;
    const ReadMask& read_;
    std::optional<std::size_t> first_;
    ImageGeometry geometry_;
    std::string format_;
    std::vector<Warning> warnings_;
};

/// Places of the masks, those that win first.
std::vector<std::size_t> orderOf(const MaskPriority& priority, const std::vector<MaskSource>& masks,
                                 MaskReader& reader) {
    std::vector<std::size_t> order(masks.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::ranges::sort(order, std::ranges::greater{},
                      [&](std::size_t n) { return std::pair(masks[n].name, masks[n].label); });
    if (priority.rule == MaskPriority::Rule::LastByName) return order;
    if (priority.rule == MaskPriority::Rule::Listed) {
        std::vector<std::size_t> listed = priority.listed;
        for (const std::size_t n : order) {
            if (std::ranges::count(listed, n) == 0) listed.push_back(n);
        }
        return listed;
    }
    std::vector<int64_t> voxels(masks.size());
    for (std::size_t n = 0; n < masks.size(); ++n) {
        const ReadVolume image = reader.read(n);
        voxels[n] = forEachInside(image.volume, masks[n], [](int64_t, Claim&) {}).voxels;
    }
    const bool isLargest = priority.rule == MaskPriority::Rule::Largest;
    std::ranges::stable_sort(order, {},
                             [&](std::size_t n) { return isLargest ? -voxels[n] : voxels[n]; });
    return order;
}

template <class T>
Volume join(const std::vector<MaskSource>& masks, const std::vector<std::size_t>& order,
            MaskReader& reader, JoinedMasks& joined) {
    std::vector<T> map;
    std::vector<std::uint64_t> isShared;
    joined.masks.resize(masks.size());
    for (const std::size_t m : order) {
        const ReadVolume image = reader.read(m);
        const auto count = static_cast<std::size_t>(reader.geometry().voxelCount());
        map.resize(count);
        isShared.resize(count / kWordBits + 1);
        const T label = static_cast<T>(masks[m].label);
        const Claim claim = forEachInside(image.volume, masks[m], [&](int64_t n, Claim& own) {
            if (map[n] == T(0)) {
                map[n] = label;
                ++own.kept;
                return;
            }
            ++own.lost[static_cast<Label>(map[n])];
            std::uint64_t& word = isShared[n / kWordBits];
            const std::uint64_t bit = std::uint64_t{1} << (n % kWordBits);
            own.newlyShared += (word & bit) == 0 ? 1 : 0;
            word |= bit;
        });
        joined.masks[m] = {masks[m].file.filename().string(), masks[m].name, masks[m].label,
                           claim.voxels, claim.kept};
        joined.sharedVoxels += claim.newlyShared;
        for (const auto& [winner, lost] : claim.lost) {
            joined.overlaps.push_back({winner, masks[m].label, lost});
        }
    }
    return Volume::fromSamples(std::move(map), reader.geometry());
}

/// Names of masks of which `isMeant` is true; several are cut short.
template <class Predicate>
std::string namesOf(const JoinedMasks& joined, const Predicate& isMeant, int64_t& count) {
    constexpr int64_t kMost = 5;
    std::string names;
    count = 0;
    for (const MaskFate& mask : joined.masks) {
        if (isMeant(mask) && ++count <= kMost) addPart(names, mask.name);
    }
    return names + (count > kMost ? ", ..." : "");
}

void warnOfMasks(const JoinedMasks& joined, const std::string& input,
                 std::vector<Warning>& warnings) {
    int64_t count = 0;
    std::string names = namesOf(
        joined, [](const MaskFate& mask) { return mask.voxels == 0; }, count);
    if (count > 0) {
        warnings.push_back(
            {"mask-empty",
             counted(count, "mask holds", "masks hold") + " no voxel, so no region: " + names,
             input});
    }
    names = namesOf(
        joined, [](const MaskFate& mask) { return mask.voxels > 0 && mask.keptVoxels == 0; },
        count);
    if (count > 0) {
        warnings.push_back({"mask-covered",
                            counted(count, "mask lies", "masks lie") +
                                " wholly within others that keep the voxels, so " +
                                (count == 1 ? "it has" : "they have") + " no region: " + names +
                                "; --priority says who keeps them",
                            input});
    }
    if (joined.sharedVoxels > 0) {
        warnings.push_back({"masks-overlap", overlapText(joined), input});
    }
}

}  // namespace

std::string MaskPriority::word() const {
    constexpr std::array<const char*, 4> kWords{"name", "largest", "smallest", "list"};
    return kWords[static_cast<std::size_t>(rule)];
}

std::string overlapText(const JoinedMasks& joined) {
    constexpr std::size_t kMost = 3;
    const std::vector<MaskOverlap>& overlaps = joined.overlaps;
    constexpr std::array<const char*, 4> kWinners{"last by name", "largest", "smallest",
                                                  "first of the list"};
    const auto nameOf = [&](Label label) {
        return std::ranges::find(joined.masks, label, &MaskFate::label)->name;
    };
    std::string text = counted(joined.sharedVoxels, "voxel lies", "voxels lie") +
                       " in more than one mask; the " +
                       kWinners[static_cast<std::size_t>(joined.priority)] + " keeps them: ";
    for (std::size_t n = 0; n < std::min(overlaps.size(), kMost); ++n) {
        text += (n == 0 ? "" : ", ") + nameOf(overlaps[n].winner) + " " +
                formatCount(overlaps[n].voxels) + " of " + nameOf(overlaps[n].loser);
    }
    const auto more = std::ssize(overlaps) - static_cast<int64_t>(kMost);
    return more > 0 ? text + ", and " + counted(more, "pair") + " more" : text;
}

MaskMap joinMasks(const std::vector<MaskSource>& masks, const MaskPriority& priority,
                  const ReadMask& read, const std::string& input) {
    MaskReader reader(masks, read);
    const std::vector<std::size_t> order = orderOf(priority, masks, reader);
    const auto labels = std::ranges::minmax(masks, {}, &MaskSource::label);
    const auto fits = [&]<class T>(T) {
        return std::in_range<T>(labels.min.label) && std::in_range<T>(labels.max.label);
    };
    JoinedMasks joined;
    joined.priority = priority.rule;
    Volume map = fits(std::uint8_t{})    ? join<std::uint8_t>(masks, order, reader, joined)
                 : fits(std::uint16_t{}) ? join<std::uint16_t>(masks, order, reader, joined)
                                         : join<Label>(masks, order, reader, joined);
    std::ranges::stable_sort(joined.overlaps, [](const auto& a, const auto& b) {
        return std::tuple(-a.voxels, a.winner, a.loser) < std::tuple(-b.voxels, b.winner, b.loser);
    });
    std::vector<Warning> warnings = reader.warnings();
    warnOfMasks(joined, input, warnings);
    return {std::move(map), reader.format(), std::move(joined), std::move(warnings)};
}

Json masksJson(const JoinedMasks& joined) {
    if (joined.masks.empty()) return nullptr;
    Json files = Json::array(), overlaps = Json::array();
    for (const MaskFate& mask : joined.masks) {
        files.push_back({{"file", mask.file},
                         {"label", mask.label},
                         {"voxels", mask.voxels},
                         {"keptVoxels", mask.keptVoxels}});
    }
    for (const MaskOverlap& overlap : joined.overlaps) {
        overlaps.push_back(
            {{"winner", overlap.winner}, {"loser", overlap.loser}, {"voxels", overlap.voxels}});
    }
    return {{"priority", MaskPriority{joined.priority}.word()},
            {"files", files},
            {"sharedVoxels", joined.sharedVoxels},
            {"overlaps", overlaps}};
}

}  // namespace adaptiso
