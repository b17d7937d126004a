#include "last_words.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>

#include <unistd.h>

#include "command.hpp"

namespace dynasurf::app {
namespace {

/// Not by print_error(), which takes memory. Where standard error is gone, nobody listens.
void say(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(written);
  }
}

[[noreturn]] void end_process() {
  // Several threads may come here at once: one speaks, and the others wait for the end that it brings.
  static std::atomic_flag is_ending;
  while (is_ending.test_and_set()) ::pause();
  try {
    if (std::current_exception()) throw;
    // An exception that a library's own promise of none stops on its way cannot be asked for its name: it is the want
    // of memory in the walk of the standard library through folders.
    say(std::uncaught_exceptions() > 0 ? "dynasurf: error: out of memory, or another failure within a library\n"
                                       : "dynasurf: error: a thread of the program was lost\n");
  } catch (const std::bad_alloc&) {
    tell_out_of_memory();
  } catch (const std::exception& error) {
    say("dynasurf: error: ");
    say(std::string_view(error.what()).substr(0, std::strcspn(error.what(), "\r\n")));
    say("\n");
  } catch (...) {
    say("dynasurf: error: something that is no error was thrown\n");
  }
  ::_exit(bad_input);
}

}  // namespace

void tell_last_words() { std::set_terminate(end_process); }

void tell_out_of_memory() { say("dynasurf: error: out of memory\n"); }

}  // namespace dynasurf::app
