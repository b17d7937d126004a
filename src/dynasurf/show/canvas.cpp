#include "dynasurf/show/detail/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>

#include <cairo-svg.h>
#include <cairo.h>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

namespace dynasurf::show {
namespace {

struct Destroy {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Context = std::unique_ptr<cairo_t, Destroy>;
using Surface2d = std::unique_ptr<cairo_surface_t, Destroy>;

/// A cairo object keeps its first error and ignores every later call: one look after many calls tells of all of them.
void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS) throw IoError(std::string("cairo: ") + cairo_status_to_string(status));
}

void ink(cairo_t* c, const io::Colour& colour, double opacity) {
  cairo_set_source_rgba(c, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0, opacity);
}

void choose_font(cairo_t* c, const Lettering& l) {
  cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         l.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, l.size);
}

void path(cairo_t* c, std::span<const Vec2> points) {
  cairo_new_path(c);
  for (const Vec2& p : points) cairo_line_to(c, p[0], p[1]);
}

}  // namespace

struct Canvas::State {
  Surface2d surface;
  Context context;
};

Canvas::Canvas(double width, double height) : state_(std::make_unique<State>()), width_(width), height_(height) {
  constexpr double most = 32000;  // cairo's pictures end at 32767 pixels
  if (!(width > 0 && width <= most && height > 0 && height <= most))
    throw InputError("a drawing of " + std::to_string(width) + " x " + std::to_string(height) +
                     " points; expected sides above 0 and up to 32000");
  const cairo_rectangle_t extent{0, 0, width, height};
  // A recording keeps lines and letters, so that one drawing becomes pixels of any scale or SVG.
  state_->surface.reset(cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, &extent));
  state_->context.reset(cairo_create(state_->surface.get()));
  check(cairo_status(state_->context.get()));
  cairo_set_line_join(state_->context.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(state_->context.get(), CAIRO_LINE_CAP_ROUND);
  rectangle({0, 0, width, height}, {255, 255, 255});
}

Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;

void Canvas::line(std::span<const Vec2> points, const Pen& pen) {
  cairo_t* c = state_->context.get();
  path(c, points);
  ink(c, pen.colour, pen.opacity);
  cairo_set_line_width(c, pen.width);
  cairo_stroke(c);
}

void Canvas::polygon(std::span<const Vec2> points, const io::Colour& fill, double opacity) {
  cairo_t* c = state_->context.get();
  path(c, points);
  cairo_close_path(c);
  ink(c, fill, opacity);
  cairo_fill(c);
}

void Canvas::shade(std::span<const Shaded> triangles) {
  if (triangles.empty()) return;
  struct Destroy {
    void operator()(cairo_pattern_t* p) const { cairo_pattern_destroy(p); }
  };
  const std::unique_ptr<cairo_pattern_t, Destroy> pattern(cairo_pattern_create_mesh());
  cairo_pattern_t* p = pattern.get();
  for (const auto& [corners, colours] : triangles) {
    // A mesh pattern is made of patches with four sides. One that is given two gets a straight third and a last without
    // length: a triangle whose colours run into each other.
    cairo_mesh_pattern_begin_patch(p);
    cairo_mesh_pattern_move_to(p, corners[0][0], corners[0][1]);
    for (const std::size_t n : {1u, 2u}) cairo_mesh_pattern_line_to(p, corners[n][0], corners[n][1]);
    for (unsigned n = 0; n < 3; ++n)
      cairo_mesh_pattern_set_corner_color_rgb(p, n, colours[n][0] / 255.0, colours[n][1] / 255.0,
                                              colours[n][2] / 255.0);
    cairo_mesh_pattern_end_patch(p);
  }
  check(cairo_pattern_status(p));
  cairo_set_source(state_->context.get(), p);
  cairo_paint(state_->context.get());
  check(cairo_status(state_->context.get()));
}

void Canvas::rectangle(const Panel& b, const io::Colour& fill, double opacity) {
  cairo_t* c = state_->context.get();
  cairo_rectangle(c, b.x, b.y, b.width, b.height);
  ink(c, fill, opacity);
  cairo_fill(c);
}

void Canvas::frame(const Panel& b, const Pen& pen) {
  const Vec2 corners[] = {{b.x, b.y}, {b.right(), b.y}, {b.right(), b.bottom()}, {b.x, b.bottom()}, {b.x, b.y}};
  line(corners, pen);
}

void Canvas::disc(const Vec2& centre, double radius, const io::Colour& fill) {
  cairo_t* c = state_->context.get();
  cairo_new_path(c);
  cairo_arc(c, centre[0], centre[1], radius, 0, 2 * std::numbers::pi);
  ink(c, fill, 1);
  cairo_fill(c);
}

void Canvas::arrow(const Vec2& from, const Vec2& to, const Pen& pen) {
  const Vec2 way = to - from;
  const double length = way.norm();
  if (length <= 0) return;
  const Vec2 along = way / length, across(-along[1], along[0]);
  const double head = std::min(length, 2 + 2.5 * pen.width);
  const Vec2 neck = to - head * along;
  const Vec2 shaft[] = {from, neck}, tip[] = {to, neck + 0.45 * head * across, neck - 0.45 * head * across};
  line(shaft, pen);
  polygon(tip, pen.colour, pen.opacity);
}

