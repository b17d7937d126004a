"""Runs pytest on the files that are named. Exit code 77, with a message, where what the tests need is not installed."""

import importlib.util
import sys


def main():
    for module, package in (("pytest", "python3-pytest"), ("numpy", "python3-numpy")):
        if importlib.util.find_spec(module) is None:
            print(f"skipped: {module} is not installed for {sys.executable} (on Debian: {package})")
            return 77
    import pytest

    return pytest.main(["-q", "-p", "no:cacheprovider", "--durations=5", *sys.argv[1:]])


if __name__ == "__main__":  # processes that a test starts read this file, too
    sys.exit(main())
