#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "dynasurf/io/detail/bytes.hpp"

// A writer of LAZ for tests: the coder of LASzip, told from its reader, with models of its own. What the reader does
// not ask for (times, angles) is drawn at random among what the format allows.

namespace dynasurf::test {

struct LazPoint {
  std::array<std::int32_t, 3> place{};
  std::array<std::uint16_t, 3> colour{};
  std::uint16_t intensity = 0, source = 0;
  std::uint8_t number = 1, returns = 1, flags = 0, kind = 0, user = 0, channel = 0;
  bool has_new_time = false;
};

struct LazFile {
  int format = 0;               // of the points
  std::size_t chunk = 50'000;   // points in each
  std::size_t extra_bytes = 0;  // behind each point
  bool tells_counts = false;    // in the table, as COPC does
  bool is_one_chunk = false;    // as the first LASzip wrote
  bool has_late_table = false;  // its place stands at the end of the file
  std::uint32_t seed = 1;       // of what is drawn
};

class LazModel {
 public:
  explicit LazModel(std::uint32_t symbols = 2) : seen_(symbols, 1), begin_(symbols), cycle_(symbols) {
    renew();
    left_ = cycle_ = (symbols + 6) >> 1;
  }

 private:
  friend class LazEncoder;
  void renew() {
    if ((total_ += cycle_) > 32768) {
      total_ = 0;
      for (auto& n : seen_) total_ += n = (n + 1) >> 1;
    }
    std::uint32_t sum = 0;
    for (std::size_t s = 0; s < seen_.size(); sum += seen_[s++]) begin_[s] = (0x80000000u / total_ * sum) >> 16;
    left_ = cycle_ = std::min<std::uint32_t>((5 * cycle_) >> 2, static_cast<std::uint32_t>(seen_.size() + 6) << 3);
  }
  std::vector<std::uint32_t> seen_, begin_;
  std::uint32_t total_ = 0, cycle_, left_;
};

class LazEncoder {
 public:
  void symbol(LazModel& m, std::uint32_t s) {
    const bool last = s + 1 == m.seen_.size();
    const std::uint32_t unit = length_ >> 15, from = m.begin_[s] * unit;
    add(from);
    length_ = last ? length_ - from : m.begin_[s + 1] * unit - from;
    renorm();
    ++m.seen_[s];
    if (--m.left_ == 0) m.renew();
  }
  struct Bit {
    std::uint32_t zeros = 1, total = 2, share = 4096, cycle = 4, left = 4;
  };
  void bit(Bit& m, bool one) {
    const std::uint32_t zero = m.share * (length_ >> 13);
    if (one) {
      add(zero);
      length_ -= zero;
    } else {
      length_ = zero;
      ++m.zeros;
    }
    renorm();
    if (--m.left != 0) return;
    if ((m.total += m.cycle) > 8192) {
      m.total = (m.total + 1) >> 1;
      m.zeros = (m.zeros + 1) >> 1;
      if (m.zeros == m.total) ++m.total;
    }
    m.share = (m.zeros * (0x80000000u / m.total)) >> 18;
    m.left = m.cycle = std::min((5 * m.cycle) >> 2, 64u);
  }
  void bits(std::uint32_t count, std::uint32_t value) {
    if (count > 19) {
      bits(16, value & 0xffff);
      value >>= 16;
      count -= 16;
    }
    length_ >>= count;
    add(value * length_);
    renorm();
  }
  std::string done() {
    const bool is_long = length_ > 1u << 25;
    add(is_long ? 1u << 24 : 1u << 23);
    length_ = is_long ? 1u << 23 : 1u << 15;
    renorm();
    return bytes_ + std::string(is_long ? 3 : 2, '\0');
  }

