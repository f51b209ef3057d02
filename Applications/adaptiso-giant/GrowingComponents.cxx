#include "GrowingComponents.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::giant {

std::uint32_t GrowingComponents::add(const GiantComponent& sums) {
    if (unused_.empty()) {
        if (parts_.size() == std::numeric_limits<std::uint32_t>::max()) {
            throw InvalidInput("the surface has more unfinished components than can be counted");
        }
        unused_.push_back(static_cast<std::uint32_t>(parts_.size()));
        parts_.emplace_back();
    }
    const std::uint32_t part = unused_.back();
    unused_.pop_back();
    parts_[part] = {sums, part, 1};
    return part;
}

std::uint32_t GrowingComponents::rootOf(std::uint32_t part) {
    std::uint32_t root = part;
    while (parts_[root].parent != root) root = parts_[root].parent;
    while (parts_[part].parent != root) {  // the way is made short
        const std::uint32_t parent = parts_[part].parent;
        parts_[part].parent = root;
        ++parts_[root].holders;
        const bool isHeldByOthers = parts_[parent].holders > 1;
        drop(parent);
        if (!isHeldByOthers) break;  // it is gone, and what it held let go
        part = parent;
    }
    return root;
}

void GrowingComponents::join(std::uint32_t a, std::uint32_t b) {
    std::uint32_t root = rootOf(a), other = rootOf(b);
    if (root == other) return;
    if (parts_[other].sums.firstPart < parts_[root].sums.firstPart) std::swap(root, other);
    GiantComponent &sums = parts_[root].sums, &more = parts_[other].sums;
    sums.vertices += more.vertices;
    sums.triangles += more.triangles;
    sums.areaMm2 += more.areaMm2;
    sums.volumeMm3 += more.volumeMm3;
    parts_[other].parent = root;
    ++parts_[root].holders;
}

void GrowingComponents::drop(std::uint32_t part) {
    while (--parts_[part].holders == 0) {
        const std::uint32_t parent = parts_[part].parent;
        unused_.push_back(part);
        if (parent == part) {
            finish(parts_[part].sums);
            return;
        }
        part = parent;
    }
}

void GrowingComponents::finish(const GiantComponent& component) {
    ++totals_.count;
    totals_.cavities += static_cast<std::int64_t>(component.isCavity());
    totals_.genus += component.genus();
    totals_.vertices += component.vertices;
    totals_.areaMm2 += component.areaMm2;
    totals_.volumeMm3 += component.volumeMm3;
    largest_.push_back(component);
    if (largest_.size() >= 2 * kMostKept) keepLargest();
}

void GrowingComponents::keepLargest() {
    std::sort(largest_.begin(), largest_.end(),
              [](const GiantComponent& a, const GiantComponent& b) {
                  return a.volumeMm3 != b.volumeMm3 ? a.volumeMm3 > b.volumeMm3
                                                    : a.firstPart < b.firstPart;
              });
    if (largest_.size() > kMostKept) largest_.resize(kMostKept);
}

void GrowingComponents::finishAll() {
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
        if (parts_[part].holders > 0 && parts_[part].parent == part) finish(parts_[part].sums);
    }
    parts_.clear();
    unused_.clear();
    keepLargest();
}

}  // namespace adaptiso::giant
