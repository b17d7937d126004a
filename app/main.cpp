#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <stop_token>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_dictionary.hpp"
#include "dynasurf/io/detail/machine_memory.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "debug_fault.hpp"
#include "interrupt.hpp"
#include "last_words.hpp"
#include "memory_argument.hpp"
#include "slicer.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

std::string version_text() {
  return std::string("dynasurf ") + version() + " (commit " + commit() + ")\nResearch use only. Not for diagnosis.\n";
}

ExitCode run(int argc, char** argv, const std::stop_token& stop) {
  CLI::App program{
      "Beating surfaces, volumes and ejection fraction of the left ventricle from a gated heart study, and light "
      "closed\n"
      "meshes from scanned points.\n"
      "Research use only. Not for diagnosis.",
      "dynasurf"};
  program.require_subcommand(1);
  program.set_version_flag("--version", version_text());
  program.footer(
      "dynasurf COMMAND --help tells the arguments of a command.\n"
      "Exit codes: 0 done, 1 usage or options, 2 input or output, 3 not trustworthy or not finished.");
  Command chosen;
  add_ventricle(program, chosen);
  add_cloud(program, chosen);
  add_lod(program, chosen);
  add_borders(program, chosen);
  add_info(program, chosen);
  add_phantom(program, chosen);
  add_measure(program, chosen);
  add_options(program, chosen);
  add_rerun(program, chosen);
  add_perfusion(program, chosen);
  add_solid(program, chosen);
  add_motion(program, chosen);
  add_show(program, chosen);
  add_view(program, chosen);
  add_organ(program, chosen);
  add_batch(program, chosen);
  add_collect(program, chosen);
  add_bids(program, chosen);
  std::string memory;
  add_memory_limit(program, memory);

  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (asks_for_slicer_description(words)) {
    print(slicer_description(*program.get_subcommand(words[0])));
    return done;
  }
  refuse_former_name(words);
  const SlicerCall slicer(words);
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    program.parse(words);
  } catch (const CLI::CallForHelp&) {
    print(program.help());  // of the command, where one was given
    return done;
  } catch (const CLI::CallForVersion&) {
    print(version_text());
    return done;
  } catch (const CLI::ParseError& error) {
    throw OptionError(std::string(error.what()) + "; see dynasurf --help");
  }
  const MemoryLimit limit(memory.empty() ? io::default_memory_limit() : memory_from_text(memory));
  cause_debug_fault();
  const ExitCode code = chosen(stop);
  slicer.write_returned(program);
  return code;
}

/// InputError and IoError tell everything themselves; what the standard library throws does not.
std::string words_of(const std::exception& error) {
  if (const auto* files = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return files->path1().string() + ": " + files->code().message();
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  const bool is_thread = std::string_view(error.what()).starts_with("pthread_create");  // oneTBB's own words
  if (is_thread || (system && system->code() == std::errc::resource_unavailable_try_again))
    return "cannot start another thread (limits on processes or memory: ulimit -u, ulimit -v; --threads 1 needs "
           "fewest)";
  return error.what();
}

ExitCode stopped() {
  print_error(words_of_stop());
  return not_trustworthy;
}

ExitCode run_and_report(int argc, char** argv) {
  try {
    io::dicom::leave_dictionary_unread();  // before the first thread
    const Interrupt interrupt;
    return run(argc, argv, interrupt.token());
  } catch (const OptionError& error) {
    print_error(error.what());
    return bad_usage;
  } catch (const Cancelled&) {
    return stopped();
  } catch (const std::bad_alloc&) {
    tell_out_of_memory();
    return bad_input;
  } catch (const std::exception& error) {
    if (is_taken_back()) return stopped();
    print_error(words_of(error));
    return bad_input;
  }
}

}  // namespace
}  // namespace dynasurf::app

int main(int argc, char** argv) {
  dynasurf::app::tell_last_words();
  dynasurf::app::prepare_process();
  return dynasurf::app::run_and_report(argc, argv);
}
