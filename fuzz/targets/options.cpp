#include "dynasurf/synthetic/options.hpp"

#include "dynasurf/io/options_json.hpp"

#include "support/toy_options.hpp"
#include "target.hpp"

namespace dynasurf::fuzz {
namespace {

/// Options of a kind and the members they are seen by.
struct Subject {
  test::Toy toy;  // has a member of every kind
  synthetic::PhantomOptions phantom;
  OptionNodes nodes;
};

/// The first byte chooses: every second value a member of every kind that there is, else one of the phantoms.
void choose(Subject& subject, unsigned char byte) {
  if (byte % 2 == 0) {
    subject.nodes = nodes_of(subject.toy);
    return;
  }
  const ChoiceRef kinds = choice_of(subject.phantom);
  subject.nodes = kinds.choose(byte / 2U % kinds.methods.size());
}

/// What was taken can be written, and what is written is taken and means the same.
void check_round_trip(const Subject& subject, unsigned char byte) {
  const std::string text = io::options_to_text(subject.nodes);
  Subject again;
  choose(again, byte);
  io::options_from_text(text, again.nodes, "");
  require(io::options_to_text(again.nodes) == text, "options are read as they were written");
}

}  // namespace

/// A file of --options.
bool run_options(std::string_view bytes) {
  if (bytes.empty()) return false;
  const auto kind = static_cast<unsigned char>(bytes[0]);
  Subject subject;
  choose(subject, kind);
  const bool taken = reads("", [&] { io::options_from_text(bytes.substr(1), subject.nodes, ""); });
  if (taken) check_round_trip(subject, kind);
  return taken;
}

/// One --set per line.
bool run_settings(std::string_view bytes) {
  if (bytes.empty()) return false;
  const auto kind = static_cast<unsigned char>(bytes[0]);
  Subject subject;
  choose(subject, kind);
  bool taken = false;
  for (std::string_view text = bytes.substr(1); !text.empty();) {
    const std::string_view line = text.substr(0, text.find('\n'));
    taken = reads("", [&] { set_option(subject.nodes, line); }) || taken;
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  if (taken) check_round_trip(subject, kind);
  return taken;
}

}  // namespace dynasurf::fuzz
