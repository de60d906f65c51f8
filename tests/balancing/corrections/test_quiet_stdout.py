"""What a compiled library prints is dropped, and nothing else."""

import ctypes
import os
import threading

import pytest

from inertia.balancing.corrections.quiet_stdout import quiet_stdout

C = ctypes.CDLL(None)


def test_drops_what_c_prints_and_keeps_what_stands_around_it(capfd: pytest.CaptureFixture[str]) -> None:
    C.puts(b"before")
    with quiet_stdout():
        C.puts(b"noise")
        os.write(1, b"noise\n")
    C.puts(b"after")
    C.fflush(None)
    assert capfd.readouterr().out == "before\nafter\n"


def test_a_fault_in_it_gives_the_output_back(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="fault"), quiet_stdout():
        raise ValueError("fault")
    os.write(1, b"after\n")
    assert capfd.readouterr().out == "after\n"


def test_threads_do_not_silence_each_other_for_good(capfd: pytest.CaptureFixture[str]) -> None:
    inside, leave = threading.Event(), threading.Event()

    def first() -> None:
        with quiet_stdout():
            inside.set()
            leave.wait(5)

    def second() -> None:
        with quiet_stdout():
            pass

    threads = [threading.Thread(target=run) for run in (first, second)]
    threads[0].start()
    inside.wait(5)
    threads[1].start()
    leave.set()
    for thread in threads:
        thread.join(5)
    os.write(1, b"after\n")
    assert capfd.readouterr().out == "after\n"