 private:
  void add(std::uint32_t more) {
    const std::uint64_t sum = std::uint64_t{base_} + more;
    base_ = static_cast<std::uint32_t>(sum & 0xffffffffu);
    if (sum >> 32 == 0) return;
    std::size_t n = bytes_.size();
    while (bytes_[--n] == '\xff') bytes_[n] = 0;
    bytes_[n] = static_cast<char>(bytes_[n] + 1);
  }
  void renorm() {
    for (; length_ < 1u << 24; length_ <<= 8) {
      bytes_ += static_cast<char>(base_ >> 24);
      base_ = (base_ & 0xffffffu) << 8;
    }
  }
  std::string bytes_;
  std::uint32_t base_ = 0, length_ = 0xffffffff;
};

class LazInteger {
 public:
  LazInteger(int bits, std::size_t contexts) : bits_(bits) {
    for (std::size_t n = 0; n < contexts; ++n) widths_.emplace_back(bits + 1);
    for (int k = 0; k <= bits; ++k) differences_.emplace_back(1u << std::min(std::max(k, 1), 8));
  }
  int width = 0;
  void encode(LazEncoder& out, std::int64_t expected, std::int64_t real, std::size_t context = 0) {
    std::int64_t c = real - expected;
    const std::int64_t range = std::int64_t{1} << bits_;
    while (c < -range / 2) c += range;
    while (c >= range / 2) c -= range;
    width = 0;
    for (std::int64_t rest = c <= 0 ? -c : c - 1; rest > 0; rest >>= 1) ++width;
    out.symbol(widths_[context], static_cast<std::uint32_t>(width));
    if (width == 0) return out.bit(zero_or_one_, c == 1);
    if (width == 32) return;
    const auto code = static_cast<std::uint32_t>(c < 0 ? c + (std::int64_t{1} << width) - 1 : c - 1);
    if (width <= 8) return out.symbol(differences_[static_cast<std::size_t>(width)], code);
    out.symbol(differences_[static_cast<std::size_t>(width)], code >> (width - 8));
    out.bits(static_cast<std::uint32_t>(width - 8), code & ((1u << (width - 8)) - 1));
  }

 private:
  int bits_;
  std::vector<LazModel> widths_, differences_;
  LazEncoder::Bit zero_or_one_;
};

/// The median of the last five, by the book: sorted numbers of which one end is given up.
class LazFive {
 public:
  std::int32_t get() const { return v_[2]; }
  void add(std::int32_t n) {
    const bool was_high = high_;
    high_ = was_high ? n < v_[2] : n <= v_[2];
    v_.erase(was_high ? v_.end() - 1 : v_.begin());
    v_.insert(was_high ? std::upper_bound(v_.begin(), v_.end(), n) : std::lower_bound(v_.begin(), v_.end(), n), n);
  }

 private:
  std::vector<std::int32_t> v_ = std::vector<std::int32_t>(5, 0);
  bool high_ = true;
};

class LazColourCoder {
 public:
  void encode(LazEncoder& out, const std::array<std::uint16_t, 3>& a, const std::array<std::uint16_t, 3>& b) {
    const auto half = [](std::uint16_t v, int h) { return h == 0 ? v & 255 : v >> 8; };
    std::uint32_t changed = b[1] != b[0] || b[2] != b[0] ? 64 : 0;
    for (std::size_t c = 0; c < 3; ++c)
      for (int h = 0; h < 2; ++h)
        if (half(a[c], h) != half(b[c], h)) changed |= 1u << (2 * c + static_cast<std::size_t>(h));
    out.symbol(used_, changed);
    const auto put = [&](std::size_t c, int h, int step) {
      const std::size_t n = 2 * c + static_cast<std::size_t>(h);
      if ((changed >> n & 1) != 0)
        out.symbol(steps_[n],
                   static_cast<std::uint32_t>(half(b[c], h) - std::clamp(half(a[c], h) + step, 0, 255)) & 255);
    };
    const auto step = [&](std::size_t c, int h) { return half(b[c], h) - half(a[c], h); };
    put(0, 0, 0);
    put(0, 1, 0);
    if ((changed & 64) == 0) return;
    for (int h = 0; h < 2; ++h) {
      put(1, h, step(0, h));
      put(2, h, (step(0, h) + step(1, h)) / 2);
    }
  }

