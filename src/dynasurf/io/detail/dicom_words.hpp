#pragma once
#include <optional>
#include <string>

#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

// What the words and codes of a DICOM header mean. Answers come from fixed lists, so that no free text of a file (a
// name typed into the wrong field) ever reaches an output.

/// View of an entry of ViewCodeSequence (context group 26): SNOMED CT codes, or the older SNOMED RT ones.
View view_of_code(const std::string& code, const std::string& scheme);

/// View named in a description ("GATED SA", "H Long Ax"); unknown when it names none or more than one.
View view_in_words(const std::string& description);

/// What a description says of the patient and of corrections: "stress, prone, attenuation corrected"; "" for nothing.
std::string circumstances_in_words(const std::string& description);

/// Whether a description says that attenuation was corrected.
Attenuation attenuation_in_words(const std::string& description);

/// The number in "gate 3", "bin 3", "phase 3" or "frame 3" of a description.
std::optional<int> gate_in_words(const std::string& description);

/// "Tc-99m" for the codes and names of the isotopes used on hearts; "" for others.
std::string isotope_of(const std::string& code, const std::string& meaning);
/// Energy of the photons that images are made of, keV, for a word of `isotope_of`; of Tc-99m when it is empty.
double photopeak_kev(const std::string& isotope);
/// "sestamibi" and the like; "" for others.
std::string tracer_of(const std::string& name);
/// One of the defined terms of CorrectedImage.
bool is_correction(const std::string& term);

}  // namespace dynasurf::io
