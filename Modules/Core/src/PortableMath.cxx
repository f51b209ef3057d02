#include "adaptiso/Core/PortableMath.h"

#include <cmath>
#include <utility>

namespace adaptiso::portable {
namespace {

/// high + low, |low| at most half an ulp of high.
struct Two {
    double high, low;
};

/// \pre |a| >= |b|, or a = 0
Two sumOf(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}
Two operator+(const Two& a, const Two& b) {
    const double sum = a.high + b.high, part = sum - a.high;
    const double rest = (a.high - (sum - part)) + (b.high - part);
    return sumOf(sum, rest + a.low + b.low);
}
Two operator*(const Two& a, const Two& b) {
    const double product = a.high * b.high;
    return sumOf(product, std::fma(a.high, b.high, -product) + (a.high * b.low + a.low * b.high));
}
Two operator/(const Two& a, double b) {
    const double quotient = a.high / b;
    return sumOf(quotient, (std::fma(-quotient, b, a.high) + a.low) / b);
}

constexpr double kNothing = 1e-34;  // beside 1
constexpr Two kOne{1, 0};

/// x - n * constant, of three doubles.
Two reduced(double x, double n, const double (&constant)[3]) {
    Two left{x, 0};
    for (const double part : constant) left = left + Two{-n, 0} * Two{part, 0};
    return left;
}

/// The series of exp(), by powers that step() goes on by; its terms fall.
template <class Step>
Two series(Two term, const Step& step) {
    Two sum = term;
    for (int n = 1; std::abs(term.high) > kNothing; ++n) {
        term = step(term, n);
        sum = sum + term;
    }
    return sum;
}

/// Sine and cosine.
std::pair<Two, Two> sineAndCosine(double x) {
    constexpr double kQuarter[]{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54,
                                -0x1.f1976b7ed8fbcp-110};
    const double quarters = std::nearbyint(x / kQuarter[0]);
    const Two angle = reduced(x, quarters, kQuarter), square = angle * angle;
    const Two minusSquare{-square.high, -square.low};
    const Two sine = series(
        angle, [&](const Two& t, int n) { return t * minusSquare / (2.0 * n * (2 * n + 1)); });
    const Two cosine = series(
        kOne, [&](const Two& t, int n) { return t * minusSquare / (2.0 * n * (2 * n - 1)); });
    const auto minus = [](const Two& t) { return Two{-t.high, -t.low}; };
    switch (static_cast<long long>(quarters) & 3) {
        case 0:
            return {sine, cosine};
        case 1:
            return {cosine, minus(sine)};
        case 2:
            return {minus(sine), minus(cosine)};
        default:
            return {minus(cosine), sine};
    }
}

/// exp(x) = mantissa * 2^exponent.
std::pair<Two, int> exponential(double x) {
    constexpr double kLogOfTwo[]{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56,
                                 0x1.7b57a079a1934p-111};
    const double exponent = std::nearbyint(x / kLogOfTwo[0]);
    const Two rest = reduced(x, exponent, kLogOfTwo);
    return {series(kOne, [&](const Two& t, int n) { return t * rest / n; }),
            static_cast<int>(exponent)};
}

}  // namespace

double sin(double x) {
    return sineAndCosine(x).first.high;
}

double cos(double x) {
    return sineAndCosine(x).second.high;
}

double exp(double x) {
    if (x < -745) return 0;
    const auto [mantissa, exponent] = exponential(x);
    return std::ldexp(mantissa.high, exponent);
}

double log(double x) {
    // a step of Newton's from what the library says
    const double about = std::log(x);
    const auto [mantissa, exponent] = exponential(-about);
    const Two ratio = mantissa * Two{std::ldexp(x, exponent), 0};
    return about + ((ratio.high - 1) + ratio.low);
}

double power(double x, int n) {
    Two result = kOne;
    for (int i = 0; i < n; ++i) result = result * Two{x, 0};
    return result.high;
}

double cubeRoot(double x) {
    const double about = std::cbrt(x);
    if (about == 0) return about;
    const Two square = Two{about, 0} * Two{about, 0};
    const Two cube = square * Two{about, 0};
    return about + ((x - cube.high) - cube.low) / (3 * square.high);
}

}  // namespace adaptiso::portable