 private:
  LazModel used_{128};
  std::vector<LazModel> steps_ = std::vector<LazModel>(6, LazModel(256));
};

/// Models of a kind, made when asked.
class LazModels {
 public:
  explicit LazModels(std::uint32_t symbols) : symbols_(symbols) {}
  LazModel& operator[](std::size_t context) { return models_.try_emplace(context, symbols_).first->second; }

 private:
  std::uint32_t symbols_;
  std::map<std::size_t, LazModel> models_;
};

/// Points one after the other: formats 0 to 3.
class LazPointwise {
 public:
  LazPointwise(const LazFile& file, std::mt19937& random) : file_(file), random_(random) {
    for (std::size_t n = 0; n < file.extra_bytes; ++n) extra_.emplace_back(256);
  }

  std::string first(const LazPoint& p) {
    std::string out = plain(p);
    if (has_time()) out += std::string(8, '\x11');
    if (has_colour())
      for (const auto c : p.colour) io::detail::append(out, c);
    last_ = p;
    return out + std::string(file_.extra_bytes, 'e');
  }

  void next(LazEncoder& out, const LazPoint& p) {
    const std::string now = plain(p), before = plain(last_);
    const auto byte = [](const std::string& record, std::size_t n) { return static_cast<unsigned char>(record[n]); };
    static constexpr int context[8][8] = {{15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},
                                          {13, 1, 2, 4, 7, 11, 11, 10},    {12, 3, 4, 5, 8, 12, 12, 11},
                                          {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
                                          {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};
    const auto m = static_cast<std::size_t>(context[p.returns & 7][p.number & 7]);
    std::uint32_t changed = 0;
    if (byte(now, 14) != byte(before, 14)) changed |= 32;
    if (p.intensity != intensities_[m]) changed |= 16;
    if (byte(now, 15) != byte(before, 15)) changed |= 8;
    if (random_() % 8 == 0) changed |= 4;
    if (p.user != last_.user) changed |= 2;
    if (p.source != last_.source) changed |= 1;
    out.symbol(changed_, changed);
    if ((changed & 32) != 0) out.symbol(returns_[byte(before, 14)], byte(now, 14));
    if ((changed & 16) != 0) intensity_.encode(out, intensities_[m], p.intensity, std::min<std::size_t>(m, 3));
    intensities_[m] = p.intensity;
    if ((changed & 8) != 0) out.symbol(kinds_[byte(before, 15)], byte(now, 15));
    if ((changed & 4) != 0) out.symbol(angles_[byte(now, 14) >> 6 & 1], random_() % 256);
    if ((changed & 2) != 0) out.symbol(users_[last_.user], p.user);
    if ((changed & 1) != 0) source_.encode(out, last_.source, p.source);
    const std::size_t single = p.returns == 1 ? 1 : 0;
    const auto even = [](int width, int most) { return static_cast<std::size_t>(std::min(width / 2 * 2, most)); };
    const auto step = [&](std::size_t axis) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(p.place[axis]) -
                                       static_cast<std::uint32_t>(last_.place[axis]));
    };
    x_.encode(out, x_steps_[m].get(), step(0), single);
    x_steps_[m].add(step(0));
    y_.encode(out, y_steps_[m].get(), step(1), single + even(x_.width, 20));
    y_steps_[m].add(step(1));
    std::int32_t& height = heights_[static_cast<std::size_t>(std::abs(p.returns - p.number))];
    z_.encode(out, height, p.place[2], single + even((x_.width + y_.width) / 2, 18));
    height = p.place[2];
    if (has_time()) time(out);
    if (has_colour()) colours_.encode(out, last_.colour, p.colour);
    for (LazModel& model : extra_) out.symbol(model, random_() % 3);
    last_ = p;
  }

 private:
  bool has_time() const { return file_.format == 1 || file_.format == 3; }
  bool has_colour() const { return file_.format >= 2; }

