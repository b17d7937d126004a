#include <cstring>
#include <memory>
#include <optional>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/las.hpp"
#include "dynasurf/io/detail/laz_colours.hpp"

// LAZ, items of version 3 (LAS 1.4): each property of a chunk's points is a layer of its own, and what is not asked for
// is skipped. The points of each channel of the scanner are predicted from their own.

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t channels = 4;

enum Layer { places, heights, kinds, flags, intensities, angles, users, sources, times, layers };

/// Which differences of the points before are looked at for a point: return r of n.
constexpr std::array<std::array<std::uint8_t, 16>, 16> context_of_return{
    {{0, 1, 2, 3, 4, 5, 3, 4, 4, 5, 5, 5, 5, 5, 5, 5},
     {1, 0, 1, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3},
     {2, 1, 2, 4, 4, 4, 4, 4, 4, 4, 4, 3, 3, 3, 3, 3},
     {3, 3, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
     {4, 3, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
     {5, 3, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4},
     {3, 3, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4, 4},
     {4, 3, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4, 4},
     {4, 3, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4, 4},
     {5, 3, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4, 4},
     {5, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 4, 4, 4, 4, 4},
     {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 4, 4, 4},
     {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4, 4},
     {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 4},
     {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5},
     {5, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5}}};

/// A point as the points after it are predicted from it.
struct Point {
  std::array<std::int32_t, 3> place;
  std::uint32_t number, returns, flags, kind, source;  // flags: withheld and others, then direction and edge
  bool has_new_time;
};

Point point_of(const char* record) {
  const auto byte = [&](std::size_t place) { return std::uint32_t{static_cast<unsigned char>(record[place])}; };
  Point point{};
  for (std::size_t axis = 0; axis < 3; ++axis) point.place[axis] = load<std::int32_t>(record + 4 * axis);
  point.number = byte(14) & 15;
  point.returns = byte(14) >> 4;
  point.flags = (byte(15) & 15) | (byte(15) >> 6) << 4;
  point.kind = byte(16);
  point.source = load<std::uint16_t>(record + 20);
  return point;
}

void store(const Point& point, std::uint32_t channel, char* record) {
  std::memcpy(record, point.place.data(), sizeof point.place);
  record[14] = static_cast<char>(point.number | point.returns << 4);
  record[15] = static_cast<char>((point.flags & 15) | channel << 4 | (point.flags >> 4) << 6);
  record[16] = static_cast<char>(point.kind);
  const auto source = static_cast<std::uint16_t>(point.source);
  std::memcpy(record + 20, &source, sizeof source);
}

struct Channel {
  Point last;
  std::array<SymbolModel, 8> changed;
  SymbolModel other_channel, number_at_same_time;
  std::array<SymbolModel, 16> returns, number;
  IntegerModel x{32, 2}, y{32, 22}, z{32, 20}, source{16, 1};
  std::array<LazMedian, 12> x_steps, y_steps;
  std::array<std::int32_t, 8> z_before;
  std::array<SymbolModel, 64> kinds, flags;

  explicit Channel(const Point& point) : last(point) {
    last.has_new_time = false;
    z_before.fill(point.place[2]);
  }
};

/// The layers of a chunk that are read. Of an empty one no point differs from the first.
class Points {
 public:
  Points(const std::array<std::string_view, layers>& layer, const char* first)
      : place_(layer[places]),
        height_(layer[heights]),
        kind_(layer[kinds]),
        flag_(layer[flags]),
        source_(layer[sources]),
        has_height_(!layer[heights].empty()),
        has_kind_(!layer[kinds].empty()),
        has_flag_(!layer[flags].empty()),
        has_source_(!layer[sources].empty()),
        now_(static_cast<unsigned char>(first[15]) >> 4 & 3u) {
    channel_[now_] = std::make_unique<Channel>(point_of(first));
  }

  std::uint32_t channel() const { return now_; }
  /// As LASzip tells it to the other parts of a point: where it changes, and 0 elsewhere.
  std::uint32_t told_channel() const { return has_changed_ ? now_ : 0; }
  bool is_broken() const {
    return place_.is_broken() || (has_height_ && height_.is_broken()) || (has_kind_ && kind_.is_broken()) ||
           (has_flag_ && flag_.is_broken()) || (has_source_ && source_.is_broken());
  }

  const Point& next() {
    const std::uint32_t changed = decode_change();
    Channel& channel = *channel_[now_];
    Point& point = channel.last;
    const bool has_new_time = (changed & 16) != 0;
    decode_returns(channel, changed);
    const bool is_last = point.number >= point.returns, is_only = is_last && point.number == 1;
    decode_place(channel, has_new_time);
    if (has_kind_) point.kind = symbol_of(kind_, channel.kinds[(point.kind & 31) << 1 | (is_only ? 1u : 0u)], 256);
    if (has_flag_) point.flags = symbol_of(flag_, channel.flags[point.flags], 64);
    if (has_source_ && (changed & 32) != 0)
      point.source =
          static_cast<std::uint32_t>(channel.source.decode(source_, static_cast<std::int32_t>(point.source), 0));
    point.has_new_time = has_new_time;
    return point;
  }

 private:
  /// What is new at the next point, and first whether another channel saw it.
  std::uint32_t decode_change() {
    const Channel& before = *channel_[now_];
    const Point& last = before.last;
    const std::size_t context =
        (last.number == 1 ? 1u : 0u) + (last.number >= last.returns ? 2u : 0u) + (last.has_new_time ? 4u : 0u);
    const std::uint32_t changed = symbol_of(place_, channel_[now_]->changed[context], 128);
    has_changed_ = (changed & 64) != 0;
    if (!has_changed_) return changed;
    now_ = (now_ + symbol_of(place_, channel_[now_]->other_channel, 3) + 1) % channels;
    if (!channel_[now_]) channel_[now_] = std::make_unique<Channel>(last);
    return changed;
  }

  void decode_returns(Channel& channel, std::uint32_t changed) {
    Point& point = channel.last;
    const std::uint32_t number = point.number;
    if ((changed & 4) != 0) point.returns = symbol_of(place_, channel.returns[point.returns], 16);
    if ((changed & 3) == 1) point.number = (number + 1) % 16;
    if ((changed & 3) == 2) point.number = (number + 15) % 16;
    if ((changed & 3) != 3) return;
    if ((changed & 16) != 0)
      point.number = symbol_of(place_, channel.number[number], 16);
    else
      point.number = (number + symbol_of(place_, channel.number_at_same_time, 13) + 2) % 16;
  }

  void decode_place(Channel& channel, bool has_new_time) {
    Point& point = channel.last;
    const std::uint32_t single = point.returns == 1 ? 1 : 0;
    const std::size_t context = context_of_return[point.returns][point.number] * 2u + (has_new_time ? 1u : 0u);
    const std::int32_t dx = channel.x.decode(place_, channel.x_steps[context].get(), single);
    channel.x_steps[context].add(dx);
    const std::size_t y_context = single + std::min(channel.x.width() & ~1u, 20u);
    const std::int32_t dy = channel.y.decode(place_, channel.y_steps[context].get(), y_context);
    channel.y_steps[context].add(dy);
    point.place[0] = sum_of(point.place[0], dx);
    point.place[1] = sum_of(point.place[1], dy);
    if (!has_height_) return;
    const std::uint32_t apart =
        point.returns > point.number ? point.returns - point.number : point.number - point.returns;
    std::int32_t& before = channel.z_before[std::min(apart, 7u)];
    const std::uint32_t width = (channel.x.width() + channel.y.width()) / 2;
    before = channel.z.decode(height_, before, single + std::min(width & ~1u, 18u));
    point.place[2] = before;
  }

  RangeDecoder place_, height_, kind_, flag_, source_;
  bool has_height_, has_kind_, has_flag_, has_source_;
  std::uint32_t now_;
  bool has_changed_ = false;
  std::array<std::unique_ptr<Channel>, channels> channel_;
};

/// The layer of colours; `bytes` may be empty.
class ColourLayer {
 public:
  ColourLayer(std::string_view bytes, std::uint32_t channel, const char* first)
      : decoder_(bytes), is_empty_(bytes.empty()), now_(channel) {
    Known& known = known_[channel].emplace();
    std::memcpy(known.last.data(), first, sizeof known.last);
  }

  bool is_broken() const { return !is_empty_ && decoder_.is_broken(); }

  void next(std::uint32_t channel, char* to) {
    std::optional<Known>* last = &known_[now_];
    // LASzip goes on from the channel before, unless the channel is new.
    if (channel != now_ && !known_[channel]) {
      known_[channel].emplace().last = (*last)->last;
      last = &known_[channel];
    }
    now_ = channel;
    LazColours::Colour& colour = (*last)->last;
    if (!is_empty_) colour = known_[channel]->models.decode(decoder_, colour);
    std::memcpy(to, colour.data(), sizeof colour);
  }

 private:
  struct Known {
    LazColours::Colour last;
    LazColours models;
  };
  RangeDecoder decoder_;
  bool is_empty_;
  std::uint32_t now_;
  std::array<std::optional<Known>, channels> known_;
};

/// Cuts the layers of a chunk out of the bytes behind its first point: their sizes come first. Empty: they do not fit.
std::vector<std::string_view> layers_of(std::string_view bytes, std::size_t count) {
  if (bytes.size() / 4 < count) return {};
  std::vector<std::string_view> all;
  std::size_t place = 4 * count;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t size = load<std::uint32_t>(bytes.data() + 4 * n);
    if (size > bytes.size() - place) return {};
    all.push_back(bytes.substr(place, size));
    place += size;
  }
  return all;
}

}  // namespace

