#include "dynasurf/io/detail/dicom_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace dynasurf::io {
namespace {

/// Upper-case words with single spaces around each: " GATED SA ".
std::string spaced_words(const std::string& text) {
  std::string words = " ";
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0)
      words += static_cast<char>(std::toupper(letter));
    else if (words.back() != ' ')
      words += ' ';
  }
  if (words.back() != ' ') words += ' ';
  return words;
}

using Marks = std::initializer_list<const char*>;
// Corrected, not corrected: marks with blanks around them match whole words only, so that NAC is no AC.
constexpr Marks corrected_marks{" AC ", " IRAC ", " ATTN "};
constexpr Marks uncorrected_marks{" NC ", " NAC ", " IRNC ", " NOAC "};

bool holds_any(const std::string& words, Marks marks) {
  return std::any_of(marks.begin(), marks.end(),
                     [&](const char* mark) { return words.find(mark) != std::string::npos; });
}

}  // namespace

View view_of_code(const std::string& code, const std::string& scheme) {
  struct Known {
    const char *snomed_ct, *snomed_rt;
    View view;
  };
  constexpr std::array<Known, 5> known{{{"103340004", "G-A186", View::short_axis},
                                        {"131186000", "G-A18B", View::horizontal_long_axis},
                                        {"131185001", "G-A18A", View::vertical_long_axis},
                                        {"62824007", "G-A117", View::transaxial},
                                        {"24422004", "G-A147", View::transaxial}}};
  for (const Known& k : known) {
    if (code == k.snomed_ct && (scheme == "SCT" || scheme.empty())) return k.view;
    // SNM3 and 99SDM are what SNOMED RT was called before.
    if (code == k.snomed_rt && (scheme == "SRT" || scheme == "SNM3" || scheme == "99SDM" || scheme.empty()))
      return k.view;
  }
  return View::unknown;
}

View view_in_words(const std::string& description) {
  const std::string words = spaced_words(description);
  View found = View::unknown;
  int kinds = 0;
  const auto look_for = [&](View view, std::initializer_list<const char*> marks) {
    if (!holds_any(words, marks)) return;
    found = view;
    ++kinds;
  };
  look_for(View::short_axis, {" SA ", " SAX ", " SHORT AX", " SHORTAX", " SHAX "});
  look_for(View::horizontal_long_axis, {" HLA ", " HORIZONTAL LONG", " HORIZ LONG", " H LONG AX", " HLAX "});
  look_for(View::vertical_long_axis, {" VLA ", " VERTICAL LONG", " VERT LONG", " V LONG AX", " VLAX "});
  look_for(View::transaxial, {" TRANSAX", " TRANSVERS", " TRANS ", " AXIAL "});
  // A description that names two views says nothing of this stack.
  return kinds == 1 ? found : View::unknown;
}

Attenuation attenuation_in_words(const std::string& description) {
  const std::string words = spaced_words(description);
  if (holds_any(words, uncorrected_marks)) return Attenuation::uncorrected;
  return holds_any(words, corrected_marks) ? Attenuation::corrected : Attenuation::unknown;
}

std::string circumstances_in_words(const std::string& description) {
  const std::string words = spaced_words(description);
  std::string found;
  const auto look_for = [&](const char* word, std::initializer_list<const char*> marks) {
    if (holds_any(words, marks)) found += (found.empty() ? "" : ", ") + std::string(word);
  };
  look_for("rest", {" REST ", " RST ", " RESTING "});
  look_for("stress", {" STRESS ", " STR ", " STRESSED "});
  look_for("prone", {" PRONE "});
  look_for("supine", {" SUPINE "});
  look_for("attenuation corrected", corrected_marks);
  look_for("not attenuation corrected", uncorrected_marks);
  return found;
}

std::optional<int> gate_in_words(const std::string& description) {
  const std::string words = spaced_words(description);
  for (const char* mark : {" GATE ", " BIN ", " PHASE ", " FRAME ", " GATE", " BIN", " PHASE"}) {
    const std::string word = mark;
    const auto at = words.find(word);
    if (at == std::string::npos) continue;
    int value = 0, digits = 0;
    for (std::size_t n = at + word.size();
         n < words.size() && std::isdigit(static_cast<unsigned char>(words[n])) != 0 && digits < 4; ++n, ++digits)
      value = 10 * value + (words[n] - '0');
    if (digits > 0) return value;
  }
  return std::nullopt;
}

std::string isotope_of(const std::string& code, const std::string& meaning) {
  struct Known {
    const char *snomed_ct, *snomed_rt, *mass, *word;
  };
  constexpr std::array<Known, 7> known{{{"72454003", "C-163A8", "99M", "Tc-99m"},
                                        {"60057003", "C-138A9", "201", "Tl-201"},
                                        {"", "C-114B1", "131", "I-131"},
                                        {"21572004", "C-114A4", "123", "I-123"},
                                        {"77004003", "C-111A1", "18", "F-18"},
                                        {"79197006", "C-159A2", "82", "Rb-82"},
                                        {"21576001", "C-107A1", "13", "N-13"}}};
  const std::string words = spaced_words(meaning);
  for (const Known& k : known) {
    const std::string mass = std::string(" ") + k.mass;
    if ((!code.empty() && (code == k.snomed_ct || code == k.snomed_rt)) || words.find(mass + " ") != std::string::npos)
      return k.word;
  }
  return "";
}

double photopeak_kev(const std::string& isotope) {
  if (isotope.empty() || isotope == "Tc-99m") return 140.5;
  if (isotope == "Tl-201") return 71;  // x-rays of the daughter, 69 to 80 keV; few photons have 167
  if (isotope == "I-123") return 159;
  if (isotope == "I-131") return 364.5;
  return 511;  // the others decay by positrons
}

std::string tracer_of(const std::string& name) {
  const std::string words = spaced_words(name);
  if (holds_any(words, {"SESTAMIBI", " MIBI", "CARDIOLITE"})) return "sestamibi";
  if (holds_any(words, {"TETROFOSMIN", "MYOVIEW"})) return "tetrofosmin";
  if (holds_any(words, {"THALLIUM", "THALLOUS"})) return "thallous chloride";
  if (holds_any(words, {"RUBIDIUM"})) return "rubidium chloride";
  if (holds_any(words, {"AMMONIA"})) return "ammonia";
  if (holds_any(words, {"DEOXYGLUCOSE", " FDG "})) return "fluorodeoxyglucose";
  if (holds_any(words, {"FLURPIRIDAZ"})) return "flurpiridaz";
  return "";
}

bool is_correction(const std::string& term) {
  constexpr std::array<const char*, 19> terms{"UNIF", "COR",   "NCO",    "DECY", "ATTN", "SCAT", "DTIM",
                                              "NRGY", "LIN",   "MOTN",   "CLN",  "NORM", "RADL", "DCAL",
                                              "RAN",  "RANSM", "RANSUB", "RESO", "PSF"};
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

}  // namespace dynasurf::io
