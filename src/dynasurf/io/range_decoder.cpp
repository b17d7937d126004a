#include "dynasurf/io/detail/range_decoder.hpp"

#include <numeric>

namespace dynasurf::io::detail {
namespace {

constexpr std::uint32_t all = 0x80000000;

}  // namespace

SymbolModel::SymbolModel(std::uint32_t symbols) : begin_(symbols), seen_(symbols, 1), cycle_(symbols) {
  std::uint32_t pieces = 8;
  piece_bits_ = share_bits - 3;
  for (; symbols > 4 * pieces; pieces *= 2) --piece_bits_;
  from_.resize(pieces + 1);
  renew();
  until_renewed_ = cycle_ = (symbols + 6) / 2;
}

void SymbolModel::renew() {
  const auto symbols = static_cast<std::uint32_t>(seen_.size());
  total_ += cycle_;
  if (total_ > 1u << share_bits) {
    for (std::uint32_t& seen : seen_) seen = (seen + 1) / 2;
    total_ = std::accumulate(seen_.begin(), seen_.end(), 0u);
  }
  const std::uint32_t scale = all / total_;
  std::uint32_t before = 0, symbol = 0;
  for (std::size_t n = 0; n < symbols; ++n) {
    begin_[n] = (scale * before) >> (31 - share_bits);
    before += seen_[n];
  }
  for (std::uint32_t piece = 0; piece < from_.size(); ++piece) {
    while (symbol + 1 < symbols && begin_[symbol + 1] <= piece << piece_bits_) ++symbol;
    from_[piece] = symbol;
  }
  until_renewed_ = cycle_ = std::min(5 * cycle_ / 4, 8 * (symbols + 6));
}

void BitModel::renew() {
  total_ += cycle_;
  if (total_ > 1u << share_bits) {
    total_ = (total_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == total_) ++total_;
  }
  zero_share_ = (zeros_ * (all / total_)) >> (31 - share_bits);
  until_renewed_ = cycle_ = std::min(5 * cycle_ / 4, 64u);
}

RangeDecoder::RangeDecoder(std::string_view bytes) : bytes_(bytes) {
  for (int n = 0; n < 4; ++n) value_ = (value_ << 8) | next_byte();
  is_broken_ |= value_ >= length_;
}

std::uint32_t RangeDecoder::next_byte() {
  is_broken_ |= place_ >= bytes_.size();
  return is_broken_ ? 0 : static_cast<unsigned char>(bytes_[place_++]);
}

void RangeDecoder::refill() {
  do {
    is_broken_ |= value_ >= length_;
    if (is_broken_) value_ = 0;
    value_ = (value_ << 8) | next_byte();
    length_ <<= 8;
  } while (length_ < shortest);
}

bool RangeDecoder::bit(BitModel& model) {
  const std::uint32_t zero = model.zero_share_ * (length_ >> BitModel::share_bits);
  const bool is_one = value_ >= zero;
  if (is_one) {
    value_ -= zero;
    length_ -= zero;
  } else {
    length_ = zero;
    ++model.zeros_;
  }
  if (length_ < shortest) refill();
  if (--model.until_renewed_ == 0) model.renew();
  return is_one;
}

std::uint32_t RangeDecoder::few_bits(std::uint32_t count) {
  length_ >>= count;
  const std::uint32_t bits = std::min(value_ / length_, (1u << count) - 1);
  value_ -= bits * length_;
  if (length_ < shortest) refill();
  return bits;
}

std::uint32_t RangeDecoder::bits(std::uint32_t count) {
  if (count <= 19) return few_bits(count);
  const std::uint32_t low = few_bits(16);
  return (few_bits(count - 16) << 16) | low;
}

std::int32_t IntegerModel::difference(RangeDecoder& decoder) {
  constexpr std::uint32_t modelled = 8;  // the highest bits; those below are as good as random
  if (width_ == 0) return decoder.bit(zero_or_one_) ? 1 : 0;
  if (width_ == 32) return INT32_MIN;
  std::uint32_t bits = symbol_of(decoder, differences_[width_], 1u << std::min(width_, modelled));
  if (width_ > modelled) {
    const std::uint32_t low = width_ - modelled;
    bits = (bits << low) | decoder.bits(low);
  }
  // The lower half of all bits is below 0, the upper one above 1.
  const auto number = static_cast<std::int64_t>(bits);
  const std::int64_t half = std::int64_t{1} << (width_ - 1);
  return static_cast<std::int32_t>(number >= half ? number + 1 : number - (2 * half - 1));
}

std::int32_t IntegerModel::decode(RangeDecoder& decoder, std::int32_t expected, std::size_t context) {
  width_ = symbol_of(decoder, widths_[context], bits_ + 1);
  std::int64_t number = std::int64_t{expected} + difference(decoder);
  if (bits_ == 32) return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(number)));
  // Fewer bits hold no sign and go round.
  const std::int64_t range = std::int64_t{1} << bits_;
  if (number < 0) number += range;
  if (number >= range) number -= range;
  return static_cast<std::int32_t>(number);
}

}  // namespace dynasurf::io::detail
