"""Ctrl-C ends long work within a second."""

import signal
import subprocess
import sys
import time

import pytest

WORK = {
    "a run": "rb.Block(eta=80, xi_v=0.0).run(theta=0.2, on_separation='fly', duration=5e5, step=1.0, tolerance=1e-13)",
    "a spectrum": "rb.spectrum(p=np.linspace(1, 4, 1_000_000), pulse=pulse)",
    "a sweep": "rb.sweep({'study': {'design': 'grid'}, 'parameters': {'pulse': {'shape': 'OneSine', 'amplitude': 6.0}, "
    "'dimensionless.p': {'from': 1.0, 'to': 4.0, 'count': 1000000}}})",
    "a search": "rb.search_overturning(rb.Block(), pulse=pulse, points=1_000_000)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT for another process")
@pytest.mark.parametrize("work", WORK)
def test_ctrl_c_ends_the_work(work):
    program = f"""
import contextlib, signal
import numpy as np, rocking_block as rb
from rocking_block import _block, _search, _studies

# A shell's background jobs ignore SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)

@contextlib.contextmanager
def ticking(progress):
    said = []
    yield lambda done, total: said or said.append(print("under way", flush=True))

_block.ticking = _search.ticking = _studies.ticking = ticking
pulse = rb.Pulse("one-sine", 6.0, 1.25)
try:
    {WORK[work]}
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        # The work reports its progress.
        assert process.stdout.readline() == "under way\n"
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        assert process.stdout.readline() == "interrupted\n"
        process.wait(10)
        assert time.monotonic() - sent < 1.0
    assert process.returncode == 0


def test_a_bar_shows_how_far_the_work_is(capsys):
    pytest.importorskip("tqdm")
    import rocking_block as rb

    rb.spectrum(p=[1.0 + 0.00001 * i for i in range(60_000)], pulse=rb.Pulse("one-sine", 6.0, 1.25), progress=True)
    assert "/60000" in capsys.readouterr().err
