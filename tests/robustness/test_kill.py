"""kill -9 at random moments of a run: the folder asked for holds nothing, the former result, or the whole new one."""

import os
import random
import shutil
import signal
import subprocess
import time
import unittest

from cli import EDGES, PROGRAM, CliTest, hashes, run, small_patient

# A full campaign: DYNASURF_KILLS=10000.
KILLS = int(os.environ.get("DYNASURF_KILLS", "200"))


class Kill(CliTest):
    def start(self, out, level):
        return subprocess.Popen([PROGRAM, "ventricle", small_patient() / "study.dcm", "--out", out, "--no-timings",
                                 "--quiet", "--set", f"mesh_level={level}", *EDGES],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def whole(self, level):
        """What an undisturbed run leaves, and how long it takes."""
        out = self.folder / f"whole-{level}"
        begin = time.monotonic()
        self.assertEqual(self.start(out, level).wait(), 0)
        return hashes(out), time.monotonic() - begin

    def test_leaves_nothing_half_done(self):
        (old, seconds), (new, _) = self.whole(1), self.whole(2)
        self.assertNotEqual(old, new)
        rng = random.Random(20260101)
        place = self.folder / "place"
        place.mkdir()
        out = place / "result"
        seen = {"nothing": 0, "former": 0, "new": 0}
        killed = 0
        runs = 0
        while killed < KILLS and runs < 4 * KILLS:
            before = hashes(out) if out.exists() else None
            after, level = (new, 2) if before != new else (old, 1)
            process = self.start(out, level)
            time.sleep(rng.uniform(0, seconds))
            process.send_signal(signal.SIGKILL)
            was_killed = process.wait() == -signal.SIGKILL
            # How long a run takes changes with the load of the machine; the kills should fall all over it.
            seconds *= 1.05 if was_killed else 0.85
            killed += was_killed
            runs += 1
            now = hashes(out) if out.exists() else None
            self.assertIn(now, [before, after], f"run {runs}")
            seen["nothing" if now is None else "new" if now == after else "former"] += 1
            # Every fourth run starts from nothing.
            if runs % 4 == 0 and out.exists():
                shutil.rmtree(out)
        print(f"{killed} of {runs} runs killed: {seen}")
        self.assertEqual(killed, KILLS)
        self.assertGreater(seen["new"], 0)
        # What killed runs left beside is swept up by the next one.
        self.assertEqual(run("ventricle", small_patient() / "study.dcm", "--out", out, "--quiet", *EDGES).returncode, 0)
        self.assertEqual([path.name for path in place.iterdir()], ["result"])


if __name__ == "__main__":
    unittest.main()
