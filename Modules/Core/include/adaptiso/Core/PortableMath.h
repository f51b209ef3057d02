#pragma once

/// Functions that vertices depend on and in whose last digit C libraries differ, rounded to the
/// nearest double: with the same digits by every library, on every processor.
///
/// They work with sums of two doubles [Shewchuk1997]. What lies within 1e-30 of the middle between
/// two doubles may be rounded either way, always the same.
namespace adaptiso::portable {

/// \pre |x| < 1e6, radians
double sin(double x);
double cos(double x);

/// 0 below -745. \pre x < 700
double exp(double x);

/// \pre x > 0, finite and normal
double log(double x);

/// x^n. \pre n >= 0
double power(double x, int n);

/// \pre x is 0, or |x| lies between 1e-280 and 1e280
double cubeRoot(double x);

}  // namespace adaptiso::portable