  static std::string plain(const LazPoint& p) {
    std::string out;
    for (const auto c : p.place) io::detail::append(out, c);
    io::detail::append(out, p.intensity);
    out += static_cast<char>(p.number | p.returns << 3 | (p.flags >> 4) << 6);
    out += static_cast<char>((p.kind & 31) | (p.flags & 4) << 5);
    out += '\0';
    out += static_cast<char>(p.user);
    io::detail::append(out, p.source);
    return out;
  }

  /// Any step of the time that the format allows.
  void time(LazEncoder& out, int turns = 0) {
    const auto drawn = [&] { return static_cast<std::int32_t>(random_() % 2000) - 1000; };
    const auto begin = [&] {
      times_.encode(out, 0, drawn(), 8);
      out.bits(16, random_() % 65536);
      out.bits(16, random_() % 65536);
      now_ = newest_ = (newest_ + 1) % 4;
      steps_[now_] = extremes_[now_] = 0;
    };
    if (steps_[now_] == 0) {
      const std::uint32_t symbol = random_() % (turns < 3 ? 6 : 3);  // the last three change the sequence
      out.symbol(still_, symbol);
      if (symbol == 1) {
        times_.encode(out, 0, steps_[now_] = drawn(), 0);
        extremes_[now_] = 0;
      }
      if (symbol == 2) begin();
      if (symbol > 2) {
        now_ = (now_ + symbol - 2) % 4;
        time(out, turns + 1);
      }
      return;
    }
    static constexpr std::uint32_t some[] = {0, 0, 0, 0, 1, 2, 9, 10, 300, 499, 500, 501, 509, 510, 511, 512, 513, 515};
    const std::uint32_t symbol = some[random_() % (std::size(some) - (turns < 3 ? 0 : 2))];
    out.symbol(multiples_, symbol);
    if (symbol == 511) return;
    if (symbol == 512) return begin();
    if (symbol > 512) {
      now_ = (now_ + symbol - 512) % 4;
      return time(out, turns + 1);
    }
    const std::int32_t step = drawn();
    const std::size_t kind = symbol == 0     ? 7
                             : symbol == 1   ? 1
                             : symbol < 10   ? 2
                             : symbol < 500  ? 3
                             : symbol == 500 ? 4
                             : symbol < 510  ? 5
                                             : 6;
    const int times = symbol <= 500 ? static_cast<int>(symbol) : 500 - static_cast<int>(symbol);
    times_.encode(out, std::int64_t{times} * steps_[now_], step, kind);
    if (symbol == 1) extremes_[now_] = 0;
    if ((symbol == 0 || symbol == 500 || symbol == 510) && ++extremes_[now_] > 3) {
      steps_[now_] = step;
      extremes_[now_] = 0;
    }
  }

  LazFile file_;
  std::mt19937& random_;
  LazPoint last_;
  LazModel changed_{64}, still_{6}, multiples_{516};
  LazModels returns_{256}, kinds_{256}, users_{256}, angles_{256};
  LazInteger intensity_{16, 4}, source_{16, 1}, x_{32, 2}, y_{32, 22}, z_{32, 20}, times_{32, 9};
  std::array<LazFive, 16> x_steps_, y_steps_;
  std::array<std::int32_t, 8> heights_{};
  std::array<std::uint16_t, 16> intensities_{};
  std::array<std::int32_t, 4> steps_{};
  std::array<int, 4> extremes_{};
  std::size_t now_ = 0, newest_ = 0;
  LazColourCoder colours_;
  std::vector<LazModel> extra_;
};

/// Properties in layers: formats 6 to 8.
class LazLayered {
 public:
  LazLayered(const LazFile& file, std::mt19937& random) : file_(file), random_(random) {}

