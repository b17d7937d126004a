#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/io/detail/png.hpp"

namespace dynasurf::show {

/// A rectangle of a drawing, in points from the upper left corner; y runs downwards.
struct Panel {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  Panel shrunk(double by) const { return {x + by, y + by, width - 2 * by, height - 2 * by}; }
};

/// How a line is drawn; its width in points.
struct Pen {
  io::Colour colour{0, 0, 0};
  double width = 1;
  double opacity = 1;
};

/// Which end of a text lies at its point.
enum class Anchor { start, middle, end };
/// How a text is written; its size in points.
struct Lettering {
  double size = 11;
  Anchor anchor = Anchor::start;
  io::Colour colour{34, 34, 34};
  bool bold = false;
  bool upwards = false;  // turned to the left by a quarter
};

/// A drawing on white, kept as lines, areas and letters until it is written. Lengths are points.
class Canvas {
 public:
  /// Throws InputError unless both sides are positive and at most 32000.
  Canvas(double width, double height);
  ~Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;

  double width() const { return width_; }
  double height() const { return height_; }

  void line(std::span<const Vec2> points, const Pen& pen);
  void polygon(std::span<const Vec2> points, const io::Colour& fill, double opacity = 1);
  /// Triangles whose corners have colours that run into each other (Gouraud), later ones over earlier ones.
  struct Shaded {
    std::array<Vec2, 3> corners;
    std::array<io::Colour, 3> colours;
  };
  void shade(std::span<const Shaded> triangles);
  void rectangle(const Panel& box, const io::Colour& fill, double opacity = 1);
  void frame(const Panel& box, const Pen& pen);
  void disc(const Vec2& centre, double radius, const io::Colour& fill);
  /// A line with a head at `to`; shorter than its head: the head alone, smaller.
  void arrow(const Vec2& from, const Vec2& to, const Pen& pen);
  /// `at` is on the line that the letters stand on. UTF-8.
  void text(const Vec2& at, const std::string& words, const Lettering& lettering = {});
  double width_of(const std::string& words, const Lettering& lettering) const;
  /// A picture spread over a box: its pixels as squares, or blended.
  void raster(const io::Picture& picture, const Panel& box, bool blended = false);
  /// What is drawn until `unclip` shows inside the box alone.
  void clip(const Panel& box);
  void unclip();

  /// The drawing as pixels, `scale` of them to a point.
  io::Picture pixels(double scale = 1) const;
  /// The drawing as the text of an SVG file.
  std::string svg() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
  double width_, height_;
};

/// The formats of drawings.
enum class DrawingFormat { png, svg };
/// By the name's ending. Throws OptionError for another one.
DrawingFormat drawing_format_of(const std::filesystem::path& path);
/// Writes PNG, two pixels to a point (one in drawings of more than 6000 points), or SVG. The file appears whole or not
/// at all. Throws IoError.
void write_drawing(const Canvas& canvas, const std::filesystem::path& path, DrawingFormat format);

/// Drawings of one size that follow each other.
struct Film {
  std::vector<Canvas> frames;
  int milliseconds = 80;  // each
};
/// Writes an animated PNG that repeats, a pixel to a point. The file appears whole or not at all. Throws IoError.
void write_film(const Film& film, const std::filesystem::path& path);

}  // namespace dynasurf::show