double Canvas::width_of(const std::string& words, const Lettering& lettering) const {
  choose_font(state_->context.get(), lettering);
  cairo_text_extents_t extents{};
  cairo_text_extents(state_->context.get(), words.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(const Vec2& at, const std::string& words, const Lettering& lettering) {
  cairo_t* c = state_->context.get();
  // The plain text interface of cairo begins at the point; other anchors shift the text by a share of its advance.
  const double share = lettering.anchor == Anchor::start ? 0 : lettering.anchor == Anchor::middle ? 0.5 : 1;
  const double shift = share * width_of(words, lettering);
  cairo_save(c);
  cairo_translate(c, at[0], at[1]);
  if (lettering.upwards) cairo_rotate(c, -std::numbers::pi / 2);
  cairo_move_to(c, -shift, 0);
  ink(c, lettering.colour, 1);
  cairo_show_text(c, words.c_str());
  cairo_restore(c);
  check(cairo_status(c));
}

void Canvas::raster(const io::Picture& picture, const Panel& box, bool blended) {
  if (picture.width <= 0 || picture.height <= 0) return;
  cairo_t* c = state_->context.get();
  const Surface2d image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height));
  check(cairo_surface_status(image.get()));
  unsigned char* bytes = cairo_image_surface_get_data(image.get());
  const int stride = cairo_image_surface_get_stride(image.get());
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const io::Colour& p = picture(x, y);
      // RGB24 is a word of 32 bits in the machine's order of bytes, its upper eight bits unused.
      const std::uint32_t word = (std::uint32_t{p[0]} << 16) | (std::uint32_t{p[1]} << 8) | p[2];
      std::memcpy(bytes + static_cast<std::ptrdiff_t>(y) * stride + 4 * static_cast<std::ptrdiff_t>(x), &word, 4);
    }
  cairo_surface_mark_dirty(image.get());  // its bytes were written without cairo
  cairo_save(c);
  cairo_translate(c, box.x, box.y);
  cairo_scale(c, box.width / picture.width, box.height / picture.height);
  cairo_set_source_surface(c, image.get(), 0, 0);
  check(cairo_status(c));  // of a failed context the source is no pattern of its own
  cairo_pattern_set_filter(cairo_get_source(c), blended ? CAIRO_FILTER_BILINEAR : CAIRO_FILTER_NEAREST);
  // Blending takes neighbours from beyond the picture: PAD repeats its rim, where the default is transparent.
  cairo_pattern_set_extend(cairo_get_source(c), CAIRO_EXTEND_PAD);
  cairo_rectangle(c, 0, 0, picture.width, picture.height);
  cairo_fill(c);
  cairo_restore(c);
}

void Canvas::clip(const Panel& box) {
  cairo_t* c = state_->context.get();
  cairo_save(c);
  cairo_rectangle(c, box.x, box.y, box.width, box.height);
  cairo_clip(c);
}

void Canvas::unclip() { cairo_restore(state_->context.get()); }

io::Picture Canvas::pixels(double scale) const {
  check(cairo_status(state_->context.get()));  // lines and areas do not look: a drawing is whole or an error
  const int w = std::max(1, round_int(width_ * scale));
  const int h = std::max(1, round_int(height_ * scale));
  const Surface2d image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, w, h));
  const Context context(cairo_create(image.get()));
  cairo_scale(context.get(), scale, scale);
  cairo_set_source_surface(context.get(), state_->surface.get(), 0, 0);
  cairo_paint(context.get());
  check(cairo_status(context.get()));
  cairo_surface_flush(image.get());  // before its bytes are read
  const unsigned char* bytes = cairo_image_surface_get_data(image.get());
  const int stride = cairo_image_surface_get_stride(image.get());
  io::Picture picture(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      std::uint32_t word = 0;
      std::memcpy(&word, bytes + static_cast<std::ptrdiff_t>(y) * stride + 4 * static_cast<std::ptrdiff_t>(x), 4);
      picture(x, y) = {static_cast<std::uint8_t>(word >> 16), static_cast<std::uint8_t>(word >> 8),
                       static_cast<std::uint8_t>(word)};
    }
  return picture;
}

std::string Canvas::svg() const {
  check(cairo_status(state_->context.get()));
  std::string text;
  const auto append = [](void* to, const unsigned char* bytes, unsigned int count) {
    // No exception may pass through cairo, which is C.
    try {
      static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(bytes), count);
      return CAIRO_STATUS_SUCCESS;
    } catch (const std::bad_alloc&) {
      return CAIRO_STATUS_NO_MEMORY;
    }
  };
  const Surface2d surface(cairo_svg_surface_create_for_stream(append, &text, width_, height_));
  {
    const Context context(cairo_create(surface.get()));
    cairo_set_source_surface(context.get(), state_->surface.get(), 0, 0);
    cairo_paint(context.get());
    check(cairo_status(context.get()));
  }
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return text;
}

DrawingFormat drawing_format_of(const std::filesystem::path& path) {
  if (path.extension() == ".png") return DrawingFormat::png;
  if (path.extension() == ".svg") return DrawingFormat::svg;
  throw OptionError("--out " + path.string() + ": expected a name that ends with .png or .svg");
}

void write_drawing(const Canvas& canvas, const std::filesystem::path& path, DrawingFormat format) {
  if (format == DrawingFormat::png)
    io::write_png(canvas.pixels(std::max(canvas.width(), canvas.height()) > 6000 ? 1 : 2), path);
  else
    io::write_file(path, canvas.svg());
}

void write_film(const Film& film, const std::filesystem::path& path) {
  std::vector<io::Picture> pictures;
  for (const Canvas& frame : film.frames) pictures.push_back(frame.pixels());
  io::write_file(path, io::encode_animation(pictures, film.milliseconds));
}

}  // namespace dynasurf::show