  std::string chunk(const LazPoint* points, std::size_t count) {
    std::string out = plain(points[0]);
    const std::size_t colours = file_.format == 6 ? 0 : 1, infrared = file_.format == 8 ? 1 : 0;
    if (colours != 0)
      for (const auto c : points[0].colour) io::detail::append(out, c);
    if (infrared != 0) out += "ir";
    out += std::string(file_.extra_bytes, 'e');
    io::detail::append(out, static_cast<std::uint32_t>(count));
    now_ = points[0].channel;
    channel_.erase(channel_.begin(), channel_.end());
    channel_.try_emplace(now_, points[0]);
    colour_now_ = now_;
    colour_.erase(colour_.begin(), colour_.end());
    colour_[now_].last = points[0].colour;
    LazEncoder coders[5];
    bool used[5] = {true, false, false, false, false};
    for (std::size_t n = 1; n < count; ++n) {
      used[1] |= points[n].place[2] != points[0].place[2];
      used[2] |= points[n].kind != points[0].kind;
      used[3] |= points[n].flags != points[0].flags;
      used[4] |= points[n].source != points[0].source;
    }
    LazEncoder red;
    bool has_red = false;
    for (std::size_t n = 1; n < count; ++n) has_red |= points[n].colour != points[0].colour;
    for (std::size_t n = 1; n < count; ++n) {
      // LASzip tells the coder of colours the channel where it changes, and 0 elsewhere.
      const std::size_t told = points[n].channel != now_ ? points[n].channel : 0;
      next(coders, used, points[n]);
      if (colours != 0 && has_red) next_colour(red, points[n], told);
    }
    // In the order of the format; of what the reader skips, some bytes that mean nothing.
    std::vector<std::string> layers(9 + colours + infrared + file_.extra_bytes);
    for (std::size_t n = 0; n < 4; ++n)
      if (used[n]) layers[n] = coders[n].done();
    if (used[4]) layers[7] = coders[4].done();
    if (has_skipped) layers[4] = layers[8] = "nothing";
    if (colours != 0 && has_red) layers[9] = red.done();
    for (const std::string& layer : layers) io::detail::append(out, static_cast<std::uint32_t>(layer.size()));
    for (const std::string& layer : layers) out += layer;
    return out;
  }

  bool has_skipped = false;

 private:
  struct Channel {
    explicit Channel(const LazPoint& p) : last(p) {
      last.has_new_time = false;
      heights.fill(p.place[2]);
    }
    LazPoint last;
    LazModels changed{128}, returns{16}, number{16}, kinds{256}, flags{64};
    LazModel other{3}, same_time{13};
    LazInteger x{32, 2}, y{32, 22}, z{32, 20}, source{16, 1};
    std::array<LazFive, 12> x_steps, y_steps;
    std::array<std::int32_t, 8> heights{};
  };

  static std::string plain(const LazPoint& p) {
    std::string out;
    for (const auto c : p.place) io::detail::append(out, c);
    io::detail::append(out, p.intensity);
    out += static_cast<char>(p.number | p.returns << 4);
    out += static_cast<char>((p.flags & 15) | p.channel << 4 | (p.flags >> 4) << 6);
    out += static_cast<char>(p.kind);
    out += static_cast<char>(p.user);
    out += std::string(2, '\0');
    io::detail::append(out, p.source);
    return out + std::string(8, '\x11');
  }

