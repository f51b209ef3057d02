// [Shewchuk1997] J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust
// Geometric Predicates, Discrete & Computational Geometry 18:305-363. Figures and theorems below
// are his. Departure: between the filter and the exact result there are no further stages; the
// expansions drop their zeros, so that exact differences (the usual case) cost little.
//
// Compiled with -ffp-contract=off: a fused multiply-add would break the error-free transforms.
#include <cmath>
#include <cstddef>

#include "adaptiso/Core/Geometry.h"

namespace adaptiso {
namespace {

constexpr double kEpsilon = 0x1p-53;                         // half an ulp of 1
constexpr double kBound2d = (3 + 16 * kEpsilon) * kEpsilon;  // section 4.2: ccwerrboundA
constexpr double kBound3d = (7 + 56 * kEpsilon) * kEpsilon;  // section 4.3: o3derrboundA

struct Sum {
    double high, low;  ///< high + low is exact, high the rounded result
};

/// Theorem 7 (Knuth).
Sum twoSum(double a, double b) {
    const double high = a + b;
    const double bVirtual = high - a;
    const double aVirtual = high - bVirtual;
    return {high, (a - aVirtual) + (b - bVirtual)};
}

/// Theorem 17 (Dekker): a in two halves of 26 bits.
Sum split(double a) {
    constexpr double kSplitter = 0x1p27 + 1;
    const double c = kSplitter * a;
    const double high = c - (c - a);
    return {high, a - high};
}

/// Theorem 18 (Veltkamp, Dekker).
Sum twoProduct(double a, double b) {
    const double high = a * b;
    const Sum x = split(a), y = split(b);
    const double error = ((high - x.high * y.high) - x.low * y.high) - x.high * y.low;
    return {high, x.low * y.low - error};
}

/// An exact number: the sum of non-overlapping doubles of growing size, without zeros. Room for
/// `Capacity` of them; the types below make sure that it is enough.
template <std::size_t Capacity>
struct Expansion {
    std::array<double, Capacity> term;
    std::size_t size = 0;

    /// Grow-Expansion (figure 6), dropping zeros.
    void add(double b) {
        double carry = b;
        std::size_t kept = 0;
        for (std::size_t n = 0; n < size; ++n) {
            const Sum sum = twoSum(carry, term[n]);
            carry = sum.high;
            if (sum.low != 0) term[kept++] = sum.low;
        }
        if (carry != 0) term[kept++] = carry;
        size = kept;
    }

    /// The largest term is larger than all others together.
    int sign() const { return size == 0 ? 0 : term[size - 1] > 0 ? 1 : -1; }
};

/// a - b.
Expansion<2> difference(double a, double b) {
    Expansion<2> result;
    const Sum d = twoSum(a, -b);
    result.add(d.low);
    result.add(d.high);
    return result;
}

template <std::size_t N, std::size_t M>
Expansion<N + M> operator+(const Expansion<N>& a, const Expansion<M>& b) {
    Expansion<N + M> result;
    for (std::size_t n = 0; n < a.size; ++n) result.term[n] = a.term[n];
    result.size = a.size;
    for (std::size_t n = 0; n < b.size; ++n) result.add(b.term[n]);
    return result;
}

template <std::size_t N>
Expansion<N> operator-(Expansion<N> a) {
    for (std::size_t n = 0; n < a.size; ++n) a.term[n] = -a.term[n];
    return a;
}

template <std::size_t N, std::size_t M>
Expansion<2 * N * M> operator*(const Expansion<N>& a, const Expansion<M>& b) {
    Expansion<2 * N * M> result;
    for (std::size_t n = 0; n < a.size; ++n) {
        for (std::size_t m = 0; m < b.size; ++m) {
            const Sum product = twoProduct(a.term[n], b.term[m]);
            result.add(product.low);
            result.add(product.high);
        }
    }
    return result;
}

int orient2dExact(const Point2& a, const Point2& b, const Point2& c) {
    return (difference(b[0], a[0]) * difference(c[1], a[1]) +
            -(difference(b[1], a[1]) * difference(c[0], a[0])))
        .sign();
}

int orient3dExact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto ux = difference(b.x, a.x), uy = difference(b.y, a.y), uz = difference(b.z, a.z);
    const auto vx = difference(c.x, a.x), vy = difference(c.y, a.y), vz = difference(c.z, a.z);
    const auto wx = difference(d.x, a.x), wy = difference(d.y, a.y), wz = difference(d.z, a.z);
    const auto x = wx * (uy * vz + -(uz * vy));
    const auto y = wy * (uz * vx + -(ux * vz));
    const auto z = wz * (ux * vy + -(uy * vx));
    return (x + y + z).sign();
}

}  // namespace

int orient2d(const Point2& a, const Point2& b, const Point2& c) {
    const double left = (b[0] - a[0]) * (c[1] - a[1]);
    const double right = (b[1] - a[1]) * (c[0] - a[0]);
    const double value = left - right;
    const double size = std::abs(left) + std::abs(right);
    const double bound = kBound2d * size;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return size == 0 ? 0 : orient2dExact(a, b, c);
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double yz = u.y * v.z, zy = u.z * v.y;
    const double zx = u.z * v.x, xz = u.x * v.z;
    const double xy = u.x * v.y, yx = u.y * v.x;
    const double value = w.x * (yz - zy) + w.y * (zx - xz) + w.z * (xy - yx);
    const double size = (std::abs(yz) + std::abs(zy)) * std::abs(w.x) +
                        (std::abs(zx) + std::abs(xz)) * std::abs(w.y) +
                        (std::abs(xy) + std::abs(yx)) * std::abs(w.z);
    const double bound = kBound3d * size;
    if (value > bound) return 1;
    if (value < -bound) return -1;
    return size == 0 ? 0 : orient3dExact(a, b, c, d);  // 0: a plane across an axis, d in it
}

}  // namespace adaptiso
