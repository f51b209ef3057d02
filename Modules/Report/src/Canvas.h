#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Report/Report.h"

struct _cairo;
struct _cairo_surface;

namespace adaptiso {

/// A point of a picture, pixels from its upper left corner.
struct Pixel {
    double x = 0, y = 0;
};

enum class Anchor { Left, Middle, Right };

/// A picture to draw on, in memory, by Cairo.
class Canvas {
public:
    /// \param ground  empty: transparent
    /// \throws InternalError
    Canvas(int width, int height, std::optional<ReportColor> ground);

    int width() const { return width_; }
    int height() const { return height_; }

    /// `grey`, row by row from the top, at its own size.
    void image(int left, int top, int width, int height, const std::vector<std::uint8_t>& grey);
    /// The same in colour.
    void image(int left, int top, int width, int height, const std::vector<ReportColor>& colors);
    /// The same over the whole picture. \param colors  already multiplied by `opacity` / 255
    void image(const std::vector<ReportColor>& colors, const std::vector<std::uint8_t>& opacity);

    void segments(const std::vector<std::pair<Pixel, Pixel>>& lines, ReportColor color,
                  double lineWidth);
    void ring(Pixel middle, double radius, ReportColor color, double lineWidth);
    void rectangle(Pixel corner, double width, double height, ReportColor color);
    /// \param base  left, middle or right end of the text's base line
    void text(Pixel base, const std::string& text, double size, ReportColor color,
              Anchor anchor = Anchor::Left, bool isBold = false);

    /// A white text with a dark rim, to be read on any ground.
    void label(Pixel base, const std::string& text, double size, Anchor anchor = Anchor::Left);

    double textWidth(const std::string& text, double size);

    /// Keeps drawing inside the rectangle until restore().
    void clip(Pixel corner, double width, double height);
    void restore();

    /// The file's bytes. \throws InternalError
    std::string png() const;

private:
    void setColor(ReportColor color);
    void setFont(double size, bool isBold);

    int width_, height_;
    std::shared_ptr<_cairo_surface> surface_;
    std::shared_ptr<_cairo> context_;
};

constexpr ReportColor kWhite{255, 255, 255};
constexpr ReportColor kBlack{0, 0, 0};
constexpr ReportColor kInk{31, 41, 55};
constexpr ReportColor kFaint{150, 158, 170};
constexpr ReportColor kAlarm{255, 72, 72};

}  // namespace adaptiso
