#pragma once

#include <vector>

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// The isovalue that best splits a volume's samples into two classes [Otsu1979].
///
/// Works on a histogram of the finite samples (one bin a value for integers that span at most 65536
/// values, else 1024 bins between the smallest and the largest), as
/// itk::OtsuMultipleThresholdsCalculator does. The isovalue is the middle between the largest
/// sample of the low class and the smallest of the high class, so it lies halfway across an empty
/// gap: 0 and 100 give 50, the integers 3 and 4 give 3.5.
///
/// \return  an isovalue in the samples' unit, low class < isovalue <= high class.
/// \throws  InvalidInput when all finite samples are equal, or none is finite.
/// Cost: a few parallel passes over the samples; the same answer whatever the thread count.
double otsuThreshold(const VolumeView& volume);

/// The isovalues that best split a volume's samples into two, three and so on to most + 1 classes,
/// ascending: first one isovalue, that of otsuThreshold(), then two, then three.
///
/// For several, every choice is tried among 256 bins (one a value for integers that span fewer),
/// between the percentiles 0.1 and 99.9, so that a few outliers do not make the bins coarse;
/// samples beyond count in the outermost bins.
///
/// \return  `most` lists; fewer where no more bins than that are filled
/// \throws  InvalidInput as otsuThreshold(), and unless 1 <= most <= 3 (more would take minutes)
std::vector<std::vector<double>> otsuThresholds(const VolumeView& volume, int most);

}  // namespace adaptiso