  static std::size_t context_of(std::size_t n, std::size_t r) {
    static const char* const rows[16] = {
        "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
        "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
        "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
        "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};
    return static_cast<std::size_t>(rows[n][r] - '0');
  }

  void next(LazEncoder (&out)[5], const bool (&used)[5], const LazPoint& p) {
    Channel* c = &channel_.at(now_);
    const LazPoint& before = c->last;
    const std::size_t context =
        (before.number == 1 ? 1u : 0u) + (before.number >= before.returns ? 2u : 0u) + (before.has_new_time ? 4u : 0u);
    const bool is_other = p.channel != now_;
    if (is_other) channel_.try_emplace(p.channel, before);
    Channel& to = channel_.at(p.channel);
    const LazPoint last = to.last;
    const std::uint32_t apart = (p.number + 16u - last.number) % 16;
    std::uint32_t changed = apart == 0 ? 0 : apart == 1 ? 1 : apart == 15 ? 2 : 3;
    if (p.returns != last.returns) changed |= 4;
    if (p.has_new_time) changed |= 16;
    if (p.source != last.source) changed |= 32;
    if (is_other) changed |= 64;
    out[0].symbol(c->changed[context], changed);
    if (is_other) out[0].symbol(c->other, (p.channel + 4u - static_cast<std::uint32_t>(now_) - 1) % 4);
    now_ = p.channel;
    if ((changed & 4) != 0) out[0].symbol(to.returns[last.returns], p.returns);
    if ((changed & 3) == 3) {
      if (p.has_new_time)
        out[0].symbol(to.number[last.number], p.number);
      else
        out[0].symbol(to.same_time, apart - 2);
    }
    const auto step = [&](std::size_t axis) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(p.place[axis]) -
                                       static_cast<std::uint32_t>(last.place[axis]));
    };
    const auto even = [](int width, int most) { return static_cast<std::size_t>(std::min(width / 2 * 2, most)); };
    const std::size_t single = p.returns == 1 ? 1 : 0;
    const std::size_t steps = 2 * context_of(p.returns, p.number) + (p.has_new_time ? 1 : 0);
    to.x.encode(out[0], to.x_steps[steps].get(), step(0), single);
    to.x_steps[steps].add(step(0));
    to.y.encode(out[0], to.y_steps[steps].get(), step(1), single + even(to.x.width, 20));
    to.y_steps[steps].add(step(1));
    if (used[1]) {
      std::int32_t& height = to.heights[static_cast<std::size_t>(std::min(std::abs(p.returns - p.number), 7))];
      to.z.encode(out[1], height, p.place[2], single + even((to.x.width + to.y.width) / 2, 18));
      height = p.place[2];
    }
    const bool is_only = p.number == 1 && p.number >= p.returns;
    if (used[2]) out[2].symbol(to.kinds[(last.kind & 31u) * 2 + (is_only ? 1 : 0)], p.kind);
    if (used[3]) out[3].symbol(to.flags[last.flags], p.flags);
    if (used[4] && (changed & 32) != 0) to.source.encode(out[4], last.source, p.source);
    to.last = p;
  }

  void next_colour(LazEncoder& out, const LazPoint& p, std::size_t told) {
    Colour* from = &colour_[colour_now_];
    if (told != colour_now_ && !colour_.contains(told)) {
      colour_[told].last = from->last;
      from = &colour_[told];
    }
    colour_now_ = told;
    colour_[told].coder.encode(out, from->last, p.colour);
    from->last = p.colour;
  }

  struct Colour {
    std::array<std::uint16_t, 3> last{};
    LazColourCoder coder;
  };
  LazFile file_;
  std::mt19937& random_;
  std::size_t now_ = 0, colour_now_ = 0;
  std::map<std::size_t, Channel> channel_;
  std::map<std::size_t, Colour> colour_;
};