bool unpack_layered(const LazChunk& chunk, const LasHeader& header) {
  const LasFormat& format = header.format;
  if (chunk.bytes.size() < header.record + 4) return false;
  const char* const first = chunk.bytes.data();
  std::memcpy(chunk.to, first, format.bytes);
  if (load<std::uint32_t>(first + header.record) != chunk.points) return false;
  const bool is_coloured = format.colour != LasFormat::none;
  const std::size_t others = (is_coloured ? 1 : 0) + (header.is_infrared ? 1 : 0) + (format.has_waveform ? 1 : 0) +
                             (header.record - format.bytes);
  const auto found = layers_of(chunk.bytes.substr(header.record + 4), layers + others);
  if (found.empty()) return false;
  std::array<std::string_view, layers> plain;
  std::copy_n(found.begin(), layers, plain.begin());
  Points points(plain, first);
  ColourLayer colours(is_coloured ? found[layers] : std::string_view(), points.channel(), first + format.colour);
  for (std::size_t n = 1; n < chunk.points; ++n) {
    char* const record = chunk.to + n * format.bytes;
    std::memcpy(record, first, format.bytes);
    const Point& point = points.next();
    store(point, points.channel(), record);
    if (is_coloured) colours.next(points.told_channel(), record + format.colour);
    if (points.is_broken() || colours.is_broken()) return false;
  }
  return true;
}

}  // namespace dynasurf::io::detail
