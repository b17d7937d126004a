#include "reconstruction_dicom.hpp"

#include <ctime>

#include "dynasurf/io/study_io.hpp"

namespace dynasurf::app {

namespace fs = std::filesystem;

std::optional<std::string> hash_of(const fs::path& file) {
  if (file.empty()) return std::nullopt;
  return io::sha256_of_file(file);
}

std::string dicom_time(const Job& job, bool study_is_dicom) {
  if (!job.outputs.dicom_time.empty()) return job.outputs.dicom_time;
  if (!job.timings) {
    const io::DicomSubject subject =
        study_is_dicom ? io::read_dicom_subject(job.study, job.series) : io::DicomSubject();
    const bool is_told = subject.study_date.size() == 8 && subject.study_time.size() >= 6;
    return is_told ? subject.study_date + subject.study_time.substr(0, 6) : "20000101000000";
  }
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[16];
  std::strftime(text, sizeof text, "%Y%m%d%H%M%S", &local);
  return text;
}

io::DicomResult dicom_context(const Job& job, const report::Provenance& provenance, bool study_is_dicom) {
  io::DicomResult context;
  context.program_version = provenance.program_version;
  context.date = job.outputs.dicom_time.substr(0, 8);
  context.time = job.outputs.dicom_time.substr(8);
  io::Hasher hasher;
  const auto add = [&](const std::string& text) { hasher.add(text.data(), text.size() + 1); };
  const auto in_json = [](const std::optional<std::string>& hash) { return hash ? '"' + *hash + '"' : "null"; };
  for (const report::InputFile& input : provenance.inputs) add(input.sha256);
  for (const std::string& text : {provenance.options_json, provenance.program_version, provenance.commit,
                                  job.outputs.dicom_time, in_json(hash_of(job.mask)), in_json(hash_of(job.start_mesh))})
    add(text);
  context.content = hasher.finish();
  context.subject = study_is_dicom ? io::read_dicom_subject(job.study, job.series)
                                   : io::nameless_subject(context.content, context.date, context.time);
  return context;
}

}  // namespace dynasurf::app
