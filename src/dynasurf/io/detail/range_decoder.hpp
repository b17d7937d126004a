#pragma once
#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace dynasurf::io::detail {

/// How often the symbols of an alphabet have come so far, as the coder of LAZ counts them (A. Said, Introduction to
/// Arithmetic Coding, HP Labs 2004): shares of 2^15 that are renewed more and more rarely.
class SymbolModel {
 public:
  SymbolModel() = default;  // of no symbol: not made yet
  explicit SymbolModel(std::uint32_t symbols);
  bool is_empty() const { return seen_.empty(); }

 private:
  friend class RangeDecoder;
  static constexpr std::uint32_t share_bits = 15;

  void renew();

  std::vector<std::uint32_t> begin_;  // the share of all symbols before each
  std::vector<std::uint32_t> seen_;
  std::vector<std::uint32_t> from_;  // the symbol at the begin of each piece of the shares
  std::uint32_t piece_bits_ = 0, total_ = 0, cycle_ = 0, until_renewed_ = 0;
};

/// The same of a bit, in shares of 2^13.
class BitModel {
 private:
  friend class RangeDecoder;
  static constexpr std::uint32_t share_bits = 13;

  void renew();

  std::uint32_t zeros_ = 1, total_ = 2, zero_share_ = 1u << (share_bits - 1), cycle_ = 4, until_renewed_ = 4;
};

/// Reads what the range coder of LAZ wrote. Never reads beyond its bytes: where they do not suffice, or no coder wrote
/// them, it is broken and what it tells is of no use.
class RangeDecoder {
 public:
  /// `bytes` outlive it.
  explicit RangeDecoder(std::string_view bytes);
  std::uint32_t symbol(SymbolModel& model);
  bool bit(BitModel& model);
  /// `count` bits without a model, 1 to 32.
  std::uint32_t bits(std::uint32_t count);
  bool is_broken() const { return is_broken_; }

 private:
  static constexpr std::uint32_t shortest = 1u << 24;

  std::uint32_t next_byte();
  std::uint32_t few_bits(std::uint32_t count);
  void refill();

  std::string_view bytes_;
  std::size_t place_ = 0;
  std::uint32_t value_ = 0, length_ = 0xffffffff;  // where in the interval, and how long it is
  bool is_broken_ = false;
};

/// Integers as differences to what was expected: first how many bits the difference has, then these.
class IntegerModel {
 public:
  /// Of 32 bits, or fewer, that are predicted in so many contexts.
  IntegerModel(std::uint32_t bits, std::size_t contexts) : bits_(bits), widths_(contexts), differences_(bits + 1) {}
  std::int32_t decode(RangeDecoder& decoder, std::int32_t expected, std::size_t context);
  /// Of the last difference, in bits.
  std::uint32_t width() const { return width_; }

 private:
  std::int32_t difference(RangeDecoder& decoder);

  std::uint32_t bits_, width_ = 0;
  std::vector<SymbolModel> widths_;
  BitModel zero_or_one_;
  std::vector<SymbolModel> differences_;  // per width
};

/// The symbol of a model that is made when it is first asked.
inline std::uint32_t symbol_of(RangeDecoder& decoder, SymbolModel& model, std::uint32_t symbols) {
  if (model.is_empty()) model = SymbolModel(symbols);
  return decoder.symbol(model);
}

inline std::uint32_t RangeDecoder::symbol(SymbolModel& model) {
  const std::uint32_t whole = length_;
  length_ >>= SymbolModel::share_bits;
  const std::uint32_t share = std::min(value_ / length_, (1u << SymbolModel::share_bits) - 1);
  const std::uint32_t piece = share >> model.piece_bits_;
  std::uint32_t symbol = model.from_[piece], end = model.from_[piece + 1] + 1;
  while (end - symbol > 1) {
    const std::uint32_t middle = (symbol + end) / 2;
    (model.begin_[middle] > share ? end : symbol) = middle;
  }
  const std::uint32_t begin = model.begin_[symbol] * length_;
  // The last symbol also has what the division left over.
  const bool is_last = symbol + 1 == model.begin_.size();
  length_ = (is_last ? whole : model.begin_[symbol + 1] * length_) - begin;
  value_ -= begin;
  if (length_ < shortest) refill();
  ++model.seen_[symbol];
  if (--model.until_renewed_ == 0) model.renew();
  return symbol;
}

}  // namespace dynasurf::io::detail
