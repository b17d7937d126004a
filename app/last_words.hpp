#pragma once

namespace dynasurf::app {

/// Lets the program end with one line on standard error and exit code 2 where C++ would abort: when memory runs out in
/// a place that no exception may leave (a destructor, a thread of a library, the telling of an error). Nothing that is
/// published later exists then; what was begun beside its place is swept up by the next run.
void tell_last_words();

/// The line for a run without memory. Takes none.
void tell_out_of_memory();

}  // namespace dynasurf::app
