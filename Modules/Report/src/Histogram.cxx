#include <algorithm>
#include <cmath>

#include "Canvas.h"
#include "Slices.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {

Picture histogramPicture(const ReportHistogram& histogram) {
    constexpr int kWidth = 1000, kHeight = 380, kSide = 30, kTop = 84, kBase = kHeight - 34;
    constexpr double kSpan = kWidth - 2 * kSide;
    Canvas canvas(kWidth, kHeight, kWhite);
    canvas.text({kSide, 26}, "Values of the image; bars are logarithmic", 16, kInk, Anchor::Left,
                true);
    const auto across = [&](double value) {
        return kSide + kSpan * (value - histogram.lower) / (histogram.upper - histogram.lower);
    };
    const auto most =
        static_cast<double>(*std::max_element(histogram.counts.begin(), histogram.counts.end()));
    const double width = kSpan / static_cast<double>(histogram.counts.size());
    for (std::size_t n = 0; n < histogram.counts.size(); ++n) {
        const double height = (kBase - kTop) *
                              std::log1p(static_cast<double>(histogram.counts[n])) /
                              std::log1p(std::max(most, 1.0));
        canvas.rectangle({kSide + static_cast<double>(n) * width, kBase - height}, width, height,
                         kFaint);
    }
    std::string marks;
    for (std::size_t n = 0; n < histogram.marks.size(); ++n) {
        const double x = across(std::clamp(histogram.marks[n], histogram.lower, histogram.upper));
        const std::string text = formatShort(histogram.marks[n]);
        const double top = 46 + 16 * static_cast<double>(n % 2);  // neighbours' texts stay apart
        canvas.rectangle({x - 3, top + 4}, 6, kBase - top - 4, kInk);
        canvas.rectangle({x - 2, top + 4}, 4, kBase - top - 4, surfaceColor(n));
        canvas.text({x, top}, text, 14, kInk, Anchor::Middle);
        marks += (marks.empty() ? "" : ", ") + text;
    }
    constexpr int kTicks = 4;
    for (int n = 0; n <= kTicks; ++n) {
        const double value =
            histogram.lower + (histogram.upper - histogram.lower) * n / double{kTicks};
        canvas.text({across(value), kHeight - 12}, formatShort(value), 13, kInk,
                    n == 0        ? Anchor::Left
                    : n == kTicks ? Anchor::Right
                                  : Anchor::Middle);
    }
    return {"histogram.png",
            "Histogram",
            "How often the image's values occur, from " + formatShort(histogram.lower) + " to " +
                formatShort(histogram.upper) + "; isovalues to try are marked: " + marks + ".",
            canvas.png(),
            canvas.width(),
            canvas.height()};
}

}  // namespace adaptiso
