#include "Canvas.h"

#include <cairo/cairo.h>

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <span>

#include "Png.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

void require(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS) {
        throw InternalError(std::string("Canvas: Cairo says ") + cairo_status_to_string(status));
    }
}

std::uint32_t packed(ReportColor c, std::uint8_t opacity = 0) {
    return std::uint32_t{opacity} << 24 | std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 |
           c[2];
}

/// The color of which Cairo holds `value`, its product with the opacity.
std::uint32_t unmultiplied(std::uint32_t value, std::uint32_t opacity) {
    if (opacity == 0) return 0;
    return std::min<std::uint32_t>(0xFF, (value * 0xFF + opacity / 2) / opacity);
}

/// Paints `packedAt(n)`, n from 0 row by row.
template <class PackedAt>
void paint(cairo_t* context, cairo_format_t format, int left, int top, int width, int height,
           const PackedAt& packedAt) {
    const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
        cairo_image_surface_create(format, width, height), cairo_surface_destroy);
    require(cairo_surface_status(surface.get()));
    unsigned char* data = cairo_image_surface_get_data(surface.get());
    const int stride = cairo_image_surface_get_stride(surface.get());
    for (int y = 0; y < height; ++y) {
        auto* row = reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
        for (int x = 0; x < width; ++x) {
            row[x] = packedAt(static_cast<std::size_t>(y) * width + x);
        }
    }
    cairo_surface_mark_dirty(surface.get());
    cairo_set_source_surface(context, surface.get(), left, top);
    cairo_paint(context);
}

}  // namespace

Canvas::Canvas(int width, int height, std::optional<ReportColor> ground)
    : width_(width),
      height_(height),
      surface_(cairo_image_surface_create(ground ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32, width,
                                          height),
               cairo_surface_destroy) {
    require(cairo_surface_status(surface_.get()));
    context_.reset(cairo_create(surface_.get()), cairo_destroy);
    require(cairo_status(context_.get()));
    if (ground) rectangle({0, 0}, width, height, *ground);
}

void Canvas::image(int left, int top, int width, int height,
                   const std::vector<std::uint8_t>& grey) {
    paint(context_.get(), CAIRO_FORMAT_RGB24, left, top, width, height, [&](std::size_t n) {
        return packed({grey[n], grey[n], grey[n]});
    });
}

void Canvas::image(int left, int top, int width, int height,
                   const std::vector<ReportColor>& colors) {
    paint(context_.get(), CAIRO_FORMAT_RGB24, left, top, width, height,
          [&](std::size_t n) { return packed(colors[n]); });
}

void Canvas::image(const std::vector<ReportColor>& colors,
                   const std::vector<std::uint8_t>& opacity) {
    paint(context_.get(), CAIRO_FORMAT_ARGB32, 0, 0, width_, height_,
          [&](std::size_t n) { return packed(colors[n], opacity[n]); });
}

void Canvas::setColor(ReportColor color) {
    cairo_set_source_rgb(context_.get(), color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
}

void Canvas::segments(const std::vector<std::pair<Pixel, Pixel>>& lines, ReportColor color,
                      double lineWidth) {
    setColor(color);
    cairo_set_line_width(context_.get(), lineWidth);
    cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);
    // a path of many pieces is slow to stroke: its parts are kept short
    constexpr std::size_t kPerStroke = 200;
    for (std::size_t n = 0; n < lines.size(); ++n) {
        cairo_move_to(context_.get(), lines[n].first.x, lines[n].first.y);
        cairo_line_to(context_.get(), lines[n].second.x, lines[n].second.y);
        if (n % kPerStroke == kPerStroke - 1) cairo_stroke(context_.get());
    }
    cairo_stroke(context_.get());
}

void Canvas::ring(Pixel middle, double radius, ReportColor color, double lineWidth) {
    setColor(color);
    cairo_set_line_width(context_.get(), lineWidth);
    cairo_new_path(context_.get());
    cairo_arc(context_.get(), middle.x, middle.y, radius, 0, 2 * std::numbers::pi);
    cairo_stroke(context_.get());
}

void Canvas::rectangle(Pixel corner, double width, double height, ReportColor color) {
    setColor(color);
    cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
    cairo_fill(context_.get());
}

void Canvas::setFont(double size, bool isBold) {
    cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           isBold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_.get(), size);
}

double Canvas::textWidth(const std::string& text, double size) {
    setFont(size, false);
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), text.c_str(), &extents);
    return extents.x_advance;
}

void Canvas::text(Pixel base, const std::string& text, double size, ReportColor color,
                  Anchor anchor, bool isBold) {
    setFont(size, isBold);
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), text.c_str(), &extents);
    const double part = anchor == Anchor::Left ? 0 : anchor == Anchor::Middle ? 0.5 : 1;
    setColor(color);
    cairo_move_to(context_.get(), base.x - part * extents.x_advance, base.y);
    cairo_show_text(context_.get(), text.c_str());
    cairo_new_path(context_.get());
}

void Canvas::label(Pixel base, const std::string& text, double size, Anchor anchor) {
    constexpr double kRim = 3.5;
    setFont(size, true);
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), text.c_str(), &extents);
    const double part = anchor == Anchor::Left ? 0 : anchor == Anchor::Middle ? 0.5 : 1;
    cairo_move_to(context_.get(), base.x - part * extents.x_advance, base.y);
    cairo_text_path(context_.get(), text.c_str());
    cairo_set_line_width(context_.get(), kRim);
    cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
    setColor(kBlack);
    cairo_stroke_preserve(context_.get());
    setColor(kWhite);
    cairo_fill(context_.get());
}

void Canvas::clip(Pixel corner, double width, double height) {
    cairo_save(context_.get());
    cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
    cairo_clip(context_.get());
}

void Canvas::restore() {
    cairo_restore(context_.get());
}

std::string Canvas::png() const {
    require(cairo_status(context_.get()));
    cairo_surface_flush(surface_.get());
    const unsigned char* data = cairo_image_surface_get_data(surface_.get());
    const int stride = cairo_image_surface_get_stride(surface_.get());
    const bool hasOpacity = cairo_image_surface_get_format(surface_.get()) == CAIRO_FORMAT_ARGB32;
    return pngOf(width_, height_, hasOpacity, [&](int y, std::span<std::uint8_t> samples) {
        const auto* row = reinterpret_cast<const std::uint32_t*>(data + std::ptrdiff_t{y} * stride);
        std::uint8_t* sample = samples.data();
        for (int x = 0; x < width_; ++x) {
            const std::uint32_t opacity = hasOpacity ? row[x] >> 24 : 0xFF;
            for (const int shift : {16, 8, 0}) {
                const std::uint32_t value = row[x] >> shift & 0xFF;
                *sample++ = static_cast<std::uint8_t>(unmultiplied(value, opacity));
            }
            if (hasOpacity) *sample++ = static_cast<std::uint8_t>(opacity);
        }
    });
}

}  // namespace adaptiso
