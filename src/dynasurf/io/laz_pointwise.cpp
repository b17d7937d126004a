#include <cstring>

#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/las.hpp"
#include "dynasurf/io/detail/laz_colours.hpp"

// LAZ, items of version 2: the properties of each point are coded one after the other, in one stream.

namespace dynasurf::io::detail {
namespace {

/// Which of the points before is looked at for a point: return r of n.
constexpr std::array<std::array<std::uint8_t, 8>, 8> context_of_pulse{{{15, 14, 13, 12, 11, 10, 9, 8},
                                                                       {14, 0, 1, 3, 6, 10, 10, 9},
                                                                       {13, 1, 2, 4, 7, 11, 11, 10},
                                                                       {12, 3, 4, 5, 8, 12, 12, 11},
                                                                       {11, 6, 7, 8, 9, 13, 13, 12},
                                                                       {10, 10, 11, 12, 13, 14, 14, 13},
                                                                       {9, 10, 11, 12, 13, 14, 15, 14},
                                                                       {8, 9, 10, 11, 12, 13, 14, 15}}};

std::uint8_t byte_at(const char* record, std::size_t place) { return static_cast<std::uint8_t>(record[place]); }

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

/// Place, flags and source of a point: the first 20 bytes.
class PlainPoints {
 public:
  /// `record` holds the last point.
  void decode(RangeDecoder& decoder, char* record) {
    const std::uint32_t changed = symbol_of(decoder, changed_, 64);
    if ((changed & 32) != 0) next_byte(decoder, returns_, record, 14);
    const std::uint32_t number = byte_at(record, 14) & 7u, returns = byte_at(record, 14) >> 3 & 7u;
    const std::uint8_t context = context_of_pulse[returns][number];
    if ((changed & 16) != 0) intensity_.decode(decoder, 0, std::min<std::size_t>(context, 3));
    if ((changed & 8) != 0) next_byte(decoder, kinds_, record, 15);
    if ((changed & 4) != 0) symbol_of(decoder, angles_[byte_at(record, 14) >> 6 & 1u], 256);
    if ((changed & 2) != 0) next_byte(decoder, users_, record, 17);
    if ((changed & 1) != 0)
      store(record + 18, static_cast<std::uint16_t>(source_.decode(decoder, load<std::uint16_t>(record + 18), 0)));
    decode_place(decoder, record, context, returns == 1, returns > number ? returns - number : number - returns);
  }

 private:
  using Models = std::array<SymbolModel, 256>;  // per value of the point before

  static void next_byte(RangeDecoder& decoder, Models& models, char* record, std::size_t place) {
    record[place] = static_cast<char>(symbol_of(decoder, models[byte_at(record, place)], 256));
  }

  void decode_place(RangeDecoder& decoder, char* record, std::size_t context, bool is_single, std::size_t level) {
    const std::uint32_t single = is_single ? 1 : 0;
    const auto place = [&](std::size_t axis) { return load<std::int32_t>(record + 4 * axis); };
    const std::int32_t dx = x_.decode(decoder, x_steps_[context].get(), single);
    x_steps_[context].add(dx);
    store(record, sum_of(place(0), dx));
    const std::int32_t dy = y_.decode(decoder, y_steps_[context].get(), single + std::min(x_.width() & ~1u, 20u));
    y_steps_[context].add(dy);
    store(record + 4, sum_of(place(1), dy));
    const std::uint32_t width = (x_.width() + y_.width()) / 2;
    heights_[level] = z_.decode(decoder, heights_[level], single + std::min(width & ~1u, 18u));
    store(record + 8, heights_[level]);
  }

  SymbolModel changed_;
  Models returns_, kinds_, users_;
  std::array<SymbolModel, 2> angles_;
  IntegerModel intensity_{16, 4}, source_{16, 1}, x_{32, 2}, y_{32, 22}, z_{32, 20};
  std::array<LazMedian, 16> x_steps_, y_steps_;
  std::array<std::int32_t, 8> heights_{};
};

/// Times of GPS in up to four sequences that take turns. Only how far the coder is matters here, not the times.
class Times {
 public:
  void decode(RangeDecoder& decoder) {
    // A sequence is changed at most a few times in a row; a coder's nonsense could go on for ever.
    for (int turn = 0; turn < 8; ++turn)
      if (!changes_sequence(decoder)) return;
  }

