# What `./dev docs` does. ./dev reads this file; the functions it calls (say, want_commands, install_missing, do_build)
# are there.
#
# One site from README.md, all other Markdown and the headers of the library: build/docs/index.html, with a search that
# needs no server. The manual of options and the pages of the schemas are generated into build/docs-pages first.

docs_pages=build/docs-pages

# The tables of `dynasurf options`, a heading for each subject.
docs_options() {
  local subject kinds
  kinds=$("$1" phantom --help | sed -n 's/^ *KIND TEXT REQUIRED *//p' | sed 's/:.*//; s/,/ /g; s/ or / /')
  printf '# Manual of options\n\n'
  for subject in ventricle cloud organ $(printf 'phantom/%s ' $kinds); do
    printf '## %s\n\n' "${subject/\// }"
    "$1" options ${subject/\// } --markdown
    printf '\n'
  done
}

# The pages of the Python module and its notebooks with their results, where the module was built.
docs_python() {
  local package=$PWD/build/release/python
  if [ ! -d $package/dynasurf ]; then
    say "no Python module in $package: its pages are left out"
    return
  fi
  PYTHONPATH=$package /usr/bin/python3 tools/python_pages.py $docs_pages
}
# A page for ParaView and one for Blender, with pictures, where they are installed.
docs_viewers() {
  DYNASURF_PROGRAM=$1 /usr/bin/python3 tools/viewers/viewer_pages.py - $docs_pages paraview blender ||
    { [ $? -eq 77 ] && say "ParaView and Blender are missing: their pages are left out"; }
}
docs_notebooks() {
  if /usr/bin/python3 -c "import nbclient, nbconvert, ipykernel, matplotlib" 2>/dev/null && [ -f $docs_pages/python-api.md ]; then
    PYTHONPATH=$PWD/build/release/python /usr/bin/python3 tools/notebook_pages.py build/docs/notebooks
  else
    say "the notebooks are not shown: python3-nbclient, python3-nbconvert, python3-ipykernel or python3-matplotlib is missing"
  fi
}

do_docs() {
  # The program only prints the manual of options: DYNASURF_PROGRAM names one that is already built.
  local program_of_docs=${DYNASURF_PROGRAM:-$program}
  [ -n "${DYNASURF_PROGRAM:-}" ] || do_build
  missing=()
  want_commands doxygen:doxygen python3:python3
  install_missing || exit 1
  rm -rf build/docs $docs_pages
  mkdir -p $docs_pages
  docs_options "$program_of_docs" >$docs_pages/manual-of-options.md
  python3 tools/schema_page.py docs/results.schema.json >$docs_pages/results-schema.md
  python3 tools/schema_page.py docs/cloud-results.schema.json >$docs_pages/cloud-results-schema.md
  docs_python || fail "the pages of the Python module were not made"
  docs_viewers "$program_of_docs" || fail "ParaView or Blender did not open a result"
  DYNASURF_VERSION=$("$program_of_docs" --version | grep -o '[0-9.]*' | head -n 1) doxygen docs/Doxyfile ||
    fail "doxygen failed; build/docs-warnings.log tells more"
  docs_notebooks || fail "a notebook did not run"
  say "$(wc -l <build/docs-warnings.log) warnings in build/docs-warnings.log"
  say "open $PWD/build/docs/index.html"
}