/// A whole file. Coordinates are thousandths.
inline std::string laz(const std::vector<LazPoint>& points, const LazFile& file, bool has_skipped = false) {
  using io::detail::append;
  const bool layered = file.format >= 6;
  static constexpr std::size_t format_bytes[] = {20, 28, 26, 34, 0, 0, 30, 36, 38};
  const std::size_t record = format_bytes[file.format] + file.extra_bytes, header = layered ? 375 : 227;
  std::vector<std::array<std::size_t, 3>> items;
  if (layered) {
    items.push_back({10, 30, 3});
    if (file.format == 7) items.push_back({11, 6, 3});
    if (file.format == 8) items.push_back({12, 8, 3});
    if (file.extra_bytes > 0) items.push_back({14, file.extra_bytes, 3});
  } else {
    items.push_back({6, 20, 2});
    if (file.format == 1 || file.format == 3) items.push_back({7, 8, 2});
    if (file.format >= 2) items.push_back({8, 6, 2});
    if (file.extra_bytes > 0) items.push_back({0, file.extra_bytes, 2});
  }
  const std::size_t coding = 34 + 6 * items.size(), begin = header + 54 + coding;
  std::string out(header, '\0');
  const auto set = [&](std::size_t place, auto value) { std::memcpy(out.data() + place, &value, sizeof value); };
  std::memcpy(out.data(), "LASF", 4);
  set(24, std::uint8_t{1});
  set(25, static_cast<std::uint8_t>(layered ? 4 : 2));
  set(94, static_cast<std::uint16_t>(header));
  set(96, static_cast<std::uint32_t>(begin));
  set(100, std::uint32_t{1});
  set(104, static_cast<std::uint8_t>(128 + file.format));
  set(105, static_cast<std::uint16_t>(record));
  set(107, static_cast<std::uint32_t>(layered ? 0 : points.size()));
  for (std::size_t axis = 0; axis < 3; ++axis) set(131 + 8 * axis, 0.001);
  if (layered) set(247, std::uint64_t{points.size()});
  std::string head(54, '\0');
  std::memcpy(head.data() + 2, "laszip encoded", 14);
  const auto number = std::uint16_t{22204}, bytes = static_cast<std::uint16_t>(coding);
  std::memcpy(head.data() + 18, &number, 2);
  std::memcpy(head.data() + 20, &bytes, 2);
  out += head;
  append(out, static_cast<std::uint16_t>(layered ? 3 : file.is_one_chunk ? 1 : 2));
  append(out, std::uint16_t{0});
  append(out, std::uint32_t{0x00000202});
  append(out, std::uint32_t{0});
  append(out, file.tells_counts ? ~std::uint32_t{0} : static_cast<std::uint32_t>(file.chunk));
  append(out, ~std::uint64_t{0});
  append(out, ~std::uint64_t{0});
  append(out, static_cast<std::uint16_t>(items.size()));
  for (const auto& item : items)
    for (const std::size_t n : item) append(out, static_cast<std::uint16_t>(n));
  if (!file.is_one_chunk) append(out, ~std::uint64_t{0});

  std::mt19937 random(file.seed);
  std::vector<std::array<std::size_t, 2>> table;
  for (std::size_t n = 0; n < points.size();) {
    // Chunks that the table counts may have any size.
    const std::size_t most = file.is_one_chunk   ? points.size()
                             : file.tells_counts ? 1 + random() % file.chunk
                                                 : file.chunk;
    const std::size_t count = std::min(most, points.size() - n);
    std::string chunk;
    if (layered) {
      LazLayered coder(file, random);
      coder.has_skipped = has_skipped;
      chunk = coder.chunk(points.data() + n, count);
    } else {
      LazPointwise coder(file, random);
      LazEncoder stream;
      chunk = coder.first(points[n]);
      for (std::size_t k = 1; k < count; ++k) coder.next(stream, points[n + k]);
      chunk += stream.done();
    }
    table.push_back({count, chunk.size()});
    out += chunk;
    n += count;
  }
  if (file.is_one_chunk) return out;
  const std::uint64_t place = out.size();
  if (!file.has_late_table) set(begin, place);
  append(out, std::uint32_t{0});
  append(out, static_cast<std::uint32_t>(table.size()));
  LazEncoder stream;
  LazInteger numbers(32, 2);
  std::array<std::size_t, 2> last{};
  for (const auto& entry : table) {
    if (file.tells_counts)
      numbers.encode(stream, static_cast<std::int64_t>(last[0]), static_cast<std::int64_t>(entry[0]), 0);
    numbers.encode(stream, static_cast<std::int64_t>(last[1]), static_cast<std::int64_t>(entry[1]), 1);
    last = entry;
  }
  out += stream.done();
  if (file.has_late_table) append(out, place);
  return out;
}

}  // namespace dynasurf::test