 private:
  static constexpr std::uint32_t most = 500, fewest = 10, same = most + fewest + 1, whole = same + 1;

  bool changes_sequence(RangeDecoder& decoder) {
    if (steps_[now_] == 0) {
      const std::uint32_t symbol = symbol_of(decoder, still_, 6);
      if (symbol == 1) step_is(differences_.decode(decoder, 0, 0));
      if (symbol == 2) begin_sequence(decoder);
      if (symbol > 2) now_ = (now_ + symbol - 2) & 3;
      return symbol > 2;
    }
    const std::uint32_t symbol = symbol_of(decoder, multiples_, most + fewest + 6);
    if (symbol > whole) {
      now_ = (now_ + symbol - whole) & 3;
      return true;
    }
    if (symbol == whole) begin_sequence(decoder);
    if (symbol < same) decode_multiple(decoder, symbol);
    return false;
  }

  /// The step is about so many times the last one: 0 to 500, then -1 to -10.
  void decode_multiple(RangeDecoder& decoder, std::uint32_t symbol) {
    if (symbol == 1) {
      differences_.decode(decoder, steps_[now_], 1);
      extremes_[now_] = 0;
      return;
    }
    const bool is_negative = symbol > most, is_extreme = symbol == 0 || symbol == most || symbol == most + fewest;
    const std::int64_t times = is_negative ? std::int64_t{most} - symbol : symbol;
    const std::size_t context = symbol == 0               ? 7
                                : symbol == most          ? 4
                                : symbol == most + fewest ? 6
                                : is_negative             ? 5
                                : symbol < 10             ? 2
                                                          : 3;
    const auto expected =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(times * steps_[now_])));
    const std::int32_t step = differences_.decode(decoder, expected, context);
    if (is_extreme && ++extremes_[now_] > 3) step_is(step);
  }

  void step_is(std::int32_t step) {
    steps_[now_] = step;
    extremes_[now_] = 0;
  }

  void begin_sequence(RangeDecoder& decoder) {
    differences_.decode(decoder, 0, 8);
    decoder.bits(16);
    decoder.bits(16);
    now_ = newest_ = (newest_ + 1) & 3;
    step_is(0);
  }

  SymbolModel still_, multiples_;
  IntegerModel differences_{32, 9};
  std::size_t now_ = 0, newest_ = 0;
  std::array<std::int32_t, 4> steps_{};
  std::array<int, 4> extremes_{};
};

}  // namespace

void LazMedian::add(std::int32_t value) {
  // The highest or the lowest makes room, and the new one goes where it belongs.
  std::size_t place;
  if (gives_up_highest_) {
    gives_up_highest_ = value < sorted_[2];
    for (place = 4; place > 0 && value < sorted_[place - 1]; --place) sorted_[place] = sorted_[place - 1];
  } else {
    gives_up_highest_ = value <= sorted_[2];
    for (place = 0; place < 4 && sorted_[place + 1] < value; ++place) sorted_[place] = sorted_[place + 1];
  }
  sorted_[place] = value;
}

bool unpack_pointwise(const LazChunk& chunk, const LasHeader& header) {
  if (chunk.bytes.size() < header.record) return false;
  std::string record(chunk.bytes.substr(0, header.record));
  const std::size_t extra = header.record - header.format.bytes;
  std::vector<SymbolModel> extras(extra);
  PlainPoints points;
  Times times;
  LazColours colours;
  RangeDecoder decoder(chunk.bytes.substr(header.record));
  for (std::size_t n = 0; n < chunk.points; ++n) {
    if (n > 0) {
      points.decode(decoder, record.data());
      if (header.format.time != LasFormat::none) times.decode(decoder);
      if (header.format.colour != LasFormat::none) {
        char* const place = record.data() + header.format.colour;
        LazColours::Colour colour;
        std::memcpy(colour.data(), place, sizeof colour);
        colour = colours.decode(decoder, colour);
        std::memcpy(place, colour.data(), sizeof colour);
      }
      for (SymbolModel& model : extras) symbol_of(decoder, model, 256);
      if (decoder.is_broken()) return false;
    }
    std::memcpy(chunk.to + n * header.format.bytes, record.data(), header.format.bytes);
  }
  return true;
}

}  // namespace dynasurf::io::detail
