#pragma once

#include <cstdint>
#include <vector>

namespace adaptiso::giant {

/// A component of the whole surface.
struct GiantComponent {
    std::int64_t vertices = 0, triangles = 0;
    double areaMm2 = 0, volumeMm3 = 0;
    std::int64_t firstPart = 0;  ///< of all pieces' components, the first that is in it
    /// Measures of a closed component.
    std::int64_t eulerNumber() const { return vertices - triangles / 2; }
    std::int64_t genus() const { return (2 - eulerNumber()) / 2; }
    bool isCavity() const { return volumeMm3 < 0; }
};

/// The components of all pieces together.
struct GiantTotals {
    std::int64_t count = 0, cavities = 0, genus = 0, vertices = 0;
    double areaMm2 = 0, volumeMm3 = 0;
};

/// Components of a surface that grows piece by piece: parts of pieces, joined where they share a
/// vertex (union-find). A part is known by a number that is used again once nothing holds it, so
/// that only unfinished components take memory; of the finished ones the largest are kept.
class GrowingComponents {
public:
    static constexpr std::size_t kMostKept = 1000;

    /// A part that is held once; its sums are those of the piece.
    std::uint32_t add(const GiantComponent& sums);
    void hold(std::uint32_t part) { ++parts_[part].holders; }
    /// When nothing holds a component any more it is finished.
    void drop(std::uint32_t part);
    void join(std::uint32_t a, std::uint32_t b);
    void addVertex(std::uint32_t part) { ++parts_[rootOf(part)].sums.vertices; }

    /// Those that are not finished count as they are.
    void finishAll();
    const GiantTotals& totals() const { return totals_; }
    /// The largest volumes first, cavities last. \pre  finishAll()
    const std::vector<GiantComponent>& largest() const { return largest_; }

private:
    struct Part {
        GiantComponent sums;        ///< of a root
        std::uint32_t parent = 0;   ///< itself: a root
        std::uint64_t holders = 0;  ///< vertices, and parts whose parent it is; 0: not in use
    };
    std::uint32_t rootOf(std::uint32_t part);
    void finish(const GiantComponent& component);
    void keepLargest();

    std::vector<Part> parts_;
    std::vector<std::uint32_t> unused_;
    GiantTotals totals_;
    std::vector<GiantComponent> largest_;
};

}  // namespace adaptiso::giant
