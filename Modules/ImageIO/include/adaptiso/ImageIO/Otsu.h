#pragma once

#include "adaptiso/Core/Volume.h"

namespace adaptiso {

/// The isovalue that best splits a volume's samples into two classes [Otsu1979].
///
/// itk::OtsuThresholdCalculator works on a histogram of the finite samples (one bin a value for
/// integers that span at most 65536 values, else 1024 bins between the smallest and the largest).
/// ITK answers with the upper edge of the last bin of the low class; the isovalue returned is the
/// middle between the largest sample of the low class and the smallest of the high class, so it
/// lies halfway across an empty gap: 0 and 100 give 50, the integers 3 and 4 give 3.5.
///
/// \return  an isovalue in the samples' unit, low class < isovalue <= high class.
/// \throws  InvalidInput when all finite samples are equal, or none is finite.
/// Cost: three passes over the samples; the same answer whatever the thread count.
double otsuThreshold(const VolumeView& volume);

}  // namespace adaptiso
