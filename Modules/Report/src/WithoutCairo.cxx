#include "Canvas.h"
#include "adaptiso/Core/Errors.h"

/// A build without Cairo: reports with pictures are refused before anything is drawn.
namespace adaptiso {

Canvas::Canvas(int width, int height, std::optional<ReportColor>) : width_(width), height_(height) {
    throw InvalidInput("this build draws no pictures for reports; use the programs");
}
void Canvas::image(int, int, int, int, const std::vector<std::uint8_t>&) {}
void Canvas::image(int, int, int, int, const std::vector<ReportColor>&) {}
void Canvas::image(const std::vector<ReportColor>&, const std::vector<std::uint8_t>&) {}
void Canvas::segments(const std::vector<std::pair<Pixel, Pixel>>&, ReportColor, double) {}
void Canvas::ring(Pixel, double, ReportColor, double) {}
void Canvas::rectangle(Pixel, double, double, ReportColor) {}
void Canvas::text(Pixel, const std::string&, double, ReportColor, Anchor, bool) {}
void Canvas::label(Pixel, const std::string&, double, Anchor) {}
double Canvas::textWidth(const std::string&, double) {
    return 0;
}
void Canvas::clip(Pixel, double, double) {}
void Canvas::restore() {}
std::string Canvas::png() const {
    return {};
}

}  // namespace adaptiso
