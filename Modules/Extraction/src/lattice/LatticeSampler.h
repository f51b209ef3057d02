#pragma once

#include <cstdint>
#include <memory>

#include "adaptiso/Core/Geometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/BlockGrid.h"

namespace adaptiso::detail {

/// An edge between two neighbouring samples: from `sample` one step along `axis`.
struct LatticeEdge {
    Index3 sample;
    int axis;
};

/// The place and the outward normal of a crossing, physical space (LPS mm). The normal is zero
/// where the volume has no gradient.
struct Crossing {
    Vec3 pointMm;
    Vec3 normal;
};

/// Crossings keep this far from lattice points, as a part of the lattice edge: values equal to the
/// isovalue would let several crossings fall together on a sample and pinch the surface there.
inline constexpr double kHair = 1e-3;

/// A volume seen at one isovalue: which samples are inside, how the surface crosses the edges
/// between them. The one place that knows the pixel type and what lies beyond the border:
/// with Border::Closed samples out there are outside, with Border::Open they repeat the last one.
class LatticeSampler {
public:
    static std::unique_ptr<LatticeSampler> make(const VolumeView& volume, double isovalue,
                                                Border border);
    /// For a volume with a closed border of which only a part is in memory: all indices are those
    /// of the whole. \pre nothing is asked that needs samples of the volume that are not there
    /// \param window  the samples that are there; its geometry's size alone counts
    /// \param first   index of its first sample
    static std::unique_ptr<LatticeSampler> makeOfWindow(const VolumeView& window,
                                                        const Index3& first,
                                                        const ImageGeometry& whole,
                                                        double isovalue);
    virtual ~LatticeSampler() = default;

    /// Inside bits of a cube of `count`^3 samples (count <= 32) starting at `first`: bit x of
    /// rows[z * count + y].
    virtual void insideRows(const Index3& first, int count, std::uint32_t* rows) const = 0;

    /// Decides an ambiguous unit square (its diagonals differ): does the inside join across it?
    /// Asymptotic decider [Nielson1991]: the bilinear saddle is inside. A tie joins; a square with
    /// a virtual sample or NaN does not. Both cells at the square get the same answer.
    /// \param corner  the square's sample of lowest index
    /// \param normal  axis at right angles to the square
    virtual bool insideJoins(const Index3& corner, int normal) const = 0;

    /// Where along an edge (0 to 1) the surface crosses it, by linear interpolation, kHair or more
    /// from its ends; half-way towards a virtual sample.
    /// \pre one end is inside, the other is not
    virtual double crossingAlong(const LatticeEdge& edge) const = 0;

    /// The same crossing in physical space, and the normal there: from central differences
    /// (one-sided at the border) at the two samples, interpolated, taken to physical space.
    /// \pre one end is inside, the other is not
    virtual Crossing crossing(const LatticeEdge& edge) const = 0;

    /// As crossing(), but in the middle of the edge, whatever the samples.
    virtual Crossing midpoint(const LatticeEdge& edge) const = 0;

    /// The outward unit normal (physical space) at a continuous index: central differences at the
    /// eight samples around it, interpolated. Zero where there is no gradient, and beyond a closed
    /// border.
    virtual Vec3 normalAt(const Vec3& index) const = 0;
};

}  // namespace adaptiso::detail
