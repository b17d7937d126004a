import concurrent.futures
import os
import pathlib
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time

import dynasurf as ds
import numpy as np
import pytest


def test_progress_is_told_in_the_calling_thread(study):
    told = []
    ds.ventricle.reconstruct(study, preset="edges",
                             progress=lambda *event: told.append((threading.get_ident(), *event)))  # fmt: skip
    assert {t[0] for t in told} == {threading.get_ident()}
    stages = {t[1] for t in told}
    assert {"borders", "surfaces"} <= stages
    assert ("borders", 6, 6) in [t[1:] for t in told]


def test_progress_of_true_needs_nothing(study, capfd):
    ds.ventricle.reconstruct(study, preset="edges", progress=True)
    assert capfd.readouterr().err


def test_an_exception_of_progress_stops_the_work(study):
    class Enough(Exception):
        pass

    def progress(*event):
        raise Enough

    with pytest.raises(Enough):
        ds.ventricle.reconstruct(study, progress=progress)
    assert ds.mesh.icosphere(1)  # the interpreter is as it was


@pytest.mark.parametrize(
    "work",
    [
        "ds.ventricle.reconstruct(study)",
        "ds.field.flow_field(big, ds.field.Gvf(iterations=1000000))",
        "ds.cloud.reconstruct(points, triangles=[20000, 5120])",
        "list(ds.dynamics.evolve_steps(*motion))",
        "ds.dynamics.evolve(*motion)",
    ],
)
def test_ctrl_c_stops_within_a_fifth_of_a_second(work):
    script = textwrap.dedent(f"""
        import os, signal, threading, time
        import numpy as np
        import dynasurf as ds
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background ignores it
        study = ds.synthetic.make_phantom(ds.synthetic.VirtualPatient(gates=16)).study
        big = ds.Image(np.random.default_rng(1).random((40, 80, 80)), spacing=(1, 1, 1))
        points = ds.synthetic.make_cloud(shape="blobs", points=200000)
        still = ds.VectorField(np.zeros((3, 9, 9, 9)), ds.Image(np.zeros((9, 9, 9)), spacing=(1, 1, 1)).grid)
        ball = ds.mesh.icosphere(4)
        ball = ds.TriMesh(ball.vertices * 2 + 4, ball.triangles)
        motion = ball, still, ds.Image(np.zeros((9, 9, 9)), spacing=(1, 1, 1)), ds.dynamics.Evolution(
            end=ds.dynamics.StopConv(max_steps=100000000, still_steps=100000))
        sent = []
        def interrupt():
            time.sleep(0.5)
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            {work}
        except KeyboardInterrupt:
            late = time.monotonic() - sent[0]
            assert ds.mesh.volume_mm3(ds.mesh.icosphere(3)) > 4
            print(f"stopped {{late:.3f}}")
        else:
            print("ended")
    """)
    begin = time.monotonic()
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    word, seconds = done.stdout.split()
    # A busy machine may let the waiting thread sleep longer than it asked for.
    assert word == "stopped" and float(seconds) < 0.2 + 0.05 * os.getloadavg()[0], f"{seconds} s of {time.monotonic() - begin}"


def test_a_handler_of_ones_own_is_called_while_work_goes_on(study):
    called = []
    former = signal.signal(signal.SIGALRM, lambda *_: called.append(1))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        ds.ventricle.reconstruct(study, preset="edges")
    finally:
        signal.signal(signal.SIGALRM, former)
    assert called == [1]


def test_other_threads_of_python_go_on(study):
    counted = [0]
    stop = threading.Event()

    def count():
        while not stop.wait(0.001):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    ds.ventricle.reconstruct(study, preset="edges")
    stop.set()
    thread.join()
    assert counted[0] > 20


def test_threads_of_futures_give_the_same_bytes(study, edges_heart):
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        hearts = list(pool.map(lambda _: ds.ventricle.reconstruct(study, preset="edges"), range(3)))
    assert len({h.results_text(timings=False) for h in [*hearts, edges_heart]}) == 1


def reconstruct_in_process(array, affine):
    heart = ds.ventricle.reconstruct(ds.Study(array, affine=affine), preset="edges")
    return heart.results["edv_ml"], heart.gates[0].endo.mesh


def test_processes_of_futures_work(study):
    import multiprocessing

    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        edv, mesh = pool.submit(reconstruct_in_process, study.array, study.affine).result()
    here, same = reconstruct_in_process(study.array, study.affine)
    assert edv == here and np.array_equal(mesh.vertices, same.vertices)


def resident_kib():
    """Memory of this process now, not its highest; what allocators hold back is given up first."""
    import ctypes
    import gc

    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path("/proc/self/status").read_text())[1])


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="memory is read from /proc")
@pytest.mark.parametrize("what", ["study", "cloud"])
def test_200_reconstructions_keep_no_memory(what):
    lattice = ds.synthetic.Lattice(nx=24, ny=24, nz=14, dx_mm=6.4, dy_mm=6.4, dz_mm=6.4)
    study = ds.synthetic.make_phantom(ds.synthetic.VirtualPatient(gates=2, lattice=lattice)).study
    points = ds.synthetic.make_cloud(shape="sphere", points=300)

    def reconstruct():
        if what == "cloud":
            lods = ds.cloud.reconstruct(points, triangles=[80])
            return lods[0].vertices.sum(), lods[0].mesh.triangles.sum(), lods.facts
        heart = ds.ventricle.reconstruct(study, preset="edges", mesh_level=1)
        return heart.segments, heart.results, [g.endo and g.endo.vertices.sum() for g in heart.gates], study.array

    def rounds(count):
        for _ in range(count):
            reconstruct()
        return resident_kib()

    begin = rounds(40)
    end = rounds(160)
    # One study of these is 64 KiB, its result more: one of them kept in each round would be tens of MiB.
    assert end - begin < 4096, f"{end - begin} KiB in 160 reconstructions"
